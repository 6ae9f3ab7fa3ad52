"""Places of readings: from the numbers in a file to metres in the frame of the field."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from subsoil.arrays import Floats
from subsoil.errors import ReadingsError, brief
from subsoil.findings import Finding
from subsoil.land.crs import (
    NEAR_M,
    WGS84,
    accuracy,
    foreign_unit,
    is_degrees,
    metres_frame,
    project,
    utm_crs,
)
from subsoil.land.field import Field
from subsoil.land.outline import looks_like_kilometres
from subsoil.land.swaps import looks_swapped, looks_transposed

_SPOT_M = 0.05


@dataclass(frozen=True)
class Places:
    """Positions of records as their file gives them.

    Attributes
    ----------
    x, y
        (n,) longitude and latitude in degrees, or easting and northing.
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

        Parameters
        ----------
        field
            The field, whose frame they are brought to; without one, to metres on the ground.
        crs
            Frame of easting and northing, if not the field's.

        Raises
        ------
        ReadingsError
            If x and y look swapped, or metres like degrees or kilometres.
        BoundaryError
            If the way from one frame to the other is unknown.
        """
        source = self._source(crs)
        if not self.lonlat:
            self._check_metres(source)
        home = field.crs if field is not None else self._home(source)
        if field is not None and self.lonlat and not home:
            return field.to_metres(self.x, self.y), home
        if source in ("", home):
            return np.column_stack([self.x, self.y]), home
        return project(source, home, self.x, self.y), home

    def findings(self, field: Field | None, crs: str | None) -> tuple[Finding, ...]:
        """How exactly they are brought to the field, unless to a metre or as the field says."""
        source = self._source(crs)
        if field is None or source in ("", WGS84, field.crs):
            return ()
        off = accuracy(source, field.crs, self.x, self.y)
        seen = f"places are brought from {brief(source)} to {field.crs} to about {off:.0f} m"
        return (Finding(seen, file=self.file),) if off > NEAR_M else ()

    def _source(self, crs: str | None) -> str:
        """Frame of the numbers; empty for that of the field, or a local one."""
        if self.lonlat:
            return crs if crs and is_degrees(crs) else WGS84
        return crs or ""

    def _home(self, source: str) -> str:
        """Frame in metres on the ground for readings of no field."""
        if not source:
            return ""
        if is_degrees(source) or foreign_unit(source):
            at = project(source, WGS84, self.x, self.y)
            wraps = np.ptp(at[:, 0]) > 180
            longitudes = np.where(wraps & (at[:, 0] < 0), at[:, 0] + 360, at[:, 0])
            return self._utm(float(np.median(longitudes)), float(np.median(at[:, 1])))
        return metres_frame(source, (float(self.x[0]), float(self.y[0])))

    def _utm(self, longitude: float, latitude: float) -> str:
        if looks_swapped(longitude, latitude):
            raise ReadingsError(
                f"longitude {longitude:.3f}, latitude {latitude:.3f} is open sea: "
                "latitude and longitude look swapped",
                where=self.file,
                remedy="swap the names of the two columns",
            )
        return utm_crs(longitude, latitude)

    def _check_metres(self, source: str) -> None:
        box = float(self.x.min()), float(self.y.min()), float(self.x.max()), float(self.y.max())
        span = max(box[2] - box[0], box[3] - box[1])
        degrees = np.abs(box).max() <= 180 and 0 < span < _SPOT_M
        if degrees or looks_like_kilometres(box):
            unit = "degrees" if degrees else "kilometres"
            raise ReadingsError(
                f"all readings lie within {span:.2g} m: these look like {unit}, not metres",
                where=self.file,
                remedy="name the columns lat,lon" if degrees else "write them in metres",
            )
        if source and looks_transposed(source, float(self.x[0]), float(self.y[0])):
            raise ReadingsError(
                f"easting {self.x[0]:.0f}, northing {self.y[0]:.0f} is far from where "
                f"{brief(source)} is used: they look swapped",
                where=self.file,
                remedy="swap the names of the two columns",
            )
