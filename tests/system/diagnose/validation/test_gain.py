"""Gain: named causes predict better on rows that were not fitted on, healthy models gain nothing, none looks ahead."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from shipcosim.diagnose.hypotheses.catalogue import hypotheses_of, read_catalogue
from shipcosim.diagnose.inference.fitting import IdentificationProblem, fitted, prepared
from shipcosim.diagnose.inference.linearisation import linearise
from shipcosim.diagnose.inference.noise import first_noise
from shipcosim.diagnose.inference.parts import in_parts
from shipcosim.diagnose.inference.predictions import (
    observed,
    predicted,
    reference,
    replayable,
    restarted,
)
from shipcosim.diagnose.inference.screening import screened
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.log.repair import repaired
from shipcosim.diagnose.ship.inputs import first_motion, record_of
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.diagnose.validation.conditions import compare_held_out, rows_without_condition
from shipcosim.diagnose.validation.cosimulation import Replayed, simulated
from shipcosim.diagnose.validation.gain import (
    MODELS,
    baseline,
    compare,
    gain,
    rms,
)
from shipcosim.diagnose.validation.missing_force import missing_force
from shipcosim.diagnose.validation.split import (
    conditions,
    first_rows,
    sorted_by,
    starts,
    trained,
    without_headings,
)
from shipcosim.library import build_stale
from shipcosim.models.core.motion import Motion
from shipcosim.ssp import read_system, with_values
from trial.gains import beyond_observer, by_condition, chance_of_more
from truth import draw

CONTRACT = {
    "horizon_s",
    "before_m",
    "bias_observer_m",
    "after_m",
    "noise_floor_m",
    "share_of_explainable",
    "ci95",
}


@pytest.fixture(scope="module")
def system(root):
    return read_system(root / "ssp" / "gunnerus_open", fmus=[build_stale(root)])


@pytest.fixture(scope="module")
def model(system):
    return ship_model_of(system)


@pytest.fixture(scope="module")
def diagnosed(model, tmp_path_factory):
    """Function from a hidden cause to the case with only that hypothesis, its fit, and the truth's parameters."""

    @cache
    def of(cause, healthy=False, kind="trial", seed=2003, minutes=16):
        hidden = draw(kind, seed, among=[cause], minutes=minutes)
        path = tmp_path_factory.mktemp("log") / "log.csv"
        (hidden.twin() if healthy else hidden).save(path)
        log = repaired(read_log(path))
        ship = replace(model, span=(float(log.time[0]), float(log.time[-1])))
        record, answer = record_of(log, ship), hidden.answer[0]
        here = (answer.cause, answer.component)
        only = tuple(
            s for s in hypotheses_of(read_catalogue(), ship) if (s.cause, s.component) == here
        )
        noise = first_noise(record, ship.parts["hull"].length)
        case = prepared(IdentificationProblem(record, ship, only, noise, first_motion(record)))
        fit = fitted(case)
        if not healthy:
            fit = fitted(case, only, screened(case, fit)[0][2])
        return case, fit, answer.parameters

    return of


@pytest.fixture(scope="module")
def loss(diagnosed):
    return compare(*diagnosed("thrust_loss")[:2])


@pytest.fixture(scope="module")
def twin(diagnosed):
    return compare(*diagnosed("thrust_loss", healthy=True)[:2])


def test_a_named_cause_takes_most_of_the_explainable_error_away(loss):
    found = gain(loss.errors)
    assert set(found) == CONTRACT
    assert found["noise_floor_m"] <= found["after_m"] < 0.5 * found["before_m"]
    assert found["share_of_explainable"] > 0.5 and beyond_observer(loss.errors) > 0.5
    low, high = found["ci95"]
    assert 0.0 < low < found["share_of_explainable"] < high <= 1.0


def test_a_healthy_log_gains_nothing(loss, twin):
    found = gain(twin.errors)
    assert found["after_m"] == found["before_m"]
    assert found["share_of_explainable"] == 0.0 and found["ci95"] == [0.0, 0.0]
    assert found["before_m"] < 0.5 * gain(loss.errors)["before_m"]


