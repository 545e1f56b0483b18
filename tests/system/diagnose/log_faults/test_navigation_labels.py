"""Labels of the navigation are told by the ship's answer where position against velocity is mistaken about them."""

from dataclasses import replace

import numpy as np
from diagnose import twin

from shipcosim.diagnose.log.mislabels import POSITION_LABELS, finding_of, negative
from shipcosim.diagnose.log_faults.navigation_labels import _matters, relabelled


def test_another_label_than_was_found_first_is_taken():
    """East was mirrored; what was undone is a swap of surge and sway."""
    healthy = twin.logs()["healthy"]
    log = healthy.assign(east=("time", -healthy["east"].values, healthy["east"].attrs))
    swap = next(
        label
        for label in POSITION_LABELS
        if label.channels == ("surge", "sway") and label.scale is None
    )
    better, *_ = relabelled(log, [finding_of(swap, 1.0)], twin.ready(healthy))
    assert [(fault.cause, fault.channels, fault.segments) for fault in better.faults] == [
        ("sign", ("east",), ())
    ]


def test_a_label_that_position_and_velocity_left_open_is_answered():
    """East was mirrored, or surge and sway swapped, or another part is: her answer tells, and nothing stays open."""
    healthy = twin.logs()["healthy"]
    log = healthy.assign(east=("time", -healthy["east"].values, healthy["east"].attrs))
    east = finding_of(negative("east"), 0.25)
    still = replace(finding_of(negative("yaw_rate"), 0.3), mislabel=None, alternatives=("another",))
    left_open = replace(east, mislabel=None, alternatives=("surge and sway are swapped",))
    swap = next(
        label
        for label in POSITION_LABELS
        if label.channels == ("surge", "sway") and label.scale is None
    )
    faults = [left_open, still, finding_of(swap, 1.0)]
    better, *_ = relabelled(log, faults, twin.ready(healthy))
    assert better.faults == (still, finding_of(negative("east"), better.faults[-1].probability))


def test_what_was_found_rightly_stays():
    healthy = twin.logs()["healthy"]
    log = healthy.assign(east=("time", -healthy["east"].values, healthy["east"].attrs))
    assert relabelled(log, [finding_of(negative("east"), 1.0)], twin.ready(healthy)) == []


def test_units_stretch_the_density_of_their_channels():
    healthy = twin.logs()["healthy"]
    knots = {role: 3600.0 / 1852.0 for role in ("surge", "sway")}
    log = healthy.assign(
        {r: ("time", k * healthy[r].values, healthy[r].attrs) for r, k in knots.items()}
    )
    problem = twin.ready(healthy)
    loud = replace(
        problem,
        noise=replace(problem.noise, white=problem.noise.white * [1, 1, 1, 1.944, 1.944, 1]),
    )
    swap = next(label for label in POSITION_LABELS if label.cause == "channel_swap")
    better, *_ = relabelled(log, [finding_of(swap, 1.0)], loud)
    assert better.faults[0].note == "surge and sway are in kn, not m/s"
    rows = 2 * np.isfinite(healthy["surge"].values).sum()
    np.testing.assert_allclose(better.density, -rows * np.log(3600.0 / 1852.0), rtol=1e-6)


def test_near_north_earth_fixed_is_body_fixed_and_no_fault():
    healthy = twin.logs()["healthy"]
    earth = next(label for label in POSITION_LABELS if "velocity towards north" in label.sentence)
    for heading, matters in ((20.0, False), (90.0, True)):
        kept = healthy.assign(
            heading=("time", np.full(healthy.sizes["time"], heading), healthy["heading"].attrs)
        )
        assert _matters(kept, earth) is matters
    assert _matters(kept, negative("surge"))


def test_rows_without_known_inputs_name_no_unit(monkeypatch):
    """Nothing predicts such a row, so that a unit gained there by its factor alone: velocities in m/s, not kn."""
    commands = twin.commands
    monkeypatch.setattr(twin, "WIND", (0.0, 2.0))
    monkeypatch.setattr(
        twin,
        "commands",
        lambda time, seed: {
            name: (0.0 * speed, direction)
            for name, (speed, direction) in commands(time, seed).items()
        },
    )
    log = twin.sailed({"healthy": {}})["healthy"]
    lost = (log["time"].values > 100.0) & (log["time"].values < 300.0)
    speed = np.where(lost, np.nan, log["wind_speed"].values)
    log = log.assign(wind_speed=log["wind_speed"].copy(data=speed))
    assert relabelled(log, (), twin.ready(log)) == []
