"""What somebody left in a name, a folder or the current directory does no harm."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from subsoil.errors import ReadingsError
from subsoil.kriging.memory import available_gib, check_memory, needed_gib

Cli = Callable[..., Any]
OUTLINE = "easting,northing\n0,0\n60,0\n60,40\n0,40\n"
NAMES = ["[red]x[bold]", "[/x]", "a\x1b[31mb", "[link=http://x]y[/link]", ":smile:", "\u202egnirts"]


def subsoil(folder: Path, *words: object, **more: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "subsoil", *map(str, words)], cwd=folder, capture_output=True,
        text=True, check=False, env={**os.environ, **more},
    )  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_a_name_is_printed_as_it_is_and_obeyed_by_nobody(
    cli: Cli, tmp_path: Path, name: str
) -> None:
    outline = tmp_path / f"{name.replace('/', '')}.csv"
    outline.write_text(OUTLINE)
    path = tmp_path / "s.gpkg"
    for call in (("init", path, "--boundary", outline), ("status", path), ("plan", path)):
        said = cli(*call)
        assert said.code == 0, said.err
        assert "\x1b" not in said.out
        assert "\u202e" not in said.out
    shown = name.replace("/", "").replace("\x1b", "?").replace("\u202e", "?")
    assert shown in cli("status", path).out
    assert cli("init", tmp_path / "t.gpkg", "--boundary", f"{name}.csv").err.count("\n") == 1


@pytest.mark.parametrize("name", [b"a\xff", b"a\x1b[31m", b"a\nb"])
def test_a_name_that_is_no_text_is_as_good_as_any(cli: Cli, tmp_path: Path, name: bytes) -> None:
    outline, path = (tmp_path / os.fsdecode(name + end) for end in (b".csv", b".gpkg"))
    outline.write_text(OUTLINE)
    for call in (("init", path, "--boundary", outline), ("run", path, "--samples", 2)):
        said = cli(*call)
        assert said.code == 0, said.err
        assert set(said.out) - {"\n", "\t"} <= set(filter(str.isprintable, said.out))
    assert cli("verify", path, "--json").json["findings"] == "none"


def test_a_folder_whose_name_is_no_text_is_refused_in_a_line(cli: Cli, tmp_path: Path) -> None:
    said = cli("demo", "--out", tmp_path / os.fsdecode(b"out\xff"), "--samples", 2)
    assert said.code == 2
    assert "is no text in UTF-8" in said.err
    assert said.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_what_lies_in_the_current_folder_is_not_loaded(tmp_path: Path) -> None:
    (tmp_path / "plot.csv").write_text(OUTLINE)
    for module in ("typer", "numpy", "rich", "mine"):
        (tmp_path / f"{module}.py").write_text("open('loaded', 'a').write(__name__)\n")
    assert subsoil(tmp_path, "init", "s.gpkg", "--boundary", "plot.csv").returncode == 0
    assert subsoil(tmp_path, "run", "s.gpkg", "--samples", 2).returncode == 0
    assert subsoil(tmp_path, "verify", "s.gpkg").returncode == 0
    assert not (tmp_path / "loaded").exists()


@pytest.mark.slow
def test_a_survey_file_that_names_code_does_not_run_it(tmp_path: Path) -> None:
    (tmp_path / "plot.csv").write_text(OUTLINE)
    (tmp_path / "mine.py").write_text(
        "open('loaded', 'a').write('x')\n"
        "from subsoil.strategies import Plan, STRATEGIES\n"
        "def own(view):\n"
        "    return STRATEGIES['greedy'](view)\n"
    )
    assert subsoil(tmp_path, "init", "s.gpkg", "--boundary", "plot.csv").returncode == 0
    done = subsoil(tmp_path, "run", "s.gpkg", "--samples", 2, "--strategy", "mine:own")
    assert done.returncode == 0, done.stderr
    (tmp_path / "loaded").unlink()
    verified = subsoil(tmp_path, "verify", "s.gpkg", PYTHONPATH=str(tmp_path))
    assert verified.returncode == 0
    assert "give --allow mine" in verified.stdout
    for verb in ("status", "plan", "replay --at 3", "resume"):
        subsoil(tmp_path, *verb.split()[:1], "s.gpkg", *verb.split()[1:], PYTHONPATH=str(tmp_path))
    assert not (tmp_path / "loaded").exists()
    allowed = subsoil(tmp_path, "verify", "s.gpkg", "--allow", "mine", PYTHONPATH=str(tmp_path))
    assert allowed.returncode == 0
    assert (tmp_path / "loaded").exists()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mine", "mine:own"])
def test_a_module_of_the_current_folder_runs_once_the_user_names_it(
    tmp_path: Path, name: str
) -> None:
    (tmp_path / "plot.csv").write_text(OUTLINE)
    (tmp_path / "mine.py").write_text(
        "from subsoil.strategies import STRATEGIES\n"
        "def own(view):\n    return STRATEGIES['greedy'](view)\n"
    )
    assert subsoil(tmp_path, "init", "s.gpkg", "--boundary", "plot.csv").returncode == 0
    planned = subsoil(tmp_path, "plan", "s.gpkg", "--strategy", "mine:own", "--samples", 3)
    assert planned.returncode == 0, planned.stderr
    done = subsoil(tmp_path, "run", "s.gpkg", "--samples", 3, "--strategy", "mine:own")
    assert done.returncode == 0, done.stderr
    refused = subsoil(tmp_path, "resume", "s.gpkg")
    assert refused.returncode == 0 or "--allow mine" in refused.stderr
    for verb in ("verify", "plan", "resume"):
        allowed = subsoil(tmp_path, verb, "s.gpkg", "--allow", name)
        assert allowed.returncode == 0, allowed.stdout + allowed.stderr
        assert "not recomputed" not in allowed.stdout


def test_a_link_in_the_place_of_an_output_is_replaced_and_not_followed(
    cli: Cli, tmp_path: Path, outline: Path, readings: Path
) -> None:
    out, victim = tmp_path / "out", tmp_path / "victim.txt"
    out.mkdir()
    names = ["mean_kpa.tif", "std_dev_kpa.tif", "depth_slices.png", "variograms.png"]
    for name in names:
        victim.write_text("mine")
        (out / name).symlink_to(victim)
    assert cli("map", readings, "--boundary", outline, "--out", out, "--layers", "0,0.1").code == 0
    assert victim.read_text() == "mine"
    assert not any((out / name).is_symlink() for name in names)
    assert [path.name for path in out.iterdir() if path.name.startswith(".")] == []


@pytest.mark.slow
def test_ctrl_c_while_it_is_loading_is_one_line(tmp_path: Path) -> None:
    for k in range(12):
        process = subprocess.Popen(
            [sys.executable, "-m", "subsoil", "doctor"], cwd=tmp_path,
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        time.sleep(0.08 + 0.06 * k)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=20)
        assert process.returncode in (0, 1, 3, -signal.SIGINT)
        assert "Traceback" not in said
        assert said.count("\n") <= 1


def test_too_many_readings_for_the_memory_are_said_before_the_work_starts() -> None:
    check_memory(1000, systems=[1000] * 8, cells=10_000, layers=8)
    many = 1_000_000
    assert needed_gib(many) > available_gib()
    with pytest.raises(ReadingsError, match=r"1000000 readings take about [\d.]+ GiB of memory"):
        check_memory(many)
    with pytest.raises(ReadingsError, match=r"mapped on 10000 cells take.*use larger cells"):
        check_memory(1000, systems=[many], cells=10_000, layers=1)
