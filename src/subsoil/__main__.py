"""``subsoil``, and ``python -m subsoil``, is the command line.

Ctrl-C while it is still loading ends it in one line. With ``-m`` Python looks for modules in the
current folder first; what lies beside somebody's survey must not be loaded from there.
"""

from __future__ import annotations

import os
import signal
import sys


def main() -> None:
    """Run the command line and exit."""
    signal.signal(signal.SIGINT, _ended)
    from subsoil.cli import run

    signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.exit(run(sys.argv[1:]))


def _ended(*_: object) -> None:
    os.write(2, b"error: stopped before anything was done\n")
    os._exit(3)


if __name__ == "__main__":
    if sys.path and sys.path[0] in ("", os.getcwd()):
        del sys.path[0]
    main()
