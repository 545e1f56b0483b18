"""What stands beside each FMU is what the FMU does: its table of variables and its reference result."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from fmpy.validation import validate_fmu

from shipcosim.fmi import Fmu, Input, Output, Parameter
from shipcosim.library import build_stale
from shipcosim.series import read_table

ROOT = Path(__file__).parents[3]
FMUS = sorted(
    folder.name for folder in (ROOT / "fmus").iterdir() if (folder / f"{folder.name}.py").is_file()
)
SETTERS = {"Real": "setReal", "Integer": "setInteger", "Boolean": "setBoolean"}
GETTERS = {"Real": "getReal", "Integer": "getInteger", "Boolean": "getBoolean"}


@pytest.fixture(scope="session")
def fmus():
    return build_stale(ROOT)


@pytest.fixture(scope="session")
def documents():
    script = ROOT / "docs" / "generators" / "write_fmu_documents.py"
    spec = importlib.util.spec_from_file_location("write_fmu_documents", script)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", FMUS)
def test_fmpy_finds_nothing_to_object_to(name, fmus):
    assert validate_fmu(str(fmus / f"{name}.fmu")) == []


@pytest.mark.parametrize("name", FMUS)
def test_every_real_variable_has_a_unit_and_every_variable_a_description(name, fmus):
    for variable in read_model_description(str(fmus / f"{name}.fmu")).modelVariables:
        assert variable.description
        assert variable.unit or variable.type != "Real", variable.name


@pytest.mark.parametrize("name", FMUS)
def test_readme_lists_the_variables_of_the_fmu(name, documents):
    assert (ROOT / "fmus" / name / "README.md").read_text(encoding="utf-8") == documents.readme(
        name
    )


def test_the_table_for_readmes_has_a_row_per_variable(documents):
    class Two(Fmu):
        a = Input("N", "force | push")
        b = Output("m/s", "speed")
        c = Parameter(2.0, "s", "time constant", tunable=True)

    assert documents.table_of_variables(Two).splitlines()[2:] == [
        "| `a` | input | Real | N | `0.0` | force &#124; push |",
        "| `b` | output | Real | m/s |  | speed |",
        "| `c` | tunable parameter | Real | s | `2.0` | time constant |",
    ]


@pytest.mark.parametrize("name", FMUS)
def test_built_fmu_gives_its_reference_result(name, fmus, documents, tmp_path):
    reference = read_table(ROOT / "fmus" / name / "reference.csv")
    parameters = documents.parameters_of(name)
    for signal, values in stepped(fmus / f"{name}.fmu", reference, parameters, tmp_path).items():
        expected = reference[signal].values.astype(float)
        tolerance = documents.reference_tolerance(name, expected)
        np.testing.assert_allclose(values, expected, rtol=0.0, atol=tolerance, err_msg=signal)


def stepped(path, reference, parameters, folder):
    """Outputs of a built FMU, stepped from row to row of a reference with the inputs of each row held."""
    description = read_model_description(str(path))
    fmu = FMU2Slave(
        guid=description.guid,
        modelIdentifier=description.coSimulation.modelIdentifier,
        unzipDirectory=extract(str(path), str(folder)),
        instanceName=path.stem,
    )
    fmu.instantiate()
    known = {variable.name: variable.valueReference for variable in description.modelVariables}
    for setter, kinds in ((fmu.setReal, float), (fmu.setInteger, int), (fmu.setString, str)):
        given = {name: value for name, value in parameters.items() if type(value) is kinds}
        setter([known[name] for name in given], list(given.values()))
    try:
        return _stepped(fmu, description.modelVariables, reference)
    finally:
        fmu.terminate()
        fmu.freeInstance()


def _stepped(fmu, variables, reference):
    inputs = [v for v in variables if v.causality == "input" and v.name in reference]
    outputs = [v for v in variables if v.causality == "output"]
    times, rows = reference["time"].values, {v.name: [] for v in outputs}
    fmu.setupExperiment(startTime=times[0])
    fmu.enterInitializationMode()
    for row, time in enumerate(times):
        for v in inputs:
            value = reference[v.name].values[max(row - 1, 0)]
            getattr(fmu, SETTERS[v.type])(
                [v.valueReference], [float(value) if v.type == "Real" else int(value)]
            )
        if row == 0:
            fmu.exitInitializationMode()
        else:
            before = times[row - 1]
            fmu.doStep(currentCommunicationPoint=before, communicationStepSize=time - before)
        for v in outputs:
            rows[v.name].append(float(getattr(fmu, GETTERS[v.type])([v.valueReference])[0]))
    return rows
