"""Numbers as Fentanes et al. (2018, arXiv:1803.08069) print them, to set beside one's own.

Their field data are not public and their tables rest on one to five runs: equal protocols do not
make equal numbers.
"""

from __future__ import annotations

MARKS = (15, 20, 30, 50)
"""Numbers of samples of tables 3 and 4."""

RMSE_KPA: dict[str, tuple[float, ...]] = {
    "random": (63.04, 53.93, 48.52, 50.13),
    "area-split": (59.58, 53.83, 51.02, 49.93),
    "w-shape": (51.20, 50.41, 50.05, 51.06),
    "greedy": (47.90, 53.11, 51.19, 47.79),
    "monte-carlo": (57.97, 55.90, 53.17, 48.02),
    "adaptive-monte-carlo": (50.39, 48.93, 50.28, 45.42),
    "adaptive-greedy": (49.51, 48.96, 46.79, 48.25),
}
"""Table 3: error of the map in kPa at each of the marks; the seven strategies in its order."""

PATH_M: dict[str, tuple[float, ...]] = {
    "random": (450, 633, 670, 944),
    "area-split": (484, 635, 820, 1054),
    "w-shape": (392, 391, 405, 408),
    "greedy": (1728, 1967, 3218, 4937),
    "monte-carlo": (1238, 1660, 2521, 3817),
    "adaptive-monte-carlo": (535, 574, 841, 1478),
    "adaptive-greedy": (502, 715, 900, 1317),
}
"""Table 4: metres driven at each of the marks."""

CORRELATION: dict[str, float] = {
    "greedy": 0.79,
    "random": 0.84,
    "area-split": 0.98,
    "adaptive-greedy": 0.96,
}
"""Table 2: correlation of kriging variance and squared error, over one to five runs."""

NORMALISED_RMSE = (3.61, 0.77, 0.31, 0.18, 0.18, None, 0.18, 0.18)
"""Table 1: RMSE over mean of each layer of 5 cm, hand survey against robot; 25-30 cm is absent."""

HAND_READINGS = 49
"""Readings of the paper's survey by hand, about 25 m apart on a loose grid."""
