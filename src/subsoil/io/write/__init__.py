"""Writing maps, each whole or not at all."""
