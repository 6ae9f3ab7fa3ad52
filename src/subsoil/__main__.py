"""``python -m subsoil`` is the command line."""

from subsoil.cli import main

main()
