"""Libraries that come with an extra: loaded when they are needed, or named in the error."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from types import ModuleType

from subsoil.errors import MissingExtraError

Need = tuple[str, str, str]
"""A module, the extra of subsoil that brings it, and what it is needed for."""

GEOTIFF: Need = ("rasterio", "geo", "a GeoTIFF")
FIGURES: Need = ("matplotlib", "plot", "drawing figures")
REPORT: Need = ("jinja2", "plot", "a report")


def load(module: str, extra: str, what: str, *, where: str = "", instead: str = "") -> ModuleType:
    """Load an optional library.

    Parameters
    ----------
    module
        Name of the module.
    extra
        The extra of subsoil that brings it.
    what
        What it is needed for, such as ``"a GeoTIFF"``.
    where
        File that needs it.
    instead
        What else the user can do.

    Raises
    ------
    MissingExtraError
        If it is not installed.

    Examples
    --------
    >>> load("json", "all", "a report").__name__
    'json'
    >>> load("no_such_library", "geo", "a GeoTIFF")
    Traceback (most recent call last):
    ...
    subsoil.errors.MissingExtraError: a GeoTIFF needs no_such_library, which is not installed \
(remedy: pip install 'subsoil[geo]')
    """
    try:
        return import_module(module)
    except ImportError as error:
        raise _missing([(module, extra, what)], where, instead) from error


def require(*needs: Need) -> None:
    """Check that all libraries are there before work starts that takes them.

    Raises
    ------
    MissingExtraError
        If some are not installed; it names them all.

    Examples
    --------
    >>> require(("json", "all", "a report"))
    >>> require(("no_such_library", "geo", "a GeoTIFF"), ("no_other", "plot", "a report"))
    Traceback (most recent call last):
    ...
    subsoil.errors.MissingExtraError: a GeoTIFF needs no_such_library, a report needs no_other, \
which are not installed (remedy: pip install 'subsoil[geo,plot]')
    """
    missing = [need for need in needs if not _importable(need[0])]
    if missing:
        raise _missing(missing)


def install(*extras: str) -> str:
    """Command that installs extras of subsoil.

    Examples
    --------
    >>> install("geo", "plot")
    "pip install 'subsoil[geo,plot]'"
    """
    return f"pip install 'subsoil[{','.join(dict.fromkeys(extras))}]'"


def _importable(module: str) -> bool:
    try:
        import_module(module)
    except ImportError:
        return False
    return True


def _missing(needs: Sequence[Need], where: str = "", instead: str = "") -> MissingExtraError:
    clauses = [f"{what} needs {module.partition('.')[0]}" for module, _, what in needs]
    command = install(*(extra for _, extra, _ in needs))
    return MissingExtraError(
        f"{', '.join(clauses)}, which {'is' if len(needs) == 1 else 'are'} not installed",
        where=where,
        remedy=f"{command}, or {instead}" if instead else command,
    )
