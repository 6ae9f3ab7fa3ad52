"""Pictures of the gallery: a figure is a value, so those of an example are among its names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sphinx_gallery.scrapers import figure_rst

DPI = 150
SHOWN = "_shown_in_the_gallery"


def drawn(_: tuple[Any, ...], names: Mapping[str, Any], gallery: Mapping[str, Any]) -> str:
    """Save the figures that a block of an example has made; returns how the page shows them.

    Parameters
    ----------
    names
        What sphinx-gallery knows of the block: the example's globals, and paths for pictures.
    gallery
        Settings of the gallery.
    """
    from matplotlib.figure import Figure

    paths = []
    for value in list(names["example_globals"].values()):
        if isinstance(value, Figure) and not hasattr(value, SHOWN):
            setattr(value, SHOWN, True)
            paths.append(next(names["image_path_iterator"]))
            value.savefig(paths[-1], dpi=DPI)
    return str(figure_rst(paths, gallery["src_dir"]))
