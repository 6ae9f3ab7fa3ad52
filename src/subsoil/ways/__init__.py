"""Ways over a field: where one may stop, how far it is, and short routes through places."""

from __future__ import annotations
