"""Ways in which files go wrong, by bytes and by structure."""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Callable

import numpy as np

_NUMBERS = (
    b"", b"NaN", b"inf", b"-1", b"0", b"1e400", b"9" * 400, b"-9999", b"1,5", b"1.500", b"1'000",
    b"\xef\xbc\x91", b"0x1F", b"12:30", b"5e-324", b"N/A", b"=1+1", b"-0", b"1_0",
)  # fmt: skip
_BITS = (
    b"\x00", b"\xff\xfe", b"\xef\xbb\xbf", b"\r", b"\n\n\n", b'"', b";", b"\t", b"<", b"&x;", b"{",
    b"[" * 3000, b"\xe9", b"\x1b[31m", b"#", b"'", b",,,,", b"\\", b"%n", b"]]>", b"*a",
)  # fmt: skip

Random = np.random.Generator


def _flip(data: bytes, random: Random) -> bytes:
    changed = bytearray(data)
    for at in random.integers(0, len(data), random.integers(1, 9)):
        changed[at] ^= 1 << int(random.integers(8))
    return bytes(changed)


def _cut(data: bytes, random: Random) -> bytes:
    return data[: random.integers(0, len(data))]


def _without(data: bytes, random: Random) -> bytes:
    a, b = sorted(random.integers(0, len(data), 2).tolist())
    return data[:a] + data[b:]


def _twice(data: bytes, random: Random) -> bytes:
    a, b = sorted(random.integers(0, len(data), 2).tolist())
    return data[:b] + data[a:b] * int(random.integers(1, 4)) + data[b:]


def _inserted(data: bytes, random: Random) -> bytes:
    at = int(random.integers(0, len(data)))
    return data[:at] + _BITS[random.integers(len(_BITS))] + data[at:]


def _numbers(data: bytes, random: Random) -> bytes:
    """Other numbers in the place of some."""
    found = list(re.finditer(rb"\d+(?:\.\d+)?", data))
    for match in reversed(
        [found[k] for k in sorted(random.integers(0, len(found), 4))] if found else []
    ):
        data = (
            data[: match.start()] + _NUMBERS[random.integers(len(_NUMBERS))] + data[match.end() :]
        )
    return data


def _lines(data: bytes, random: Random) -> bytes:
    """Lines in another order, twice, or gone."""
    lines = data.split(b"\n")
    kept = random.integers(0, len(lines), len(lines))
    return b"\n".join(lines[k] for k in kept)


def _cells(data: bytes, random: Random) -> bytes:
    """Two cells of lines swapped, or one gone."""
    lines = data.split(b"\n")
    for k in random.integers(0, len(lines), 3):
        cells = lines[k].split(b",")
        a, b = random.integers(0, len(cells), 2)
        cells[a], cells[b] = cells[b], cells[a]
        lines[k] = b",".join(cells[: len(cells) - int(random.integers(2))])
    return b"\n".join(lines)


def _recoded(data: bytes, random: Random) -> bytes:
    text = data.decode("latin-1")
    code = ("utf-16", "utf-16-le", "cp037", "utf-7", "utf-8")[random.integers(5)]
    return bytes(text.encode(code, "replace"))


def _words(data: bytes, random: Random) -> bytes:
    """Some word in the place of another of the same file."""
    found = list(re.finditer(rb"[A-Za-z_]{2,}", data))
    if len(found) < 2:
        return data
    a, b = (found[k].span() for k in random.integers(0, len(found), 2).tolist())
    return data[: a[0]] + data[slice(*b)] + data[a[1] :]


MUTATIONS: tuple[Callable[[bytes, Random], bytes], ...] = (
    _flip, _cut, _without, _twice, _inserted, _numbers, _lines, _cells, _recoded, _words,
)  # fmt: skip


def mutated(data: bytes, random: Random) -> bytes:
    """A file with one to three things wrong; of an archive, also in what is inside."""
    if data[:2] == b"PK" and random.integers(2):
        return _inside(data, random)
    for _ in range(int(random.integers(1, 4))):
        data = MUTATIONS[random.integers(len(MUTATIONS))](data, random) or b"\n"
    return data


def _inside(data: bytes, random: Random) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(packed, "w") as new:
        names = old.namelist()
        wrong = names[random.integers(len(names))]
        for name in names:
            content = old.read(name) or b"\n"
            new.writestr(name, mutated(content, random) if name == wrong else content)
    return packed.getvalue()