def test_both_sides_have_the_same_observers_so_that_without_a_cause_nothing_is_beyond_them(
    twin, loss
):
    assert twin.errors.sel(model="extended_observer").equals(
        twin.errors.sel(model="bias_observer").assign_coords(model="extended_observer")
    )
    assert not beyond_observer(twin.errors) > 0.0
    errors = loss.errors.copy(deep=True)
    for model, missed in (
        ("plain", 9.0),
        ("bias_observer", 3.0),
        ("extended", 8.0),
        ("extended_observer", 1.5),
    ):
        errors["position"].loc[{"model": model}] = missed
    errors["position"].loc[{"model": "floor"}] = 1.0
    assert beyond_observer(errors) == pytest.approx(0.75)
    assert (
        gain(errors)["after_m"] == 8.0
    )  # the cause alone: what an observer does is not the name's doing


def test_with_the_cause_named_the_ship_is_as_predictable_as_her_healthy_twin(loss, twin):
    assert rms(loss.errors, "position", "extended") < 1.3 * rms(twin.errors, "position", "plain")


def test_a_wrong_instrument_gains_in_what_it_shows(diagnosed):
    case, fit, truth = diagnosed("heading_bias")
    comparison = compare(case, fit)
    found = gain(comparison.errors)
    assert found["after_m"] < 0.8 * found["before_m"]
    assert np.degrees(comparison.fit.values["instruments.heading_bias"]) == pytest.approx(
        truth["offset"], abs=1.0
    )


def test_baseline_grows_with_the_horizon_and_is_what_the_gain_starts_from(loss):
    found = baseline(loss.errors)
    assert set(found) == {"horizon_s", "position_error_m", "heading_error_deg"}
    assert found["horizon_s"] == [10, 30, 60]
    assert sorted(found["position_error_m"]) == found["position_error_m"]
    assert found["position_error_m"][-1] == gain(loss.errors)["before_m"]


def test_the_same_seed_gives_the_same_interval_and_another_nearly(loss):
    assert gain(loss.errors, seed=5) == gain(loss.errors, seed=5)
    assert gain(loss.errors, seed=6)["ci95"] == pytest.approx(
        gain(loss.errors, seed=5)["ci95"], abs=0.05
    )


def test_conditions_share_the_segments_among_them(loss):
    parts = by_condition(loss.errors, "regime")
    assert set(parts) <= {"holding", "moving", "turning"}  # no thruster fails in these logs
    assert sum(part["segments"] for part in parts.values()) == loss.errors.sizes["segment"]
    squares = sum(part["segments"] * part["plain"] ** 2 for part in parts.values())
    assert np.sqrt(squares / loss.errors.sizes["segment"]) == pytest.approx(
        rms(loss.errors, "position", "plain")
    )
    assert set(loss.errors["model"].values) == set(MODELS)


def test_as_a_co_simulation_the_gain_is_the_same(loss, system):
    runs = []
    found = simulated(
        loss,
        Replayed(system),
        Replayed(with_values(system, loss.fit.values)),
        most=4,
        progress=lambda done, of: runs.append((done, of)),
    )
    assert runs == [(done, 8) for done in range(1, 9)]
    assert float(found["difference"].max()) < 0.15
    same = loss.errors.sel(segment=np.isin(loss.errors["start_time"], found["start_time"]))
    for model in ("plain", "extended"):
        assert rms(found, "position", model) == pytest.approx(rms(same, "position", model), abs=0.1)
        assert rms(found, "position", model) != rms(same, "position", model)
    assert rms(found, "position", "bias_observer") == rms(same, "position", "bias_observer")
    assert gain(found)["after_m"] < gain(found)["before_m"]


def test_held_out_rows_have_no_say_in_the_parameters(diagnosed):
    case, fit, _ = diagnosed("thrust_loss")
    train = first_rows(case.record)
    lied = case.record.measured.copy()
    lied[~train] += 1000.0
    base = case.base.whole()
    base = base._replace(seen=np.where(train[:, None, None], base.seen, 1000.0))
    other = replace(case, record=replace(case.record, measured=lied), base=in_parts(base))
    honest, untouched = (
        fitted(trained(one, train), fit.hypotheses, fit.values, rounds=1) for one in (case, other)
    )
    assert honest.score == untouched.score and np.array_equal(honest.theta, untouched.theta)
    assert honest.std != fit.std


