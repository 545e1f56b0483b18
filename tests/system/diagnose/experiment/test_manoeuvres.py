"""Manoeuvres do what their names say, and separate what physics says they separate; beliefs are made by hand."""

import time as clock
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from diagnose import twin
from manoeuvres.testability import testability as nats_of

from shipcosim.diagnose.experiment.design import CLEAR, design_experiment, separations
from shipcosim.diagnose.experiment.manoeuvres import (
    LONGEST,
    Manoeuvre,
    cannot_turn,
    library,
    planned,
    step_for,
    true_wind,
)
from shipcosim.diagnose.hypotheses.catalogue import hypotheses_of, read_catalogue
from shipcosim.diagnose.inference.fitting import IdentificationProblem, Regressor
from shipcosim.diagnose.inference.innovations import Noise, innovations
from shipcosim.diagnose.inference.linearisation import linearise
from shipcosim.diagnose.ship.inputs import Record
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.diagnose.ship.track_keeping import DpController, kept_on_track
from shipcosim.models.core.motion import Motion
from shipcosim.models.environment.wind_loads import apparent_wind

NOISE = Noise(twin.WHITE, twin.JOLT, np.array([1e-5, 1e-5, 1e-6]))
KEEP = Manoeuvre("keep the place", ((240.0, 0.0, 0.0, 0.0),))


@cache
def problem(wind=0.0):
    """A log of five minutes at rest, from which only time, place and wind are taken."""
    model = replace(ship_model_of(twin.system()), span=(0.0, 300.0), wind_is_true=True)
    time = np.arange(300.0)
    units = {name: (np.zeros(300), np.full(300, 0.7)) for name in model.thrusters}
    record = Record(
        time, np.zeros((300, 6)), units, (np.full(300, wind), np.full(300, 0.5)), np.ones(300, bool)
    )
    return IdentificationProblem(
        record,
        model,
        tuple(hypotheses_of(read_catalogue(), model)),
        NOISE,
        Motion(*np.zeros((6, 300))),
    )


@dataclass(frozen=True)
class Belief:
    """What `design_experiment` asks of a fit."""

    hypotheses: tuple
    columns: list
    left: np.ndarray
    covariance: np.ndarray
    model: ShipModel


def believed(values, spread=0.1, of=None):
    """Causes by label with the values of their numbers, known to a share of their typical size."""
    of = of or problem()
    present = [hypothesis for hypothesis in of.hypotheses if hypothesis.label in values]
    known = of.ship_columns(present)
    own = [
        Regressor({path: of.model.tolerances[path]})
        for hypothesis in present
        for path in hypothesis.definition.companions
    ]
    turned, numbers = [], {}
    for hypothesis in present:
        for parameter, value in zip(hypothesis.parameters, values[hypothesis.label], strict=True):
            turned.append(Regressor(dict.fromkeys(parameter.paths, parameter.typical)))
            numbers |= dict.fromkeys(parameter.paths, value)
    width = np.array([1.0] * len(known + own) + [spread] * len(turned))
    columns, ship = [*known, *own, *turned], of.model.with_values(numbers)
    return Belief(tuple(present), columns, 0.0 * width, np.diag(width**2), ship)


def pick(start):
    return next(one for one in library(problem().model) if one.name.startswith(start))


def apart(one, other, *wanted, of=None):
    """Expected nats by manoeuvre."""
    return separations(of or problem(), [one, other], list(wanted))[0, 1]


def test_reversal_separates_what_only_differs_in_reversing_and_a_circle_of_headings_does_not():
    one = believed({"thrust_loss of port": [0.3]})
    both = believed({"thrust_loss of port": [0.3], "reverse_loss": [0.4]})
    reversal, circle = apart(one, both, pick("reversal"), pick("full circle"))
    assert reversal > CLEAR
    assert circle < 1.0


def alike_on_the_beam():
    """A current from the west, and waves that push a ship with her bow to the north as hard."""
    drag = (
        0.5 * 1025.0 * 1.5 * 33.9 * 2.786 * 0.2**2
    )  # cross flow of a slab, as the nominal model states it
    return believed({"current": [0.0, 0.2]}), believed({"wave_drift": [0.0, drag]})


def test_current_and_wave_drift_are_separated_by_turning():
    current, drift = alike_on_the_beam()
    keep, turn, circle = apart(current, drift, KEEP, pick("turn by 90"), pick("full circle"))
    assert keep < CLEAR < min(turn, circle)
    assert turn > 3.0 * keep
    told = design_experiment(
        problem(), current, [drift], [KEEP, pick("turn by 90"), pick("full circle")]
    )
    assert (told.manoeuvre, told.minutes) == (
        "turn by 90 deg and hold",
        4.0,
    )  # the circle takes seven minutes
    assert told.separates == (("current", "wave_drift"),)


def test_twin_thrusters_are_separated_by_pulses():
    port, starboard = (
        believed({"thrust_loss of port": [0.25]}),
        believed({"thrust_loss of starboard": [0.25]}),
    )
    idle = Manoeuvre("idle", ((180.0, 0.0, 0.0, 0.0),), free=((0.0, 200.0),))
    pulses, nothing = apart(port, starboard, pick("pulses"), idle)
    assert pulses > CLEAR
    assert nothing < 0.1


