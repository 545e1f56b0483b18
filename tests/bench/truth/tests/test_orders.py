"""What is sailed after a log: the log stays as it was, and the ship does as told."""

import numpy as np
import pytest

from truth import cases, orders
from truth.cases import CAUSES, draw, draw_many
from truth.orders import Orders
from truth.ship import BOLLARD_ASTERN, PROPELLER_DIAMETER, WATER_DENSITY
from truth.streams import Lengthened
from truth.weather import gauss_markov

BEGINS = 600 + cases.AFTER + orders.STOP
TURN = {"legs": [[30, 0, 0, 0], [90, 0, 0, np.pi / 2], [60, 0, 0, np.pi / 2]]}
BOX = {"legs": [[90, 30, 0, 0], [90, 30, 30, 0], [90, 0, 30, 0], [90, 0, 0, 0]]}
DRIFT = {"legs": [[30, 0, 0, 0], [180, 0, 0, 0]], "free": [[30, 210]]}
LOST = {"legs": [[240, 0, 0, 0]], "free": [[0, 60]]}
REVERSE = {"legs": [[120, 0, 0, 0]], "pushes": [["port", 30, 90, -6.4e3, 0.0, 0.0]]}
SWEEP = {
    "legs": [[100, 0, 0, 0]],
    "pushes": [["port", 20, 70, 6e3, -2.6, -0.5], ["starboard", 20, 70, 6e3, 0.0, 0.0]],
}


def short(kind, seed, after, **options):
    return draw(kind, seed, minutes=10, after=after, **options)


def test_the_log_before_the_orders_keeps_every_byte_whatever_is_hidden():
    wanted = [[cause] for cause in CAUSES] + [["clock", "current_varying"]]
    drawn = []
    for after in (None, TURN):
        several = [
            cases.set_up(kind, 12, causes=len(names), among=names, minutes=10, after=after)
            for kind, names in zip(("trial", "work") * len(wanted), wanted, strict=False)
        ]
        drawn.append(cases.draw_batch(several))
    for one, long in zip(*drawn, strict=True):
        assert long.log[long.log["time [s]"] <= 600].to_csv() == one.log.to_csv(), one.answer
        assert long.log["time [s]"].iloc[-1] > 600 + cases.AFTER + Orders(**TURN).seconds


def test_a_told_turn_is_made_and_held():
    for case in draw_many("hold", range(20, 24), minutes=10, causes=0, after=TURN):
        turned = np.degrees(case.truth["psi"].to_numpy() - case.truth["psi"][600])
        assert abs(turned[BEGINS]) < 5.0 and turned[-1] == pytest.approx(90.0, abs=5.0)


def test_a_told_box_is_sailed_at_one_heading():
    case = short("hold", 21, BOX, causes=0)
    x, y, psi = (case.truth[name].to_numpy() for name in ("x", "y", "psi"))
    c, s = np.cos(psi[BEGINS]), np.sin(psi[BEGINS])
    north, east = x - x[BEGINS], y - y[BEGINS]
    ahead, starboard = c * north + s * east, c * east - s * north
    for at, place in ((90, (30, 0)), (180, (30, 30)), (270, (0, 30)), (365, (0, 0))):
        assert np.hypot(ahead[BEGINS + at] - place[0], starboard[BEGINS + at] - place[1]) < 5.0
    assert np.degrees(np.abs(psi[BEGINS:] - psi[BEGINS])).max() < 15.0


def test_without_power_propellers_run_down_and_the_ship_drifts_until_the_log_ends():
    case = short("work", 22, DRIFT, among=["tow"])
    log = case.log.set_index("time [s]")
    drifting = log.loc[BEGINS + 30 + orders.LATE + 20 :]
    assert drifting[["port_rpm [rpm]", "starboard_rpm [rpm]"]].abs().max().max() < 3.0
    assert drifting["tunnel_rpm [rpm]"].abs().max() < 20.0
    stopping = (
        log["port_rpm [rpm]"].loc[BEGINS + 30 : BEGINS + 30 + orders.LATE + 20].dropna().abs()
    )
    assert ((stopping > 5.0) & (stopping < 0.8 * stopping.iloc[0])).any()
    assert case.off_track[-1] > 15.0 > case.off_track[BEGINS]


def test_when_power_is_back_the_ship_holds_where_she_is():
    case = short("hold", 23, LOST, among=["tow"])
    place = np.hypot(case.truth["x"], case.truth["y"]).to_numpy()
    assert place[BEGINS + 75] > 3.0
    assert np.abs(place[-30:] - place[-1]).max() < 1.5 and place[-1] > 3.0


def test_a_thruster_by_hand_does_as_told_and_the_others_hold_the_ship():
    case = short("hold", 24, REVERSE, causes=0)
    log = case.log.set_index("time [s]").loc[BEGINS + 30 + orders.LATE + 25 : BEGINS + 90]
    rpm = -60 * np.sqrt(6.4e3 / (WATER_DENSITY * PROPELLER_DIAMETER**4 * BOLLARD_ASTERN))
    assert log["port_rpm [rpm]"].median() == pytest.approx(rpm, abs=1.0)
    assert log["port_azimuth [deg]"].median() == pytest.approx(0.0, abs=1.0)
    assert case.off_track.max() < 6.0


def test_a_unit_by_hand_turns_evenly():
    case = short("work", 25, SWEEP, causes=0)
    late = int(cases.stream("work", 25, "captain").integers(2, orders.LATE + 1))
    azimuth = case.log.set_index("time [s]")["port_azimuth [deg]"]
    start = BEGINS + late + 20
    for at in (30, 40, 48):
        share = at / 49
        assert azimuth[start + at] == pytest.approx(np.degrees(-2.6 + share * 2.1), abs=8.0)


def test_a_current_that_varied_goes_on_varying():
    for seed in range(4):
        before, after = (
            cases.set_up("hold", seed, among=["current_varying"], after=a) for a in (None, TURN)
        )
        longer = (after.rows - 1) / (before.rows - 1)
        one, other = before.effects[0], after.effects[0]
        ends = [
            np.hypot(e.answer.parameters["north_end"], e.answer.parameters["east_end"])
            for e in (one, other)
        ]
        slow, fast = one.shape["speeds"]
        assert ends[1] == pytest.approx(abs(slow + longer * (fast - slow)))
        assert other.answer.parameters["north_start"] == one.answer.parameters["north_start"]


def test_a_lengthened_stream_keeps_its_start_and_goes_on_smoothly():
    jumps = []
    for seed in range(400):
        first, then = np.random.default_rng(seed), np.random.default_rng(1000 + seed)
        long = gauss_markov(Lengthened(first, then, {60: 40}), 60, 1.0, 20.0)
        np.testing.assert_array_equal(
            long[:40], gauss_markov(np.random.default_rng(seed), 40, 1.0, 20.0)
        )
        jumps.append(long[40] - long[39])
    assert np.std(jumps) == pytest.approx(np.sqrt(2 - 2 * np.exp(-1 / 20)), rel=0.1)
