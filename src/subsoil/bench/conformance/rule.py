"""A rule that every implementation keeps, and what came of trying it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from subsoil.errors import SubsoilError, brief, printable
from subsoil.registry import NOBODY, Allowed


@dataclass(frozen=True)
class Subject:
    """A strategy or an estimator to try rules on.

    Attributes
    ----------
    name
        As the registry or ``module:attribute`` has it.
    allowed
        Modules whose code may be run, or what was handed over in memory.
    """

    name: str
    allowed: Allowed = NOBODY


@dataclass(frozen=True)
class Rule:
    """Something that holds of every implementation.

    Attributes
    ----------
    words
        What holds, in a sentence.
    remedy
        What to do where it does not.
    cases
        Names of the fields or readings that it is tried on.
    seen
        From a subject and the name of a case to what was seen there that must not be, in words;
        empty where the rule holds.
    """

    words: str
    remedy: str
    cases: tuple[str, ...]
    seen: Callable[[Subject, str], str]


@dataclass(frozen=True)
class Verdict:
    """What came of trying a rule.

    Attributes
    ----------
    rule
        The rule in words.
    case
        Name of the first field or readings on which it is broken; empty if it holds.
    seen
        What was seen there; empty if the rule holds.
    remedy
        What to do about it; empty if the rule holds.
    """

    rule: str
    case: str = ""
    seen: str = ""
    remedy: str = ""

    @property
    def holds(self) -> bool:
        """Whether nothing was seen that must not be."""
        return not self.seen

    def __str__(self) -> str:
        if self.holds:
            return f"ok: {self.rule}"
        return f"BROKEN: {self.rule}: {self.seen} (on: {self.case}; remedy: {self.remedy})"


def verdict(rule: Rule, subject: Subject) -> Verdict:
    """Try a rule on each of its cases, up to the first on which it is broken."""
    for case in rule.cases:
        try:
            seen, remedy = rule.seen(subject, case), rule.remedy
        except SubsoilError as error:
            seen, remedy = error.what, error.remedy or rule.remedy
        except Exception as error:  # whatever somebody's code brings about
            seen, remedy = (
                f"it ends in {type(error).__name__}: {brief(str(error), 200)}",
                rule.remedy,
            )
        if seen:
            return Verdict(rule.words, case, printable(seen), printable(remedy))
    return Verdict(rule.words)