def test_the_reference_favours_no_model(diagnosed):
    case, fit, _ = diagnosed("tow")
    found = []
    for model, motion in ((case.model, case.motion), (fit.model, fit.motion)):
        linear = linearise(motion, case.record, model, [])
        found.append(reference(linear, motion, case.noise, case.record, model))
    one, other = found
    assert np.sqrt(np.mean((one.x - other.x) ** 2 + (one.y - other.y) ** 2)) < 0.05
    assert (
        np.hypot(case.motion.x - fit.motion.x, case.motion.y - fit.motion.y).max() > 0.3
    )  # what it must not inherit


def test_a_problem_restarted_for_another_ship_is_hers(diagnosed):
    case, _, _ = diagnosed("thrust_loss")
    other = case.model.with_values(
        {"vessel.mass_scale": 1.02, "instruments.lever_x": 0.5, "port.thrust_loss": 0.05}
    )
    own, theirs = (linearise(case.motion, case.record, model, []) for model in (other, case.model))
    found = restarted(theirs, case.motion, case.record, other)
    assert np.allclose(found.driven, own.driven, atol=1e-12) and np.allclose(
        found.seen, own.seen, atol=1e-12
    )
    assert not np.allclose(found.driven, theirs.driven) and not np.allclose(found.seen, theirs.seen)


def test_observers_know_nothing_of_later_rows(diagnosed):
    case, _, _ = diagnosed("thrust_loss")
    linear = linearise(case.motion, case.record, case.model, [])
    later = linear.seen.copy()
    later[400:] += 5.0
    noise = replace(
        case.noise, **{n: np.stack([getattr(case.noise, n)] * 2) for n in ("white", "jolt", "walk")}
    )
    known = observed(
        [linear, linear._replace(seen=later)],
        noise,
        case.record,
        [case.motion] * 2,
        [case.model] * 2,
    )
    for value in (*known.motion, known.force):
        assert np.array_equal(value[0, :400], value[1, :400])
    assert not np.allclose(known.motion.x[0, 400], known.motion.x[1, 400])


def test_what_is_predicted_from_and_to_is_either_fitted_on_or_held_out(diagnosed):
    record = diagnosed("thrust_loss")[0].record
    for train in (first_rows(record), without_headings(record, 0.5)):
        inside, outside = sorted_by(train, starts(record), record)
        assert outside.size and inside.size
        assert all(train[row : row + 61].all() for row in inside)
        assert not any(train[row : row + 61].any() for row in outside)


def test_unseen_headings_are_predicted_with_what_the_others_taught(diagnosed):
    case, fit, _ = diagnosed("thrust_loss")
    most = np.nanmedian(np.mod(case.record.measured[:, 2] + np.pi, 2.0 * np.pi)) - np.pi
    comparison = compare(case, fit, train=without_headings(case.record, most, np.radians(80.0)))
    assert comparison.errors["heading_known"].mean() < 0.5
    assert rms(comparison.errors, "position", "extended") < rms(
        comparison.errors, "position", "plain"
    )


def test_a_condition_is_held_out_wherever_it_is_in_the_log(diagnosed):
    case, fit, _ = diagnosed("thrust_loss")
    record = case.record
    time = np.arange(record.time.size)
    dead = {
        name: (np.where((time > 300) & (time <= 600), 0.0, np.maximum(np.abs(n), 1.0)), a)
        for name, (n, a) in record.units.items()
    }
    train = rows_without_condition(replace(record, units=dead))["free drift"]
    assert np.array_equal(np.flatnonzero(~train), np.arange(301, 601))


def test_headings_that_nothing_was_fitted_on_are_15_deg_away_from_those(diagnosed):
    case, fit, _ = diagnosed("thrust_loss", seed=2008)
    found = compare_held_out(case, fit)
    assert set(found) == {"other headings"}
    comparison = found["other headings"]
    heading = np.degrees(case.motion.psi)
    known = np.unique(heading[comparison.train].round() % 360.0)
    apart = np.abs((heading[comparison.rows][:, None] - known + 180.0) % 360.0 - 180.0).min(axis=1)
    assert (
        comparison.train.mean() > 0.5
        and apart.min() > 14.0
        and apart.size == comparison.errors.sizes["segment"]
    )
    assert gain(comparison.errors)["share_of_explainable"] > 0.5


