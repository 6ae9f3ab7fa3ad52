"""How good the map is, and what more probing would buy: in numbers, and in a sentence."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from subsoil.mapping.uncertainty import MeanSquare, mean_square_error, predicted_rmse
from subsoil.stopping import FEWEST, SureRmse, TargetRmse, forecast, further
from subsoil.survey import Survey
from subsoil.variogram import ESTIMATORS, LeastSquares
from subsoil.ways.routing import length, reroute

SURE = 0.8
"""Probability with which the error is below what is said of it."""
_FEW, _MANY = 6, 20
"""Further stops to speak of where no other number suggests itself."""
_MOST = 40
"""Most stops ahead that are looked at."""


@dataclass(frozen=True)
class Prospect:
    """Where so many more samples would bring the map.

    Attributes
    ----------
    more
        Further samples.
    minutes
        Further time in min: the way through them, and one push each.
    money
        Further price.
    rmse
        Predicted RMSE then in kPa.
    """

    more: int
    minutes: float
    money: float
    rmse: float


@dataclass(frozen=True)
class Outlook:
    """How good a map is and what more probing would buy.

    Attributes
    ----------
    samples
        Samples taken.
    rmse
        Predicted RMSE now in kPa; NaN before the second sample.
    error
        What is known of the mean square error.
    ahead
        One entry a further sample; none before the second sample.
    planned
        How many of them are planned.
    """

    samples: int
    rmse: float
    error: MeanSquare
    ahead: tuple[Prospect, ...]
    planned: int

    @property
    def milestones(self) -> tuple[Prospect, ...]:
        """One or two entries worth speaking of: the planned stops, and some more."""
        last = len(self.ahead)
        far = min(last, max(_MANY, self.planned))
        near = min(last, self.planned if 0 < self.planned < far else _FEW)
        return tuple(self.ahead[k - 1] for k in sorted({near, far} - {0}))


def outlook(survey: Survey) -> Outlook:
    """How good the map of a survey is, and what more probing would buy.

    The planned stops come first, in their order; then those that tell most, by a short way
    through them. Exact for the variograms as they are, which further samples will change.
    """
    soil_map = survey.soil_map
    rmse, error = predicted_rmse(soil_map), mean_square_error(soil_map)
    samples = survey.taken
    if samples < 2:
        return Outlook(samples, rmse, error, (), 0)
    planned = survey.plan.cells[:_MOST]
    taken = (*survey.visited, *survey.refused)
    new = further(soil_map, taken, planned, _stops_ahead(survey) - len(planned))
    metres = _metres(survey, planned, new)
    predicted = forecast(soil_map, (*planned, *new))
    settings = survey.settings
    ahead = []
    for more, (way, then) in enumerate(zip(metres, predicted.tolist(), strict=True), start=1):
        minutes = settings.pace.minutes(way, more)
        money = settings.rates.more(more, way, minutes)
        ahead.append(Prospect(more, minutes, money, then))
    return Outlook(samples, rmse, error, tuple(ahead), len(planned))


def in_words(survey: Survey, outlook: Outlook) -> str:
    """Say how good the map is, and what more would buy."""
    n = survey.taken
    head = f"{n} {'sample' if n == 1 else 'samples'} in {survey.minutes:.0f} min"
    if n < 2:
        return f"{head}: too few to say how good the map is."
    below = f"{100 * SURE:.0f} % sure: below {outlook.error.rmse(SURE):.0f}"
    words = [f"{head}: typical error {outlook.rmse:.0f} kPa ({below})."]
    words += _more_in_words(survey, outlook.milestones)
    if n < FEWEST:
        words.append(f"Variograms of fewer than {FEWEST} samples say little.")
    return " ".join(words)


def _more_in_words(survey: Survey, entries: Sequence[Prospect]) -> Iterator[str]:
    """Say what more samples would buy, if any are left to take."""
    if not entries:
        return
    costs = [f"{entry.minutes:.0f} min" for entry in entries]
    if not survey.settings.rates.free:
        currency = survey.settings.rates.currency
        costs = [
            f"{c}, {entry.money:.0f} {currency}" for c, entry in zip(costs, entries, strict=True)
        ]
    first, *then = (f"{entry.more} more ({c})" for c, entry in zip(costs, entries, strict=True))
    words = f"{first} would bring it to about {entries[0].rmse:.0f} kPa"
    for more, entry in zip(then, entries[1:], strict=True):
        words += f", {more} to about {entry.rmse:.0f}"
    yield f"{words}."


def too_sure(survey: Survey) -> Iterator[str]:
    """Whether what is said of the error is to be believed, by how variograms are estimated."""
    estimator = ESTIMATORS.get(survey.settings.estimator)
    if isinstance(estimator, LeastSquares) and survey.taken > 1:
        yield (
            "least-squares variograms of few samples make the error look smaller than it is: "
            "the estimator pmc does not"
        )


def out_of_reach(survey: Survey, outlook: Outlook) -> Iterator[str]:
    """Which targets the limits of a survey under way leave no hope for, as the map now is."""
    if survey.finished or not outlook.ahead:
        return
    within = _within_limits(survey, outlook)
    if len(within) == len(outlook.ahead) < survey.settings.samples - survey.taken:
        return
    best = min((entry.rmse for entry in within), default=outlook.rmse)
    for goal in survey.settings.goals:
        if isinstance(goal, TargetRmse | SureRmse) and best > (needed := _needed(goal, outlook)):
            yield (
                f"the target RMSE of {goal.kpa:g} kPa is out of reach: it takes a predicted RMSE "
                f"of {needed:.0f} kPa, and within its limits the survey comes to about {best:.0f}"
            )


def _needed(goal: TargetRmse | SureRmse, outlook: Outlook) -> float:
    """Predicted RMSE in kPa that meets a target, if the error stays as sure as it is."""
    if isinstance(goal, TargetRmse):
        return goal.kpa
    return goal.kpa * outlook.rmse / outlook.error.rmse(goal.probability)


def _within_limits(survey: Survey, outlook: Outlook) -> tuple[Prospect, ...]:
    limits, spent = survey.settings.limits, survey.spent
    return tuple(
        entry
        for entry in outlook.ahead
        if spent.samples + entry.more <= limits.samples
        and spent.minutes + entry.minutes <= limits.minutes
        and spent.money + entry.money <= limits.money
    )


def _stops_ahead(survey: Survey) -> int:
    """How many stops to look ahead: to the end of the survey, and some more."""
    left = survey.settings.samples - survey.taken
    return min(_MOST, max(_MANY, len(survey.plan.cells), left))


def _metres(survey: Survey, planned: tuple[int, ...], new: list[int]) -> list[float]:
    """Way in m through the planned stops, and on through ever more of the new ones."""
    access, cells = survey.access, survey.access.at
    ways = [
        length(access, survey.position, cells[list(planned[: k + 1])]) for k in range(len(planned))
    ]
    here = cells[planned[-1]] if planned else survey.position
    before = ways[-1] if ways else 0.0
    route: tuple[int, ...] = ()
    for cell in new:
        route = reroute(access, cells, here, route, (cell,))
        ways.append(before + length(access, here, cells[list(route)]))
    return ways
