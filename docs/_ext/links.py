"""Links from names to their pages, wherever what they name is written, and short signatures."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from pydoc import locate
from typing import TYPE_CHECKING, Any

from docutils.utils import get_source_line
from rooms import homes, key
from sphinx.util.nodes import make_refnode

if TYPE_CHECKING:
    from docutils.nodes import Element
    from sphinx.addnodes import pending_xref
    from sphinx.application import Sphinx

REPOSITORY = "https://github.com/subsoil/subsoil"
_ARRAY = r"~?numpy\.ndarray\[tuple\[~?typing\.Any, \.\.\.\], ~?numpy\.dtype\[[^\]]*\]\]"


def resolved(app: Sphinx, _: Any, node: pending_xref, text: Element) -> Element | None:
    """Link a name to the page of what it names; one without a page here stays text.

    A name of nothing is left to Sphinx, which warns of it.
    """
    if node["refdomain"] != "py":
        return None
    target = node["reftarget"].partition("[")[0]
    for name in (f"{around}.{target}".strip(".") for around in ("", *_around(node))):
        thing = locate(name) or sys.modules.get(name)
        if thing is not None:
            home = _by_key().get(key(name, thing))
            return _link(app, node, text, home) if home else text
        owner, field = name.rpartition(".")[::2]
        if field in getattr(locate(owner), "__annotations__", ()):
            return text
    return None


def rewritten(app: Sphinx, docname: str, source: list[str]) -> None:
    """Let a page's links, which hold in the repository, lead to the same in the site.

    The gallery has its pages under another name; what is outside of the documentation is in the
    repository alone.
    """
    docs = Path(app.srcdir).resolve()
    here = (docs / docname).parent

    def moved(link: re.Match[str]) -> str:
        path, anchor = link[1], link[2] or ""
        file = (here / path).resolve()
        if not file.exists() or path.startswith("/"):
            return link[0]
        if file.is_relative_to(docs / "gallery"):
            page = docs / "examples" / ("index" if file.is_dir() else file.stem)
            return f"]({os.path.relpath(page, here)})"
        if file.is_relative_to(docs):
            return link[0]
        return f"]({REPOSITORY}/blob/main/{file.relative_to(docs.parent).as_posix()}{anchor})"

    source[0] = re.sub(r"\]\(([^)#:\s]+)(#[^)\s]*)?\)", moved, source[0])


def _around(node: pending_xref) -> Iterator[str]:
    """Modules and classes, the inmost first, that what names something is written in."""
    source = re.search("docstring of (.*)", get_source_line(node)[0] or "")
    inmost = source[1] if source else node.get("py:module") or ""
    parts = inmost.split(".")
    return (".".join(parts[:k]) for k in range(len(parts), 0, -1))


def shortened(*said: Any) -> tuple[str, str] | None:
    """Write arrays in a signature without their generics, and defaults without a value as dots."""
    signature, returns = said[-2:]
    if signature is None:
        return None
    return _short(signature), _short(returns)


def _short(types: str | None) -> str:
    arrays = re.sub(_ARRAY, "~numpy.ndarray", types or "")
    return re.sub(r"<[^>]*>", "...", arrays)


@cache
def _by_key() -> dict[object, str]:
    return {key(home, locate(home)): home for room in homes().values() for home in room.values()}


def _link(app: Sphinx, node: pending_xref, text: Element, home: str) -> Element:
    file = app.config.autosummary_filename_map.get(home, home)
    return make_refnode(app.builder, node["refdoc"], f"reference/api/{file}", home, text, home)


def setup(app: Sphinx) -> dict[str, bool]:
    """Tell Sphinx."""
    app.connect("missing-reference", resolved)
    app.connect("source-read", rewritten)
    app.connect("autodoc-process-signature", shortened)
    return {"parallel_read_safe": True}
