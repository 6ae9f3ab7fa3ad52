"""Things by name: built in, installed as a plug-in, or code that the user allows to be run.

A name in a file of somebody else's must not run code. So ``module:attribute`` is imported only
where its module is among those allowed in that call; built-in names and entry points of installed
packages always are.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import entry_points
from typing import Generic, TypeVar

from subsoil.errors import NotAllowedError, ParameterError

T = TypeVar("T")

NOBODY: frozenset[str] = frozenset()
"""No module beside what is registered."""


@dataclass(frozen=True)
class Registry(Generic[T]):
    """Things of one kind by name.

    Attributes
    ----------
    kind
        What they are, in a word.
    group
        Entry points at which installed packages offer more of them.
    built_in
        Those that are always there.
    """

    kind: str
    group: str
    built_in: Mapping[str, T]

    def __getitem__(self, name: str) -> T:
        """Return the registered thing of a name."""
        return self.named(name)

    def named(self, name: str, allowed: frozenset[str] = NOBODY) -> T:
        """Thing of a name, or of ``module:attribute`` if its module is allowed.

        Raises
        ------
        ParameterError
            If there is none, or it cannot be imported.
        NotAllowedError
            If it is code of a module that was not allowed.
        """
        if name in self.built_in:
            return self.built_in[name]
        for point in entry_points(group=self.group, name=name):
            thing: T = point.load()
            return thing
        module, _, attribute = name.partition(":")
        if not (attribute and all(part.isidentifier() for part in module.split("."))):
            raise ParameterError(
                f"there is no {self.kind} {name!r}",
                where=self.kind,
                remedy=f"one of {', '.join(self.names)}, or your own as module:attribute",
            )
        if module not in allowed:
            raise NotAllowedError(
                f"{name!r} is code of the module {module!r}, which was not run",
                where=self.kind,
                remedy=f"if you trust it, give --allow {module}",
            )
        return self._imported(name, module, attribute)

    @property
    def names(self) -> tuple[str, ...]:
        """All registered names."""
        return (*self.built_in, *sorted(point.name for point in entry_points(group=self.group)))

    def _imported(self, name: str, module: str, attribute: str) -> T:
        try:
            thing: T = getattr(import_module(module), attribute)
        except (ImportError, AttributeError) as error:
            raise ParameterError(
                f"cannot import {name!r}: {error}",
                where=self.kind,
                remedy="check that Python finds the module from here",
            ) from error
        if not callable(thing):
            raise ParameterError(f"{name!r} is not callable", where=self.kind)
        return thing


def module_of(name: str) -> frozenset[str]:
    """Module that a name typed by the user allows: that of ``module:attribute``, else none.

    Examples
    --------
    >>> sorted(module_of("mine.own:strategy")), sorted(module_of("greedy"))
    (['mine.own'], [])
    """
    module, _, attribute = name.partition(":")
    return frozenset([module]) if attribute else NOBODY
