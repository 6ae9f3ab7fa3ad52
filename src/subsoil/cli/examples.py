"""An example or two of every verb, as its help shows them; each is run by a test, in this order."""

from __future__ import annotations

EXAMPLES: dict[str, tuple[str, ...]] = {
    "demo": ("subsoil demo", "subsoil demo --out quick --strategy greedy --samples 12"),
    "init": (
        "subsoil init survey.gpkg --boundary field.geojson",
        "subsoil init hand.gpkg --boundary field.geojson --speed 1.2 --samples 12",
    ),
    "plan": (
        "subsoil plan survey.gpkg --samples 30",
        "subsoil plan survey.gpkg --minutes 60 --strategy area-split",
    ),
    "run": (
        "subsoil run survey.gpkg --samples 20 --seed 1",
        "subsoil run survey.gpkg --target-rmse 250 --probability 0.8 --minutes 90",
    ),
    "resume": ("subsoil resume survey.gpkg",),
    "next": (
        "subsoil next hand.gpkg",
        "subsoil next hand.gpkg --agent anna --from 52.0002,0.0003",
        "subsoil next hand.gpkg --agent ben --write stops.gpx",
    ),
    "add": (
        "subsoil add hand.gpkg --kpa 500,900,1400 --depths 10,20,30",
        "subsoil add hand.gpkg --kpa 450,800 --depths 4in,8in --at 52.0002,0.0003",
    ),
    "stone": ("subsoil stone hand.gpkg --depth 12 --agent anna",),
    "skip": ('subsoil skip hand.gpkg --agent ben --reason "under water"',),
    "ingest": (
        "subsoil ingest hand.gpkg readings.csv --preview",
        "subsoil ingest hand.gpkg readings.csv",
    ),
    "status": ("subsoil status survey.gpkg", "subsoil status survey.gpkg --units us"),
    "amend": ("subsoil amend hand.gpkg REPORT --kpa 500,950 --depths 10,20 --reason typo",),
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
