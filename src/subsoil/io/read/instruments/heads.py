"""The first bytes of a file as text, to tell what wrote it."""

from __future__ import annotations

_UTF_16 = (b"\xff\xfe", b"\xfe\xff")


def text_of(head: bytes) -> str:
    r"""Text of the first bytes of a file, in small letters; any bytes will do.

    Examples
    --------
    >>> text_of(b"Name: A\xb0"), text_of("Name".encode("utf-16"))
    ('name: a°', 'name')
    """
    encoding = "utf-16" if head.startswith(_UTF_16) else "latin-1"
    return head.decode(encoding, "replace").lstrip("\ufeff\u00ef\u00bb\u00bf").lower()
