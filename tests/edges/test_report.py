"""The report is one page that says what the survey is worth, wherever it is opened."""

from __future__ import annotations

import base64
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from subsoil.errors import MissingExtraError, ReadingsError
from subsoil.layers import LayerState, Sample
from subsoil.mapping.soilmap import SoilMap
from subsoil.report import Progress, render, write_report
from subsoil.reports import Refused
from subsoil.strategies import Plan
from subsoil.survey import Stop, Survey, apply, opened
from subsoil.survey.events import Configured, Opened
from subsoil.survey.outlook import SURE, outlook
from subsoil.variogram import BoundedLinear, Fit

History = tuple[Progress, ...]
Fits = tuple[Fit, ...]

PICTURES = ("depth_slices", "std_dev", "learning_curves", "variograms", "profiles")
ALLOWED_TAGS = {
    "html", "head", "meta", "title", "style", "body", "h1", "h2", "p", "table", "thead", "tbody",
    "tr", "th", "td", "ul", "li", "figure", "img", "figcaption", "code", "div", "span",
}  # fmt: skip


@dataclass
class Page(HTMLParser):
    """What is on a page: tags, attributes and text."""

    tags: set[str] = field(default_factory=set)
    links: list[str] = field(default_factory=list)
    alts: list[str] = field(default_factory=list)
    open: list[str] = field(default_factory=list)
    text: str = ""

    def __post_init__(self) -> None:
        super().__init__()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        self.links += [v or "" for k, v in attrs if k in ("src", "href", "srcset", "action")]
        self.alts += [v or "" for k, v in attrs if k == "alt"]
        if tag not in ("meta", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data


def parsed(html: str) -> Page:
    found = Page()
    found.feed(html)
    found.close()
    assert not found.open
    found.text = " ".join(found.text.split())
    return found


def words_of(survey: Survey, history: Sequence[Progress], fits: Sequence[Fit]) -> str:
    """Text of the page without its pictures."""
    return parsed(render(survey, history, fits, ())).text


def test_a_report_holds_its_pictures_and_they_lie_beside_it(
    survey: Survey, history: History, fits: Fits, tmp_path: Path
) -> None:
    path = write_report(survey, history, fits, tmp_path)
    assert path == tmp_path / "report.html"
    found = parsed(path.read_text(encoding="utf-8"))
    held = [base64.b64decode(link.removeprefix("data:image/png;base64,")) for link in found.links]
    assert held == [(tmp_path / f"{name}.png").read_bytes() for name in PICTURES]
    assert all(found.alts)


def test_a_report_needs_nothing_from_elsewhere(survey: Survey, fits: Fits, tmp_path: Path) -> None:
    path = write_report(survey, (), fits, tmp_path)
    text = path.read_text(encoding="utf-8")
    found = parsed(text)
    assert found.tags <= ALLOWED_TAGS
    assert all(link.startswith("data:image/png;base64,") for link in found.links)
    assert not any(word in text for word in ("http://", "https://", "url(", "@import", "<script"))


def test_a_report_gives_the_numbers_of_the_survey(
    survey: Survey, history: History, fits: Fits
) -> None:
    text = words_of(survey, history, fits)
    kv = survey.soil_map.field_kv
    for words in (
        "0.24 ha, 96 cells of 5 m",
        "none: a local frame",
        f"Way driven{survey.metres:.0f} m",
        f"Time{survey.minutes:.0f} min",
        f"{kv:,.0f} kPa², a standard deviation of {np.sqrt(kv):.0f} kPa",
        f"RMSE{history[-1].rmse:.0f} kPa against the simulated truth after 8 samples",
        "Strategyadaptive-monte-carlo",
        "Estimatorpaper-10, fitted anew every sample",
        "Seed3",
        "130 mm², 30°",
        "State8 samples taken",
    ):
        assert words in text


@pytest.mark.parametrize(("error", "side"), [(10.0, "below"), (1e4, "above")])
def test_a_report_says_whether_the_error_is_what_the_map_promised(
    survey: Survey, history: History, fits: Fits, error: float, side: str
) -> None:
    known = (*history[:-1], replace(history[-1], rmse=error))
    promised = outlook(survey).error.rmse(SURE)
    text = words_of(survey, known, fits)
    assert "OutlookBy its own variograms, 8 samples in" in text
    assert (
        f"The error against the simulated truth is {error:.0f} kPa: {side} the {promised:.0f} kPa "
        "that it was 80 % sure to stay below."
    ) in text


def test_a_report_without_a_truth_of_its_last_sample_judges_no_promise(
    survey: Survey, history: History, fits: Fits
) -> None:
    assert "sure to stay below" not in words_of(survey, history[:-1], fits)
    assert "sure to stay below" not in words_of(survey, (), fits)


def test_a_report_has_a_row_for_every_layer_with_the_reason_of_its_variogram(
    survey: Survey, history: History, fits: Fits
) -> None:
    text = words_of(survey, history, fits)
    soil_map = survey.soil_map
    for k, (name, fit) in enumerate(zip(soil_map.layers.names, fits, strict=True)):
        row = text.split(f"{name} ", 1)[1]
        mean, spread = soil_map.mean[k].mean(), soil_map.mean[k].std()
        deviation = np.sqrt(soil_map.variance[k]).mean()
        measured = np.isfinite(soil_map.kpa[k]).sum()
        assert row.startswith(f"{measured} {mean:,.0f} {spread:,.0f} {deviation:,.0f} linear")
        assert fit.why in text


def test_a_hostile_name_stays_text(survey: Survey, history: History, fits: Fits) -> None:
    name = "<script>alert('$x_{')</script> & \"Söhne\""
    changed = replace(survey, name=name, field=replace(survey.field, name=name))
    found = parsed(render(changed, history, fits, ()))
    assert "script" not in found.tags
    assert found.text.count(name) >= 2


def test_what_cannot_be_seen_in_a_name_is_not_in_the_page(
    survey: Survey, history: History, fits: Fits
) -> None:
    name = "a\x1b[31m\u202eb\udcff"
    changed = replace(survey, name=name, field=replace(survey.field, name=name))
    html = render(changed, history, fits, ())
    assert html.count("a?[31m?b?") >= 2
    assert not {"\x1b", "\u202e", "\udcff"} & set(html)


def test_a_title_is_used_as_given(survey: Survey, history: History, fits: Fits) -> None:
    html = render(survey, history, fits, (), title="Spring <2024>")
    assert parsed(html).text.startswith("Spring <2024>")


def test_without_a_truth_there_is_no_error_to_report(
    survey: Survey, history: History, fits: Fits
) -> None:
    blind = [replace(now, rmse=float("nan")) for now in history]
    text = words_of(survey, blind, fits)
    assert "RMSE" not in text
    assert "simulated truth" not in text


def stony_stop(survey: Survey) -> Stop:
    """A stop that gave no reading."""
    free = next(k for k in range(96) if k not in survey.visited)
    stone = Refused(agent="robot", at=(1, 1), reason="stone", metres=5, seconds=50, tries=3)
    return Stop("stony", "robot", free, refusal=stone)


def test_a_report_warns_of_bounds_priors_and_refusals(
    survey: Survey, history: History, fits: Fits
) -> None:
    soil_map = survey.soil_map
    last = soil_map.samples[-1]
    state = last.state.copy()
    state[-1] = LayerState.AT_LEAST
    samples = (*soil_map.samples[:-1], replace(last, state=state))
    changed = replace(
        survey,
        soil_map=SoilMap(soil_map.field, soil_map.layers, soil_map.variograms, samples),
        stops=(*survey.stops, stony_stop(survey)),
    )
    own = (replace(fits[0], is_prior=True), *fits[1:])
    text = words_of(changed, history, own)
    assert "force limit ended 1 push inside a layer" in text
    assert "In 1 of 8 layers there is too little to fit a variogram to" in text
    assert "(prior, not a fit)" in text
    assert "1 stop gave no reading" in text


def test_a_report_passes_on_the_notes_of_the_map(
    survey: Survey, history: History, fits: Fits
) -> None:
    cells = np.random.default_rng(0).choice(survey.field.cells, 40, replace=False)
    samples = tuple(Sample(tuple(at), np.full(8, 700.0), np.zeros(8, np.int8)) for at in cells)
    linear = BoundedLinear(0.0, 15.0, 100.0)
    soil_map = SoilMap(survey.field, survey.layers, (linear,) * 8, samples)
    (note,) = soil_map.notes
    text = words_of(replace(survey, soil_map=soil_map), history, fits)
    assert note in text
    assert text.count("kriged as circular") == 8


def test_a_survey_under_way_says_how_to_go_on(survey: Survey, history: History, fits: Fits) -> None:
    changed = replace(survey, finished="", plan=Plan((1, 2), "as planned"))
    text = words_of(changed, history, fits)
    assert "under way, 2 stops planned" in text
    assert "subsoil resume" in text


def test_a_survey_that_was_never_configured_can_be_reported(survey: Survey, fits: Fits) -> None:
    text = words_of(replace(survey, method=""), (), fits)
    assert "Strategy" not in text


def test_a_survey_without_a_sample_is_refused(
    survey: Survey, fits: Fits, plot_opened: Opened, tmp_path: Path
) -> None:
    begun = apply(opened(plot_opened), Configured(settings=survey.settings))
    with pytest.raises(ReadingsError, match="no sample"):
        write_report(begun, (), fits, tmp_path)
    assert not (tmp_path / "report.html").exists()


def test_without_jinja_there_is_a_remedy(
    survey: Survey,
    history: History,
    fits: Fits,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "jinja2", None)
    with pytest.raises(MissingExtraError, match=r"jinja2.*subsoil\[plot\]"):
        render(survey, history, fits, ())
