"""Layered maps of a field, what they are worth, and the fits that they stand on."""

from __future__ import annotations
