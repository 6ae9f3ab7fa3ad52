"""What holds for every estimator, whatever was read."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from subsoil.bench.conformance.estimators import RULES
from subsoil.bench.conformance.rule import Rule, Subject
from subsoil.registry import Allowed
from subsoil.variogram import ESTIMATORS

OWN = "tenth_nugget_estimator:tenth_nugget"
EVERY = [*ESTIMATORS, OWN]
TRIED = [(rule, case) for rule in RULES for case in rule.cases]


@pytest.fixture(scope="module", autouse=True)
def own_estimator(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """A user's estimator in a file of their own."""
    folder = tmp_path_factory.mktemp("own")
    (folder / "tenth_nugget_estimator.py").write_text(
        """
import numpy as np
from subsoil import Spherical

def tenth_nugget(at, z):
    known = [layer[np.isfinite(layer)] for layer in z]
    sills = [layer.var() if np.ptp(layer) > 0 else 1.0 for layer in known if layer.size]
    usual = np.mean(sills) if sills else 1.0
    each = [layer.var() if layer.size and np.ptp(layer) > 0 else usual for layer in known]
    return [Spherical(0.1 * sill, 50.0, 0.9 * sill) for sill in each]
"""
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(folder)
        yield


@pytest.mark.parametrize("name", EVERY)
@pytest.mark.parametrize(("rule", "case"), TRIED, ids=lambda x: getattr(x, "words", x))
def test_an_estimator_keeps_every_rule(rule: Rule, case: str, name: str) -> None:
    assert rule.seen(Subject(name, Allowed.by_name(name)), case) == ""
