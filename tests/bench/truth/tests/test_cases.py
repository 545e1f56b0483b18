"""Drawn logs: the same again, twins that differ by the effect alone, and a DP that holds the ship."""

import hashlib
from datetime import date

import numpy as np
import pandas as pd
import pytest

from truth import cases, effects, unknowns
from truth.cases import (
    CAUSES,
    FIXED_SEED,
    KINDS,
    bench_seed,
    draw,
    draw_many,
    share_held,
    weekly_seed,
)
from truth.sensors import ROLES

SHORT = {"minutes": 10}
IN_LOOP = [cause for cause in CAUSES if cause in effects.ACT]


@pytest.fixture(scope="module")
def one_of_each():
    """A short trial for every cause of the catalogue."""
    setups = [cases.set_up("trial", 11, among=[cause], **SHORT) for cause in CAUSES]
    return dict(zip(CAUSES, cases.draw_batch(setups), strict=True))


def test_log_has_the_columns_of_the_contract(one_of_each):
    log = one_of_each["drag"].log
    assert list(log.columns) == [
        "time [s]",
        *(f"{role} [{unit}]" for role, (unit, _) in ROLES.items()),
    ]
    assert log["time [s]"].iloc[[0, -1]].tolist() == [0.0, 600.0]
    assert log["heading [deg]"].between(0, 360, inclusive="left").all()


def test_same_seed_gives_the_same_bytes_alone_or_among_others():
    many = draw_many("work", range(2), **SHORT)
    alone = draw("work", 1, **SHORT)
    assert alone.log.to_csv() == many[1].log.to_csv()
    assert alone.twin().log.to_csv() == many[1].twin().log.to_csv()
    assert alone.answer == many[1].answer
    healthy = draw("work", 1, causes=0, **SHORT)
    assert healthy.log.to_csv() == draw_many("work", range(2), causes=0, **SHORT)[1].log.to_csv()
    assert many[0].log.to_csv() != many[1].log.to_csv()


@pytest.mark.parametrize(
    ("kind", "seed", "options", "digest"),
    [
        ("trial", 3, {}, "604df3a30cdb45ee"),
        ("work", 8, {"causes": 2}, "79201ae689c86a29"),
        ("hold", 5, {"causes": "unknown"}, "f2d865f653387edc"),
        ("work", 4, {"causes": 0, "mismatch": 2.0, "rough": True}, "aa129d12a79bff6c"),
        ("trial", 2, {"among": ["clock"]}, "a74f3c05c6f4e913"),
        ("hold", 9, {"among": ["current_varying"], "onset": True, "size": 0.5}, "e1b3ce20c5afda05"),
    ],
)
def test_a_draw_gives_for_ever_what_it_gave(kind, seed, options, digest):
    log = draw(kind, seed, minutes=10, **options).log
    assert hashlib.sha256(log.to_csv().encode()).hexdigest()[:16] == digest


def test_another_day_has_the_same_ship_in_other_weather():
    first, second = (cases.set_up("work", 8, day=day, **SHORT) for day in (0, 1))
    trial = cases.set_up("trial", 8, causes=0, ship="work", **SHORT)
    for other in (second, trial):
        assert all(
            np.array_equal(a, b) for a, b in zip(*map(coefficients, (first, other)), strict=True)
        )
        assert other.style == first.style and other.weather != first.weather
        assert not np.array_equal(other.noise.log, first.noise.log)
    assert [effect.answer for effect in second.effects] == [
        effect.answer for effect in first.effects
    ]
    assert not np.array_equal(second.plan.eta, first.plan.eta)


def coefficients(setup):
    """All coefficients of the ship of a setup."""
    return vars(setup.coefficients).values()


def test_a_healthy_draw_is_its_own_twin_and_that_of_the_faulty_one():
    healthy = draw("work", 2, causes=0, **SHORT)
    faulty = draw("work", 2, among=["tow"], **SHORT)
    assert healthy.answer == [] and healthy.twin() is healthy
    assert faulty.twin().log.to_csv() == healthy.log.to_csv() != faulty.log.to_csv()


@pytest.mark.parametrize("cause", IN_LOOP)
def test_effects_at_the_ship_change_its_motion(one_of_each, cause):
    case = one_of_each[cause]
    assert np.abs(case.truth - case.twin().truth).to_numpy().max() > 1e-3


@pytest.mark.parametrize("cause", [cause for cause in CAUSES if cause not in effects.ACT])
def test_faults_of_the_log_leave_the_ship_alone(one_of_each, cause):
    case = one_of_each[cause]
    pd.testing.assert_frame_equal(case.truth, case.twin().truth)
    assert not case.log.equals(case.twin().log)


def test_outside_its_segments_and_channels_a_fault_leaves_the_twins_log(one_of_each):
    for cause in ("gap", "frame", "channel_swap", "sign", "heading_wrap"):
        case = one_of_each[cause]
        (answer,) = case.answer
        ours, twins = (c.log.set_index("time [s]") for c in (case, case.twin()))
        at = twins.index.intersection(ours.index)
        outside = [
            t for t in at if answer.segments and not any(a <= t <= b for a, b in answer.segments)
        ]
        pd.testing.assert_frame_equal(ours.loc[outside], twins.loc[outside])
        others = [c for c in ours if c.split(" [")[0] not in answer.channels]
        pd.testing.assert_frame_equal(ours.loc[at, others], twins.loc[at, others])


