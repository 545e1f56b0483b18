"""Logs of real craft through the whole diagnosis: no crash, figures of the error, time and memory.

The logs are no part of the project; without them these tests skip. What is asserted is what anybody can check in the
files themselves, never a cause that nobody knows.
"""

import resource
import time
from pathlib import Path

import numpy as np
import pandas
import pytest
from measured.logs import CHANNELS, FOLDERS, as_table

import shipcosim as sc
from shipcosim.diagnose.calibration_pipeline import calibrate
from shipcosim.diagnose.checked_log import checked
from shipcosim.diagnose.compared_log import compared
from shipcosim.diagnose.joint_pipeline import diagnose_jointly
from shipcosim.diagnose.log.checks.wind_jumps import jumping_wind
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.pipeline import read_measurements
from shipcosim.diagnose.replays import replay_log
from shipcosim.diagnose.validation.tracks import errors_of
from shipcosim.library import build_stale
from shipcosim.ssp import read_system

ROOT = Path(__file__).resolve().parents[3]
MEASURED = ROOT.parent / "shared" / "measured"
SPIN = ("blueboat", "run_224.csv.gz")


@pytest.fixture(scope="module")
def fmus():
    return build_stale(ROOT)


@pytest.fixture
def log(tmp_path):
    """Function from a craft and a file's name to the table, its channel file and the craft's system."""

    return lambda craft, name: place_of(craft, name, tmp_path)


def place_of(craft, name, folder):
    """The table of a log, which may lie in a folder, its channel file and the craft's system."""
    path = MEASURED / FOLDERS[craft] / name
    if not path.is_file():
        pytest.skip("needs the logs in ../shared/measured, which are not here")
    return as_table(path, folder), CHANNELS / f"{craft}.toml", ROOT / "ssp" / f"{craft}_open"


def diagnosed(table, channels, system, fmus):
    """A diagnosis, and what it took: printed with -s."""
    begun = time.perf_counter()
    found = sc.diagnose(table, read_system(system, fmus=[fmus]), channels=channels)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    named = ", ".join(finding.label for finding in found.findings) or "nothing"
    print(
        f"{table.name}: {found.verdict}, {named}; {time.perf_counter() - begun:.0f} s, {memory:.2f} GB so far"
    )
    return found


def has_figures(found):
    """Whether the errors of the simulation are stated, as numbers."""
    base, errors = found.baseline, errors_of(found.tracks)
    if not all(np.isfinite(base[key]).all() for key in ("position_error_m", "heading_error_deg")):
        return False
    return all(
        np.isfinite(errors[channel].values).all()
        for channel in ("position", "heading", "surge", "yaw_rate")
    )


@pytest.fixture(scope="module")
def spun(fmus, tmp_path_factory):
    """A log of a craft that spins, its channel file, her system, and the whole diagnosis."""
    table, channels, system = place_of(*SPIN, tmp_path_factory.mktemp("spin"))
    return table, channels, system, diagnosed(table, channels, system, fmus)


def test_a_log_goes_through_the_whole_diagnosis_and_its_thrusters_are_found_exchanged(spun):
    """The left thruster is at y = -0.285 m: more force there turns her to starboard, and in this spin to port."""
    table, *_, found = spun
    spin = pandas.read_csv(table)
    assert np.corrcoef(spin["left_force"] - spin["right_force"], spin["yaw_rate"])[0, 1] < -0.8
    assert has_figures(found)
    data = [(one.cause, one.channels) for one in found.findings if one.kind == "data"]
    assert data == [("channel_swap", ("left_thrust", "right_thrust"))]


def test_kvlcc2_zigzags_as_published_numbers_say(log, fmus):
    """Within half a length and 12 deg after 50 s, by numbers of another tank and nothing fitted."""
    table, channels, system = log("kvlcc2", "Z_35_05.dat.gz")
    errors = errors_of(
        replay_log(
            table, {"before": read_system(system, fmus=[fmus])}, channels, horizon=50.0
        ).tracks
    )
    assert float(errors["position"].max()) < 3.5 and float(errors["heading"].max()) < 12.0


