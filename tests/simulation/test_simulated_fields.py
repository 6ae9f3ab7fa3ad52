"""Random fields: the test bed is what the comparisons say it is, and any outline can have one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from subsoil.errors import ParameterError
from subsoil.land.field import Field
from subsoil.layers import Layers
from subsoil.simulation import Scheme, Soil, Truth, draw_field, draw_truth
from subsoil.simulation.soil import FLOOR_KPA

SEEDS = range(8)


def _soil(truth: Truth) -> Soil:
    assert isinstance(truth.origin, Soil)
    return truth.origin


@pytest.fixture(scope="module")
def beds() -> dict[Scheme, list[Truth]]:
    def draw(protocol: Scheme) -> list[Truth]:
        return [draw_field(np.random.default_rng(seed), protocol) for seed in SEEDS]

    return {"surrogate": draw("surrogate"), "signal": draw("signal")}


def test_the_test_bed_is_936_cells_of_5_m_in_eight_layers(
    beds: dict[Scheme, list[Truth]],
) -> None:
    truth = beds["surrogate"][0]
    assert truth.kpa.shape == truth.noise.shape == (8, 936)
    assert truth.field.cell_size == 5.0
    assert truth.field.boundary.bounds == (0.0, 0.0, 180.0, 130.0)


def test_the_surrogate_varies_by_65_kpa_and_is_read_without_noise(
    beds: dict[Scheme, list[Truth]],
) -> None:
    for truth in beds["surrogate"]:
        off = truth.kpa - truth.kpa.mean(axis=1, keepdims=True)
        assert np.sqrt(np.mean(off**2)) == pytest.approx(65.0, rel=1e-12)
        assert not truth.noise.any()


def test_both_protocols_of_a_seed_are_one_soil(beds: dict[Scheme, list[Truth]]) -> None:
    for kriged, grown in zip(beds["surrogate"], beds["signal"], strict=True):
        assert kriged.origin == grown.origin
        assert kriged.kpa.mean(axis=1) == pytest.approx(grown.kpa.mean(axis=1), rel=0.1)
    deep = [
        np.corrcoef(kriged.kpa[4], grown.kpa[4])[0, 1]
        for kriged, grown in zip(beds["surrogate"], beds["signal"], strict=True)
    ]
    assert np.mean(deep) > 0.6


def test_the_same_seed_gives_the_same_field(beds: dict[Scheme, list[Truth]]) -> None:
    for protocol, truths in beds.items():
        again = draw_field(np.random.default_rng(SEEDS[3]), protocol)
        assert np.array_equal(again.kpa, truths[3].kpa)
        assert np.array_equal(again.noise, truths[3].noise)
        assert again.origin == truths[3].origin
    assert not np.array_equal(beds["signal"][0].kpa, beds["signal"][1].kpa)


def test_surrogates_are_smoother_than_their_soil(beds: dict[Scheme, list[Truth]]) -> None:
    def roughness(truth: Truth) -> float:
        return float(np.nanstd(np.diff(truth.field.grid.image(truth.kpa), axis=-1)))

    for kriged, grown in zip(beds["surrogate"], beds["signal"], strict=True):
        assert roughness(kriged) < roughness(grown)


def test_pushes_in_the_signal_scatter_with_the_drawn_nugget(
    beds: dict[Scheme, list[Truth]],
) -> None:
    """Noise is white along the ground, so its mean square has a chi-square's standard error."""
    for truth in beds["signal"]:
        soil = _soil(truth)
        sd = soil.scale * soil.sd_kpa(truth.layers.centre_m)[:, None]
        nugget = soil.variogram().nugget
        share = np.mean((truth.noise / sd) ** 2, axis=1) / nugget
        assert share == pytest.approx(1.0, abs=4.5 * np.sqrt(2 / 936))


def test_the_soil_of_a_field_varies_as_its_drawn_variogram_says() -> None:
    """Differences of a plain soil over 5 and 20 m, pooled over fields, against the model."""
    field = Field.from_metres([(0, 0), (60, 0), (60, 60), (0, 60)])
    ratios: dict[int, list[float]] = {1: [], 4: []}
    for seed in range(100):
        truth = draw_truth(field, np.random.default_rng(seed))
        soil = _soil(truth)
        if soil.headland or soil.tramlines or soil.drift > 0.5:
            continue
        z = truth.kpa[4] / soil.sd_kpa(truth.layers.centre_m)[4]
        image = field.grid.image(z)
        for step, found in ratios.items():
            # Along both axes a linear drift adds its squared step, which is known.
            slope = 0.75 * soil.drift * 5.0 * step / 30.0  # 0.75: the drift at 22.5 cm
            east, north = image[:, step:] - image[:, :-step], image[step:] - image[:-step]
            mean_square = (np.nanmean(east**2) + np.nanmean(north**2)) / 2
            gamma = float(mean_square - slope**2 / 2) / 2
            found.append(gamma / float(soil.variogram().rise(np.array(5.0 * step))))
    for found in ratios.values():
        assert len(found) > 10
        error = np.std(found, ddof=1) / np.sqrt(len(found))
        assert np.mean(found) == pytest.approx(1.0, abs=4 * error)
        assert error < 0.15


