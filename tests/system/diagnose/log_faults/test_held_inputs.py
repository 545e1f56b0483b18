"""A thruster's channel that is held is a gap where the ship was driven otherwise, and none where the thruster stood."""

import numpy as np
import pytest
from diagnose import twin

from shipcosim.diagnose.checked_log import ReadLog
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.log_faults.corrections import with_measured_inputs
from shipcosim.diagnose.log_faults.held_inputs import held_inputs
from shipcosim.diagnose.pipeline import problem_of

FIRST, LAST = 120.0, 180.0  # s


def inside(log):
    """Rows in which a channel is held."""
    return (log["time"].values >= FIRST) & (log["time"].values <= LAST)


def with_noise(log):
    """A log whose thrusters are logged as instruments show them: with noise, to a tenth."""
    random = np.random.default_rng(1)
    for role in [role for role in log if role.endswith(("_rpm", "_azimuth"))]:
        values = np.round(log[role].values + 0.3 * random.normal(size=log.sizes["time"]), 1)
        log = log.assign({role: log[role].copy(data=values)})
    return log


def gaps(log):
    """Channels and segments of the gaps that the ship's response shows."""
    found = with_measured_inputs(problem_of(ReadLog(log, twin.model(), read_catalogue())))
    return [(fault.channels, *fault.segments) for fault in found.faults if fault.cause == "gap"]


@pytest.mark.parametrize(
    "channels, is_zero",
    [
        (("port_rpm",), True),
        (("tunnel_rpm",), False),
        (("starboard_rpm", "starboard_azimuth"), True),
    ],
)
def test_a_held_channel_that_the_ship_contradicts_is_a_gap(channels, is_zero):
    log = with_noise(twin.logs()["healthy"])
    here = inside(log)
    for role in channels:
        values = log[role].values
        held = 0.0 if is_zero else values[here][0]
        log = log.assign({role: log[role].copy(data=np.where(here, held, values))})
    assert gaps(log) == [(channels, (FIRST, LAST))]


@pytest.mark.parametrize("role, value", [("wind_speed", 0.0), ("wind_from", 40.0)])
def test_a_wind_that_never_changes_is_a_gap(role, value):
    log = with_noise(twin.logs()["healthy"])
    log = log.assign({role: log[role].copy(data=np.full(log.sizes["time"], value))})
    (found,) = gaps(log)
    assert found[0] == ("wind_speed", "wind_from")


def test_a_thruster_that_stands_still_is_no_gap(monkeypatch):
    commands = twin.commands

    def stopped(time, seed=0):
        units = commands(time, seed)
        speed, direction = units["port"]
        stands = (time >= FIRST) & (time <= LAST)
        return units | {"port": (np.where(stands, 0.0, speed), direction)}

    monkeypatch.setattr(twin, "commands", stopped)
    log = with_noise(twin.sailed({"healthy": {}})["healthy"])
    stands = np.where(inside(log), 0.0, log["port_rpm"].values)
    assert gaps(log.assign(port_rpm=log["port_rpm"].copy(data=stands))) == []


@pytest.mark.parametrize("speed, is_gap", [(3.0, False), (60.0, True)])
def test_the_direction_of_a_shaft_that_hardly_turns_may_be_held(speed, is_gap):
    """A unit that lost its power stops turning; its propeller windmills."""
    log = with_noise(twin.logs()["healthy"])
    here = inside(log)
    wobble = np.random.default_rng(2).normal(scale=0.5, size=log.sizes["time"])
    rpm = np.where(here, speed + wobble, log["port_rpm"].values)
    azimuth = np.where(here, 12.0, log["port_azimuth"].values)
    log = log.assign(
        port_rpm=log["port_rpm"].copy(data=rpm),
        port_azimuth=log["port_azimuth"].copy(data=azimuth),
        logged_time=log["time"],
    )
    channels = {finding.channels for finding in held_inputs(log, twin.model())}
    assert (("port_azimuth",) in channels) == is_gap


@pytest.mark.parametrize("speed, is_gap", [(5.0, False), (8.0, True)])
def test_the_wind_of_her_own_way_in_calm_air_may_stay_the_same(speed, is_gap):
    """Straight ahead at 5 m/s: a wind of 5 m/s from ahead is calm air, one of 8 m/s would have varied."""
    log = with_noise(twin.logs()["healthy"])
    values = {"surge": 5.0, "sway": 0.0, "wind_speed": speed, "wind_from": 0.0}
    constant = {
        role: log[role].copy(data=np.full(log["time"].size, v)) for role, v in values.items()
    }
    log = log.assign(constant).assign(logged_time=log["time"])
    channels = {finding.channels for finding in held_inputs(log, twin.model())}
    assert (("wind_speed", "wind_from") in channels) == is_gap
    assert is_gap or not any("wind_from" in some for some in channels)
