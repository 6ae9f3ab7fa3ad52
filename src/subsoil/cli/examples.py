"""An example or two of every verb, as its help shows them; each is run by a test, in this order."""

from __future__ import annotations

EXAMPLES: dict[str, tuple[str, ...]] = {
    "demo": ("subsoil demo", "subsoil demo --out quick --strategy greedy --samples 12"),
    "init": ("subsoil init survey.gpkg --boundary field.geojson",),
    "plan": (
        "subsoil plan survey.gpkg --samples 30",
        "subsoil plan survey.gpkg --minutes 60 --strategy area-split",
    ),
    "run": (
        "subsoil run survey.gpkg --samples 20 --seed 1",
        "subsoil run survey.gpkg --target-rmse 250 --probability 0.8 --minutes 90",
    ),
    "resume": ("subsoil resume survey.gpkg",),
    "status": ("subsoil status survey.gpkg", "subsoil status survey.gpkg --units us"),
    "withdraw": ('subsoil withdraw survey.gpkg REPORT --reason "hit a stone"',),
    "map": ("subsoil map readings.csv --boundary field.geojson --out maps --layers 0,.1,.2",),
    "variogram": ("subsoil variogram readings.csv",),
    "cv": ("subsoil cv readings.csv --layers 0,0.1,0.2 --block 40",),
    "replay": ("subsoil replay survey.gpkg --at 12",),
    "verify": ("subsoil verify survey.gpkg",),
    "strategies": ("subsoil strategies", "subsoil strategies --json"),
    "doctor": ("subsoil doctor",),
    "bench run": ("subsoil bench run --out duel --fields 2 --strategies random,joint --samples 9",),
    "bench report": ("subsoil bench report duel",),
    "bench check": ("subsoil bench check area-split", "subsoil bench check pmc --json"),
}
"""Command lines by verb, for a folder with field.geojson and readings.csv."""


def epilog(verb: str) -> str:
    """What the help of a verb ends with."""
    lines = EXAMPLES[verb]
    return "\n  ".join(["Example:" if len(lines) == 1 else "Examples:", *lines])
