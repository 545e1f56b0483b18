"""The monitor against hand-made commands and feedbacks."""

from math import pi

from shipcosim.models.allocation.monitor import MonitorParameters, Unit, alarms, at_rest, step

LIMITS = MonitorParameters()
WELL = Unit(10e3, 10e3, 0.0, 0.0, True)
H = 0.5


def watched(seconds, port=WELL, state=None, errors=(0.0, 0.0), bias=(0.0, 0.0)):
    state = state or at_rest()
    for _ in range(round(seconds / H)):
        state = step(state, (port, WELL, WELL), errors, bias, H, parameters=LIMITS)
    return state


def said(state):
    return [name for name, on in alarms(state, parameters=LIMITS)._asdict().items() if on]


def test_a_difference_within_the_tolerance_is_no_fault():
    assert said(watched(600.0, WELL._replace(thrust_feedback=12.9e3, azimuth_feedback=9.0 * pi / 180.0))) == []


def test_a_unit_off_its_command_is_faulty_after_the_delay_and_stays_so():
    off = WELL._replace(thrust_feedback=14e3)
    assert said(watched(LIMITS.fault_delay - H, off)) == []
    state = watched(LIMITS.fault_delay, off)
    assert said(state) == ["port"]
    assert said(watched(60.0, WELL._replace(available=False), state)) == ["port"]


def test_a_shorter_difference_is_forgotten():
    off = WELL._replace(azimuth_feedback=1.0)
    state = watched(H, state=watched(LIMITS.fault_delay - H, off))
    assert said(watched(LIMITS.fault_delay - H, off, state)) == []


def test_a_unit_without_power_is_no_fault():
    assert said(watched(60.0, WELL._replace(thrust_feedback=0.0, available=False))) == []


def test_directions_are_compared_the_shorter_way_round():
    assert said(watched(60.0, WELL._replace(azimuth_cmd=pi - 0.01, azimuth_feedback=-pi + 0.01))) == []


def test_alarms_of_the_ship_come_after_their_delay_and_go():
    for kind, away in (
        ("position", {"errors": (3.1, 0.0)}),
        ("heading", {"errors": (0.0, -0.1)}),
        ("force", {"bias": (30e3, 30e3)}),
    ):
        assert said(watched(LIMITS.alarm_delay - H, **away)) == []
        state = watched(LIMITS.alarm_delay, **away)
        assert said(state) == [kind]
        assert said(watched(H, state=state)) == []
