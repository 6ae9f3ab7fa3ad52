"""Files: field outlines and readings in, maps and prescriptions out."""
