"""A survey of two agents' processes survives any of them being killed, at any moment."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from subsoil.journal import create, open_journal, read_events, verify
from subsoil.survey import LocalDispatch, fold
from subsoil.survey.events import Assigned, Configured, Opened, Refused, Released, Sampled

Configure = Callable[..., Configured]

SCRIPT = Path(__file__).with_name("two_agents.py")
NAMES = ("anna", "bert")


GDAL = """
import sys, time, pyogrio
while True:
    for layer in ("boundary", "samples", "targets", "route"):
        pyogrio.raw.read(sys.argv[1], layer=layer)
    time.sleep(0.02)
"""
QGIS = """
import sys, time
from qgis.core import QgsApplication, QgsVectorLayer
app = QgsApplication([], False)
app.initQgis()
layers = [QgsVectorLayer(f"{sys.argv[1]}|layername={n}", n, "ogr") for n in ("samples", "targets")]
while True:
    for layer in layers:
        layer.reload()
        list(layer.getFeatures())
    time.sleep(0.02)
"""
LOOKERS = {"gdal": [sys.executable, "-c", GDAL], "qgis": ["/usr/bin/python3", "-c", QGIS]}
"""Programs that look at the survey file all the time."""


class Crew:
    """The processes of a survey: its owner and its agents."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.file = folder / "survey.gpkg"
        self.running: dict[str, subprocess.Popen[str]] = {}

    def start(self, name: str) -> None:
        """Start a process that is not running."""
        if name in self.running and self.running[name].poll() is None:
            return
        socket = str(self.folder / "socket")
        words = ["own", str(self.file), socket]
        if name != "owner":
            words = ["work", name, socket, str(self.folder / f"{name}.acknowledged")]
        self.running[name] = subprocess.Popen(
            [sys.executable, str(SCRIPT), *words], stdout=subprocess.DEVNULL, text=True
        )

    def kill(self, name: str) -> None:
        self.running[name].send_signal(signal.SIGKILL)
        self.running[name].wait()

    def acknowledged(self) -> set[str]:
        files = self.folder.glob("*.acknowledged")
        return {line for file in files for line in file.read_text().split()}

    def look(self, program: str) -> None:
        """Let a GIS look on until the end."""
        call = [*LOOKERS[program], str(self.file)]
        self.running[program] = subprocess.Popen(
            call,
            env={**os.environ, "QT_QPA_PLATFORM": "offscreen"},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            text=True,
        )


def survey_file(crew: Crew, opening: Opened, settings: Configured) -> None:
    with create(crew.file, opening) as journal:
        LocalDispatch(fold(journal.events()), journal).record(settings)


def finish(crew: Crew) -> None:
    """Let all work until the survey is over."""
    for name in ("owner", *NAMES):
        crew.start(name)
    for name in NAMES:
        crew.running[name].wait(timeout=120)
    crew.kill("owner")


def check_leases(path: Path) -> None:
    """No stop is handed to two while a lease on it holds."""
    held: dict[str, int] = {}
    for event in read_events(path):
        if isinstance(event, Assigned):
            assert event.cell not in held.values()
            held[event.id] = event.cell
        elif isinstance(event, Sampled | Refused | Released):
            held.pop(event.assignment, None)


with_qgis = pytest.param(
    4, "qgis",
    marks=[pytest.mark.gis, pytest.mark.skipif(not shutil.which("qgis_process"), reason="no QGIS")],
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "looker"),
    [*((seed, looker) for looker in ("", "gdal") for seed in range(4)), with_qgis],
)
def test_no_kill_of_owner_or_agents_loses_or_doubles_anything(
    tmp_path: Path, plot_opened: Opened, configured: Configure, seed: int, looker: str
) -> None:
    """25 kills a run: 100 alone, and 100 while GDAL looks on, and 25 while QGIS does."""
    crew, rng = Crew(tmp_path), random.Random(seed)
    survey_file(crew, plot_opened, configured("adaptive-greedy", 60, estimator="pmc"))
    if looker:
        crew.look(looker)
    for _ in range(25):
        for name in ("owner", *NAMES):
            crew.start(name)
        time.sleep(rng.uniform(0.8, 2.0))
        crew.kill(rng.choice(("owner", *NAMES)))
    if looker:
        assert crew.running[looker].poll() is None, "the GIS gave up"
    finish(crew)
    if looker:
        crew.kill(looker)
    events = read_events(crew.file)
    survey = fold(events)
    assert survey.finished == "60 samples taken"
    reports = [event.id for event in events if isinstance(event, Sampled | Refused)]
    assert len(reports) == len(set(reports))
    assert crew.acknowledged() <= set(reports)
    check_leases(crew.file)
    assert verify(crew.file).findings == ()
    with open_journal(crew.file) as journal:
        assert len(journal.events()) == len(events)
