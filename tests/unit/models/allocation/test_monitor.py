"""The monitor against hand-made commands and feedbacks."""

from math import pi

from shipcosim.models.allocation.monitor import MonitorParameters, alarms, at_rest, deviation, step

LIMITS = MonitorParameters()
WELL = {"thrusts": (10e3, 10e3)}
H = 0.5


def watched(seconds, port=WELL, state=None, errors=(0.0, 0.0), bias=(0.0, 0.0), runs=True):
    """State after some time in which port's commands and feedbacks are these and the others are well."""
    tolerances = {
        "thrust_tolerance": LIMITS.azimuth_thrust_tolerance,
        "azimuth_tolerance": LIMITS.azimuth_tolerance,
    }
    deviations, state = (deviation(**port, **tolerances), 0.0, 0.0), state or at_rest()
    for _ in range(round(seconds / H)):
        state = step(state, deviations, (runs, True, True), errors, bias, H, parameters=LIMITS)
    return state


def said(state):
    return [name for name, on in alarms(state, parameters=LIMITS)._asdict().items() if on]


def test_a_difference_within_the_tolerance_is_no_fault():
    assert (
        said(watched(600.0, {"thrusts": (10e3, 12.9e3), "azimuths": (0.0, 9.0 * pi / 180.0)})) == []
    )


def test_a_unit_off_its_command_is_faulty_after_the_delay_and_stays_so():
    off = {"thrusts": (10e3, 14e3)}
    assert said(watched(LIMITS.fault_delay - H, off)) == []
    state = watched(LIMITS.fault_delay, off)
    assert said(state) == ["port"]
    assert said(watched(60.0, state=state, runs=False)) == ["port"]


def test_a_shorter_difference_is_forgotten():
    off = WELL | {"azimuths": (0.0, 1.0)}
    state = watched(H, state=watched(LIMITS.fault_delay - H, off))
    assert said(watched(LIMITS.fault_delay - H, off, state)) == []


def test_a_unit_without_power_is_no_fault():
    assert said(watched(60.0, {"thrusts": (10e3, 0.0)}, runs=False)) == []


def test_directions_are_compared_the_shorter_way_round():
    assert said(watched(60.0, WELL | {"azimuths": (pi - 0.01, -pi + 0.01)})) == []


def test_alarms_of_the_ship_come_after_their_delay_and_go():
    for kind, away in (
        ("position", {"errors": (5.1, 0.0)}),
        ("heading", {"errors": (0.0, -0.2)}),
        ("force", {"bias": (30e3, 30e3)}),
    ):
        assert said(watched(LIMITS.alarm_delay - H, **away)) == []
        state = watched(LIMITS.alarm_delay, **away)
        assert said(state) == [kind]
        assert said(watched(H, state=state)) == []
