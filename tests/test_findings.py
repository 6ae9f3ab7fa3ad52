"""Findings on a screen: a line for what is the same, files named where there are several."""

from __future__ import annotations

from subsoil.findings import Finding, together


def gap(row: int, file: str = "a.csv") -> Finding:
    return Finding("no position", "left out", "left out", file, row)


def test_rows_of_which_the_same_is_to_be_said_share_a_line() -> None:
    lines = together([gap(2), Finding("odd", row=3), gap(4), gap(9)])
    assert lines == ("rows 2, 4, 9: no position; left out", "row 3: odd")


def test_a_row_alone_reads_as_it_does_in_json() -> None:
    one = Finding("'x' is not a number", "left out", "left out", "a.csv", 14, "kpa_5cm")
    assert together([one]) == (str(one),)


def test_files_are_named_where_there_are_several() -> None:
    assert together([gap(2), gap(3, "b.csv")]) == (
        "a.csv, row 2: no position; left out",
        "b.csv, row 3: no position; left out",
    )


def test_a_long_list_is_cut_and_says_how_much_is_not_shown() -> None:
    lines = together([Finding(f"{row} m outside", row=row) for row in range(2, 102)], most=20)
    assert len(lines) == 21
    assert lines[-1] == "80 more; --json lists all"
