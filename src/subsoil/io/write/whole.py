"""Files written whole or not at all, and never through a link that somebody left in their place."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """Path under which to write a file; it gets its own name when it is complete.

    What has that name is replaced: a link itself, and not what it leads to.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder, whole(Path(folder) / "a.txt") as unfinished:
    ...     _ = unfinished.write_text("done")
    """
    path = Path(path)
    with TemporaryDirectory(dir=path.parent, prefix=".unfinished-") as room:
        unfinished = Path(room) / path.name
        yield unfinished
        os.replace(unfinished, path)
