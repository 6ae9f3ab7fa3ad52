"""Findings about files, as every verb that reads says them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

import typer

from subsoil.findings import Finding, left_out, others


def said(
    findings: Sequence[Finding], further: Sequence[str] = (), *, as_json: bool
) -> dict[str, object]:
    """What was left out and what else there is to know; each finding by its parts in JSON."""
    words = {
        "refused": tuple(str(finding) for finding in left_out(findings)),
        "notes": tuple(dict.fromkeys((*others(findings), *further))),
    }
    return {**words, "findings": [asdict(each) for each in findings]} if as_json else {**words}


def exit_for(findings: Sequence[Finding]) -> None:
    """End with exit code 1 where something was left out that could have counted."""
    if left_out(findings):
        raise typer.Exit(1)
