"""Packed outlines: KMZ and zipped shapefiles, unpacked by hand so that nothing else is opened.

Only members that belong to an outline are unpacked, under names of ours, and never more bytes than
a field needs, whatever the archive says of their size.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from zipfile import BadZipFile, ZipFile, ZipInfo

from subsoil.errors import BoundaryError, listed
from subsoil.io.read.outlines.outlines import Outlines, left_alone

ARCHIVES = (".kmz", ".zip")
"""Suffixes of archives."""
MOST_BYTES = 200_000_000
"""Bytes that the members of an archive may have together, unpacked."""
_MOST_MEMBERS = 50
_PARTS = (".shx", ".dbf", ".cpg", ".prj")

Reader = Callable[[Path, str | None, str], Outlines]


def read_archive(path: Path, readers: Mapping[str, Reader], crs: str | None, name: str) -> Outlines:
    """Read the only file of outlines in an archive, or the one of a name.

    Parameters
    ----------
    path
        The archive.
    readers
        Reader of each suffix.
    crs
        Frame of a file that does not name one.
    name
        Which file, layer or outline to look for, where there are several.

    Raises
    ------
    BoundaryError
        If it is damaged, unpacks to too much, or holds no or several files of outlines.
    """
    with TemporaryDirectory(prefix="subsoil-") as folder:
        files = _unpacked(path, Path(folder), (*readers, *_PARTS))
        files = [file for file in files if file.suffix in readers]
        if not files:
            raise BoundaryError(
                "it holds no file of outlines",
                where=path.name,
                remedy=f"pack one of {' '.join(readers)}",
            )
        asked = [file for file in files if name and file.stem.casefold() == name.casefold()]
        if len(files) > 1 and len(asked) == 1:
            found = _read(asked[0], path, readers, crs, "")
            parcels = tuple(replace(each, name=name) for each in found.parcels)
            return replace(found, parcels=parcels)
        tried = [(file, *_tried(file, path, readers, crs, name)) for file in files]
        return _only([each for each in tried if _calls(each[1], name)] or tried, path)


def _only(tried: list[tuple[Path, Outlines | None, BoundaryError | None]], path: Path) -> Outlines:
    """The one file that holds outlines; the others are noted."""
    fit = [(file, found) for file, found, _ in tried if found is not None]
    if not fit:
        raise next(error for _, _, error in tried if error)
    if len(fit) > 1:
        raise BoundaryError(
            f"it holds {len(fit)} files of outlines: {listed([f.stem for f, _ in fit], 20)}",
            where=path.name,
            remedy="choose one with --name",
        )
    ((file, found),) = fit
    others = left_alone([f"file {each.name}" for each, *_ in tried if each != file], path.name)
    return replace(found, findings=(*found.findings, *others))


def _calls(found: Outlines | None, name: str) -> bool:
    """Whether a file holds an outline of a name."""
    parcels = found.parcels if found else ()
    return bool(name) and any(each.name.casefold() == name.casefold() for each in parcels)


def _tried(
    file: Path, path: Path, readers: Mapping[str, Reader], crs: str | None, name: str
) -> tuple[Outlines | None, BoundaryError | None]:
    try:
        return _read(file, path, readers, crs, name), None
    except BoundaryError as error:
        return None, error


def _read(
    file: Path, path: Path, readers: Mapping[str, Reader], crs: str | None, name: str
) -> Outlines:
    try:
        found = readers[file.suffix](file, crs, name)
    except BoundaryError as error:
        where = f"{path.name}, {error.where}"
        raise BoundaryError(error.what, where=where, remedy=error.remedy) from error
    findings = tuple(replace(f, file=f"{path.name}, {f.file}") for f in found.findings)
    return replace(found, findings=findings)


def _unpacked(path: Path, folder: Path, suffixes: tuple[str, ...]) -> list[Path]:
    """Members with these suffixes, unpacked into a folder."""
    left = MOST_BYTES
    files = []
    try:
        with ZipFile(path) as archive:
            wanted = [each for each in archive.infolist() if _suffix(each) in suffixes]
            for member in wanted[:_MOST_MEMBERS]:
                with archive.open(member) as packed:
                    data = packed.read(left + 1)
                left -= len(data)
                if left < 0:
                    raise BoundaryError(
                        f"it unpacks to more than {MOST_BYTES // 1_000_000} MB",
                        where=path.name,
                        remedy="pack the outline alone",
                    )
                files.append(folder / _name(member))
                files[-1].write_bytes(data)
    except (
        BadZipFile,
        NotImplementedError,
        OSError,
        RuntimeError,
        ValueError,
        zlib.error,
    ) as error:
        raise BoundaryError(
            f"it cannot be unpacked: {str(error)[:80] or 'it is damaged'}",
            where=path.name,
            remedy="pack it again as a plain zip, without a password",
        ) from error
    return files


def _suffix(member: ZipInfo) -> str:
    name = PurePosixPath(member.filename)
    hidden = any(part.startswith((".", "__MACOSX")) for part in name.parts)
    return "" if member.is_dir() or hidden else name.suffix.lower()


def _name(member: ZipInfo) -> str:
    """Name of ours for a member: without its folders, and with a suffix in small letters."""
    name = PurePosixPath(member.filename)
    stem = "".join(sign if sign.isalnum() or sign in " -_" else "_" for sign in name.stem)
    return f"{stem[:80]}{_suffix(member)}"
