"""Outlines as files draw them: formats, rings and tracks, parcels, archives, and their frame."""
