"""Read mutated files one after the other, and say of which something is wrong.

Run as ``python -m tests.fuzz.reading FIRST COUNT``: a process of its own, so that a crash, a hang
or a run on the memory ends no test but is said.
"""

from __future__ import annotations

import re
import signal
import sys
import tempfile
import traceback
import warnings
from pathlib import Path
from types import FrameType

import numpy as np
from tests.fuzz.corpus import Sound, corpus
from tests.fuzz.mutations import mutated

from subsoil.errors import SubsoilError
from subsoil.io.read.boundary import read_field
from subsoil.io.read.covariate import read_covariate
from subsoil.io.read.readings import read_readings
from subsoil.land.field import Field
from subsoil.penetrometer import SMALL_CONE

LONGEST_S, MOST_MIB = 10, 500
_STATUS, _CLEAR = Path("/proc/self/status"), Path("/proc/self/clear_refs")


class HangError(Exception):
    """It took too long."""


def _hang(_: int, __: FrameType | None) -> None:
    raise HangError(f"still at it after {LONGEST_S} s")


def peak_mib() -> float:
    """Most memory since it was last asked for."""
    if not _STATUS.exists():
        return 0.0
    found = re.search(r"VmHWM:\s+(\d+)", _STATUS.read_text())
    _CLEAR.write_text("5")
    return int(found[1]) / 1024 if found else 0.0


def read(path: Path, kind: str, field: Field) -> None:
    """Read a file as what it was before it was broken."""
    if kind == "outline":
        read_field(path)
    elif kind == "covariate":
        read_covariate(path, field, column="ec" if path.suffix == ".csv" else None)
    elif kind == "positions":
        read_readings(path.with_name("unplaced.csv"), positions=path, field=field)
    else:
        read_readings(path, field=None if kind == "elsewhere" else field, cone=SMALL_CONE)


def trouble(sound: Sound, seed: int, folder: Path, field: Field) -> str:
    """What is wrong with how a broken file is read; empty if nothing."""
    path = folder / sound.name
    path.write_bytes(mutated(sound.data, np.random.default_rng(seed)))
    before = peak_mib()
    signal.alarm(LONGEST_S)
    try:
        read(path, sound.kind, field)
    except SubsoilError as error:
        if "\n" in str(error) or len(str(error)) > 1000:
            return f"{sound.name}, seed {seed}: not one line: {str(error)[:200]!r}"
    except BaseException:
        return f"{sound.name}, seed {seed}: {traceback.format_exc(limit=-3)}"
    finally:
        signal.alarm(0)
    more = peak_mib() - before
    return f"{sound.name}, seed {seed}: {more:.0f} MiB" if more > MOST_MIB else ""


def main() -> None:
    first, count = map(int, sys.argv[1:])
    warnings.simplefilter("ignore")
    signal.signal(signal.SIGALRM, _hang)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files = corpus(folder)
        field = read_field(_saved(next(f for f in files if f.name == "field.geojson"), folder))
        (folder / "unplaced.csv").write_text(
            "id,kpa_10cm,kpa_20cm\n" + "".join(f"{k},{500 + k},{900 + k}\n" for k in range(1, 10))
        )
        for sound in files:
            read(_saved(sound, folder), sound.kind, field)
        for seed in range(first, first + count):
            print(f"at {seed}", flush=True)
            if said := trouble(files[seed % len(files)], seed, folder, field):
                print(f"WRONG {said}", flush=True)
    print("done", flush=True)


def _saved(sound: Sound, folder: Path) -> Path:
    path = folder / sound.name
    path.write_bytes(sound.data)
    return path


if __name__ == "__main__":
    main()
