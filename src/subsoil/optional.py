"""Libraries that come with an extra: loaded when they are needed, or named in the error."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

from subsoil.errors import MissingExtraError


def load(module: str, extra: str, what: str) -> ModuleType:
    """Load an optional library.

    Parameters
    ----------
    module
        Name of the module.
    extra
        The extra of subsoil that brings it.
    what
        What it is needed for, such as ``"a GeoTIFF"``.

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
        raise MissingExtraError(
            f"{what} needs {module.partition('.')[0]}, which is not installed",
            remedy=f"pip install 'subsoil[{extra}]'",
        ) from error
