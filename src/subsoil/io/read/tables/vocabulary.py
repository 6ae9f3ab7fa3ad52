"""Words of headings: units, lengths, strength, places and the rest, as people write them.

English, French, German and Spanish, without regard to capitals and accents.
"""

from __future__ import annotations

import re
import unicodedata

_PRESSURES = {
    "kpa": r"kpa|kilopascals?|kn ?/ ?m\^?2",
    "mpa": r"mpa|megapascals?|n ?/ ?mm\^?2",
    "psi": r"psi|lbf? ?/ ?in\^?2|lbs? ?/ ?sq ?in",
    "bar": r"bars?",
    "n/cm2": r"n ?/ ?cm\^?2",
    "kgf/cm2": r"(?:kgf?|kp) ?/ ?cm\^?2",
}
_FORCES = {
    "kn": r"kn|kilonewtons?",
    "lbf": r"lbf|lbs",
    "kgf": r"kgf",
    "n": r"newtons?",
}
_UNITS = {**_PRESSURES, **_FORCES}
UNIT = re.compile(
    r"(?:(?<![a-z])|(?<=\d[cm]m)|(?<=\din))(?:"
    + "|".join(f"(?P<u{k}>{words})" for k, words in enumerate(_UNITS.values()))
    + r"|(?P<newton>n(?![\w/°])))(?![a-z/])"
)
"""A unit of strength in a heading."""
_LENGTHS = {
    "mm": r"mm|millimet(?:er|re)s?|milimetros?",
    "cm": r"cm|centimet(?:er|re)s?|centimetros?|zentimeter",
    "dm": r"dm|decimet(?:er|re)s?",
    "in": r"in|inch|inches|zoll|pouces?|pulgadas?|\"|''",
    "ft": r"ft|feet|foot|pies?|pieds?|'",
    "m": r"m|met(?:er|re)s?|metros?",
}
LENGTH = "(?:" + "|".join(_LENGTHS.values()) + ")(?![a-z0-9'])"
"""Pattern of a unit of depth."""
_SIGNS = str.maketrans({
    "−": "-", "–": "-", "—": "-", "‐": "-", "′": "'", "’": "'", "″": '"', "”": '"', "“": '"',
    "ø": "o", "ß": "s",
})  # fmt: skip

SOIL = {
    "pressure", "resistance", "strength", "cone", "index", "penetration", "penetrometer",
    "firmness", "compaction", "force", "load", "ci", "qc", "pr", "widerstand", "festigkeit",
    "eindringwiderstand", "penetrationswiderstand", "bodenfestigkeit", "druck", "kraft", "pression",
    "presion", "fuerza", "resistencia", "penetracion", "indice", "cono", "compactacion",
    "pa", "hpa", "mbar", "ksi", "atm",
}  # fmt: skip
"""Words of strength, units among them that are not known here."""
UNKNOWN_UNITS = {"pa", "hpa", "mbar", "ksi", "atm"}
FILLERS = {
    "depth", "at", "to", "in", "of", "the", "soil", "d", "p", "x", "value", "reading", "mean",
    "avg", "average", "tiefe", "bei", "bis", "prof", "profondeur", "profundidad", "sol", "suelo",
    "boden", "a", "de", "la", "le", "du", "al", "del", "en",
}  # fmt: skip
"""Words that say no more of a column than that it is of some depth."""

DEPTHS = {"depth", "depths", "tiefe", "bodentiefe", "profondeur", "profundidad", "prof", "diepte"}
TOPS = {"top", "from", "upper", "start", "von", "oben", "desde", "debut", "haut"}
BOTTOMS = {"bottom", "to", "lower", "end", "bis", "unten", "hasta", "fin", "bas"}
UNIT_WORDS = {"unit", "units", "einheit", "einheiten", "unite", "unites", "unidad", "unidades"}
TIMES = {
    "time", "date", "datetime", "timestamp", "zeit", "datum", "uhrzeit", "zeitpunkt", "zeitstempel",
    "fecha", "hora", "heure",
}  # fmt: skip
_BESIDE_TIME = {"utc", "gps", "local", "of", "reading", "measurement", "created", "start", "and"}
NUMBERS = (
    "push", "probe", "insertion", "einstich", "reading", "measurement", "messung", "mesure",
    "number", "num", "no", "nr", "nummer", "numero", "point", "pt", "punkt", "messpunkt", "punto",
    "id", "stop", "sample", "muestra", "location", "station", "site", "plot", "profile", "fid",
    "objectid",
)  # fmt: skip
"""Words for what the owner calls a push, the most usual first."""
_BESIDE_CONE = {"size", "area", "type", "tip", "base", "of", "mm", "cm", "in"}
SUMMARIES = {
    "mean", "average", "avg", "total", "sum", "median", "min", "max", "minimum", "maximum", "sd",
    "std", "stdev", "cv", "count", "mittel", "mittelwert", "summe", "moyenne", "somme", "ecart",
    "media", "promedio", "suma",
}  # fmt: skip
"""What rows below a table are called that hold no reading."""