def test_an_interval_needs_blocks(loss):
    few = loss.errors.isel(segment=slice(0, 24))
    assert gain(few, fewest=2)["ci95"] is None and gain(few)["ci95"] is not None
    assert gain(few, fewest=2)["share_of_explainable"] == gain(few)["share_of_explainable"]


def test_a_model_is_surely_worse_only_where_most_draws_say_so(loss):
    assert chance_of_more(loss.errors, "plain", "extended") > 0.95
    assert chance_of_more(loss.errors, "extended", "plain") < 0.05
    errors = loss.errors.copy(deep=True)
    times = errors["start_time"].values
    odd = ((times - times[0]) // 120.0).astype(int) % 2 == 1
    errors["position"].loc[{"model": "plain"}] = np.where(odd, 1.1, 1.0)
    errors["position"].loc[{"model": "extended"}] = np.where(odd, 1.0, 1.1)
    assert 0.2 < chance_of_more(errors, "plain", "extended") < 0.8


def test_no_gain_is_claimed_from_a_handful_of_rows(diagnosed):
    case, fit, _ = diagnosed("thrust_loss")
    assert compare(case, fit, train=first_rows(case.record, 0.97)) is None


def test_a_force_held_in_the_earth_undoes_a_line_and_one_held_aboard_does_not(model, diagnosed):
    record = diagnosed("thrust_loss")[0].record
    start = Motion(*(np.array([value]) for value in (0.0, 0.0, 0.4, 0.5, 0.0, 0.06)))
    rows, pull = np.array([300]), np.array([3000.0, -2000.0])
    still = replace(
        record,
        units={name: tuple(0.0 * s for s in pair) for name, pair in record.units.items()},
        wind=None,
    )
    c, s = np.cos(0.4), np.sin(0.4)
    force = -np.array([[c * pull[0] + s * pull[1], c * pull[1] - s * pull[0], 0.0]])
    towed = model.with_values(
        {"water.tow_north": pull[0], "water.tow_east": pull[1], "water.tow_x": 0.0}
    )
    free = predicted(start, rows, still, model, [60])
    held = predicted(start, rows, still, towed, [60], force)
    aboard = predicted(start, rows, still, towed, [60], force, earth=False)
    assert np.ptp(free.psi - 0.4) == 0.0 and abs(free.psi[0, 0] - 0.4) > 0.3
    assert np.hypot(held.x - free.x, held.y - free.y).max() < 1e-6
    assert np.hypot(aboard.x - free.x, aboard.y - free.y).min() > 1.0


def test_a_replayable_log_has_no_late_channel(model, diagnosed):
    record = diagnosed("thrust_loss")[0].record
    late = model.with_values({"instruments.thruster_lag": 2.0, "instruments.wind_lag": 0.0})
    seen = Motion(*record.measured.T)
    ready, _ = replayable(record, late, seen)
    assert np.allclose(ready.units["port"][0][:-3], record.units["port"][0][2:-1])


def test_the_missing_force_of_a_line_points_where_it_pulls(diagnosed):
    case, fit, truth = diagnosed("tow")
    found = missing_force(case, case.model, case.motion)
    size = np.hypot(truth["north"], truth["east"])
    for name in ("north", "east"):
        assert float(found[name].median()) == pytest.approx(truth[name], abs=0.25 * size)
    rest = missing_force(case, fit.model, fit.motion)
    assert float((rest["north"] ** 2 + rest["east"] ** 2).mean()) < 0.1 * size**2
    sizes = (
        np.hypot(found[a], found[b]) for a, b in (("port_along", "port_across"), ("north", "east"))
    )
    assert np.allclose(*sizes, equal_nan=True)


def test_a_ship_without_thrust_drifts(diagnosed):
    case, _, _ = diagnosed("thrust_loss")
    record, rows = case.record, np.array([200, 500])
    dead = {
        name: (np.where(np.arange(n.size) < 300, 0.0, n), a)
        for name, (n, a) in record.units.items()
    }
    seen, train = case.motion, first_rows(record)
    found = conditions(replace(record, units=dead), seen, rows, train)["regime"][1]
    assert found[0] == "drifting" and found[1] != "drifting"
