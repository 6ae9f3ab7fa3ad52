"""Mean kriging variance over a field's cells, of designs that are not probed yet.

Kriging variance does not depend on readings, so a design, the cells to probe, can be judged before
it is probed. With C the covariance of cells (sill 1, nugget t apart), c(x) its column of cell x at
the cells of the design, and a border of ones for the unknown mean::

    A = [[C + t I, 1], [1', 0]]        G = mean over cells x of [c(x); 1] [c(x); 1]'
    mean variance = C(0) - tr(A^-1 G)

G is a part of one matrix that all designs share, whose rows are convolutions on the field's grid:
a row costs a fast Fourier transform, and after that nothing about a design grows with the field.
Probing one more cell q lowers the mean variance by the mean square of the error covariance with q
over the variance of a reading at q (:meth:`Designs.gains`); one cell less is a downdate of A^-1.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy
from numpy.typing import NDArray

from subsoil.arrays import Floats
from subsoil.land.field import Field
from subsoil.variogram.nested import Nested


class Designs:
    """Designs on the N cells of a field under one correlogram.

    Parameters
    ----------
    field
        The field.
    correlogram
        Its shape; the sill is taken for 1.
    weights
        (N,) how much the variance of each cell counts.

    Attributes
    ----------
    origin
        C(0), what the nugget leaves of the sill.
    nugget
        Variance of a reading around the soil of its cell.
    average
        (N,) mean covariance of each cell with all cells, by their weights.
    squares
        (N,) mean squared covariance: the diagonal of G.

    Examples
    --------
    >>> from subsoil.variogram import Exponential, Structure
    >>> field = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)])
    >>> shape = Nested(1.0, (Structure(0.8, Exponential, 45.0),))
    >>> designs = Designs(field, shape, np.ones(len(field.cells)))
    >>> [round(designs.mean_variance(cells), 3) for cells in ([0, 1], [20, 75], [20, 30, 65, 75])]
    [1.312, 0.886, 0.715]
    """

    def __init__(self, field: Field, correlogram: Nested, weights: Floats) -> None:
        inside = field.grid.inside
        ny, nx = inside.shape
        self._north, self._east = np.nonzero(inside)
        away = field.cell_size * np.hypot(np.arange(ny)[:, None], np.arange(nx))
        self._kernel = correlogram.correlation(away)
        self._size = (
            scipy.fft.next_fast_len(2 * ny - 1, real=True),
            scipy.fft.next_fast_len(2 * nx - 1, real=True),
        )
        self._spectrum = self._transformed(self._kernel)
        self._weights = np.zeros(inside.shape)
        self._weights[inside] = weights / weights.sum()
        self._known: dict[int, tuple[Floats, Floats]] = {}
        self.origin = float(self._kernel[0, 0])
        self.nugget = 1.0 - self.origin
        self.average = self._convolved(self._weights, self._spectrum)
        self.squares = self._convolved(self._weights, self._transformed(self._kernel**2))

    def covariances(self, cells: Sequence[int]) -> tuple[Floats, Floats]:
        """(k, N) covariances of cells with all cells, and their (k, N) rows of G."""
        unknown = [cell for cell in cells if cell not in self._known]
        if unknown:
            north, east = self._north[unknown, None], self._east[unknown, None]
            c = self._kernel[np.abs(north - self._north), np.abs(east - self._east)]
            images = np.zeros((len(unknown), *self._weights.shape))
            images[:, self._north, self._east] = c
            g = self._convolved(images * self._weights, self._spectrum)
            self._known.update(zip(unknown, zip(c, g, strict=True), strict=True))
        known = [self._known[cell] for cell in cells]
        return np.array([c for c, _ in known]), np.array([g for _, g in known])

    def mean_variance(self, cells: Sequence[int]) -> float:
        """Mean kriging variance of the soil, filtered of its nugget, once cells are probed."""
        c, g = self.covariances(cells)
        return self.variance_left(self.inverse(c[:, list(cells)]), self.gram(cells, g))

    def inverse(self, covariance: Floats) -> Floats:
        """(n + 1, n + 1) inverse of the bordered system of readings at n cells."""
        n = len(covariance)
        system = np.ones((n + 1, n + 1))
        system[:n, :n] = covariance
        system[np.arange(n), np.arange(n)] += self.nugget
        system[n, n] = 0.0
        return np.asarray(np.linalg.inv(system))

    def gram(self, cells: Sequence[int], g: Floats) -> Floats:
        """(n + 1, n + 1) G of n cells, given their (n, N) rows."""
        n, index = len(cells), list(cells)
        gram = np.ones((n + 1, n + 1))
        gram[:n, :n] = g[:, index]
        gram[:n, n] = gram[n, :n] = self.average[index]
        return gram

    def variance_left(self, inverse: Floats, gram: Floats) -> float:
        """Mean kriging variance of a design by its system and its G."""
        return self.origin - float(np.vdot(inverse, gram))

    def _transformed(self, kernel: Floats) -> NDArray[np.complex128]:
        """Spectrum of a kernel of lags, mirrored to negative ones."""
        ny, nx = kernel.shape
        whole = np.zeros(self._size)
        whole[:ny, :nx] = kernel
        whole[self._size[0] - ny + 1 :, :nx] = kernel[:0:-1]
        whole[:, self._size[1] - nx + 1 :] = whole[:, nx - 1 : 0 : -1]
        return np.asarray(scipy.fft.rfft2(whole))

    def _convolved(self, images: Floats, spectrum: NDArray[np.complex128]) -> Floats:
        """(..., N) values at the cells of (..., ny, nx) images convolved with a kernel."""
        product = scipy.fft.irfft2(scipy.fft.rfft2(images, self._size) * spectrum, self._size)
        return np.asarray(product[..., self._north, self._east])
