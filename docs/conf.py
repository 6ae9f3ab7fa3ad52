"""How the documentation is built: ``make docs``. Nothing is fetched, neither here nor by a page."""

from __future__ import annotations

import sys
from pathlib import Path

from sphinx.util.inspect import TypeAliasForwardRef

import subsoil

sys.path.insert(0, str(Path(__file__).parent / "_ext"))

project = "subsoil"
author = "The subsoil authors"
project_copyright = author
release = subsoil.__version__

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "myst_nb",
    "sphinx_gallery.gen_gallery",
    "commands",
    "rooms",
    "links",
]
exclude_patterns = ["_build", "_ext", "_templates", "gallery", "examples/*.ipynb"]
templates_path = ["_templates"]
nitpicky = True
nitpick_ignore = [
    ("py:class", name)
    for name in (
        # Imported for types alone: nothing has them when pages are made.
        *("ArrayLike", "Axes", "CRS", "Dataset", "Drawn", "Figure", "Format", "Outlook", "Path"),
        # What autodoc makes of the union of all events within another type.
        *("FieldInfo", "NoneType", "types.Annotated"),
    )
]

html_theme = "pydata_sphinx_theme"
html_title = "subsoil"
html_static_path = ["_static"]
html_css_files = ["subsoil.css"]
html_sidebars = {"index": []}
html_show_sourcelink = False
html_theme_options = {
    "navbar_end": ["theme-switcher"],
    "footer_end": [],
    "navigation_with_keys": False,
    "show_prev_next": True,
    "show_toc_level": 2,
}

myst_heading_anchors = 4
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 120

# An alias within another type goes by its name there too, not by Python's words for it.
TypeAliasForwardRef.__repr__ = lambda alias: alias.name
autosummary_generate = True
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_type_aliases = {
    **dict.fromkeys(("Bools", "Floats", "Indices", "Integers"), "numpy.ndarray"),
    "ArrayLike": "numpy.typing.ArrayLike",
    "Estimator": "subsoil.variogram.Estimator",
    "Event": "subsoil.survey.events.Event",
    "Report": "subsoil.reports.Report",
    "Strategy": "subsoil.strategies.Strategy",
}
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 80
numpydoc_show_class_members = False

sphinx_gallery_conf = {
    "examples_dirs": ["gallery"],
    "gallery_dirs": ["examples"],
    "within_subsection_order": "FileNameSortKey",
    "image_scrapers": ("figures.drawn",),
    "ignore_repr_types": r"matplotlib\.figure",
    "reset_modules": (),
    "min_reported_time": 5,
    "show_memory": False,
    "write_computation_times": False,
}
