"""At night: each system of the conformance suite as one FMU."""

import pytest
from conformance.cases import cases, write

from shipcosim.cosim import export_fmu
from shipcosim.errors import ShipcosimError
from shipcosim.ssp import read_system

EXPRESSED = {
    "connection",
    "dictionary_file",
    "feedback",
    "names",
    "nested_bindings",
    "nested_deep",
    "other_ssp",
    "types",
}


EXPRESSED |= {
    "parameter_enumeration",
    "ssm_transformations",
    "ssv_several",
    "start_values",
    "units_suppressed",
}


NOT_EXPRESSED = {
    "boolean_mapping",
    "calculated",
    "enumeration_mapping",
    "integer_to_real",
    "linear",
    "nested",
    "units",
}


NOT_EXPRESSED |= {"step_component"}


def test_each_system_of_the_conformance_suite_is_exported_with_its_values_or_refused(tmp_path):
    outcome = {True: set(), False: set()}
    for name, case in cases().items():
        path = write(case, tmp_path / name, "ssp, 1.0" if "1.0" in case.versions else "ssp, 2.0")
        fmu = tmp_path / f"{name}.fmu"
        try:
            system = read_system(path)
            export_fmu(system, fmu, case.step_size or system.experiment.step_size)
        except ShipcosimError as error:
            assert all(
                "container FMU" in problem.remedy or problem.where for problem in error.problems
            ), name
        assert fmu.exists() or name not in EXPRESSED, name
        outcome[fmu.exists()].add(name)
    assert outcome[True] >= EXPRESSED and outcome[False] >= NOT_EXPRESSED
