"""Replays of a log, of a run as a log, and of what a diagnosis extended."""

import numpy as np
import pytest
from diagnose import twin

import shipcosim as sc
from shipcosim.diagnose.extension.extend import extend
from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.diagnose.log.runs import run_as_log
from shipcosim.diagnose.replays import replay_log
from shipcosim.diagnose.validation.tracks import errors_of
from shipcosim.errors import ShipcosimError
from shipcosim.series import make_table, write_table
from shipcosim.ssp import read_system, with_values

ROOT = twin.ROOT


@pytest.fixture(scope="module")
def tanker():
    return read_system(ROOT / "ssp" / "kvlcc2_open", fmus=[twin.build_stale(ROOT)])


@pytest.fixture(scope="module")
def run(tanker):
    """Two minutes of KVLCC2 with her rudder from side to side."""
    time = np.arange(0.0, 121.0, 0.5)
    rudder = 15.0 * np.sign(np.sin(2.0 * np.pi * time / 60.0))
    columns = [
        ("propeller_rpm", np.full(time.size, 610.0), "rpm", ""),
        ("propeller_azimuth", rudder, "deg", ""),
    ]
    begun = with_values(tanker, {"vessel.u_start": 1.0})
    done = sc.simulate(
        begun, stop_time=120.0, step_size=0.1, output_interval=0.5, inputs=make_table(time, columns)
    )
    return done.table


def test_a_run_read_as_a_log_has_the_roles_of_its_signals(run):
    log = run_as_log(run, "vessel", ["propeller"])
    assert {"north", "heading", "surge", "wind_speed", "propeller_rpm", "propeller_azimuth"} <= set(
        log.data_vars
    )
    assert (
        log["heading"].attrs["units"] == "rad" and log["propeller_azimuth"].attrs["units"] == "deg"
    )
    np.testing.assert_array_equal(
        log["north"].values, run["vessel.x"].values + run["vessel.x_wave"].values
    )


def test_a_log_of_any_other_form_is_left_as_it_is(run):
    log = run_as_log(run, "vessel", [])
    assert run_as_log(log, "vessel", []) is log


def test_a_run_of_another_ship_says_what_is_missing(run):
    with pytest.raises(
        ShipcosimError, match=r"no x, y, psi of 'hull'.*Its components: .*vessel.*--system"
    ):
        run_as_log(run, "hull", [])


def test_a_run_replayed_by_its_own_system_is_the_run(run, tanker):
    """0.5 m of 29 m: she starts from smoothed values, and her rudder jumps within a row, which a log does not tell."""
    tracks = replay_log(run, {"before": tanker}).tracks
    errors = errors_of(tracks)
    assert tracks.horizon > 25.0 and tracks.predicted["before"].sizes["segment"] == 4
    assert float(errors["position"].max()) < 0.5 and float(errors["heading"].max()) < 3.0


def test_a_log_from_a_file_is_replayed_with_another_parameter_set_beside(run, tanker, tmp_path):
    write_table(run, tmp_path / "result.nc")
    weak = with_values(tanker, {"propeller.lift_gradient": 1.4})
    found = errors_of(
        replay_log(tmp_path / "result.nc", {"before": weak, "after": tanker}, horizon=30.0).tracks
    )
    before, after = (
        float(found["heading"].sel(simulation=name).isel(after=-1)) for name in ("before", "after")
    )
    assert after < 3.0 < before


def test_instruments_of_an_extended_system_are_taken_off_its_start_and_put_on_what_it_shows(
    run, tanker, tmp_path
):
    """An antenna 3 m ahead: the plain ship is 3 m off in part of the circle, the extended one is not."""
    log = run_as_log(run, "vessel", ["propeller"])
    psi, r = np.radians(1.0) * 0.0 + run["vessel.psi"].values, run["vessel.r"].values
    moved = log.assign(
        north=log["north"] + 3.0 * np.cos(psi),
        east=log["east"] + 3.0 * np.sin(psi),
        sway=log["sway"] + 3.0 * r,
    )
    for name in ("north", "east", "sway"):
        moved[name].attrs = dict(log[name].attrs)
    arm = {"x": ParameterEstimate(3.0, 0.1, "m"), "y": ParameterEstimate(0.0, 0.1, "m")}
    extended = extend(
        ROOT / "ssp" / "kvlcc2_open", [Finding("lever_arm", parameters=arm)], tmp_path
    )
    after = read_system(str(extended.ssp))
    found = errors_of(replay_log(moved, {"before": tanker, "after": after}, horizon=30.0).tracks)[
        "position"
    ]
    before, after = (
        float(found.sel(simulation=name).isel(after=1)) for name in ("before", "after")
    )
    assert after < 0.3 < before


def test_a_log_without_a_whole_stretch_is_refused(run, tanker):
    with pytest.raises(ShipcosimError, match="no 500 s of the log"):
        replay_log(run, {"before": tanker}, horizon=500.0)


@pytest.mark.parametrize(
    "name", ["result.nc", "result.csv", "none.csv", "broken.nc", "broken.csv.gz"]
)
def test_of_a_file_only_the_names_are_read_before_it_is_known_to_be_a_run(name, tmp_path):
    """A file that cannot be read is left to the reader, which says what is wrong with it."""
    path = tmp_path / name
    if name.startswith("result"):
        signals = "vessel.x", "vessel.u", "barge.x", "barge.y", "barge.psi"
        write_table(
            make_table(np.arange(3.0), [(name, np.arange(3.0), "m", "") for name in signals]), path
        )
        with pytest.raises(ShipcosimError, match="no y, psi of 'vessel'"):
            run_as_log(path, "vessel", [])
    else:
        if "broken" in name:
            path.write_bytes(b"\x1f\x8bnothing")
        assert run_as_log(path, "vessel", []) == path
