"""Words of a report and lines of a picture hold the numbers of the survey, in their units."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from math import hypot, nan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from subsoil.errors import ParameterError
from subsoil.land.field import Field
from subsoil.layers import Layers, LayerState, Sample
from subsoil.mapping.soilmap import SoilMap
from subsoil.mapping.uncertainty import MeanSquare
from subsoil.plots import layer_panel, route_panel, variogram_panel
from subsoil.plots.land import draw_samples, extent, frame, round_length
from subsoil.plots.semivariance import parameters, remark
from subsoil.plots.sheet import Sheet, least_length, letters, too_small
from subsoil.plots.subject import subject
from subsoil.report import Progress
from subsoil.report.wording import headline, in_units, notes, promise_kept, rows
from subsoil.stopping import Rates
from subsoil.survey import LocalDispatch, Memory, Survey, opened, opening
from subsoil.survey.events import Configured, Simulation
from subsoil.survey.outlook import Outlook, Prospect, outlook
from subsoil.units import METRIC, US
from subsoil.variogram import Exponential, Fit, Nested, Spherical, Structure

History = tuple[Progress, ...]
Fits = tuple[Fit, ...]
PSI = 0.1450377

SEEN = Outlook(
    8, 100.0, MeanSquare(10_000.0, 60.0, 40.0),
    tuple(Prospect(k, 2.0 * k, 0.0, 100.0 - k) for k in range(1, 21)), 4,
)  # fmt: skip


def changed(survey: Survey, **settings: object) -> Survey:
    return replace(survey, settings=survey.settings.model_copy(update=settings))


def test_a_headline_gives_cost_and_schedule_only_where_there_is_one(survey: Survey) -> None:
    plain = dict(headline(survey, ()))
    assert "Cost" not in plain
    assert plain["Estimator"] == "paper-10, fitted anew every sample"
    charged = changed(
        survey, rates=Rates(call_out=12_345.0, currency="CHF"), refit_every=4, estimator="pmc"
    )
    said = dict(headline(charged, ()))
    assert said["Cost"] == "12,345 CHF"
    assert said["Estimator"] == "pmc, fitted anew every 4 samples"


def test_a_headline_says_who_took_the_readings_or_in_which_soil(survey: Survey) -> None:
    assert dict(headline(survey, ()))["Readings"] == "simulated; soil: simulated, seed 3"
    soils = (*survey.simulation, Simulation(world="riseholme", seed=9), *survey.simulation)
    several = replace(survey, simulation=soils)
    assert dict(headline(several, ()))["Readings"] == (
        "simulated; soil: simulated, seed 3; riseholme, seed 9"
    )
    by_hand = LocalDispatch(opened(opening(survey.field, survey.layers, survey.cone)), Memory())
    assert dict(headline(by_hand.survey, ()))["Readings"] == "none"
    for name, kind in (("anna", "person"), ("rob", "robot")):
        by_hand.join(name, kind)  # type: ignore[arg-type]
    said = dict(headline(by_hand.survey, ()))
    assert said["Readings"] == "anna (person), rob (robot)"
    assert said["State"] == "under way, 0 stops planned"
    assert said["Mean kriging variance"] == "unknown: one sample tells no variance"
    assert not {"Outlook", "Strategy", "Seed", "RMSE"} & set(said)


def test_a_table_of_layers_in_other_units_is_the_metric_one_converted(
    survey: Survey, fits: Fits
) -> None:
    def whole(text: str) -> float:
        return float(text.replace(",", ""))

    metric, us = rows(survey, fits), rows(survey, fits, US)
    soil_map = survey.soil_map
    for k, (one, other) in enumerate(zip(metric, us, strict=True)):
        edges = [edge / 0.0254 for edge in survey.layers.edges_m[k : k + 2]]
        assert other.name == f"{edges[0]:.1f}-{edges[1]:.1f} in"
        assert one.numbers[0] == other.numbers[0] == "8"
        assert whole(other.numbers[1]) == pytest.approx(PSI * soil_map.mean[k].mean(), abs=0.51)
        assert whole(other.numbers[2]) == pytest.approx(PSI * soil_map.mean[k].std(), abs=0.51)
        model = fits[k].variogram
        assert whole(other.parameters[0]) == pytest.approx(PSI**2 * model.nugget, abs=0.51)
        assert whole(other.parameters[1]) == pytest.approx(PSI**2 * model.sill, abs=0.51)
        assert whole(other.parameters[2]) == pytest.approx(model.range / 0.3048, abs=0.51)
        assert whole(one.parameters[2]) == pytest.approx(model.range, abs=0.51)


def test_a_layer_that_nothing_reached_has_dashes_in_the_table(survey: Survey, fits: Fits) -> None:
    soil_map = survey.soil_map
    shallow = tuple(
        replace(
            sample,
            kpa=np.where(np.arange(8) < 7, sample.kpa, nan),
            state=np.array([0] * 7 + [LayerState.UNREACHED], np.int8),
        )
        for sample in soil_map.samples
    )
    cut = replace(survey, soil_map=replace(soil_map, samples=shallow))
    assert rows(cut, fits)[-1].numbers == ("0", "–", "–", "–")
    said = list(notes(cut, (), fits))
    assert any(line.startswith("8 pushes did not reach the deepest layer") for line in said)


def test_notes_of_one_sample_say_that_its_variance_is_assumed(survey: Survey, fits: Fits) -> None:
    one = replace(survey, soil_map=replace(survey.soil_map, samples=survey.soil_map.samples[:1]))
    said = " ".join(notes(one, (), fits))
    assert "One sample tells no variance: standard deviations follow from an assumed sill." in said
    assert "One sample" not in " ".join(notes(survey, (), fits))


def test_an_outlook_in_other_units_is_the_same_sentence_with_its_errors_converted(
    survey: Survey,
) -> None:
    metric = in_units(survey, SEEN, replace(US, pressure=replace(US.pressure, factor=1.0)))
    us = in_units(survey, SEEN, US)
    assert "kPa" not in us
    numbers = re.compile(
        r"error (\d+) \w+ \(80 % sure: below (\d+)\).*about (\d+) .* about (\d+)\."
    )
    before, after = numbers.search(metric), numbers.search(us)
    assert before is not None
    assert after is not None
    for one, other in zip(before.groups(), after.groups(), strict=True):
        assert float(other) == pytest.approx(PSI * float(one), abs=0.5 + 0.5 * PSI)
    strip = re.compile(r"\d+ (kPa|psi)|below \d+|about \d+")
    assert strip.sub("", metric).replace("psi", "") == strip.sub("", us).replace("psi", "")


@pytest.mark.parametrize(("rmse", "side"), [(115.0, "above"), (100.0, "below")])
def test_a_promise_is_judged_in_the_units_asked_for(rmse: float, side: str) -> None:
    promised = SEEN.error.rmse(0.8)
    assert 100.0 < promised < 115.0
    assert promise_kept(SEEN, rmse, US) == (
        f"The error against the simulated truth is {PSI * rmse:.1f} psi: {side} the "
        f"{PSI * promised:.1f} psi that it was 80 % sure to stay below."
    )
    unknown = replace(SEEN, error=MeanSquare(nan, nan, nan))
    assert promise_kept(unknown, rmse) == ""


# What is drawn


def test_a_panel_of_a_layer_shows_its_means_on_the_colours_of_all(survey: Survey) -> None:
    soil_map = survey.soil_map
    for layer in (0, 7):
        ax = layer_panel(soil_map, layer, ax=Figure().subplots())
        image = ax.images[0]
        np.testing.assert_array_equal(np.asarray(image.get_array()).ravel(), soil_map.mean[layer])
        assert image.get_clim() == (soil_map.mean.min(), soil_map.mean.max())
        places = np.asarray(ax.collections[0].get_offsets())
        np.testing.assert_array_equal(places, soil_map.at)
    for layer in (-1, 8):
        with pytest.raises(ParameterError) as caught:
            layer_panel(soil_map, layer, ax=Figure().subplots())
        assert str(caught.value) == (f"layer_panel: there is no layer {layer} (remedy: 0 to 7)")


def test_a_route_has_handed_out_stops_before_planned_ones_and_is_as_long_as_driven(
    plot_opened: object, configured: Callable[..., Configured]
) -> None:
    dispatch = LocalDispatch(opened(plot_opened), Memory())  # type: ignore[arg-type]
    dispatch.record(configured("area-split", samples=4))
    dispatch.join("rob")
    dispatch.assign("rob")
    survey = dispatch.survey
    ax = route_panel(survey, ax=Figure().subplots())
    lines = {str(line.get_label()): np.asarray(line.get_xydata()) for line in ax.lines}
    cells = [survey.leases[0].cell, *survey.plan.cells]
    assert len(cells) == 4
    np.testing.assert_array_equal(lines["planned"], survey.field.cells[cells])
    (on,) = [line for line in ax.lines if line.get_linestyle() == "--"]
    way = np.asarray(on.get_xydata())
    np.testing.assert_array_equal(way[0], survey.position)
    legs = np.hypot(*np.diff(np.vstack([survey.position, survey.field.cells[cells]]), axis=0).T)
    assert sum(hypot(*leg) for leg in np.diff(way, axis=0)) == pytest.approx(legs.sum())
    assert "sample" not in lines


def test_a_variogram_panel_draws_bins_as_large_as_their_pairs_are_many(fits: Fits) -> None:
    fit = fits[4]
    ax = variogram_panel(fit, ax=Figure().subplots())
    bins, dots = fit.empirical, ax.collections[0]
    np.testing.assert_allclose(
        np.asarray(dots.get_offsets()), np.column_stack([bins.lag, bins.semivariance / 1000.0])
    )
    sizes = np.asarray(dots.get_sizes())  # type: ignore[attr-defined]
    np.testing.assert_allclose(sizes, 8.0 + 50.0 * bins.pairs / bins.pairs.max())
    lag, gamma = np.asarray(ax.lines[0].get_xydata()).T
    model = fit.variogram
    np.testing.assert_allclose(1000.0 * gamma, model.nugget + model.rise(lag))
    assert lag[-1] == pytest.approx(1.08 * bins.lag[-1])
    assert ax.get_ylim()[0] == 0.0


def test_a_variogram_is_told_in_thousands_and_a_remark_says_what_it_is_not(fits: Fits) -> None:
    model = Spherical(1234.0, 41.6, 8766.0)
    assert parameters(model) == "nugget 1.23, sill 10, range 42 m"
    nested = Nested(9000.0, (Structure(0.75, Exponential, 30.0),))
    assert parameters(nested).startswith("nugget 2.25, sill 9, range ")
    fit = replace(fits[0], variogram=model, is_prior=False, at_bound=("nugget", "range"))
    assert remark(fit, model) == "nugget and range at bound"
    assert remark(replace(fit, is_prior=True), model) == "prior, not a fit"
    other = Exponential(1.0, 2.0, 3.0)
    assert remark(replace(fit, at_bound=()), other) == "kriged as exponential"
    assert remark(replace(fit, at_bound=()), model) == ""


def test_a_map_has_room_around_its_field_and_cells_to_their_edges() -> None:
    field = Field.from_metres([(10, 20), (70, 20), (70, 60), (10, 60)])
    assert frame(field) == (10 - 4.9, 20 - 4.9, 70 + 4.9, 60 + 4.9)
    assert extent(field) == (10.0, 70.0, 20.0, 60.0)


@given(st.floats(1e-6, 1e6))
def test_a_scale_bar_is_a_round_length_of_more_than_two_fifths_of_its_room(metres: float) -> None:
    length = round_length(metres)
    assert 0.4 * metres < length <= metres * (1 + 1e-9)
    digits = f"{length:.0e}"
    assert digits[0] in "125"


@pytest.mark.parametrize(("number", "size"), [(60, 15.0), (61, 6.0)])
def test_many_samples_are_smaller_marks_of_one_colour_a_state(number: int, size: float) -> None:
    at = np.arange(2.0 * number).reshape(-1, 2)
    states = np.full(number, LayerState.MEASURED, np.int8)
    states[0], states[1] = LayerState.AT_LEAST, LayerState.UNREACHED
    ax = Figure().subplots()
    draw_samples(ax, at, states)
    drawn = {str(marks.get_label()): marks for marks in ax.collections}
    assert {name: len(np.asarray(m.get_offsets())) for name, m in drawn.items()} == {
        "sample": number - 2, "at least (force limit)": 1, "layer not reached": 1,
    }  # fmt: skip
    assert {float(s) for m in drawn.values() for s in m.get_sizes()} == {size}  # type: ignore[attr-defined]
    grey = drawn["layer not reached"].get_facecolor()
    assert to_hex(np.asarray(grey)[0]) == "#8c8c8c"


def test_what_is_drawn_says_how_many_samples_and_of_what(survey: Survey) -> None:
    one = SoilMap(
        survey.field, Layers((0.0, 0.4)), (Spherical(1.0, 9.0, 9.0),),
        (Sample((2.5, 2.5), np.array([900.0]), np.zeros(1, np.int8)),),
    )  # fmt: skip
    assert subject(one).cost == "1 sample"
    assert subject(one).on_land == "1 sample; local frame, cells of 5 m"
    assert subject(survey).cost.endswith(" min, simulated")


@settings(max_examples=30, deadline=None)
@given(st.floats(0.5, 9.0), st.floats(0.5, 9.0), st.integers(1, 4))
def test_panels_of_a_sheet_lie_within_it_and_apart_or_it_says_what_it_needs(
    wide: float, high: float, number: int
) -> None:
    layout = Sheet(number, 1, 2.0, 1.5, 0.3, 0.2, 0.4, 0.2, 0.5, 0.4)
    try:
        fitted = layout.within((wide, high), (0.8, 0.6))
    except ParameterError as error:
        needed = re.search(r"needs ([\d.]+) by ([\d.]+) inches", str(error))
        assert needed is not None
        assert float(needed[1]) > wide - 0.1 or float(needed[2]) > high - 0.1
        enough = (float(needed[1]), float(needed[2]))
        assert layout.within(enough, (0.8, 0.6)).size == enough
        return
    assert fitted.size == (wide, high)
    assert fitted.width / fitted.height == pytest.approx(2.0 / 1.5)
    assert fitted.width >= 0.8 - 1e-9
    boxes = []
    figure = Figure(figsize=(wide, high))
    for k in range(number):
        box = fitted.panel(figure, k).get_position()
        assert min(box.x0, box.y0) >= -1e-9
        assert max(box.x1, box.y1) <= 1 + 1e-9
        boxes.append((round(box.x0 * wide, 6), round(box.y0 * high, 6)))
    assert len(set(boxes)) == number


def test_letters_shrink_to_their_room_and_no_further_than_can_be_read() -> None:
    assert letters(["a" * 100], 8.0, 2.0) == pytest.approx(72 * 2.0 / (0.58 * 100))
    assert letters([], 8.0, 2.0) == letters([""], 8.0, 0.0) == 8.0
    assert least_length(["ab", "abcd"]) == pytest.approx(4 * 0.58 * 5.0 / 72)
    error = too_small((2.0, 2.0), [(9.0, 2.0), (2.41, 2.2)])
    assert str(error) == (
        "figure: the picture needs 2.5 by 2.2 inches, and has 2.0 by 2.0 "
        "(remedy: draw into a larger figure, or fewer pictures side by side)"
    )


def test_the_outlook_of_a_headline_is_that_of_the_survey(survey: Survey) -> None:
    said = dict(headline(survey, ()))["Outlook"]
    assert said == f"By its own variograms, {in_units(survey, outlook(survey), METRIC)}"
