"""Tables of readings as people write them: sheets, headings, numbers, places, rows."""