def test_loss_by_the_neighbours_slipstream_shows_in_the_sweep_only():
    nothing, hit = believed({}), believed({"thruster_interaction": [0.35]})
    sweep, *others = apart(nothing, hit, pick("sweep"), pick("full circle"), pick("reversal"), KEEP)
    assert sweep > CLEAR
    assert max(others) < 1.0


def test_nothing_separates_a_cause_from_itself():
    one, same = (believed({"current": [0.1, 0.2]}) for _ in range(2))
    assert (
        np.abs(apart(one, same, pick("turn by 90"), pick("reversal"), pick("free drift"))).max()
        < 1e-6
    )
    assert design_experiment(problem(), one, [same], [pick("turn by 90")]) is None


def test_what_one_manoeuvre_cannot_separate_is_not_said_to_be():
    drag, heavy = believed({"drag": [2.5]}), believed({"mass": [1.2]})
    astern = believed({"reverse_loss": [0.4]})
    told = design_experiment(problem(), drag, [heavy, astern], [pick("reversal")])
    assert ("drag", "mass") not in told.separates
    assert set(told.separates) == {("drag", "reverse_loss"), ("mass", "reverse_loss")}


def test_noisy_logs_show_the_expected_difference_or_somewhat_more():
    """Noisy sailings of the truth, filtered by both beliefs. Not less: noise moves the thrusters more than the plan."""
    truth, rival = (
        believed({"thrust_loss of port": [0.1]}),
        believed({"thrust_loss of starboard": [0.1]}),
    )
    one, count, random = pick("pulses"), 12, np.random.default_rng(3)
    of = replace(problem(), noise=replace(NOISE, walk=NOISE.walk * 1e-3))
    expected = apart(truth, rival, one, of=of)[0]
    dp = DpController(of.model, step_for(of.model))
    track, record, _ = planned([one], dp, (300.0, 0.0, 0.0, 0.0), (0.0, 0.5))
    rows = record.time.size
    jolts = random.standard_normal((rows, 3, count)) * (NOISE.jolt * np.sqrt(dp.h))[:, None]
    motion, units = kept_on_track(truth.model, count, track, record, dp, jolts=jolts)
    white = NOISE.white / np.sqrt(dp.h)
    measured = np.stack(motion, axis=-1) + white * random.standard_normal((count, rows, 6))
    still = tuple(np.broadcast_to(series, (count, rows)) for series in record.wind)
    record = replace(record, units=units, measured=measured, wind=still)
    scores = [
        _log_evidence(fit, motion, record, replace(of.noise, white=white)) for fit in (truth, rival)
    ]
    differences = scores[0] - scores[1]
    doubt = 3.0 * differences.std() / np.sqrt(count)
    assert expected - doubt < differences.mean() < 2.0 * expected
    assert expected > 5.0


def _log_evidence(fit, motion, record, noise):
    found = innovations(linearise(motion, record, fit.model, fit.columns), noise, record)
    rows = np.moveaxis(found.white, 0, 1).reshape(len(motion.x), -1, len(fit.columns) + 1)
    scores = []
    for y, logdet in zip(rows, found.log_determinant.sum(0), strict=True):
        G, g = y[:, 1:].T @ y[:, 1:], y[:, 1:].T @ y[:, 0]
        precision = G + np.linalg.inv(fit.covariance)
        free = y[:, 0] @ y[:, 0] - g @ np.linalg.solve(precision, g)
        scores.append(-0.5 * (free + logdet + np.linalg.slogdet(precision @ fit.covariance)[1]))
    return np.array(scores)


def sailing(one, wind=(6.0, 0.5), model=None):
    model = model or problem().model
    dp = DpController(model, step_for(model))
    track, record, held = planned([one], dp, (0.0, 0.0, 0.0, 0.0), wind)
    motion, units = kept_on_track(model, 1, track, record, dp, held=held)
    return (
        record.time,
        Motion(*(v[0] for v in motion)),
        {n: tuple(s[0] for s in pair) for n, pair in units.items()},
    )


def test_reversal_reverses_each_azimuth_thruster_in_turn_for_most_of_a_minute():
    time, _, units = sailing(pick("reversal"))
    astern = {name: time[units[name][0] < -0.5] for name in ("port", "starboard")}
    assert all(40.0 < when.size * (time[1] - time[0]) < 80.0 for when in astern.values())
    assert astern["port"].max() < astern["starboard"].min()


def test_free_drift_has_idle_thrusters_for_three_minutes():
    time, _, units = sailing(pick("free drift"))
    idle = np.all([np.abs(n) < 1.0 for n, _ in units.values()], axis=0)
    assert idle.sum() * (time[1] - time[0]) > 170.0


def test_circle_turns_once_round_on_the_spot():
    _, motion, _ = sailing(pick("full circle"))
    assert motion.psi[-1] - motion.psi[0] == pytest.approx(2.0 * np.pi, abs=np.radians(8.0))
    assert np.hypot(motion.x, motion.y).max() < 5.0


