"""Large tables: a hundred thousand rows in seconds, a million refused in one line."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest

from subsoil.errors import ReadingsError
from subsoil.io.read.readings import read_readings

HEAD = "lat,lon," + ",".join(f"kpa_{5 * k}cm" for k in range(1, 9))
ROW = "52.09{0:05d},5.64{0:05d},483.5,823.1,1119.2,1682.0,1526.4,1893.3,2206.9,2290.1"


@pytest.mark.slow
def test_a_hundred_thousand_rows_are_read_in_seconds(tmp_path: Path) -> None:
    path = tmp_path / "walk.csv"
    path.write_text("\n".join([HEAD, *(ROW.format(k) for k in range(100_000))]) + "\n")
    before = time.process_time()
    readings = read_readings(path)
    assert time.process_time() - before < 15.0, "three times what it takes on a slow machine"
    assert len(readings) == 100_000
    np.testing.assert_array_equal(readings.profiles[-1].kpa[[0, -1]], [483.5, 2290.1])


def test_a_million_rows_are_refused_in_one_line(tmp_path: Path) -> None:
    path = tmp_path / "walk.csv"
    path.write_text("\n".join([HEAD, *["52.1,5.6,1,2,3,4,5,6,7,8"] * 1_000_000]) + "\n")
    with pytest.raises(ReadingsError, match="its 1000001 rows have more than 4 million cells"):
        read_readings(path)
