"""Ships that the diagnosis was not made for: a ferry with four azimuths, a USV whose two propellers never turn."""

from functools import cache

import numpy as np
import pytest
from diagnose import ferry, twin, usv
from scipy.integrate import solve_ivp

import shipcosim as sc
from shipcosim.diagnose.extension.extend import extend
from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.diagnose.hypotheses.catalogue import hypotheses_of, read_catalogue
from shipcosim.diagnose.inference.linearisation import Regressor, advanced, linearise
from shipcosim.diagnose.log.checks.examine import examine
from shipcosim.diagnose.ship.dynamics import loads, motion_rates
from shipcosim.diagnose.ship.inputs import Inputs, first_motion, record_of
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.diagnose.ship.thrusters import dp_thruster_of
from shipcosim.models.core.motion import Motion

LOSS = ParameterEstimate(0.3, 0.02, "1")
NORTH_EAST = (("north", -9e3), ("east", 8e3))  # N
LEFT_TOE = usv.SIDES["left"][1]
short_ferry = cache(lambda: ferry.log(minutes=5.0))
short_usv = cache(lambda: usv.log(minutes=3.0))


@cache
def along(ship, log):
    """ShipModel of a system, record and motion of a log of her."""
    model = ship_model_of(ship().checked())
    record = record_of(log(), model)
    return model, record, first_motion(record)


def test_a_propeller_that_nothing_turns_pushes_where_the_system_points_it():
    model, record, _ = along(usv.structure, short_usv)
    assert model.thrusters == ["left", "right"] and model.azimuths == []
    assert not any("irection" in remark for remark in record.remarks)
    units = {"left": (10.0, LEFT_TOE), "right": (0.0, 0.0)}
    X, Y, N = loads(Motion(*np.zeros(6)), Inputs(0.0, units, None, None), model)["left"]
    np.testing.assert_allclose(record.units["left"][1], LEFT_TOE)
    assert X > 0.0 and pytest.approx(np.tan(LEFT_TOE)) == Y / X
    assert pytest.approx(-2.2 * Y + 0.7 * X) == N
    assert (dp_thruster_of(model, "left").axis, dp_thruster_of(model, "left").turns) == (
        LEFT_TOE,
        False,
    )


def test_a_propeller_that_nothing_turns_can_lose_thrust_astern_and_has_no_offset_of_direction():
    model, *_ = along(usv.structure, short_usv)
    labels = {hypothesis.label for hypothesis in hypotheses_of(read_catalogue(), model)}
    assert {"thrust_loss of left", "rpm_offset of right", "reverse_loss"} <= labels
    assert not {"azimuth_offset of left", "azimuth_offset of right"} & labels


def test_a_small_craft_is_moved_from_row_to_row_as_an_integrator_with_small_steps_moves_her():
    """Side forces of the propellers turn her away within a third of a row: one step of a row runs away."""
    model, record, motion = along(usv.structure, short_usv)
    rows = np.arange(40, 100, 10)
    found = np.stack(advanced(Motion(*(value[:-1] for value in motion)), record, model))[:, rows]
    right = np.stack([_integrated(motion, record, model, row) for row in rows], axis=-1)
    assert (np.abs(found - right) < [[2e-3], [2e-3], [1e-3], [5e-3], [2e-3], [1e-3]]).all()


def _integrated(motion, record, model, row):
    def rates(t, state):
        inputs = record.inputs(model, t)
        units = {name: tuple(series[row] for series in pair) for name, pair in inputs.units.items()}
        here = Inputs(inputs.time[row], units, inputs.wind_speed[row], inputs.wind_from[row])
        return np.array(motion_rates(Motion(*state), here, model)) * record.step

    return solve_ivp(rates, (0.0, 1.0), [value[row] for value in motion], rtol=1e-8, atol=1e-10).y[
        :, -1
    ]