_LATITUDES = {"lat", "latitude", "latitud", "breite", "breitengrad", "latitudes"}
_LONGITUDES = {"lon", "long", "lng", "longitude", "longitud", "lange", "laenge", "langengrad",
               "laengengrad", "longitudes"}  # fmt: skip
_EASTINGS = {"easting", "eastings", "rechtswert", "ostwert"}
_NORTHINGS = {"northing", "northings", "hochwert", "nordwert"}
_XS = {"x", "xcoord", "east", "este", "est", "ost", "e"}
_YS = {"y", "ycoord", "north", "norte", "nord", "n"}
_PLACES = {
    "latitude": _LATITUDES, "longitude": _LONGITUDES, "easting": _EASTINGS, "northing": _NORTHINGS,
    "x": _XS, "y": _YS,
}  # fmt: skip
_BESIDE_PLACE = {
    "wgs", "wgs84", "84", "gps", "gnss", "rtk", "utm", "deg", "degree", "degrees", "dd", "dec",
    "decimal", "grad", "grados", "m", "metre", "metres", "meter", "meters", "coord", "coordinate",
    "koordinate", "coordenada", "coordonnee", "pos", "position", "geo", "geographische", "point",
    "epsg", "4326", "dms", "ddmm", "dm", "nmea", "in",
}  # fmt: skip
_HALVES = {"n/s": "north or south", "ns": "north or south", "e/w": "east or west",
           "ew": "east or west"}  # fmt: skip
_BESIDE_HALF = {"hemisphere", "hemi", "hem", "dir", "direction", "ref", "indicator"}


def plain(text: str) -> str:
    """Text in small letters without accents, brackets and underscores.

    Examples
    --------
    >>> plain("Länge_[°]"), plain("10cm (N/cm²)")
    ('lange °', '10cm n/cm2')
    """
    text = unicodedata.normalize("NFKC", text.translate(_SIGNS)).translate(_SIGNS)
    parts = unicodedata.normalize("NFKD", text.casefold())
    bare = "".join(c for c in parts if not unicodedata.combining(c))
    return " ".join(re.sub(r"[_()\[\]{}:;|@=#]", " ", bare).split())


def words_of(text: str) -> list[str]:
    """Words and numbers of a plain text."""
    return re.findall(r"[^\W\d_]+|\d+|\"|''?", text)


def unit_named(match: re.Match[str]) -> str:
    """Unit of a match of :data:`UNIT`."""
    return "n" if match["newton"] else list(_UNITS)[int((match.lastgroup or "u0")[1:])]


def length_named(word: str) -> str:
    """Unit of depth of a word; empty if it is none.

    Examples
    --------
    >>> length_named("inches"), length_named("zoll"), length_named("acre")
    ('in', 'in', '')
    """
    return next((k for k, words in _LENGTHS.items() if re.fullmatch(words, word)), "")


def place_named(text: str) -> str:
    """What coordinate a plain text names; empty if none.

    Examples
    --------
    >>> place_named("lon wgs84"), place_named("rechtswert"), place_named("easting 27700")
    ('longitude', 'easting', '')
    """
    words = {word for word in words_of(text) if word not in _BESIDE_PLACE}
    if not words:
        return ""
    found = [kind for kind, known in _PLACES.items() if words & known]
    if not words <= set().union(*(_PLACES[kind] for kind in found)):
        return ""
    return found[0] if len(found) == 1 or found[1:] in (["x"], ["y"]) else ""


def half_named(text: str) -> str:
    """Whether a plain text is of north and south or east and west; empty if of neither.

    Examples
    --------
    >>> half_named("n/s"), half_named("lon dir"), half_named("hemisphere")
    ('north or south', 'east or west', '')
    """
    if text.replace(" ", "") in _HALVES:
        return _HALVES[text.replace(" ", "")]
    words = set(words_of(text))
    of = words - _BESIDE_HALF
    if not of or of == words:
        return ""
    if of <= _LATITUDES | {"ns"}:
        return "north or south"
    return "east or west" if of <= _LONGITUDES | {"ew"} else ""


def names_time(text: str) -> bool:
    """Whether a plain text names a column of dates or times."""
    words = set(words_of(text))
    return bool(words & TIMES) and words <= TIMES | _BESIDE_TIME


def names_number(text: str) -> bool:
    """Whether a plain text names a column of what pushes are called."""
    words = set(words_of(text.replace("n°", "no").replace("nº", "no")))
    return bool(words) and words <= set(NUMBERS)


def names_cone(text: str) -> bool:
    """Whether a plain text names a column of cone sizes."""
    words = {word for word in words_of(text) if not word.isdigit()}
    return (
        bool(words & {"cone", "konus", "cono"})
        and len(words) > 1
        and words <= ({"cone", "konus", "cono"} | _BESIDE_CONE)
    ) or text == "cone"
