"""What other engines make of FMUs of other versions and forms: the table of docs/fmi-versions.md, measured.

Each engine reads an SSP itself, in a process of its own, since some die of it. As a script this is that process.
"""

import json
import sys
import zipfile

import c_fmus
import numpy as np
import pytest

STEP, STEPS = 0.125, 8
EULER, EXACT = float((1 - 2 * STEP) ** STEPS), float(np.exp(-2.0))
DECAY = """
#define NX 1
#define NZ 0
#define STATES {0}
static void start(M* m) { m->r[0] = 1; m->r[3] = 2; }
static void equations(M* m) { m->r[1] = m->r[2] - m->r[3] * m->r[0]; m->r[4] = m->r[0]; }
static void indicators(M* m, double* z) {}
static void event(M* m) {}
static int completed(M* m) { return 0; }
"""
VARIABLES = [("x", 0, "output", "Real", None), ("der(x)", 1, "local", "Real", None)]
VARIABLES += [("u", 2, "input", "Real", 0.0), ("k", 3, "parameter", "Real", 2.0)]
CS, ME = "CoSimulation", "ModelExchange"
CASES = {
    "FMI 1.0 co-simulation": ("1.0", (CS,), "any", EULER),
    "FMI 2.0 co-simulation": ("2.0", (CS,), "any", EULER),
    "FMI 3.0 co-simulation": ("3.0", (CS,), "any", EULER),
    "FMI 1.0 model exchange": ("1.0", (ME,), "any", EXACT),
    "FMI 2.0 model exchange": ("2.0", (ME,), "any", EXACT),
    "FMI 3.0 model exchange": ("3.0", (ME,), "any", EXACT),
    "both forms, co-simulation asked for": ("2.0", (CS, ME), CS, EULER),
    "both forms, model exchange asked for": ("2.0", (CS, ME), ME, EXACT),
}
SSD = """<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription name="decays" version="1.0"
    xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"><ssd:System name="decays"><ssd:Elements>
  <ssd:Component name="m" type="application/x-fmu-sharedlibrary" source="resources/decay.fmu" implementation="{form}">
    <ssd:Connectors><ssd:Connector name="x" kind="output"><ssc:Real/></ssd:Connector></ssd:Connectors>
  </ssd:Component></ssd:Elements></ssd:System>
  <ssd:DefaultExperiment startTime="0.0" stopTime="1.0"/></ssd:SystemStructureDescription>"""


def in_shipcosim(path):
    import shipcosim as sc

    return sc.simulate(str(path), stop_time=1.0, step_size=STEP)["m.x"].values[-1].item()


def in_libcosim(path):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver

    execution, observer = (
        CosimExecution.from_ssp_file(str(path), round(STEP * 1e9)),
        CosimObserver.create_last_value(),
    )
    execution.add_observer(observer)
    for _ in range(STEPS):
        if not execution.step():
            raise RuntimeError("a step failed")
    return observer.last_real_values(execution.slave_index_from_instance_name("m"), [0])[0]


def in_ecos(path):
    from ecospy import EcosLib, EcosSimulation

    EcosLib.set_log_level("off")
    simulation = EcosSimulation(ssp_path=str(path), step_size=STEP)
    if not simulation.init():
        raise RuntimeError(EcosLib.get_last_error())
    for _ in range(STEPS):
        simulation.step()
    return simulation.get_real("m::x")


def in_fmpy(path):
    from fmpy.ssp.simulation import simulate_ssp

    return float(simulate_ssp(str(path), stop_time=1.0, step_size=STEP)["m.x"][-1])


ENGINES = {"shipcosim": in_shipcosim, "libcosim": in_libcosim, "ecos": in_ecos, "FMPy": in_fmpy}


@pytest.fixture(scope="module")
def packages(tmp_path_factory, needs):
    """SSP of each case."""
    if c_fmus.compiler() is None:
        needs("a C compiler")
    paths = {}
    for number, (name, (version, forms, asked, _)) in enumerate(CASES.items()):
        folder = tmp_path_factory.mktemp(f"case{number}")
        text = c_fmus.describe("decay", version, VARIABLES, forms, 1)
        fmu = c_fmus.build(folder, "decay", version, DECAY, text, forms[0])
        with zipfile.ZipFile(folder / "decays.ssp", "w") as archive:
            archive.writestr("SystemStructure.ssd", SSD.format(form=asked))
            archive.write(fmu, "resources/decay.fmu")
        paths[name] = folder / "decays.ssp"
    return paths


@pytest.mark.parametrize("name", CASES)
def test_our_engine_is_right(packages, name):
    assert in_shipcosim(packages[name]) == pytest.approx(CASES[name][-1], rel=1e-5)


if __name__ == "__main__":
    try:
        print(json.dumps({"value": ENGINES[sys.argv[1]](sys.argv[2])}), flush=True)
    except Exception as error:
        print(json.dumps({"error": str(error)}), flush=True)
