"""Two FMUs of PythonFMU with modules of one name: each runs its own code, or the run is refused with the reason."""

import json

import numpy as np
import pytest

from shipcosim.cosim import RunOptions, Variation, export_fmu, replay, simulate, simulate_many
from shipcosim.cosim.export.osp import write_osp
from shipcosim.errors import ShipcosimError
from shipcosim.series import make_table

AT_START = "helper.VALUE"
LATE = ("__import__('helper').VALUE", "__import__('model').helper.VALUE")
"""Imported in a step: Python then finds the module that was imported last."""


def values(table):
    return float(table["stock.y"][-1]), float(table["other.y"][-1])


@pytest.mark.parametrize("engine", ["fmpy", "native"])
@pytest.mark.parametrize("expression", [AT_START, *LATE])
def test_each_runs_its_own_code_on_our_engines(pythonfmu_system, make_scenario, engine, expression):
    system = pythonfmu_system(expression, "VALUE = 1.0", "VALUE = 2.0")
    for _ in range(2):
        table = simulate(system, make_scenario(0.2, 0.1), RunOptions(engine=engine))
        assert values(table) == (1.0, 2.0)
    remarks = [text for text in json.loads(table.attrs["remarks"]) if "Python module" in text]
    assert bool(remarks) == (expression in LATE)


@pytest.mark.parametrize("engine", ["libcosim", "ecos"])
def test_other_engines_refuse_them_and_run_equal_ones(
    pythonfmu_system, make_scenario, engine, tmp_path
):
    pytest.importorskip({"libcosim": "libcosimpy", "ecos": "ecospy"}[engine])
    system = pythonfmu_system(AT_START, "VALUE = 1.0", "VALUE = 2.0")
    with pytest.raises(ShipcosimError, match="another Python module 'helper'"):
        simulate(system, make_scenario(0.2, 0.1), RunOptions(engine=engine))


def test_exports_refuse_them(pythonfmu_system, make_scenario, tmp_path):
    system = pythonfmu_system(AT_START, "VALUE = 1.0", "VALUE = 2.0")
    for export in (
        lambda: write_osp(system, make_scenario(), tmp_path / "osp"),
        lambda: export_fmu(system, tmp_path / "all.fmu", 0.1),
    ):
        with pytest.raises(ShipcosimError, match="stock, other: each bring another Python module"):
            export()


def test_many_runs_and_replays_in_one_process_refuse_them(pythonfmu_system, make_scenario):
    system = pythonfmu_system(LATE[0], "VALUE = 1.0", "VALUE = 2.0")
    table = make_table(np.arange(3.0), [])
    with pytest.raises(ShipcosimError, match="another Python module 'helper'"):
        simulate_many(system, make_scenario(), [Variation({}, make_scenario())], RunOptions())
    with pytest.raises(ShipcosimError, match="another Python module 'helper'"):
        replay(system, table, [0.0], 0.2, step_size=0.1)


def test_equal_modules_are_no_clash(pythonfmu_system, make_scenario, tmp_path):
    system = pythonfmu_system(LATE[0], "VALUE = 3.0", "VALUE = 3.0")
    assert values(simulate(system, make_scenario(0.2, 0.1))) == (3.0, 3.0)
    write_osp(system, make_scenario(), tmp_path / "osp")
