"""A clock that runs wrong while a ship keeps still is told by how she answers, at its rate; a right one is not."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose import twin

import shipcosim as sc
from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.diagnose.inference.fitting import prepared
from shipcosim.diagnose.log.repair import repaired
from shipcosim.diagnose.log.rows import inside
from shipcosim.diagnose.log_faults import clock as timing
from shipcosim.diagnose.log_faults.clock import clock_by_response, is_testable, settled_clock
from shipcosim.diagnose.log_faults.corrections import with_right_clock
from shipcosim.diagnose.pipeline import problem_of, read_measurements

FIRST, LAST, RATE = 150.0, 300.0, 1.3


def hurried(log, segments=((FIRST, LAST),)):
    """The log as a clock writes it that counts a second in some segments of its own time while RATE pass."""
    time = log["time"].values
    pace = np.where(inside(time[1:], segments), RATE, 1.0)
    true = np.r_[0.0, np.cumsum(pace * np.diff(time))] + time[0]
    rows = true <= time[-1]
    table = {str(name): np.interp(true[rows], time, log[name].values) for name in log.data_vars}
    for name in ("heading", "wind_from"):
        table[name] = np.mod(
            np.interp(true[rows], time, np.unwrap(log[name].values, period=360.0)), 360.0
        )
    return log.isel(time=rows).assign(
        {name: ("time", values, log[name].attrs) for name, values in table.items()}
    )


def test_a_right_clock_is_not_suspected():
    log = twin.logs()["healthy"]
    assert clock_by_response(twin.ready(log)) is None


def test_swell_that_the_thrusters_work_against_is_no_wrong_clock():
    """Her speed answers less than modelled, since the waves push; how far she comes at it is right."""
    swell = {
        "environment.wind_speed": 3.0,
        "environment.significant_wave_height": 0.5,
        "environment.peak_period": 6.0,
        "environment.seed": 11,
    }
    run = sc.run("stationkeeping", set=swell, stop_time=450.0).table
    problem = problem_of(read_measurements(run, sc.read("gunnerus_open").checked()))
    assert with_right_clock(problem).faults == ()


def test_a_clock_that_is_slow_for_a_while_is_found_with_its_rate():
    log = hurried(twin.logs()["healthy"])
    finding = clock_by_response(twin.ready(log))
    assert (finding.cause, finding.channels) == ("clock", ("time",))
    ((first, last),) = finding.segments
    assert abs(first - FIRST) < 20.0 and abs(last - LAST) < 20.0
    right = repaired(log, [finding])
    settled = settled_clock(twin.ready(right), finding, right).parameters["rate"]
    assert settled.estimate == pytest.approx(RATE, abs=0.05)


def test_two_segments_of_a_slow_clock_are_not_taken_for_one_with_what_is_between():
    log = hurried(twin.logs()["healthy"], ((180.0, 260.0), (325.0, 400.0)))
    first, second = clock_by_response(twin.ready(log)).segments
    np.testing.assert_allclose((*first, second[0]), (180.0, 260.0, 325.0), atol=15.0)


def test_a_clock_is_testable_where_the_ship_moves_and_not_where_nothing_happens():
    problem = twin.ready(twin.logs()["healthy"])
    assert is_testable(problem)
    motion = problem.motion
    still = motion._replace(**{name: 0.0 * getattr(motion, name) for name in ("u", "v", "r")})
    units = {name: (0.0 * speed, angle) for name, (speed, angle) in problem.record.units.items()}
    calm = replace(
        problem.record, units=units, wind=tuple(0.0 * series for series in problem.record.wind)
    )
    assert not is_testable(replace(problem, motion=still, record=calm))


def test_a_compass_that_deviates_with_the_heading_is_no_clock():
    """While she turns it tells of more or less turning, as a wrong clock would; her way goes on at the right rate."""
    log = twin.logs()["healthy"]
    heading = log["heading"].values
    deviated = np.mod(heading + 15.0 * np.sin(np.radians(heading)), 360.0)
    problem = twin.ready(log.assign(heading=("time", deviated, log["heading"].attrs)))
    # Beside the noise of the log without the deviation, as its own hides such a clock.
    problem = prepared(replace(problem, noise=twin.ready(log).noise))
    gain, finding = timing._most_likely(
        timing._blocks(problem, timing._edges(problem), problem.ship_columns(()))
    )
    assert gain > 30.0 and finding.cause == "clock"
    assert (
        not timing._all_aspects_agree(problem, finding, problem.ship_columns(()))
        and clock_by_response(problem) is None
    )


def test_thrusters_that_push_less_for_a_while_are_no_clock():
    """The speed answers at another rate then, but she comes as far at her speed as before."""
    log = twin.logs()["healthy"]
    here = (log["time"].values > FIRST) & (log["time"].values < LAST)
    told = {
        role: ("time", np.where(here, 1.25, 1.0) * log[role].values)
        for role in log.data_vars
        if "_rpm" in role
    }
    clock = Finding(
        "clock",
        None,
        "data",
        0.98,
        {"rate": ParameterEstimate(0.8, 0.02, "1")},
        ((FIRST, LAST),),
        ("time",),
    )
    problem = twin.ready(log.assign(told))
    assert not timing._all_aspects_agree(problem, clock, problem.ship_columns(()))
    slow, told = twin.ready(hurried(log)), {"rate": ParameterEstimate(RATE, 0.02, "1")}
    assert timing._all_aspects_agree(slow, replace(clock, parameters=told), slow.ship_columns(()))
