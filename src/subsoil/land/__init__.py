"""Land: fields, their outlines and grids, and the frames that places are given in."""

from __future__ import annotations
