"""What is printed: names as they are, and nothing that steers a terminal."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from subsoil.cli.output import progress, tell, tell_table
from subsoil.errors import printable

Cli = Callable[..., Any]

NAMES = {
    "closing tag": ("[/x]", "[/x]"),
    "colour": ("[red]x[bold]", "[red]x[bold]"),
    "number": ("field [1]", "field [1]"),
    "link": ("[link=file:///x]y[/link]", "[link=file:///x]y[/link]"),
    "emoji code": ("a :smile: b", "a :smile: b"),
    "escape": ("a\x1b[31mb", "a?[31mb"),
    "title of the terminal": ("a\x1b]0;owned\x07b", "a?]0;owned?b"),
    "single-byte escape": ("a\x9b31mb", "a?31mb"),
    "carriage return": ("good\rbad", "good bad"),
    "direction": ("abc\u202edef", "abc?def"),
    "isolate": ("abc\u2066def", "abc?def"),
    "half a character": ("a\udcffb", "a?b"),
    "line separator": ("a\u2028b", "a b"),
}
STEERING = {chr(k) for k in (*range(32), 0x7F, *range(0x80, 0xA0))}


@pytest.mark.parametrize("case", NAMES)
def test_a_name_is_printed_as_it_is_or_its_signs_are_taken_out(
    capsys: pytest.CaptureFixture[str], case: str
) -> None:
    name, shown = NAMES[case]
    tell({name: name, "all": {name: 1.0}}, as_json=False)
    tell_table(name, [name, "b"], [[name, 1.0]])
    printed = capsys.readouterr().out
    assert printed.count(shown) >= 6
    assert not (set(printed) - {"\n", "\t"}) & STEERING


@pytest.mark.parametrize("case", NAMES)
def test_json_holds_a_name_as_it_is_and_no_sign_that_a_terminal_obeys(
    capsys: pytest.CaptureFixture[str], case: str
) -> None:
    tell({"name": NAMES[case][0]}, as_json=True)
    printed = capsys.readouterr().out
    assert printed.isascii()
    assert not (set(printed) - {"\n"}) & STEERING


@pytest.mark.parametrize("case", NAMES)
def test_progress_on_a_terminal_is_not_steered_by_a_name(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, case: str
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "200")
    name, shown = NAMES[case]
    with progress(name, 2) as advance:
        advance(1, f"note {name}")
    printed = capsys.readouterr().err
    assert f"note {shown}" in printed
    assert name == shown or name not in printed


def test_an_error_line_is_not_steered_by_a_name(cli: Cli, tmp_path: Path) -> None:
    outcome = cli("cv", tmp_path / "a\x1b[31m[x]\u202e\n.csv")
    assert outcome.code == 2
    assert outcome.err.count("\n") == 1
    assert "a?[31m[x]? .csv: there is no such file" in outcome.err


def test_a_heading_with_brackets_is_kept_in_the_notes(cli: Cli, readings: Path) -> None:
    header, *rows = readings.read_text().splitlines()
    readings.write_text("\n".join([f"{header},[red]note[/x]", *(f"{row},y" for row in rows)]))
    outcome = cli("cv", readings, "--layers", "0,0.05,0.1")
    assert outcome.code == 0
    assert "columns left alone: [red]note[/x]" in outcome.out


@given(st.text())
def test_what_is_printable_is_one_line_of_signs_that_can_be_seen(text: str) -> None:
    assert printable(text).isprintable()
    assert printable(printable(text)) == printable(text)
    printable(text).encode()
