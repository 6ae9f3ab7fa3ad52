"""Pictures show what the survey knows, all of it, and say what is what."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text

from subsoil.errors import MissingExtraError, ParameterError, ReadingsError
from subsoil.land.field import Field
from subsoil.layers import Layers, LayerState, Sample
from subsoil.mapping.soilmap import SoilMap
from subsoil.penetrometer import SMALL_CONE
from subsoil.plots import (
    depth_slices,
    draw_readings,
    draw_survey,
    learning_curves,
    profiles,
    std_dev,
    variograms,
)
from subsoil.plots.saving import save_all
from subsoil.plots.sheet import blank, sheet
from subsoil.plots.subject import way
from subsoil.report import Progress
from subsoil.reports import Refused
from subsoil.survey import Stop, Survey, apply, opened, opening
from subsoil.survey.events import Configured, Opened
from subsoil.variogram import BoundedLinear, Fit, LeastSquares, Spherical, Variogram

FIELD = Field.from_metres([(0, 0), (60, 0), (60, 40), (0, 40)], name="plot")
LAYERS = Layers((0.0, 0.1, 0.2, 0.3))
_, AT_LEAST, UNREACHED = LayerState
CORNERS = {
    "tall": [(0, 0), (40, 0), (60, 300), (20, 310)],
    "wide": [(0, 0), (400, 0), (400, 60), (0, 80)],
    "L-shaped": [(0, 0), (160, 0), (160, 60), (90, 60), (90, 140), (0, 140)],
}
UTM = np.array([681_000.0, 5_900_000.0])

History = tuple[Progress, ...]
Fits = tuple[Fit, ...]
Legible = Callable[[Figure], None]


def layered(
    kpa: list[list[float]],
    states: list[list[int]],
    models: tuple[Variogram, ...] = (Spherical(100.0, 30.0, 5000.0),) * 3,
) -> SoilMap:
    """Map of samples given as (n, 3) layer means and states, at cells ten apart."""
    samples = tuple(
        Sample(tuple(at), np.array(values), np.array(state, dtype=np.int8))
        for at, values, state in zip(FIELD.cells[::10].tolist(), kpa, states, strict=False)
    )
    return SoilMap(FIELD, LAYERS, models, samples)


def surveyed(soil_map: SoilMap, refused: tuple[int, ...] = ()) -> Survey:
    """Survey with the samples of a map, and with stones at some cells."""
    begun = opened(opening(soil_map.field, soil_map.layers, SMALL_CONE))
    stone = Refused(agent="robot", at=(1, 1), reason="stone", metres=5, seconds=50, tries=3)
    stops = tuple(Stop(f"stone {cell}", "robot", cell, refusal=stone) for cell in refused)
    return replace(begun, soil_map=soil_map, stops=stops)


def panels(figure: Figure, number: int) -> list[Axes]:
    return figure.axes[:number]


def texts(axes: Axes) -> list[str]:
    return [axes.get_title(loc="left"), *(text.get_text() for text in axes.texts)]


def names(figure: Figure) -> set[str]:
    return {text.get_text() for legend in figure.legends for text in legend.get_texts()}


def points(line: Line2D) -> list[list[float]]:
    found: list[list[float]] = np.asarray(line.get_xydata()).tolist()
    return found


def named(axes: Axes, name: str) -> list[list[float]]:
    """Points of the one line of a name."""
    (line,) = [line for line in axes.lines if line.get_label() == name]
    return points(line)


def scale_bar(figure: Figure) -> Line2D:
    (bar,) = [line for axes in figure.axes for line in axes.lines if line.get_gid() == "scale bar"]
    return bar


def rendered(figure: Figure) -> bytes:
    target = BytesIO()
    figure.savefig(target, dpi=40)
    return target.getvalue()


def test_slices_share_one_scale_from_the_lowest_to_the_highest_mean(survey: Survey) -> None:
    soil_map = survey.soil_map
    drawn = panels(depth_slices(soil_map), 8)
    limits = {axes.images[0].get_clim() for axes in drawn}
    assert limits == {(soil_map.mean.min(), soil_map.mean.max())}
    assert {axes.images[0].get_cmap().name for axes in drawn} == {"viridis"}


def test_slices_show_every_cell_where_it_lies_north_up(survey: Survey) -> None:
    soil_map = survey.soil_map
    for k, axes in enumerate(panels(depth_slices(soil_map), 8)):
        image = axes.images[0]
        assert image.origin == "lower"
        assert list(image.get_extent()) == [0.0, 60.0, 0.0, 40.0]
        np.testing.assert_array_equal(np.asarray(image.get_array()).ravel(), soil_map.mean[k])


def test_slices_are_named_after_layers_with_metres_of_equal_length(survey: Survey) -> None:
    drawn = panels(depth_slices(survey.soil_map), 8)
    assert tuple(axes.get_title(loc="left") for axes in drawn) == Layers().names
    assert {axes.get_aspect() for axes in drawn} == {1.0}


def test_slices_have_a_scale_bar_of_its_stated_length_and_a_north_arrow(survey: Survey) -> None:
    figure = depth_slices(survey.soil_map)
    bar = scale_bar(figure)
    foot = bar.axes
    assert isinstance(foot, Axes)
    words = [text.get_text() for text in foot.texts]
    assert "N" in words
    (length,) = [float(word.removesuffix(" m")) for word in words if word.endswith(" m")]

    def inches(axes: Axes, x: float) -> float:
        return float(axes.transData.transform((x, 0.0))[0]) / figure.dpi

    ends = [inches(foot, x) for x, _ in points(bar)]
    ten_metres = inches(figure.axes[0], 10.0) - inches(figure.axes[0], 0.0)
    assert (ends[1] - ends[0]) / ten_metres * 10.0 == pytest.approx(length)


def test_the_colour_bar_says_kpa(survey: Survey) -> None:
    soil_map = survey.soil_map
    for figure in (depth_slices(soil_map), std_dev(soil_map)):
        assert any(axes.get_ylabel().endswith("(kPa)") for axes in figure.axes)


def test_standard_deviations_are_roots_of_variances_on_one_scale_of_their_own(
    survey: Survey,
) -> None:
    soil_map = survey.soil_map
    drawn = panels(std_dev(soil_map), 8)
    for k, axes in enumerate(drawn):
        values = np.asarray(axes.images[0].get_array()).ravel()
        np.testing.assert_allclose(values**2, soil_map.variance[k], rtol=1e-12)
    assert len({axes.images[0].get_clim() for axes in drawn}) == 1
    assert drawn[0].images[0].get_cmap().name != "viridis"


def test_a_sample_is_drawn_by_what_it_knows_of_the_layer() -> None:
    nan = np.nan
    soil_map = layered(
        [[500, 900, 1200], [600, 1900, nan], [550, 950, 1250]],
        [[0, 0, 0], [0, AT_LEAST, UNREACHED], [0, 0, 0]],
    )
    figure = depth_slices(soil_map)
    drawn = [
        {marks.get_label(): len(np.asarray(marks.get_offsets())) for marks in axes.collections}
        for axes in panels(figure, 3)
    ]
    bound, unreached = "at least (force limit)", "layer not reached"
    assert drawn == [{"sample": 3}, {"sample": 2, bound: 1}, {"sample": 2, unreached: 1}]
    assert names(figure) == {"sample", bound, unreached}


def test_the_way_goes_from_the_start_through_all_samples_in_order(survey: Survey) -> None:
    places = way(survey)
    assert places[0].tolist() == list(survey.settings.start)
    np.testing.assert_array_equal(places[1:], survey.soil_map.at)
    figure = depth_slices(survey)
    for axes in panels(figure, 8):
        assert any(points(line) == places.tolist() for line in axes.lines)
    assert {"way between samples", "start"} <= names(figure)


def test_keep_outs_holes_and_refused_stops_are_drawn(survey: Survey) -> None:
    ring = [(20, 10), (30, 10), (30, 20), (20, 20)]
    field = replace(FIELD, keep_outs=(Field.from_metres(ring).boundary,))
    soil_map = SoilMap(field, Layers(), survey.soil_map.variograms, survey.soil_map.samples)
    figure = depth_slices(surveyed(soil_map, refused=(3, 7)))
    for axes in panels(figure, 8):
        assert len(axes.patches) == 1
        assert axes.patches[0].get_hatch()
    assert "refused" in names(figure)


def test_a_layer_that_no_sample_measured_says_so() -> None:
    soil_map = layered([[500, 900, np.nan]], [[0, 0, UNREACHED]])
    drawn = panels(depth_slices(soil_map), 3)
    assert [any("no sample" in text for text in texts(axes)) for axes in drawn] == [
        False,
        False,
        True,
    ]


def test_every_picture_says_what_the_survey_cost(
    survey: Survey, history: History, fits: Fits
) -> None:
    cost = f"8 samples, {survey.metres:.0f} m driven, {survey.minutes:.0f} min"
    for figure in draw_survey(survey, history, fits).values():
        assert figure.texts[1].get_text().startswith(cost)


@pytest.mark.parametrize("samples", [1, 2, 3])
def test_the_first_samples_of_a_survey_can_be_drawn(
    survey: Survey, history: History, samples: int, plot_opened: Opened
) -> None:
    changed = apply(opened(plot_opened), Configured(settings=survey.settings))
    kept = survey.soil_map.samples[:samples]
    soil_map = replace(changed.soil_map, samples=kept, variograms=survey.soil_map.variograms)
    early = replace(changed, soil_map=soil_map, stops=survey.stops[:samples])
    own = LeastSquares(Spherical)(soil_map.at, soil_map.kpa)
    figures = draw_survey(early, history[:samples], own)
    assert len(figures) == 5
    for figure in figures.values():
        figure.draw_without_rendering()


@pytest.mark.parametrize("draw", [depth_slices, std_dev, profiles])
def test_without_a_sample_there_is_one_line_saying_so(
    draw: Callable[[SoilMap], Figure],
) -> None:
    with pytest.raises(ReadingsError, match="nothing to draw: no sample"):
        draw(SoilMap(FIELD, LAYERS))


def test_alike_values_can_be_drawn() -> None:
    soil_map = layered([[700.0] * 3] * 4, [[0] * 3] * 4)
    low, high = depth_slices(soil_map).axes[0].images[0].get_clim()
    assert low < 700.0 < high


def test_a_name_is_text_and_never_a_formula(survey: Survey) -> None:
    named = replace(survey.soil_map, field=replace(FIELD, name="$\\frac{oops$"))
    figure = depth_slices(named, caption="50 $ a sample, 60 $ an hour")
    assert rendered(figure).startswith(b"\x89PNG")
    assert any("$\\frac{oops$" in text.get_text() for text in figure.texts)


@pytest.mark.parametrize("shape", CORNERS)
@pytest.mark.parametrize("layers", [1, 8])
def test_no_two_texts_of_a_map_overlap(shape: str, layers: int, assert_legible: Legible) -> None:
    field = Field.from_metres(np.array(CORNERS[shape]) + UTM, crs="EPSG:32630", name=shape)
    bands = Layers(tuple(0.05 * k for k in range(layers + 1)))
    rng = np.random.default_rng(2)
    samples = tuple(
        Sample(
            tuple(at),
            rng.uniform(200, 2000, layers),
            ((k + np.arange(layers)) % len(LayerState)).astype(np.int8),
        )
        for k, at in enumerate(field.cells[::40].tolist())
    )
    soil_map = SoilMap(field, bands, (Spherical(1.0, 50.0, 9.0),) * layers, samples)
    figure = depth_slices(surveyed(soil_map, refused=(5,)), caption="a caption " * 8)
    assert_legible(figure)
    assert not scale_bar(figure).get_window_extent().overlaps(figure.legends[0].get_window_extent())
    for axes in panels(figure, layers):
        (title,) = [text for text in axes.findobj(Text) if text.get_text() in bands.names]
        above = title.get_window_extent().y0 - axes.bbox.y1
        assert 0 < above < 0.1 * figure.dpi


@given(st.integers(1, 24), st.floats(0.1, 10.0))
def test_a_sheet_holds_all_panels_within_reach(number: int, aspect: float) -> None:
    layout = sheet(number, aspect, strip=0.24, across=0.12, left=0.2, right=1.05, bottom=0.75)
    assert layout.rows * layout.columns >= number
    assert (layout.rows - 1) * layout.columns < number
    assert layout.width / layout.height == pytest.approx(aspect)
    width, height = layout.size
    assert width <= 10.7
    assert height <= 10.1


def test_eight_layers_of_a_wide_field_make_two_rows_of_four() -> None:
    layout = sheet(8, 1.4, strip=0.24, across=0.12, left=0.2, right=1.05, bottom=0.75)
    assert (layout.rows, layout.columns) == (2, 4)


HISTORY = (
    Progress(1, 20.0, 1.2, 0.9, 600.0),
    Progress(2, 50.0, 2.5, 40_000.0, 420.0),
    Progress(2, 80.0, 4.0, 40_000.0, 420.0),
    Progress(3, 95.0, 5.1, 22_500.0, 380.0),
)


def curves(axes: Axes) -> dict[str, list[list[float]]]:
    return {str(line.get_label()): points(line) for line in axes.lines}


def test_learning_curves_set_the_error_against_what_the_map_expects() -> None:
    error, variance = learning_curves(HISTORY).axes
    drawn = curves(error)
    assert drawn["against the simulated truth (RMSE)"] == [[1, 600], [2, 420], [3, 380]]
    assert drawn["as the map expects it (root mean KV)"][1:] == [[2, 200], [3, 150]]
    assert curves(variance)["mean KV"][1:] == [[2, 40.0], [3, 22.5]]
    assert error.get_ylabel() == "error (kPa)"
    assert variance.get_ylabel() == "mean KV (10³ kPa²)"


def test_learning_curves_tell_no_variance_of_one_sample() -> None:
    _, variance = learning_curves(HISTORY).axes
    assert np.isnan(curves(variance)["mean KV"][0][1])
    assert any("no variance" in text for text in texts(learning_curves(HISTORY[:1]).axes[1]))


def test_learning_curves_give_metres_and_minutes_of_the_last_entry_of_a_sample() -> None:
    axes = learning_curves(HISTORY).axes[0]
    labels = [label.get_text() for label in axes.get_xticklabels()]
    assert labels == ["1\n20\n1", "2\n80\n4", "3\n95\n5"]


def test_learning_curves_without_a_truth_show_the_variance_alone() -> None:
    blind = [replace(now, rmse=float("nan")) for now in HISTORY]
    (variance,) = learning_curves(blind).axes
    assert "mean KV" in curves(variance)


def test_learning_curves_of_nothing_are_an_error_that_says_so() -> None:
    with pytest.raises(ReadingsError, match="nothing to draw"):
        learning_curves(())


def test_variograms_show_bins_pairs_and_the_curve(survey: Survey, fits: Fits) -> None:
    drawn = panels(variograms(fits, survey.soil_map), 8)
    for axes, fit in zip(drawn, fits, strict=True):
        bins, model = fit.empirical, fit.variogram
        dots = np.asarray(axes.collections[0].get_offsets())
        np.testing.assert_allclose(dots, np.column_stack([bins.lag, bins.semivariance / 1000.0]))
        pairs = [text.get_text() for text in axes.texts if text.get_gid() == "pairs"]
        assert pairs == [str(number) for number in bins.pairs]
        lag, gamma = np.array(points(axes.lines[0])).T
        np.testing.assert_allclose(gamma * 1000.0, model.nugget + model.rise(lag))
        assert any(f"range {model.range:.0f} m" in text for text in texts(axes))
        assert any("nugget" in text and "sill" in text for text in texts(axes))


def test_variograms_say_which_are_priors() -> None:
    soil_map = layered([[500, 900, 1200], [600, 950, 1300]], [[0] * 3] * 2)
    fits = LeastSquares(Spherical)(soil_map.at, soil_map.kpa)
    for axes in panels(variograms(fits, soil_map), 3):
        assert "prior, not a fit" in texts(axes)


def test_variograms_show_the_circular_model_where_kriging_had_to_use_it() -> None:
    linear = BoundedLinear(0.0, 15.0, 100.0)
    rng = np.random.default_rng(0)
    cells = FIELD.cells[rng.choice(len(FIELD.cells), 40, replace=False)]
    samples = tuple(
        Sample(tuple(at), np.array([500.0 + rng.normal()]), np.zeros(1, np.int8))
        for at in cells.tolist()
    )
    soil_map = SoilMap(FIELD, Layers((0.0, 0.2)), (linear,), samples)
    fitted = LeastSquares(BoundedLinear)(soil_map.at, soil_map.kpa)
    figure = variograms([replace(fitted[0], variogram=linear)], soil_map)
    (axes,) = figure.axes
    assert any("kriged as circular" in text for text in texts(axes))
    dashed = curves(axes)["kriged"]
    circular = linear.circular()
    lag = np.array(dashed)[:, 0]
    np.testing.assert_allclose(np.array(dashed)[:, 1] * 1000.0, circular.rise(lag))


def test_pairs_of_close_bins_are_written_apart(assert_legible: Legible) -> None:
    rng = np.random.default_rng(0)
    samples = tuple(
        Sample(tuple(at), rng.uniform(300, 2000, 8), np.zeros(8, np.int8))
        for at in rng.choice(FIELD.cells, 60, replace=False)
    )
    models = (Spherical(100.0, 30.0, 5000.0),) * 8
    soil_map = SoilMap(FIELD, Layers(), models, samples)
    assert_legible(variograms(LeastSquares(Spherical)(soil_map.at, soil_map.kpa), soil_map))


def test_variograms_want_one_fit_a_layer(survey: Survey, fits: Fits) -> None:
    with pytest.raises(ParameterError, match="7 fits for 8 layers"):
        variograms(fits[:7], survey.soil_map)


def test_profiles_go_down_with_one_line_a_sample_and_the_mean() -> None:
    soil_map = layered([[500, 900, 1200], [700, 1100, 1400]], [[0] * 3] * 2)
    (axes,) = profiles(soil_map).axes
    bottom, top = axes.get_ylim()
    assert bottom > top
    expected = np.array([[600.0, 0.05], [1000.0, 0.15], [1300.0, 0.25]])
    np.testing.assert_allclose(named(axes, "mean"), expected)
    for sample in soil_map.samples:
        assert any([x for x, _ in points(line)] == sample.kpa.tolist() for line in axes.lines)
    assert {x for x, _ in named(axes, "2 MPa")} == {2000.0}


def test_profiles_have_one_arrow_for_every_lower_bound_and_leave_it_out_of_the_mean() -> None:
    nan = np.nan
    soil_map = layered(
        [[500, 1800, nan], [700, 1100, 1900], [600, 1000, 1300]],
        [[0, AT_LEAST, UNREACHED], [0, 0, AT_LEAST], [0, 0, 0]],
    )
    (axes,) = profiles(soil_map).axes
    arrows = np.array(named(axes, "at least (force limit)"))
    np.testing.assert_allclose(arrows, np.array([[1800.0, 0.15], [1900.0, 0.25]]))
    mean = np.array(named(axes, "mean"))[:, 0]
    np.testing.assert_allclose(mean, np.array([600.0, 1050.0, 1300.0]))
    assert {"3 of 3", "2 of 3", "1 of 3"} <= set(texts(axes))


def test_profiles_variograms_and_learning_curves_are_legible(
    survey: Survey, history: History, fits: Fits, assert_legible: Legible
) -> None:
    soil_map = survey.soil_map
    assert_legible(profiles(soil_map, caption="a caption"))
    assert_legible(variograms(fits, soil_map, caption="a caption"))
    assert_legible(learning_curves(history, caption="a caption"))


def test_figures_of_readings_are_png_files(survey: Survey, fits: Fits, tmp_path: Path) -> None:
    paths = save_all(draw_readings(survey.soil_map, fits), tmp_path, "png")
    assert [path.name for path in paths] == [
        "depth_slices.png",
        "std_dev.png",
        "variograms.png",
        "profiles.png",
    ]
    for path in paths:
        assert path.read_bytes().startswith(b"\x89PNG")
        assert 10_000 < path.stat().st_size < 600_000


def test_figures_of_a_survey_have_learning_curves_only_with_a_history(
    survey: Survey, history: History, fits: Fits
) -> None:
    assert list(draw_survey(survey, (), fits)) == [
        "depth_slices",
        "std_dev",
        "variograms",
        "profiles",
    ]
    assert draw_survey(survey, history, fits).keys() >= {"learning_curves"}


def test_a_refused_stop_of_a_survey_is_drawn(survey: Survey, fits: Fits) -> None:
    free = next(k for k in range(96) if k not in survey.visited)
    place = (float(FIELD.cells[free][0]), float(FIELD.cells[free][1]))
    refusal = Refused(agent="robot", at=place, reason="stone", metres=5, seconds=50, tries=3)
    figure = draw_survey(apply(survey, refusal), (), fits)["depth_slices"]
    assert named(figure.axes[0], "refused") == [FIELD.cells[free].tolist()]


def test_pictures_are_drawn_without_pyplot(
    survey: Survey, history: History, fits: Fits, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", None)
    figures = draw_survey(survey, history, fits)
    assert rendered(figures["profiles"])
    assert rendered(figures["learning_curves"])


def test_without_matplotlib_there_is_a_remedy(
    survey: Survey, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(MissingExtraError, match=r"matplotlib.*subsoil\[plot\]"):
        profiles(survey.soil_map)


def test_a_name_with_signs_that_cannot_be_seen_is_drawn_without_them() -> None:
    figure = blank((6.0, 4.0), "a\x1b[31m\u202eb\udcff", "c\x07")
    assert [text.get_text() for text in figure.texts] == ["a?[31m?b?", "c?"]
    figure.savefig(BytesIO())
