"""Places of readings: from the numbers in a file to metres in the frame of the field."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely

from subsoil.arrays import Floats, Integers
from subsoil.errors import ReadingsError
from subsoil.findings import Finding
from subsoil.land.crs import WGS84, check_metric, looks_swapped, metres_frame, project, utm_crs
from subsoil.land.field import Field

_SPOT_M = 0.05


@dataclass(frozen=True)
class Places:
    """Positions of records as their file gives them.

    Attributes
    ----------
    x, y
        (n,) longitude and latitude in degrees, or easting and northing in m.
    lonlat
        Which of the two.
    file
        Name of the file.
    """

    x: Floats
    y: Floats
    lonlat: bool
    file: str

    def metres(self, field: Field | None, crs: str | None) -> tuple[Floats, str]:
        """(n, 2) easting and northing in m, and their frame.

        Raises
        ------
        ReadingsError
            If latitude and longitude look swapped, or metres look like degrees.
        BoundaryError
            If the way from one frame to the other is unknown.
        """
        if self.lonlat and field is not None:
            return field.to_metres(self.x, self.y), field.crs
        if self.lonlat:
            home = self._utm()
            return project(WGS84, home, self.x, self.y), home
        self._check_metres()
        if crs is not None:
            check_metric(crs, self.file)
        if field is not None:
            home = field.crs
        else:
            home = metres_frame(crs, (float(self.x[0]), float(self.y[0]))) if crs else ""
        if crs is None or crs == home:
            return np.column_stack([self.x, self.y]), home
        return project(crs, home, self.x, self.y), home

    def _utm(self) -> str:
        longitude, latitude = float(np.median(self.x)), float(np.median(self.y))
        if looks_swapped(longitude, latitude):
            raise ReadingsError(
                f"longitude {longitude:.3f}, latitude {latitude:.3f} is open sea: "
                "latitude and longitude look swapped",
                where=self.file,
                remedy="swap the names of the two columns",
            )
        return utm_crs(longitude, latitude)

    def _check_metres(self) -> None:
        span = max(float(np.ptp(self.x)), float(np.ptp(self.y)))
        degrees = np.abs(self.x).max() <= 180 and np.abs(self.y).max() <= 180
        if degrees and 0 < span < _SPOT_M:
            raise ReadingsError(
                f"all readings lie within {span:.2g} m: these look like degrees, not metres",
                where=self.file,
                remedy="name the columns lat,lon",
            )


def outside(rows: Integers, at: Floats, field: Field, file: str) -> tuple[Finding, ...]:
    """Findings about readings, (n,) rows and (n, 2) m, that the field does not contain."""
    away = [
        f"{_far(away)} outside the field" if away else "in a keep-out"
        for away in _metres_away(at, field)
    ]
    return tuple(
        Finding(seen, "left out", "left out", file, int(row))
        for seen, row in zip(away, rows, strict=True)
    )


def elsewhere(places: Places, field: Field, at: Floats, crs: str | None) -> ReadingsError:
    """Complaint about readings most of which lie outside the field."""
    strays = at[~field.contains(at)]
    away = _far(float(np.median(_metres_away(strays, field))))
    what = f"{len(strays)} of {len(at)} readings lie outside {field.name}, typically {away} away"
    mirrored, _ = replace(places, x=places.y, y=places.x).metres(field, crs)
    if 2 * field.contains(mirrored).sum() > len(at):
        columns = "latitude and longitude" if places.lonlat else "easting and northing"
        return ReadingsError(
            f"{what}; swapping {columns} puts them inside",
            where=places.file,
            remedy="swap the names of the two columns",
        )
    remedy = "check that file and field belong together"
    return ReadingsError(
        what,
        where=places.file,
        remedy=remedy if places.lonlat else f"{remedy}, and name the CRS of the readings",
    )


def _metres_away(at: Floats, field: Field) -> Floats:
    away = np.asarray(shapely.distance(shapely.points(at), field.boundary))
    return np.where(np.isfinite(away), away, np.inf)


def _far(metres: float) -> str:
    if not np.isfinite(metres):
        return "half a world"
    if metres >= 10_000:
        return f"{metres / 1000:.0f} km"
    return f"{metres:.0f} m" if metres >= 10 else f"{metres:.2g} m"
