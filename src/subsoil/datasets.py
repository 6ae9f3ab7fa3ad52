"""Real data to try things on, fetched from where its owners publish it.

``SUBSOIL_DATA`` may name a folder with the same files, for machines without a network::

    $SUBSOIL_DATA/riseholme/cosmos-gt.yaml
    $SUBSOIL_DATA/riseholme/cosmos.coords

Otherwise they are downloaded once, and kept in the user's cache. Either way each file is checked
against its SHA-256.
"""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from subsoil.errors import DataUnavailableError
from subsoil.io.read.boundary import read_field
from subsoil.io.read.readings import read_readings
from subsoil.land.field import Field
from subsoil.optional import load
from subsoil.readings import Readings

COSMOS_URL = "https://raw.githubusercontent.com/Jailander/COSMOS"
"""Where the robot group of Lincoln publishes its surveys (MIT licence)."""

_SET = "set SUBSOIL_DATA to a folder with riseholme/cosmos-gt.yaml and riseholme/cosmos.coords"
_FOLDER = "kriging_exploration/resources"
_HALF_FIELD_OSGB36 = (
    (498298.6, 374949.8),
    (498326.8, 374780.4),
    (498448.6, 374774.8),
    (498448.6, 374949.8),
)
_OSGB36_TO_UTM30 = (
    "+proj=pipeline "
    "+step +inv +proj=tmerc +lat_0=49 +lon_0=-2 +k=0.9996012717 +x_0=400000 +y_0=-100000 "
    "+ellps=airy "
    "+step +proj=push +v_3 "
    "+step +proj=cart +ellps=airy "
    "+step +proj=helmert +x=446.448 +y=-125.157 +z=542.06 +rx=0.15 +ry=0.247 +rz=0.842 "
    "+s=-20.489 +convention=position_vector "
    "+step +inv +proj=cart +ellps=WGS84 "
    "+step +proj=pop +v_3 "
    "+step +proj=utm +zone=30 +ellps=WGS84"
)


@dataclass(frozen=True)
class _File:
    """A file as its owners published it once and for all."""

    name: str
    commit: str
    sha256: str


_READINGS = _File(
    "cosmos-gt.yaml",
    "c44416baab603a313741f3fbd9318660dfa347bf",
    "095c9a2c217c61d2a7628e091ea6d53241978b22f068cf38167d56f82eaae8c6",
)
_OUTLINE = _File(
    "cosmos.coords",
    "ddef22db21452f1f7dc27af1daf6c2d58eabb447",
    "6b4efd397843ef68594d47b57395a9eb84075bee243520a80238d364ebc96eac",
)


@dataclass(frozen=True)
class RiseholmeSurvey:
    """The robot's survey of the Cosmos field at Riseholme, Lincolnshire, of December 2018.

    Attributes
    ----------
    field
        The whole field: 7.02 ha, 2809 cells of 5 m, in UTM zone 30 (EPSG:32630).
    half_field
        The western part that the 2018 paper surveyed, see :func:`half_field`.
    readings
        177 pushes about 20 m apart over the whole field, every 2.5 cm from 2.5 to 45 cm, in kPa.
        Five end early. 65 lie in the half field.
    """

    field: Field
    half_field: Field
    readings: Readings


def riseholme(*, url: str = COSMOS_URL) -> RiseholmeSurvey:
    """Load the robot penetrometer survey of Riseholme.

    Same field, robot group and instrument as Fentanes et al., *3D Soil Compaction Mapping through
    Kriging-based Exploration with a Mobile Robot* (2018, arXiv:1803.08069), but a later and
    larger survey: December 2018, by the dates of its commits. It is not the paper's own survey of
    January 2018 (286 points), which is not public; results on one are not results on the other.

    Parameters
    ----------
    url
        Where to download from, if ``SUBSOIL_DATA`` is not set: its commits' folders.

    Raises
    ------
    DataUnavailableError
        If the files are neither in ``SUBSOIL_DATA`` nor in the cache nor reachable, or are not
        what was published.
    MissingExtraError
        If they have to be downloaded and pooch is not installed.
    """
    field = read_field(_path(_OUTLINE, url))
    return RiseholmeSurvey(field, half_field(), read_readings(_path(_READINGS, url), field=field))


def half_field() -> Field:
    """Western half of the field at Riseholme, the area of the 2018 paper; needs no files.

    A reconstruction: the paper gives no coordinates, but 2.33 ha and 936 cells of 5 m; this has
    2.34 ha and 935. Its corners are in the British National Grid (EPSG:27700), and are brought to
    UTM zone 30 by the seven-parameter Helmert transformation OSGB36 to WGS84 (EPSG:1314), since
    pyproj ships without the exact grid OSTN15: the field may lie up to about 2 m off. The two
    corners that it shares with the outline of the whole field come to lie within 5 cm of those.

    Examples
    --------
    >>> len(half_field().cells)
    935
    """
    from pyproj import Transformer

    corners = np.array(_HALF_FIELD_OSGB36)
    to_utm = Transformer.from_pipeline(_OSGB36_TO_UTM30)
    easting, northing = to_utm.transform(corners[:, 0], corners[:, 1])
    return Field.from_metres(
        np.column_stack([easting, northing]), crs="EPSG:32630", name="Riseholme half field"
    )


def _path(file: _File, url: str) -> Path:
    folder = os.environ.get("SUBSOIL_DATA")
    return _local(file, Path(folder)) if folder else _download(file, url)


def _local(file: _File, folder: Path) -> Path:
    path = folder / "riseholme" / file.name
    if not path.is_file():
        raise DataUnavailableError(
            "SUBSOIL_DATA names a folder without this file",
            where=str(path),
            remedy="put it there, or unset SUBSOIL_DATA to download it",
        )
    if hashlib.sha256(path.read_bytes()).hexdigest() != file.sha256:
        raise DataUnavailableError(
            "the file is not the one that was published: its SHA-256 differs",
            where=str(path),
            remedy="get it again, or unset SUBSOIL_DATA to download it",
        )
    return path


def _download(file: _File, url: str) -> Path:
    pooch = load("pooch", "data", "downloading data", where=file.name, instead=_SET)
    address = f"{url}/{file.commit}/{_FOLDER}/{file.name}"
    try:
        path = pooch.retrieve(
            address,
            known_hash=f"sha256:{file.sha256}",
            fname=file.name,
            path=pooch.os_cache("subsoil"),
        )
    except OSError as error:
        raise DataUnavailableError(
            f"it cannot be downloaded ({type(error).__name__})",
            where=address,
            remedy=f"connect to the network, or {_SET}",
        ) from error
    except ValueError as error:
        raise DataUnavailableError(
            "what is there is not what was published: its SHA-256 differs",
            where=address,
            remedy=_SET,
        ) from error
    return Path(path)