def test_a_lag_is_found_by_shifting_the_twins_log():
    case = draw("trial", 5, among=["navigation_lag"], **SHORT)
    lag = case.answer[0].parameters["lag"]
    rate, twins = (
        c.log.set_index("time [s]")["yaw_rate [deg/s]"].dropna() for c in (case, case.twin())
    )
    misfit = {
        d: np.mean((np.interp(rate.index - d, twins.index, twins) - rate) ** 2)
        for d in np.arange(0, 6, 0.1)
    }
    assert min(misfit, key=misfit.get) == pytest.approx(lag, abs=0.5)


def test_answers_are_the_parameters_of_the_contract(one_of_each):
    names = {
        "current": {"north", "east"},
        "current_varying": {"north_start", "east_start", "north_end", "east_end"},
        "wave_drift": {"north", "east"},
        "tow": {"north", "east"},
        "lever_arm": {"x", "y"},
        "clock": {"rate"},
    }
    names |= dict.fromkeys(("thrust_loss", "reverse_loss", "thruster_interaction"), {"loss"})
    names |= dict.fromkeys(("wind_scale", "mass", "drag", "crossflow", "velocity_scale"), {"scale"})
    names |= dict.fromkeys(
        ("wind_direction", "azimuth_offset", "rpm_offset", "heading_bias"), {"offset"}
    )
    names |= dict.fromkeys(("navigation_lag", "thruster_lag"), {"lag"})
    for cause, case in one_of_each.items():
        ((named, component, parameters, *_),) = case.answer
        assert named == cause and set(parameters) == names.get(cause, set())
        assert all(type(value) is float for value in parameters.values())
        assert (component is not None) == (cause in ("thrust_loss", "azimuth_offset", "rpm_offset"))


def test_two_causes_go_together():
    for seed in range(300):
        pair = [e.answer.cause for e in cases.set_effects("work", seed, causes=2)]
        assert len(set(pair)) == 2 and cases.go_together(pair)
    with pytest.raises(ValueError, match="go together"):
        draw("work", 1, causes=2, among=["sign", "frame"])


def test_every_cause_is_drawn_and_about_as_often():
    drawn = [cases.set_effects("trial", seed)[0].answer.cause for seed in range(2000)]
    counts = pd.Series(drawn).value_counts()
    assert set(counts.index) == set(CAUSES) and counts.min() > 0.6 * 2000 / len(CAUSES)


def test_every_unknown_effect_is_drawn_where_it_can_show():
    for kind in KINDS:
        notes = {
            cases.set_effects(kind, seed, causes="unknown")[0].answer.note for seed in range(300)
        }
        assert notes == set(unknowns.SHOWS_AT_REST if kind == "hold" else unknowns.ALL)


def test_an_onset_comes_within_the_log():
    case = draw("work", 3, among=["tow"], onset=True, **SHORT)
    onset = case.answer[0].onset
    assert 150.0 <= onset <= 360.0
    before = case.truth.index < onset
    pd.testing.assert_frame_equal(case.truth[before], case.twin().truth[before])
    assert np.abs(case.truth - case.twin().truth)[~before].to_numpy().max() > 0.1


def test_dropouts_are_short_and_few():
    log = draw("hold", 4, causes=0, minutes=20).log
    assert log.isna().sum().max() <= 20 and np.diff(log["time [s]"]).max() <= 4


def test_weekly_seed_is_printed(capsys):
    assert weekly_seed(date(2026, 11, 21)) == 202647
    assert "202647" in capsys.readouterr().out


def test_seed_of_a_bench_does_not_depend_on_the_day_unless_fresh_seeds_are_asked_for(monkeypatch):
    monkeypatch.delenv("SHIPCOSIM_FRESH_SEEDS", raising=False)
    assert bench_seed(date(2026, 11, 30)) == bench_seed(date(2027, 5, 3)) == FIXED_SEED
    monkeypatch.setenv("SHIPCOSIM_FRESH_SEEDS", "1")
    assert bench_seed(date(2026, 11, 30)) == 202649


def test_bad_options_are_refused():
    with pytest.raises(ValueError, match="kind"):
        draw("drift", 1)
    with pytest.raises(ValueError, match="minutes"):
        draw("work", 1, minutes=5)


@pytest.mark.parametrize("kind", KINDS)
def test_the_dp_holds_the_ship(kind):
    assert share_held(draw_many(kind, range(500, 540), causes=0, minutes=20)) >= 0.95


def test_stationkeeping_stays_within_two_metres():
    drawn = draw_many("hold", range(700, 710), causes=0, minutes=20)
    assert max(c.off_track.max() for c in drawn) < 2.0


def test_a_trial_turns_all_round_reverses_and_uses_every_thruster():
    for case in draw_many("trial", range(8), causes=0, minutes=20):
        log = case.log
        assert np.histogram(log["heading [deg]"].dropna(), bins=8, range=(0, 360))[0].min() > 0
        assert (log["port_rpm [rpm]"] < -20).any() and (log["starboard_rpm [rpm]"] < -20).any()
        assert log["tunnel_rpm [rpm]"].max() > 400 > -400 > log["tunnel_rpm [rpm]"].min()
        assert log["surge [m/s]"].max() > 0.8 and log["surge [m/s]"].min() < -0.6
