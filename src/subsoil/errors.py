"""Everything that can go wrong, as one tree.

::

    SubsoilError                 exit code 3
    ├── InputError               exit code 2   something given to subsoil is wrong
    │   ├── BoundaryError            a field outline
    │   ├── ReadingsError            readings of an instrument or robot
    │   ├── ParameterError           a parameter of a function or the command line
    │   │   └── NotAllowedError          code named by a file, which the user did not allow
    │   ├── ReportError              what an agent says and that cannot be taken
    │   └── MissingExtraError        an optional library is not installed
    ├── KrigingError             exit code 3   a system that has no answer
    │   └── SingularSystemError      not positive definite
    ├── JournalError             exit code 3   a survey file that cannot be used
    │   ├── SurveyBusyError          another process is writing to it
    │   └── CorruptJournalError      what it says does not add up
    ├── DataUnavailableError     exit code 3   a data set that is not at hand
    └── RobotError               exit code 3   the robot cannot go on
        └── BatteryError             not enough charge for the next stop

Every message says what happened, where, and what to do about it, on one line. What a file or an
agent says is in it only as far as :func:`brief` leaves it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar


def printable(text: str) -> str:
    r"""Text on one line, without signs that a terminal would obey or hide.

    Examples
    --------
    >>> printable("a\x1b[31m field\nof mine")
    'a?[31m field of mine'
    """
    return "".join(sign if sign.isprintable() else "?" for sign in " ".join(text.split()))


def brief(text: str, most: int = 40) -> str:
    """Text of somebody else in a message, cut short where it is long.

    Examples
    --------
    >>> brief("a" * 50, 5)
    'aaaaa...'
    """
    return text if len(text) <= most else f"{text[:most]}..."


def listed(names: Sequence[str], most: int = 6) -> str:
    """Names in a message, cut short where there are many or one is long.

    Examples
    --------
    >>> listed(["a", "b", "c"], 2)
    'a, b and 1 more'
    """
    shown = ", ".join(brief(name) for name in names[:most])
    return f"{shown} and {len(names) - most} more" if len(names) > most else shown


class SubsoilError(Exception):
    """Root of all errors that subsoil raises on purpose.

    Parameters
    ----------
    what
        What happened, in one clause.
    where
        File, row, cell, layer or parameter concerned.
    remedy
        What the user can do about it.

    Examples
    --------
    >>> print(SubsoilError("the file is empty", where="field.geojson", remedy="export it again"))
    field.geojson: the file is empty (remedy: export it again)
    """

    exit_code: ClassVar[int] = 3

    def __init__(self, what: str, *, where: str = "", remedy: str = "") -> None:
        self.what, self.where, self.remedy = what, where, remedy
        place = f"{where}: " if where else ""
        advice = f" (remedy: {remedy})" if remedy else ""
        super().__init__(f"{place}{what}{advice}")

    def __reduce__(self) -> tuple[object, ...]:
        return _rebuild, (type(self), self.what, self.where, self.remedy)


def _rebuild(kind: type[SubsoilError], what: str, where: str, remedy: str) -> SubsoilError:
    return kind(what, where=where, remedy=remedy)


class InputError(SubsoilError):
    """Something given to subsoil is wrong."""

    exit_code = 2


class BoundaryError(InputError):
    """A field outline or keep-out cannot be used."""


class ReadingsError(InputError):
    """Readings of an instrument or robot cannot be used."""


class ParameterError(InputError):
    """A parameter is outside what it may be."""


class NotAllowedError(ParameterError):
    """A file names code to run, and the user did not allow it."""


class ReportError(InputError):
    """A report or a request of an agent cannot be taken; the survey is as it was before."""


class MissingExtraError(InputError):
    """An optional library is needed and not installed."""


class KrigingError(SubsoilError):
    """A kriging system has no answer."""


class SingularSystemError(KrigingError):
    """A kriging system is not positive definite."""


class JournalError(SubsoilError):
    """A survey file cannot be used."""


class SurveyBusyError(JournalError):
    """Another process is writing to the survey file."""


class CorruptJournalError(JournalError):
    """What the survey file says does not add up."""


class DataUnavailableError(SubsoilError):
    """A data set is neither on this machine nor reachable."""


class RobotError(SubsoilError):
    """The robot cannot go on."""


class BatteryError(RobotError):
    """The battery does not last for the next stop."""
