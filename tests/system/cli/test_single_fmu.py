"""One FMU runs by itself, of every version and form: its inputs from a table, its parameters set."""

import c_fmus
import numpy as np
import pytest
from conformance.c_parts import build_c
from conformance.fmus import build_part

import shipcosim as sc
from shipcosim.cli.commands.simulate import simulate
from shipcosim.series import read_table
from shipcosim.ssp import read_system, settings_of_one, with_values


def test_it_runs_on_inputs_of_a_table_with_a_value_set(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "inputs.csv").write_text(
        "time [s],u [m]\n" + "".join(f"{0.25 * i},{i}\n" for i in range(9))
    )
    simulate(
        str(build_part("gain")),
        2.0,
        0.25,
        inputs="inputs.csv",
        settings=["factor=3"],
        out=tmp_path / "out",
    )
    table = read_table(tmp_path / "out" / "result.nc")
    assert table["gain.y"].values == pytest.approx(3.0 * np.maximum(np.arange(9) - 1.0, 0.0))
    assert table["gain.y"].attrs["units"] == "m"


def test_parameters_are_named_with_and_without_the_component():
    system = read_system(build_part("gain"))
    assert settings_of_one(system, {"factor": 2, "gain.shift": 1, "u": 4, "gain.u": 5}) == {
        "gain.factor": 2,
        "gain.shift": 1,
        "u": 5,
    }
    with pytest.raises(sc.ShipcosimError, match="factr"):
        with_values(system, settings_of_one(system, {"factr": 2}))


@pytest.mark.parametrize(
    "name", ["decay_1_cs", "decay_1_me", "decay_2_me", "decay_3_cs", "decay_3_me", "matrix"]
)
def test_every_version_and_form_runs_by_itself(name, needs, tmp_path):
    if c_fmus.compiler() is None:
        needs("a C compiler")
    path = build_c(name, tmp_path)
    system = read_system(path)
    step = 1 / 16
    table = sc.simulate(system, stop_time=1.0, step_size=step)
    if name == "matrix":
        assert [signal for signal in table if signal.startswith("echo.")]
        return
    n = np.arange(17)
    exact = np.exp(-2 * n * step) if name.endswith("me") else (1 - 2 * step) ** n
    assert table[f"{name}.x"].values == pytest.approx(exact, rel=1e-6)
