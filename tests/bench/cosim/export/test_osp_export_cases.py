"""Every system of the conformance suite, exported for libcosim, has our values there, or the export refuses it."""

import numpy as np
import pytest
from conformance import cases as conformance

from shipcosim.cosim import engines_missing, simulate
from shipcosim.cosim.engines.foreign_process import readers
from shipcosim.cosim.export.osp import write_osp
from shipcosim.errors import ShipcosimError
from shipcosim.scenario import Scenario
from shipcosim.ssp import read_system

REFUSED = {
    "arrays": "libcosim runs FMI 2.0",
    "boolean_mapping": "it maps values",
    "both_me": "model exchange",
    "calculated": "it sets a parameter",
    "enumeration_by_integers": "has enumerations",
    "enumeration_mapping": "has enumerations",
    "fmi1_cs": "libcosim runs FMI 2.0",
    "fmi1_me": "libcosim runs FMI 2.0",
    "fmi2_me": "model exchange",
    "fmi3_cs": "libcosim runs FMI 2.0",
    "fmi3_me": "libcosim runs FMI 2.0",
    "integer_mapping": "it maps values",
    "integer_to_real": "it goes from Integer to Real",
    "parameter_enumeration": "has enumerations",
    "ssm_enumeration": "has enumerations",
}


@pytest.mark.parametrize(
    "name", [name for name in conformance.cases() if not name.startswith("gap_")]
)
def test_a_system_has_our_values_in_libcosim_or_is_refused(name, tmp_path, needs):
    if missing := engines_missing().get("libcosim"):
        needs("libcosim", str(missing))
    case = conformance.cases()[name]
    path = conformance.write(
        case, tmp_path, "folder, 1.0" if "1.0" in case.versions else "ssp, 2.0"
    )
    system = read_system(path)
    step = case.run.get("step_size", case.step_size)
    scenario = Scenario(stop_time=step * 8, step_size=step)
    if name in REFUSED:
        with pytest.raises(ShipcosimError) as error:
            write_osp(system, scenario, tmp_path / "osp")
        assert REFUSED[name] in str(error.value) and not (tmp_path / "osp").exists()
        return
    write_osp(system, scenario, tmp_path / "osp")
    theirs = readers(tmp_path / "osp" / "OspSystemStructure.xml", scenario)["libcosim"](system)
    ours = simulate(system, scenario).isel(time=slice(1, None))
    for signal in theirs.data_vars:
        rows = slice(None)
        if steps := system.components[system.split(str(signal))[0]].step_size:
            rows = slice(
                round(steps / step) - 1, None, round(steps / step)
            )  # between its steps libcosim shows the end
        np.testing.assert_array_equal(
            theirs[signal].values[rows], ours[signal].values[rows].astype(float), str(signal)
        )
