"""Options of a reading that is typed in, and the reading that they make."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import typer

from subsoil.arrays import Floats
from subsoil.cli.field import OptionalConeArea
from subsoil.cli.parsing import FIELD, one_of
from subsoil.errors import ParameterError, ReadingsError, brief
from subsoil.findings import Finding
from subsoil.io.read.missing import is_missing
from subsoil.io.read.plausible import Flat, strength
from subsoil.io.read.recording import KPA, METRES, NEWTONS, UNITS, kpa_per_unit
from subsoil.penetrometer import Cone, Profile, faults
from subsoil.reports import Reading, Tip

_BETWEEN = re.compile(r"\s*[,;]\s*|\s+")
_FAR_BEYOND = 4.0
HARD_KPA = 5000.0
"""Pressure from which on one value that stands out is doubted: few soils are as hard."""
_DEPTH = re.compile(r"(\d+(?:\.\d*)?|\.\d+)\s*([a-z]*)", re.IGNORECASE)


@dataclass(frozen=True)
class TypedOptions:
    """A reading as the command line says it.

    Attributes
    ----------
    kpa, values, depths
        Pressures in kPa, or pressures or forces in another unit, and the depths they are for.
    unit, cone_area
        Of the values.
    note
        What else there is to say.
    """

    kpa: Annotated[
        str | None,
        typer.Option(
            metavar="KPA,KPA,...",
            help="Pressure at each depth; - where nothing was read.",
            rich_help_panel=FIELD,
        ),
    ] = None
    values: Annotated[
        str | None,
        typer.Option(
            metavar="N,N,...",
            help="The same in another --unit, or force with --cone-area.",
            rich_help_panel=FIELD,
        ),
    ] = None
    depths: Annotated[
        str | None,
        typer.Option(
            metavar="CM,CM,...",
            help="Depths down to which they count, in cm or with units: 4in,8in.",
            rich_help_panel=FIELD,
        ),
    ] = None
    unit: Annotated[
        str | None,
        typer.Option(
            metavar="UNIT",
            help=f"Unit of the --values: {', '.join(UNITS)}.",
            autocompletion=one_of(UNITS),
            rich_help_panel=FIELD,
        ),
    ] = None
    cone_area: OptionalConeArea = None
    note: Annotated[
        str | None,
        typer.Option(
            metavar="WORDS", help="What else to say of it, such as 'wheel track'.",
            rich_help_panel=FIELD,
        ),
    ] = None  # fmt: skip

    @property
    def given(self) -> bool:
        """Whether there are values."""
        return any(each is not None for each in (self.kpa, self.values, self.depths))

    def reading(self, cone: Cone) -> Reading:
        """The reading that was typed in.

        Parameters
        ----------
        cone
            Of the survey.

        Raises
        ------
        ParameterError
            If values or depths are missing, do not pair, or are no numbers.
        ReadingsError
            If they have no unit, are forces without a cone, or cannot be true.
        """
        values, depths = self._values(), self._depths()
        if len(values) != len(depths):
            raise ParameterError(
                f"{len(values)} values do not pair with {len(depths)} depths",
                where="--depths",
                remedy="give one depth a value, and - for a value that was not read",
            )
        if not (np.diff(depths) > 0).all():
            raise ParameterError(
                "depths do not increase", where="--depths", remedy="shallowest first"
            )
        reading = self._in_units(values, depths)
        if fault := faults(reading, cone):
            raise ReadingsError(fault, where="reading", remedy="correct the values, or their unit")
        return reading

    def _in_units(self, values: Floats, depths: Floats) -> Reading:
        """Reading of what was read, as pressure or as force under its cone."""
        cone = Cone(self.cone_area) if self.cone_area is not None else None
        unit = "kpa" if self.kpa is not None else (self.unit or "").lower()
        if unit not in UNITS:
            raise ParameterError(
                f"{brief(unit)!r} is no unit of strength" if unit else "the values have no unit",
                where="--unit",
                remedy=f"one of {' '.join(UNITS)}",
            )
        factor = kpa_per_unit("kpa" if self.kpa is not None else "", self.unit, cone, "--unit")
        read = np.isfinite(values)
        if not read.any():
            raise ParameterError("no depth was read", where="reading", remedy="see subsoil stone")
        tops = np.concatenate([[0.0], depths[:-1]])
        gaps = not read[: read.sum()].all()
        depth_m = tuple(depths[read].tolist())
        top_m = tuple(tops[read].tolist()) if gaps else ()
        flags = (self.note,) if self.note else ()
        if unit in KPA:
            kpa = (factor * values[read]).tolist()
            return Reading(depth_m=depth_m, kpa=tuple(kpa), top_m=top_m, flags=flags)
        assert cone is not None
        force = (NEWTONS[unit] * values[read]).tolist()
        tip = Tip(area_mm2=cone.area_mm2, angle_deg=cone.angle_deg)
        return Reading(
            depth_m=depth_m, force_n=tuple(force), tip=tip, top_m=top_m, flags=flags
        )  # fmt: skip

    def _values(self) -> Floats:
        """(k,) values, NaN where nothing was read."""
        text = self.kpa if self.kpa is not None else self.values
        if text is None or (self.kpa is not None and self.values is not None):
            what = "there are none" if text is None else "they are there twice"
            remedy = "give --kpa 500,900, or --values 73,130 --unit psi, with --depths 10,20"
            raise ParameterError(what, where="values", remedy=remedy)
        where = "--kpa" if self.kpa is not None else "--values"
        return np.array([_number(part, where) for part in _parts(text)])

    def _depths(self) -> Floats:
        """(k,) depths in m."""
        if self.depths is None:
            remedy = "give --depths 10,20,30, in cm or with units"
            raise ParameterError("there are none", where="--depths", remedy=remedy)
        return np.array([depth_m(part, "--depths") for part in _parts(self.depths)])


def typing_doubts(push: Profile) -> tuple[Finding, ...]:
    """What of a reading looks mistyped: its unit, or one value far beyond all others.

    Examples
    --------
    >>> from subsoil.penetrometer import profile
    >>> slip = profile([0.1, 0.2, 0.3], [640.0, 17200.0, 2110.0])
    >>> print(*typing_doubts(slip))
    17200 kPa at 0.2 m is over 4 times any other depth's; correct it with subsoil amend
    """
    found = list(strength(Flat.of([push]), ""))
    for k, (deep, kpa) in enumerate(zip(push.depth_m, push.kpa, strict=True)):
        others = np.delete(push.kpa, k)
        if others.size and kpa > max(_FAR_BEYOND * others.max(), HARD_KPA):
            seen = f"{kpa:.0f} kPa at {deep:g} m is over {_FAR_BEYOND:g} times any other depth's"
            found.append(Finding(seen, "correct it with subsoil amend", "doubt"))
    return tuple(found)


def depth_m(text: str, where: str) -> float:
    """Depth in m of a number in cm, or with a unit of its own.

    Raises
    ------
    ParameterError
        If it is none.

    Examples
    --------
    >>> depth_m("15", "--depths"), depth_m("6 in", "--depths"), depth_m("0.3m", "--depths")
    (0.15, 0.1524, 0.3)
    """
    found = _DEPTH.fullmatch(text.strip())
    unit = (found[2].lower() or "cm") if found else ""
    if found is None or unit not in METRES:
        raise ParameterError(
            f"{brief(text)!r} is no depth",
            where=where,
            remedy=f"give numbers in cm, or with one of the units {', '.join(METRES)}",
        )
    return round(float(found[1]) * METRES[unit], 6)


def _parts(text: str) -> list[str]:
    """Parts of a list; blanks beside commas do not count."""
    return _BETWEEN.split(text.strip())


def _number(text: str, where: str) -> float:
    if is_missing(text):
        return float("nan")
    try:
        return float(text)
    except ValueError:
        raise ParameterError(
            f"{brief(text)!r} is not a number",
            where=where,
            remedy="give numbers with decimal points and commas between them",
        ) from None