def test_sweep_crosses_the_neighbour_with_the_slipstream_while_both_push():
    _, _, units = sailing(pick("sweep"))
    for name, away in (("port", -0.5 * np.pi), ("starboard", 0.5 * np.pi)):
        n, azimuth = units[name]
        off = np.abs(np.angle(np.exp(1j * (azimuth - away))))
        assert off[n > 0.3].min() < np.radians(5.0)


@pytest.mark.parametrize("times", [0.1, 0.5, 1.0, 4.0, 20.0])
def test_manoeuvres_keep_to_time_and_area_on_ships_of_all_sizes(times):
    model = problem().model
    hull = model.parts["hull"]
    ship = replace(model, parts=model.parts | {"hull": replace(hull, length=times * hull.length)})
    found = library(ship)
    assert all(0.0 < one.minutes <= LONGEST for one in found)
    assert all(
        np.hypot(x, y) < 3.0 * ship.parts["hull"].length for one in found for _, x, y, _ in one.legs
    )
    assert len(found) == len(library(model)) or times > 4.0


def test_a_ship_that_cannot_hold_her_place_is_not_sent():
    flood, other = believed({"current": [0.0, 4.0]}), believed({"current": [0.0, 0.2]})
    assert np.isnan(apart(flood, other, KEEP)).all()
    assert design_experiment(problem(), flood, [other], [KEEP]) is None


def test_a_ship_that_her_dp_cannot_steer_gets_lost_and_not_infinite():
    model = problem().model
    light = model.with_values(
        {"vessel.mass": 2e3, "vessel.A11": 1e3, "vessel.A22": 1e3, "vessel.inertia_yaw": 1e4}
    )
    light = light.with_values({"vessel.A66": 1e4, "vessel.A26": 0.0, "vessel.A62": 0.0})
    _, motion, _ = sailing(pick("pulses"), (20.0, 0.5), light)
    assert np.isfinite(np.stack(motion)).all()
    assert np.abs(motion.u).max() <= np.sqrt(9.81 * 33.9)


def test_fixed_propellers_are_not_asked_to_turn():
    one = problem()
    ahead = {name: (n, 0.0 * azimuth) for name, (n, azimuth) in one.record.units.items()}
    fixed = cannot_turn(replace(one.record, units=ahead), one.model)
    assert set(fixed) == {"port", "starboard"} and cannot_turn(one.record, one.model) == ()
    assert not [m for m in library(one.model, fixed) if m.name.startswith("sweep")]
    dp = DpController(one.model, 2.0, fixed)
    _, record, _ = planned(library(one.model, fixed), dp, (0.0, 0.0, 0.0, 0.0), (6.0, 0.5))
    assert all(np.ptp(record.units[name][1]) == 0.0 for name in fixed)


def test_wind_of_a_log_is_that_over_ground_however_the_ship_moves():
    model = replace(problem().model, wind_is_true=False)
    t = np.arange(300.0)
    motion = Motion(t, t, 0.02 * t, 1.0 + np.sin(t / 20.0), 0.3 * np.cos(t / 30.0), 0.02 + 0.0 * t)
    wind = apparent_wind(motion.psi, motion.u, motion.v, -7.0 * np.cos(2.0), -7.0 * np.sin(2.0))
    record = replace(problem().record, wind=wind)
    assert true_wind(record, motion, model) == pytest.approx((7.0, 2.0))
    assert true_wind(replace(record, wind=None), motion, model) is None


def test_one_pair_takes_less_than_five_seconds():
    current, drift = alike_on_the_beam()
    before = clock.process_time()
    assert design_experiment(problem(), current, [drift]) is not None
    assert clock.process_time() - before < 5.0


def test_before_sailing_a_cause_shows_where_it_acts():
    model = problem().model
    names = ("reversal", "sweep", "steps in surge", "full circle")
    found = nats_of(model, problem().hypotheses, NOISE, [pick(name) for name in names], (6.0, 0.5))
    best = {label: names[int(np.argmax(nats))] for label, nats in found.items()}
    assert best["reverse_loss"] == "reversal"
    assert best["thruster_interaction"] == "sweep"
    assert best["drag"] == best["velocity_scale"] == "steps in surge"
    assert best["wave_drift"] == best["wind_scale"] == "full circle"
    assert found["reverse_loss"][3] < 1.0 < CLEAR < found["reverse_loss"][0]


def test_before_sailing_nothing_is_said_of_weather_that_the_ship_cannot_hold_against():
    hypothesis = [
        hypothesis for hypothesis in problem().hypotheses if hypothesis.label == "wind_scale"
    ]
    gale = nats_of(problem().model, hypothesis, NOISE, [pick("turn by 90")], (45.0, 1.5))
    assert np.isnan(gale["wind_scale"]).all()


def test_the_page_lists_the_library(root):
    page = (root / "docs" / "generated" / "manoeuvres.md").read_text(encoding="utf-8")
    for i, one in enumerate(library(problem().model), start=1):
        assert f"| {i} | {one.name} | {one.minutes:g} |" in page
