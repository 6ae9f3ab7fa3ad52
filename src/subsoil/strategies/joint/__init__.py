"""Stops and the way through them chosen together, by exchange search."""

from __future__ import annotations
