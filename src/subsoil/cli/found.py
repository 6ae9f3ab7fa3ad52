"""Findings about files, as every verb that reads says them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

import typer

from subsoil.findings import Finding, left_out, others, together


def said(
    findings: Sequence[Finding], further: Sequence[str] = (), *, as_json: bool
) -> dict[str, object]:
    """What was left out and what else there is to know.

    In JSON each finding stands for itself, in words and by its parts; on a screen those of which
    the same is to be said share a line, and a long list is cut.
    """
    refused = left_out(findings)
    if as_json:
        notes = tuple(dict.fromkeys((*others(findings), *further)))
        parts = [asdict(each) for each in findings]
        return {"refused": tuple(map(str, refused)), "notes": notes, "findings": parts}
    rest = [each for each in findings if each.severity != "left out"]
    return {
        "refused": together(refused),
        "notes": tuple(dict.fromkeys((*together(rest), *further))),
    }


def exit_for(findings: Sequence[Finding]) -> None:
    """End with exit code 1 where something was left out that could have counted."""
    if left_out(findings):
        raise typer.Exit(1)
