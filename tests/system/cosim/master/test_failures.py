"""What goes wrong is said with component and time, and the rows before it are kept."""

import gc
import json
import os
import sys
import tempfile
import zipfile

import numpy as np
import pytest

from shipcosim.cosim import Interrupted, RunError, RunOptions, simulate
from shipcosim.errors import ShipcosimError


@pytest.fixture
def failing(make_system):
    """Function: a system with a component that fails in a way."""
    return lambda how: make_system({"clock": "clock", "engine": ("failing", {"how": how})})


def traces():
    temporary = [
        name for name in os.listdir(tempfile.gettempdir()) if name.startswith("shipcosim-")
    ]
    return temporary, [entry for entry in sys.path if "shipcosim-" in entry]


def test_exception_in_a_step_arrives_with_component_time_and_traceback(failing, make_scenario):
    with pytest.raises(RunError) as error:
        simulate(failing("raise"), make_scenario(1.0, 0.1))
    said = str(error.value)
    assert said.startswith("engine: failed in the step from t = 0.5 s.")
    assert (
        "ValueError: 50%s of it is wrong" in said
        and "Traceback" in said
        and "failing.py" in said
        and "\\n" not in said
    )
    table = error.value.table
    assert (
        table.time.values[-1] == 0.5
        and table["clock.count"].values[-1] == 5
        and table.attrs["complete"] == 0
    )


def test_exception_at_the_start_arrives_too(failing, make_scenario):
    with pytest.raises(
        RunError, match="(?s)engine: failed at the start.*50%s of the start is wrong"
    ) as error:
        simulate(failing("start"), make_scenario(1.0, 0.1))
    assert error.value.table.sizes["time"] == 0


def test_nan_is_named_with_component_variable_and_time(pythonfmu_system, make_scenario):
    with pytest.raises(RunError, match=r"stock\.y: is nan at t = 0\.6 s"):
        simulate(pythonfmu_system("float('nan') if t > 0.45 else t"), make_scenario(1.0, 0.1))


def test_percent_signs_in_a_stock_fmus_message_do_no_harm(pythonfmu_system, make_scenario):
    with pytest.raises(RunError, match=r"(?s)stock: failed.*100%s %n wrong"):
        simulate(pythonfmu_system("int('100%s %n wrong')"), make_scenario(1.0, 0.1))


def test_warnings_of_an_fmu_stay_with_the_table(failing, make_scenario):
    table = simulate(failing("warn"), make_scenario(0.6, 0.1))
    assert json.loads(table.attrs["remarks"]) == ["engine at t = 0.5 s: 100% full"]


def test_ctrl_c_inside_an_fmu_stops_the_run_and_keeps_its_rows(failing, make_scenario):
    with pytest.raises(Interrupted) as interrupted:
        simulate(failing("stop"), make_scenario(1.0, 0.1))
    table = interrupted.value.table
    assert np.allclose(table.time, np.arange(7) * 0.1) and table.attrs["complete"] == 0
    assert table["clock.count"].values.tolist() == list(range(7))


def test_interrupt_in_the_progress_display_keeps_the_rows(failing, make_scenario):
    def progress(done, total):
        raise KeyboardInterrupt

    with pytest.raises(Interrupted) as interrupted:
        simulate(failing("nothing"), make_scenario(1.0, 0.1), RunOptions(progress=progress))
    assert interrupted.value.table.sizes["time"] == 1


@pytest.mark.parametrize("how", ["nothing", "raise", "start", "stop"])
def test_nothing_is_left_behind(failing, make_scenario, how, tmp_path, monkeypatch):
    """In a folder for temporary files that no other process uses."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    system, before = failing(how), traces()
    try:
        simulate(system, make_scenario(1.0, 0.1))
    except (ShipcosimError, Interrupted):
        pass
    gc.collect()
    assert traces() == before


def test_binary_for_another_platform_is_said(make_system, make_scenario, tmp_path):
    system = make_system({"clock": "clock"})
    path = system.components["clock"].fmu.path
    (tmp_path / "resources").mkdir(exist_ok=True)
    with (
        zipfile.ZipFile(path) as old,
        zipfile.ZipFile(tmp_path / "resources" / "clock.fmu", "w") as new,
    ):
        for entry in old.infolist():
            name = entry.filename.replace("binaries/linux64", "binaries/vax").replace(
                "binaries/win64", "binaries/vms"
            )
            new.writestr(name, old.read(entry))
    foreign = make_system({"clock": "clock"})
    with pytest.raises(RunError, match=r"cannot be started.*It has: binaries/vax/clock.so, .*vms"):
        simulate(foreign, make_scenario())


def test_missing_fmu_is_an_error_before_anything_runs(make_system, make_scenario, tmp_path):
    make_system({"clock": "clock"})
    with pytest.raises(ShipcosimError, match=r"clock\.fmu"):
        simulate(tmp_path / "SystemStructure.ssd", make_scenario())


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"step_size": 0.3}, "stop_time = 1 s is no multiple of the step size 0.3 s"),
        ({"output_interval": 0.25}, "output_interval = 0.25 s is no multiple"),
        ({"set": {"clock.cuont": 1}}, "Did you mean 'count'"),
        ({"set": {"engine.when": "soon"}}, "'soon' is no Real"),
        ({"expect": [{"signal": "engine.yy", "at_least": 0.0}]}, "engine has no variable 'yy'"),
        ({"expect": [{"signal": "engine.when", "at_least": 0.0}]}, "'engine.when' is not recorded"),
    ],
)
def test_scenarios_that_do_not_fit_are_refused(failing, make_scenario, more, said):
    with pytest.raises(ShipcosimError, match=said):
        simulate(failing("nothing"), make_scenario(**{"stop_time": 1.0, "step_size": 0.1} | more))


def test_step_of_a_component_has_to_fit(make_system, make_scenario):
    with pytest.raises(
        ShipcosimError, match=r"slow: its step of 0.25 s is no multiple of the step size 0.1 s"
    ):
        simulate(make_system({"slow": ("clock", {}, 0.25)}), make_scenario(1.0, 0.1))
    with pytest.raises(
        ShipcosimError, match=r"slow: its step of 0.3 s does not divide the run's 1 s"
    ):
        simulate(make_system({"slow": ("clock", {}, 0.3)}), make_scenario(1.0, 0.1))


def test_modules_of_one_name_in_two_stock_fmus_run_their_own_code(pythonfmu_system, make_scenario):
    system = pythonfmu_system("helper.VALUE", "VALUE = 1.0", "VALUE = 2.0")
    for _ in range(2):
        table = simulate(system, make_scenario(0.2, 0.1))
        assert (float(table["stock.y"][-1]), float(table["other.y"][-1])) == (1.0, 2.0)
