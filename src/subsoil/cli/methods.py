"""Which strategies and estimators there are, and what can be set about them."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

from subsoil.cli.output import AsJson, say, tell
from subsoil.registry import Registry
from subsoil.strategies import named
from subsoil.variogram import estimators

_OWN = (
    "One of your own is given as module:attribute, such as --strategy mine:plan for plan(view) or "
    "--estimator mine:estimate for estimate(at, z) in mine.py of this folder; its parameters are "
    "settings. Try on it first what holds of these: subsoil bench check mine:plan"
)
_ROLE = re.compile(r"^An? :\w+:`[^`]*`: ")
_REGISTRIES: dict[str, Registry[Any]] = {
    "strategy": named.REGISTRY,
    "estimator": estimators.REGISTRY,
}


@dataclass(frozen=True)
class _Method:
    """A strategy or an estimator, in a line, and what can be set about it."""

    what: str
    settings: Mapping[str, object]

    @property
    def lines(self) -> tuple[str, ...]:
        """For people: what it is, and its settings if it has any."""
        settings = ", ".join(f"{name}={value}" for name, value in self.settings.items())
        return (self.what, settings) if settings else (self.what,)


def strategies(as_json: AsJson = False) -> None:
    """List strategies and estimators, with their settings and what these are when not set."""
    found = {
        kind: {name: _method(registry[name]) for name in registry.names}
        for kind, registry in _REGISTRIES.items()
    }
    if as_json:
        tell({kind: _as_json(methods) for kind, methods in found.items()}, as_json)
        return
    for kind, methods in found.items():
        print()
        say(f"For --{kind}; each setting with --{kind}-setting NAME=VALUE:")
        tell({name: method.lines for name, method in methods.items()}, as_json)
    print()
    say(_OWN)


def _as_json(methods: Mapping[str, _Method]) -> dict[str, object]:
    return {
        name: {"what": method.what, "settings": method.settings} for name, method in methods.items()
    }


def _method(method: Callable[..., Any]) -> _Method:
    """What a method says of itself."""
    first = (inspect.getdoc(method) or "").partition("\n\n")[0]
    what = _ROLE.sub("", " ".join(first.split()))
    what = what[:1].upper() + what[1:]
    if not is_dataclass(method):
        known = list(inspect.signature(method).parameters.values())[1:]
        return _Method(what, {parameter.name: parameter.default for parameter in known})
    values = {each.name: getattr(method, each.name) for each in fields(method)}
    numbers = {
        name: int(value) if isinstance(value, bool) else value
        for name, value in values.items()
        if isinstance(value, int | float)
    }
    if "model" in values:
        what = f"{what.rstrip('.')}: {values['model'].__name__}."
    return _Method(what, numbers)