def test_a_craft_is_learned_from_her_own_log_and_runs_as_a_system(spun, fmus, tmp_path):
    """Co-simulated, the extended system errs by less than half as much as the file's."""
    table, channels, system, found = spun
    given = read_system(system, fmus=[fmus])
    errors = found.craft.errors
    assert errors.after < 0.3 * errors.before and errors.after_deg < 0.3 * errors.before_deg
    # The sides of her thrusters are exchanged in the log.
    text = channels.read_text().replace("left_force", "?").replace("right_force", "left_force")
    put_right = tmp_path / "channels.toml"
    put_right.write_text(text.replace("?", "right_force"))
    systems = {"before": given, "after": found.extended}
    replayed = errors_of(replay_log(table, systems, put_right, horizon=3.0).tracks)
    before, after = (float(replayed["position"].sel(simulation=name)[-1]) for name in systems)
    assert after < 0.5 * before


def test_two_logs_together_teach_a_craft_that_predicts_each_from_the_other(log, fmus, tmp_path):
    thinned, (_, channels, system) = [], log(*SPIN)
    for name in ("run_224.csv.gz", "run_230.csv.gz"):
        table = pandas.read_csv(log("blueboat", name)[0])
        thinned.append(tmp_path / name.replace(".csv.gz", "_thinned.csv"))
        table.iloc[::3].to_csv(thinned[-1], index=False)
    found = diagnose_jointly(thinned, read_system(system, fmus=[fmus]), channels)
    gain = found.as_json()["gain"]
    assert gain["after_m"] < gain["before_m"] and found.craft.logs == 2


def test_calibration_to_logs_of_a_real_craft_makes_a_reference_that_predicts_each_from_the_others(
    log, fmus, tmp_path
):
    """It refused her as too far off, or made a reference that missed by more than the file's ship."""
    tables = [log("blueboat", f"run_{run}.csv.gz") for run in (224, 230)]
    system = read_system(tables[0][2], fmus=[fmus])
    made = calibrate([table for table, *_ in tables], system, tables[0][1], out=tmp_path)
    errors = [one.errors.position for one in made.logs]
    squares = [(one["before"][-1] ** 2, one["after"][-1] ** 2) for one in errors]
    before, after = np.sqrt(np.mean(squares, axis=0))
    assert not made.refusals and (tmp_path / "reference.json").is_file()
    assert after < 0.6 * before


@pytest.mark.parametrize("every", [1, 10])
def test_gusts_in_a_pond_are_no_wrong_labels_of_the_wind(every):
    """The wind channels are right in all of these logs; ten of eighteen were said to be wrong, at 0.99."""
    folder = MEASURED / "esso_osaka"
    if not folder.is_dir():
        pytest.skip("needs the logs in ../shared/measured, which are not here")
    for path in sorted(folder.glob("*.gz")):
        log = read_log(path, CHANNELS / "esso_osaka.toml").isel(time=slice(None, None, every))
        arrays = {name: log[name].values.astype(float) for name in (*log.data_vars, "time")}
        arrays["heading"] = np.degrees(np.unwrap(np.radians(arrays["heading"])))
        assert jumping_wind(arrays) == [], path.name


def test_thrusters_that_would_brake_the_craft_are_found_exchanged(log, fmus, tmp_path):
    """By the labels of this log, and of others at night, the two thrusters turn the boat against her rate of turn."""
    check_exchanged("run_223.csv.gz", 1, log, fmus, tmp_path)


def check_exchanged(name, stride, log, fmus, tmp_path):
    table, channels, system = log("blueboat", name)
    thinned = tmp_path / "thinned.csv"
    pandas.read_csv(table).iloc[::stride].to_csv(thinned, index=False)
    found = compared(
        checked(read_measurements(thinned, read_system(system, fmus=[fmus]), channels))
    )
    assert ("channel_swap", ("left_thrust", "right_thrust")) in [
        (fault.cause, fault.channels) for fault in found.faults
    ]


def test_of_a_thruster_whose_log_is_dead_the_other_one_gets_no_wrong_sign(log, fmus, tmp_path):
    table, channels, system = log("blueboat", "run_224.csv.gz")
    dead = tmp_path / "dead.csv"
    pandas.read_csv(table).assign(left_force=0.0).to_csv(dead, index=False)
    found = compared(checked(read_measurements(dead, read_system(system, fmus=[fmus]), channels)))
    assert not found.faults