@pytest.mark.parametrize("seed", range(3))
def test_any_outline_can_have_a_soil(seed: int) -> None:
    outline = [(1000, 2000), (1120, 2010), (1110, 2060), (1060, 2055), (1050, 2110), (995, 2100)]
    field = Field.from_metres(outline, cell_size=4.0)
    layers = Layers((0.05, 0.15, 0.3, 0.6))
    truth = draw_truth(field, np.random.default_rng(seed), layers)
    assert truth.kpa.shape == (3, len(field.cells))
    assert np.array_equal(draw_truth(field, np.random.default_rng(seed), layers).kpa, truth.kpa)
    readings = truth.kpa + truth.noise
    assert min(truth.kpa.min(), readings.min() + 1e-9) >= FLOOR_KPA
    variation = readings.std(axis=1) / readings.mean(axis=1)
    assert np.all((variation > 0.15) & (variation < 0.6))


def test_too_many_cells_are_refused_with_a_size_that_would_do() -> None:
    field = Field.from_metres([(0, 0), (500, 0), (500, 500), (0, 500)])
    with pytest.raises(ParameterError, match=r"10000 cells.*use cells of 5\.6 m"):
        draw_truth(field, np.random.default_rng(0))
    enough = replace(field, cell_size=5.6)
    assert len(enough.cells) <= 8000


def test_a_protocol_must_be_one_of_two() -> None:
    with pytest.raises(ParameterError, match="surrogate, signal"):
        draw_field(np.random.default_rng(0), "truth")  # type: ignore[arg-type]


def test_the_test_bed_of_a_seed_stays_what_published_comparisons_ran_on(
    beds: dict[Scheme, list[Truth]],
) -> None:
    """Values of seed 5 in the fifth layer: three cells of the map, and deviations there."""
    cells = [0, 467, 935]
    kriged, grown = beds["surrogate"][5], beds["signal"][5]
    expected = [1414.684675922159, 1439.287159970852, 1551.904789868699]
    assert kriged.kpa[4, cells] == pytest.approx(expected, rel=1e-9)
    expected = [1318.7514618303987, 1356.1871710927614, 1524.0577347723936]
    assert grown.kpa[4, cells] == pytest.approx(expected, rel=1e-9)
    expected = [28.34548461889598, 9.781474107207627, 7.519982732144896]
    assert grown.noise[4, cells] == pytest.approx(expected, rel=1e-9)


def test_the_test_bed_can_be_laid_on_any_field(beds: dict[Scheme, list[Truth]]) -> None:
    rectangle = [(0, 0), (180, 0), (180, 130), (0, 130)]
    same = draw_field(np.random.default_rng(SEEDS[2]), field=Field.from_metres(rectangle))
    assert np.array_equal(same.kpa, beds["surrogate"][2].kpa)
    bent = [(1003, 2001), (1150, 2001), (1150, 2060), (1070, 2060), (1070, 2140), (1003, 2140)]
    field = Field.from_metres(bent, name="L")
    kriged = draw_field(np.random.default_rng(1), "surrogate", field)
    grown = draw_field(np.random.default_rng(1), "signal", field)
    assert kriged.origin == grown.origin
    off = kriged.kpa - kriged.kpa.mean(axis=1, keepdims=True)
    assert kriged.kpa.shape == (8, len(field.cells))
    assert np.sqrt(np.mean(off**2)) == pytest.approx(65.0, rel=1e-12)
    assert np.corrcoef(kriged.kpa[4], grown.kpa[4])[0, 1] > 0.3
    assert grown.noise.any()
    assert not kriged.noise.any()


def test_samples_at_the_centres_of_cells_read_the_soil_of_the_cell() -> None:
    """Cells of 10 m have their centres where the samples are."""
    field = Field.from_metres([(0, 0), (120, 0), (120, 90), (0, 90)], cell_size=10.0)
    truth = draw_field(np.random.default_rng(1), "surrogate", field)
    assert truth.kpa.shape == (8, 108)
    assert np.isfinite(truth.kpa).all()


def test_a_test_bed_of_too_many_cells_is_refused() -> None:
    field = Field.from_metres([(0, 0), (500, 0), (500, 500), (0, 500)])
    with pytest.raises(ParameterError, match=r"10000 cells are more than the 8000"):
        draw_field(np.random.default_rng(0), field=field)
