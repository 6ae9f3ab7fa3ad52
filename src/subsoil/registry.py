"""Things by name: built in, installed as a plug-in, or code that the user allows to be run.

A name in a file of somebody else's must not run code. So ``module:attribute`` is imported only
where its module is among those allowed in that call; built-in names and entry points of installed
packages always are, and what was handed over in memory is what its name then stands for.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from importlib.metadata import entry_points
from types import ModuleType
from typing import Any, Generic, TypeVar, cast

from subsoil.errors import NotAllowedError, ParameterError, brief

T = TypeVar("T")

Thing = Callable[..., Any]


@dataclass(frozen=True)
class Allowed:
    """Code that may be run beside what is registered.

    Attributes
    ----------
    modules
        Names of modules that may be imported.
    given
        Things handed over in memory, by the names that are recorded for them.

    Examples
    --------
    >>> sorted((Allowed.by_name("mine.own:strategy") | Allowed.by_name("greedy")).modules)
    ['mine.own']
    """

    modules: frozenset[str] = frozenset()
    given: Mapping[str, Thing] = field(default_factory=dict)

    @classmethod
    def by_name(cls, *names: str) -> Allowed:
        """What names that the user typed allow: the modules of ``module:attribute``."""
        pairs = (name.partition(":") for name in names)
        return cls(frozenset(module for module, _, attribute in pairs if attribute))

    def __or__(self, other: Allowed) -> Allowed:
        """Both."""
        return Allowed(self.modules | other.modules, {**self.given, **other.given})


NOBODY = Allowed()
"""No code beside what is registered."""


def handed_over(thing: str | Thing) -> tuple[str, Allowed]:
    """Name to record of what a caller of the library gives, and leave to run it.

    Examples
    --------
    >>> handed_over("mine:strategy")[0], handed_over(abs)[0]
    ('mine:strategy', 'builtins:abs')
    """
    if isinstance(thing, str):
        return thing, Allowed.by_name(thing)
    named = thing if hasattr(thing, "__qualname__") else type(thing)
    name = f"{named.__module__}:{named.__qualname__}"
    return name, Allowed(given={name: thing})


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

    def named(self, name: str, allowed: Allowed = NOBODY) -> T:
        """Thing of a name, given in memory, or of ``module:attribute`` if its module is allowed.

        Raises
        ------
        ParameterError
            If there is none, or it cannot be imported.
        NotAllowedError
            If it is code of a module that was not allowed.
        """
        if name in allowed.given:
            return cast("T", allowed.given[name])
        if name in self.built_in:
            return self.built_in[name]
        for point in entry_points(group=self.group, name=name):
            thing: T = point.load()
            return thing
        module, _, attribute = name.partition(":")
        if not (attribute and all(part.isidentifier() for part in module.split("."))):
            raise ParameterError(
                f"there is no {self.kind} {brief(name)!r}",
                where=self.kind,
                remedy=f"one of {', '.join(self.names)}, or your own as module:attribute",
            )
        if module not in allowed.modules:
            raise NotAllowedError(
                f"{brief(name)!r} is code of the module {brief(module)!r}, which was not run",
                where=self.kind,
                remedy=f"if you trust it, give --allow {brief(module, 200)}",
            )
        return self._imported(name, module, attribute)

    @property
    def names(self) -> tuple[str, ...]:
        """All registered names."""
        return (*self.built_in, *sorted(point.name for point in entry_points(group=self.group)))

    def _imported(self, name: str, module: str, attribute: str) -> T:
        found = imported(module, f"{self.kind} {brief(name)}")
        if not hasattr(found, attribute):
            raise ParameterError(
                f"cannot import {brief(name)!r}: its module has no {brief(attribute)!r}",
                where=self.kind,
                remedy=f"check what {brief(module, 200)} defines",
            )
        thing: T = getattr(found, attribute)
        if not callable(thing):
            raise ParameterError(f"{brief(name)!r} is not callable", where=self.kind)
        return thing


def imported(module: str, where: str) -> ModuleType:
    """Module of a name, which the user allows to be run.

    Parameters
    ----------
    module
        Its full name.
    where
        What asks for it, for messages.

    Raises
    ------
    ParameterError
        If it cannot be imported, whatever goes wrong in it.
    """
    try:
        return import_module(module)
    except Exception as error:
        raise ParameterError(
            f"cannot import {brief(module)!r}: {brief(f'{type(error).__name__}: {error}', 200)}",
            where=where,
            remedy="check its name, and that Python finds and loads it from this folder",
        ) from error
