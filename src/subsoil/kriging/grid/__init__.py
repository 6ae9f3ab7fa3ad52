"""Dense maps: kriging at every cell of a large grid, tile by tile."""