def test_columns_of_a_small_craft_are_what_her_motion_changes_by():
    model, record, motion = along(usv.structure, short_usv)
    turns = [{"left.thrust_loss": 0.1}, {"hull.drag_scale": 0.5}, {"right.rpm_offset": 10.0}]
    linear = linearise(motion, record, model, [Regressor(changes) for changes in turns])
    start = Motion(*(value[:-1] for value in motion))
    for column, change in enumerate(turns, start=1):
        other = model.with_values({path: model.get(path) + by for path, by in change.items()})
        real = np.stack(advanced(start, record, other)) - np.stack(advanced(start, record, model))
        told = -np.moveaxis(linear.driven[:, :6, column], 0, -1)
        apart = np.sqrt(((real - told) ** 2).sum(1) / (real**2).sum(1))
        assert apart[3] < 0.3 and (
            column == 2 or apart[5] < 0.4
        )  # surge; yaw rate, which drag hardly changes


def test_a_ship_of_our_own_size_is_still_moved_by_one_step_a_row():
    record = record_of(twin.logs()["healthy"], twin.model())
    assert record.substeps(twin.model()) == 1
    assert record.substeps(along(usv.structure, short_usv)[0]) == 4


def test_the_slipstream_is_that_of_the_unit_which_the_system_wires():
    system = ferry.structure()
    for kind in ("azimuth", "rpm"):
        system.connect(f"aft_port.{kind}", f"fore_port.neighbour_{kind}")
    model = ship_model_of(system.checked())
    assert model.neighbours["fore_port"] == "aft_port"
    assert model.neighbours["fore_starboard"] == "fore_port"
    assert model.get("fore_port.neighbour_x") == -42.0


def test_what_no_set_says_is_known_in_proportion_to_the_ship():
    models = (
        ship_model_of(ferry.structure().checked()),
        along(usv.structure, short_usv)[0],
        twin.model(),
    )
    at = {"hull": ("fore_port", "ship"), "usv": ("left", "hull"), "ours": ("port", "vessel")}
    for model, (unit, vessel) in zip(models, at.values(), strict=True):
        known = 0.1 if model.vessel == "vessel" else 5e-4 * model.get(f"{unit}.rpm_max")
        assert model.tolerances[f"{unit}.rpm_offset"] == pytest.approx(known)
        length = model.get(f"{vessel}.length") / 33.9
        assert model.get("water.drift_yaw_arm") == pytest.approx(-1.5 * length)
        lever = next(
            s for s in hypotheses_of(read_catalogue(), model) if s.cause == "lever_arm"
        ).parameters[0]
        assert lever.typical == pytest.approx(4.0 * length, rel=1e-3)
    without = usv.structure()
    without.set("hull.N_vvv", -80.0)
    assert ship_model_of(without.checked()).tolerances["hull.N_vvv"] == pytest.approx(
        4.0
    )  # 5 %: ours has none


def test_the_wind_that_a_fast_craft_meets_is_no_fault_of_its_labels():
    assert examine(usv.log(minutes=12.0, seed=106)) == []


@pytest.mark.parametrize(
    "finding",
    [
        Finding(
            "tow",
            parameters={
                n: ParameterEstimate(v, 200.0, "N") for n, v in (("north", -12e3), ("east", 8e3))
            },
        ),
        Finding(
            "wave_drift",
            parameters={
                n: ParameterEstimate(v, 200.0, "N") for n, v in (("north", -9e3), ("east", 8e3))
            },
        ),
        Finding("thruster_interaction", parameters={"loss": LOSS}),
        Finding("thrust_loss", "aft_port", parameters={"loss": LOSS}),
    ],
    ids=lambda finding: finding.cause,
)
def test_the_ferry_with_a_cause_runs(finding, tmp_path):
    extension = extend(ferry.structure(), [finding], tmp_path)
    run = sc.simulate(
        sc.read(extension.ssp), stop_time=20.0, set={"fore_port_rpm": 60.0, "aft_port_rpm": 90.0}
    )
    assert np.isfinite(run["ship.x"].values).all() and run["ship.u"].values[-1] > 0.0
    if finding.cause == "wave_drift":
        assert extension.values["wave_drift.yaw_arm"] == pytest.approx(-1.5 * 96.0 / 33.9)
