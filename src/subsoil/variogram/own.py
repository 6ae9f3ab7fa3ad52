"""Estimators of somebody's own: whatever they answer is looked at before it is used."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from subsoil.arrays import Floats
from subsoil.errors import ParameterError, SubsoilError, brief
from subsoil.variogram.empirical import EmpiricalVariogram, empirical_layers
from subsoil.variogram.fitting import Fit
from subsoil.variogram.models import Bounded
from subsoil.variogram.nested import Nested

Own = Callable[[Floats, Floats], Sequence[Fit | Bounded | Nested]]
"""From places (n, 2) in m and values (m, n), NaN where a layer was not measured, to a fit or a
model for each layer."""


@dataclass(frozen=True)
class Checked:
    """An estimator whose answer is looked at.

    Attributes
    ----------
    name
        What to call it in errors.
    own
        What estimates.
    """

    name: str
    own: Own

    def __call__(self, at: Floats, z: Floats) -> tuple[Fit, ...]:
        """One fit a layer.

        Raises
        ------
        ParameterError
            If it fails, or answers with something else than one fit or model a layer.
        """
        try:
            found = tuple(self.own(at, z))
        except SubsoilError:
            raise
        except Exception as error:
            raise ParameterError(
                f"it failed{self._where(at, z)}: {type(error).__name__}: {brief(str(error), 200)}",
                where=f"estimator {brief(self.name)}",
                remedy="let it give a model for every layer, also one with few readings or none",
            ) from error
        if len(found) != len(z):
            raise ParameterError(
                f"it gave {len(found)} variograms for {len(z)} layers",
                where=f"estimator {brief(self.name)}",
                remedy="let it give one a layer",
            )
        bins = empirical_layers(at, z)
        return tuple(
            self._fit(k, each, curve)
            for k, (each, curve) in enumerate(zip(found, bins, strict=True))
        )

    def _where(self, at: Floats, z: Floats) -> str:
        """Which layer is the first to fail on its own; nothing where none does."""
        for k, layer in enumerate(z, start=1):
            try:
                self.own(at, layer[None])
            except Exception:  # whatever somebody's code raises
                return f" in layer {k}"
        return ""

    def _fit(self, layer: int, answer: object, bins: EmpiricalVariogram) -> Fit:
        model = answer.variogram if isinstance(answer, Fit) else answer
        if not isinstance(model, Bounded | Nested):
            raise ParameterError(
                f"it gave {brief(repr(model))} for layer {layer + 1}, which is no variogram",
                where=f"estimator {brief(self.name)}",
                remedy="let it give models such as Spherical(nugget, range, psill)",
            )
        return answer if isinstance(answer, Fit) else Fit(model, bins, False, self.name)
