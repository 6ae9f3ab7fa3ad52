"""Pictures are drawn into figures and axes of one's own, within them, and change nothing else."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

import subsoil as ss
from subsoil.errors import ParameterError, ReadingsError
from subsoil.layers import Layers, Sample
from subsoil.mapping.soilmap import SoilMap
from subsoil.report import Progress
from subsoil.survey import Survey, opened
from subsoil.survey.events import Opened
from subsoil.survey.outlook import outlook
from subsoil.variogram import Fit, LeastSquares, Spherical

Legible = Callable[[Figure | SubFigure], None]
Draw = Callable[[Figure | SubFigure | None], Figure | SubFigure]
Panel = Callable[[Axes], Axes]

PICTURES = (
    "depth slices", "depth slices with the way", "std dev", "variograms", "profiles",
    "learning curves", "outlook curve", "route",
)  # fmt: skip
PANELS = ("layer", "variogram", "profiles", "outlook", "route")
SIZES = [(6.0, 6.0), (6.0, 9.0), (8.0, 5.0), (12.0, 5.0), (4.2, 7.0)]


@pytest.fixture(scope="module")
def pictures(
    survey: Survey, history: tuple[Progress, ...], fits: tuple[Fit, ...]
) -> dict[str, Draw]:
    """Each picture by name, drawn into a figure or a new one."""
    soil, ahead = survey.soil_map, outlook(survey)
    draw: tuple[Draw, ...] = (
        lambda figure: ss.plots.depth_slices(soil, figure=figure),
        lambda figure: ss.plots.depth_slices(survey, figure=figure),
        lambda figure: ss.plots.std_dev(soil, figure=figure),
        lambda figure: ss.plots.variograms(fits, soil, figure=figure),
        lambda figure: ss.plots.profiles(soil, figure=figure),
        lambda figure: ss.plots.learning_curves(history, figure=figure),
        lambda figure: ss.plots.outlook_curve(history, ahead, figure=figure),
        lambda figure: ss.plots.route(survey, figure=figure),
    )
    return dict(zip(PICTURES, draw, strict=True))


@pytest.fixture(scope="module")
def single(
    survey: Survey, history: tuple[Progress, ...], fits: tuple[Fit, ...]
) -> dict[str, Panel]:
    """Each picture of one panel by name, drawn into axes."""
    draw: tuple[Panel, ...] = (
        lambda ax: ss.plots.layer_panel(survey.soil_map, 2, ax=ax),
        lambda ax: ss.plots.variogram_panel(fits[0], ax=ax),
        lambda ax: ss.plots.profiles_panel(survey.soil_map, ax=ax),
        lambda ax: ss.plots.outlook_panel(history, outlook(survey), ax=ax),
        lambda ax: ss.plots.route_panel(survey, ax=ax),
    )
    return dict(zip(PANELS, draw, strict=True))


def halves(width: float, height: float) -> tuple[SubFigure, SubFigure]:
    left, right = np.ravel(np.asarray(Figure(figsize=(width, height)).subfigures(1, 2)))
    return left, right


def pixels(figure: Figure) -> np.ndarray:
    target = BytesIO()
    figure.savefig(target, dpi=50, format="rgba")
    width, height = (round(50 * inches) for inches in figure.get_size_inches())
    return np.frombuffer(target.getvalue(), dtype=np.uint8).reshape(height, width, 4)


def inked(image: np.ndarray) -> float:
    """Share of the pixels that are not white."""
    return float((image[..., :3] < 250).any(axis=-1).mean())


def content(figure: Figure | SubFigure) -> str:
    """Names, lines, cells and marks of a figure, wherever they are drawn."""
    panels = [
        (
            axes.get_title(loc="left"),
            [np.asarray(line.get_xydata()).tolist() for line in axes.lines if not line.get_gid()],
            [np.asarray(image.get_array()).tolist() for image in axes.images],
            [np.asarray(marks.get_offsets()).tolist() for marks in axes.collections],
        )
        for axes in figure.axes
    ]
    names = {text.get_text() for legend in figure.legends for text in legend.get_texts()}
    return repr((panels, sorted(names)))


@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_is_drawn_into_the_part_of_a_figure_and_stays_there(
    pictures: dict[str, Draw], assert_legible: Legible, name: str
) -> None:
    whole = Figure(figsize=(12, 6))
    left, right = np.ravel(np.asarray(whole.subfigures(1, 2)))
    assert pictures[name](right) is right
    assert not left.axes
    assert not left.texts
    assert_legible(right)
    image = pixels(whole)
    assert inked(image[:, : image.shape[1] // 2]) == 0.0
    assert inked(image[:, image.shape[1] // 2 :]) > 0.03


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_fits_a_figure_of_any_size_or_says_how_large_it_has_to_be(
    pictures: dict[str, Draw], assert_legible: Legible, name: str, size: tuple[float, float]
) -> None:
    figure = Figure(figsize=size)
    try:
        assert pictures[name](figure) is figure
    except ParameterError as error:
        assert not figure.axes
        assert not figure.texts
        figure = Figure(figsize=needed(error))
        pictures[name](figure)
    assert_legible(figure)


@pytest.mark.parametrize("name", PICTURES)
def test_a_room_that_is_too_small_is_refused_with_the_inches_that_are_enough(
    pictures: dict[str, Draw], assert_legible: Legible, name: str
) -> None:
    with pytest.raises(ParameterError, match=r"has 1\.0 by 1\.0") as refused:
        pictures[name](Figure(figsize=(1, 1)))
    assert_legible(pictures[name](Figure(figsize=needed(refused.value))))


def needed(error: ParameterError) -> tuple[float, float]:
    found = re.search(r"needs ([\d.]+) by ([\d.]+) inches", str(error))
    assert found
    return float(found[1]), float(found[2])


@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_shows_the_same_with_a_figure_and_without(
    pictures: dict[str, Draw], name: str
) -> None:
    given = Figure(figsize=(12, 12))
    assert content(pictures[name](given)) == content(pictures[name](None))


@pytest.mark.parametrize("layers", [1, 3, 12])
@pytest.mark.parametrize("side", [20.0, 400.0])
def test_maps_of_few_and_many_layers_and_of_small_fields_fit_half_a_page(
    assert_legible: Legible, layers: int, side: float
) -> None:
    field = ss.Field.from_metres([(0, 0), (side, 0), (side, side), (0, side)], name="square")
    rng = np.random.default_rng(1)
    samples = tuple(
        Sample(tuple(at), rng.uniform(300, 2000, layers), np.zeros(layers, np.int8))
        for at in field.cells[:: max(1, len(field.cells) // 9)].tolist()
    )
    bands = Layers(tuple(0.05 * k for k in range(layers + 1)))
    soil = SoilMap(field, bands, (Spherical(100.0, 50.0, 5000.0),) * layers, samples)
    fits = LeastSquares(Spherical)(soil.at, soil.kpa)
    left, right = halves(13, 7.5)
    assert_legible(ss.plots.depth_slices(soil, figure=left))
    assert_legible(ss.plots.variograms(fits, soil, figure=right))
    assert_legible(ss.plots.std_dev(soil))
    with pytest.raises(ParameterError) as refused:
        ss.plots.depth_slices(soil, figure=Figure(figsize=(1, 1)))
    assert_legible(ss.plots.depth_slices(soil, figure=Figure(figsize=needed(refused.value))))


def test_pictures_side_by_side_do_not_share_their_colours(survey: Survey) -> None:
    left, right = halves(12, 6)
    means = ss.plots.depth_slices(survey.soil_map, figure=left)
    spreads = ss.plots.std_dev(survey.soil_map, figure=right)
    assert means.axes[0].images[0].get_cmap().name == "viridis"
    assert spreads.axes[0].images[0].get_cmap().name == "magma"
    assert len(left.axes) == len(right.axes) == 10


@pytest.mark.parametrize("name", PANELS)
def test_a_panel_is_drawn_into_its_axes_and_changes_no_other(
    single: dict[str, Panel], name: str
) -> None:
    before = Figure(figsize=(8, 4))
    before.subplots(1, 2, gridspec_kw={"wspace": 0.8})
    figure = Figure(figsize=(8, 4))
    other, mine = figure.subplots(1, 2, gridspec_kw={"wspace": 0.8})
    assert single[name](mine) is mine
    assert figure.axes == [other, mine]
    assert not figure.texts
    assert not figure.legends
    changed = (pixels(figure) != pixels(before)).any(axis=-1)
    end = round(float(other.get_tightbbox().x1) / figure.dpi * 50)
    assert not changed[:, :end].any()
    assert changed[:, end:].mean() > 0.02


def test_layers_drawn_one_by_one_share_the_colours_of_all(survey: Survey) -> None:
    axes = Figure().subplots(1, 2)
    for layer, ax in zip((0, 7), axes, strict=True):
        ss.plots.layer_panel(survey.soil_map, layer, ax=ax)
    assert axes[0].images[0].get_clim() == axes[1].images[0].get_clim()
    assert axes[0].get_title(loc="left") == survey.layers.names[0]
    with pytest.raises(ParameterError, match=r"no layer 8.*0 to 7"):
        ss.plots.layer_panel(survey.soil_map, 8, ax=axes[0])


def test_what_cannot_be_drawn_leaves_the_figure_empty(
    plot_opened: Opened, history: tuple[Progress, ...]
) -> None:
    begun, figure = opened(plot_opened), Figure(figsize=(10, 10))
    draw: tuple[Callable[[], object], ...] = (
        lambda: ss.plots.depth_slices(begun, figure=figure),
        lambda: ss.plots.profiles(begun, figure=figure),
        lambda: ss.plots.route(begun, figure=figure),
        lambda: ss.plots.outlook_curve(history, outlook(begun), figure=figure),
    )
    for each in draw:
        with pytest.raises(ReadingsError, match="nothing to"):
            each()
    assert not figure.axes
    assert not figure.texts


def test_a_route_shows_the_way_the_samples_and_the_stops_still_planned(survey: Survey) -> None:
    free = [k for k in range(96) if k not in survey.visited][:2]
    going = replace(survey, plan=ss.Plan(tuple(free), "two more"), finished="")
    ax = ss.plots.route_panel(going, ax=Figure().subplots())
    drawn = {str(line.get_label()): np.asarray(line.get_xydata()) for line in ax.lines}
    np.testing.assert_array_equal(drawn["sample"], survey.soil_map.at)
    np.testing.assert_array_equal(drawn["planned"], survey.field.cells[free])
    assert drawn["way between samples"][0].tolist() == list(survey.settings.start)
    assert ax.get_aspect() == 1.0
    finished = ss.plots.route_panel(survey, ax=Figure().subplots())
    assert "planned" not in {str(line.get_label()) for line in finished.lines}


def test_a_title_is_smaller_in_a_narrow_figure_before_it_is_cut(survey: Survey) -> None:
    def titles(width: float) -> tuple[str, float]:
        figure = ss.plots.route(survey, figure=Figure(figsize=(width, 6.0)))
        return figure.texts[0].get_text(), float(figure.texts[0].get_fontsize())

    wide, narrow, slit = titles(8.0), titles(2.6), titles(2.3)
    assert wide[0] == narrow[0] == "Route of the survey, plot"
    assert wide[1] > narrow[1] > slit[1]


def test_a_figure_with_a_layout_of_its_own_can_be_drawn_into(
    survey: Survey, assert_legible: Legible
) -> None:
    whole = Figure(figsize=(13, 7), layout="constrained")
    left, right = np.ravel(np.asarray(whole.subfigures(1, 2)))
    ss.plots.depth_slices(survey, figure=left)
    ss.plots.profiles(survey, figure=right)
    assert_legible(left)
    assert_legible(right)
