"""Channels of thrusters and wind that are not what they are labelled are told by the ship's answer, and where."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose import twin

from shipcosim.diagnose.log.mislabels import WIND_LABELS, finding_of
from shipcosim.diagnose.log_faults.input_labels import (
    WHERE_TO,
    best_run,
    suspected_inputs,
    with_label,
    with_refined_segment,
)

KNOTS = next(label for label in WIND_LABELS if "in kn," in label.sentence)
FIRST, LAST = 120.0, 260.0


def changed(channels, part=True):
    """The healthy log with other values in some channels, in a part or throughout."""
    log = twin.logs()["healthy"]
    time = log["time"].values
    here = (time >= FIRST) & (time <= LAST) | (not part)
    return log.assign(
        {
            role: ("time", np.where(here, values, log[role].values))
            for role, values in channels.items()
        }
    )


def best(log):
    finding = suspected_inputs(log, twin.ready(log))[0]
    return finding, with_label(log, finding.mislabel, finding.segments)


def test_a_tunnel_of_the_other_sign_is_found_in_its_part_of_the_log():
    healthy = twin.logs()["healthy"]
    finding, right = best(changed({"tunnel_rpm": -healthy["tunnel_rpm"].values}))
    assert (finding.cause, finding.channels, finding.kind) == ("sign", ("tunnel_rpm",), "data")
    ((first, last),) = finding.segments
    assert abs(first - FIRST) < 20.0 and abs(last - LAST) < 20.0
    time = healthy["time"].values
    inner = (time > FIRST + 20.0) & (time < LAST - 20.0)
    np.testing.assert_array_equal(
        right["tunnel_rpm"].values[inner], healthy["tunnel_rpm"].values[inner]
    )


def test_the_ends_of_a_segment_are_settled_to_a_few_rows():
    """From ends that are half a minute off, about the motion that the log tells of with those."""
    log = changed({"tunnel_rpm": -twin.logs()["healthy"]["tunnel_rpm"].values})
    finding = suspected_inputs(log, twin.ready(log))[0]
    finding = replace(finding, segments=((FIRST + 25.0, LAST - 30.0),))
    for _ in range(2):
        right = with_label(log, finding.mislabel, finding.segments)
        finding = with_refined_segment(log, finding, twin.ready(right))
    ((first, last),) = finding.segments
    assert abs(first - FIRST) <= 4.0 and abs(last - LAST) <= 4.0


@pytest.mark.parametrize("part", [True, False], ids=["in a part", "throughout"])
def test_what_is_told_throughout_is_settled_to_the_part_where_it_is_so(part):
    log = changed(
        {"wind_speed": 3600.0 / 1852.0 * twin.logs()["healthy"]["wind_speed"].values}, part
    )
    told = finding_of(KNOTS, 0.99)
    found = with_refined_segment(log, told, twin.ready(with_label(log, KNOTS)))
    np.testing.assert_allclose(found.segments, [(FIRST, LAST)] if part else np.zeros(0), atol=10.0)


def test_a_tunnel_of_the_other_sign_throughout_has_no_segment():
    healthy = twin.logs()["healthy"]
    finding, right = best(changed({"tunnel_rpm": -healthy["tunnel_rpm"].values}, part=False))
    assert (finding.cause, finding.channels, finding.segments) == ("sign", ("tunnel_rpm",), ())
    np.testing.assert_array_equal(right["tunnel_rpm"].values, healthy["tunnel_rpm"].values)


def test_swapped_twins_are_found_by_their_channels():
    healthy = twin.logs()["healthy"]
    pairs = [(f"port_{what}", f"starboard_{what}") for what in ("rpm", "azimuth")]
    pairs += [pair[::-1] for pair in pairs]
    finding, right = best(
        changed({role: healthy[other].values for role, other in pairs}, part=False)
    )
    assert finding.cause == "channel_swap"
    assert set(finding.channels) == {role for pair in pairs for role in pair}
    for role in finding.channels:
        np.testing.assert_array_equal(right[role].values, healthy[role].values)


def test_a_wind_direction_that_is_where_the_wind_goes_is_found():
    healthy = twin.logs()["healthy"]["wind_from"].values
    finding, right = best(changed({"wind_from": np.mod(healthy + 180.0, 360.0)}, part=False))
    assert (finding.cause, finding.note, finding.segments) == ("frame", WHERE_TO.sentence, ())
    np.testing.assert_allclose(right["wind_from"], np.mod(healthy, 360.0))


def test_the_late_channel_of_one_thruster_is_found():
    speed = twin.logs()["healthy"]["starboard_rpm"].values
    finding, _ = best(changed({"starboard_rpm": np.r_[speed[:6], speed[:-6]]}, part=False))
    assert (finding.cause, finding.channels) == ("channel_lag", ("starboard_rpm",))
    assert "6.0 s later" in finding.note


@pytest.mark.parametrize("name", ["healthy", "thrust_loss"])
def test_right_channels_are_not_suspected(name):
    assert suspected_inputs(twin.logs()[name], twin.ready(twin.logs()[name])) == []


def test_a_channel_without_values_in_a_few_rows_is_not_taken_for_late():
    """Moved in time its rows would all have values, and each row makes a log likelier."""
    log = twin.logs()["healthy"]
    speed = log["tunnel_rpm"].values.copy()
    for first in (60, 180, 181, 182, 300, 301):
        speed[first] = np.nan
    log = log.assign(tunnel_rpm=("time", speed))
    assert suspected_inputs(log, twin.ready(log)) == []


def test_thebest_run_is_the_one_of_all_runs_that_adds_up_to_most():
    gain = np.random.default_rng(0).normal(-0.1, 1.0, 80)
    runs = {(a, b): gain[a : b + 1].sum() for a in range(80) for b in range(a + 9, 80)}
    first, last, total = best_run(gain, 10)
    assert (first, last) == max(runs, key=runs.get) and total == pytest.approx(max(runs.values()))
