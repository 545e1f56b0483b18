"""One FMU instance: FMI 3.0 by a small FMU in C, since nothing here builds one otherwise."""

import os
import shutil
import subprocess
import zipfile

import numpy as np
import pytest
from c_fmus import functions_of

from shipcosim.cosim import RunError, RunOptions, simulate
from shipcosim.cosim.slaves.instances import Instances
from shipcosim.ssp import read_system

CODE = """
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
typedef void (*Log)(void*, int, const char*, const char*);
typedef struct { double u, y; float half; int64_t count; bool odd; Log log; } Tank;

void* fmi3InstantiateCoSimulation(const char* name, const char* token, const char* folder, bool visible, bool logging,
    bool events, bool early, const unsigned r[], size_t n, void* environment, Log log, void* update) {
  Tank* tank = calloc(1, sizeof(Tank));
  tank->log = log;
  return tank;
}
void fmi3FreeInstance(void* tank) { free(tank); }
int fmi3EnterInitializationMode(void* tank, bool defined, double tolerance, double start, bool stops, double stop) {
  return stops && stop > 0.0 ? 0 : 3;
}
int fmi3ExitInitializationMode(void* tank) { return 0; }
int fmi3Terminate(void* tank) { return 0; }
int fmi3SetFloat64(Tank* tank, const unsigned* r, size_t n, const double* v, size_t m) {
  for (size_t i = 0; i < n; i++) if (r[i] == 1) tank->u = v[i]; else return 3;
  return 0;
}
int fmi3GetFloat64(Tank* tank, const unsigned* r, size_t n, double* v, size_t m) {
  for (size_t i = 0; i < n; i++) if (r[i] == 2) v[i] = tank->y; else return 3;
  return 0;
}
int fmi3GetFloat32(Tank* tank, const unsigned* r, size_t n, float* v, size_t m) { *v = tank->half; return 0; }
int fmi3GetInt64(Tank* tank, const unsigned* r, size_t n, int64_t* v, size_t m) { *v = tank->count; return 0; }
int fmi3GetBoolean(Tank* tank, const unsigned* r, size_t n, bool* v, size_t m) { *v = tank->odd; return 0; }
int fmi3DoStep(Tank* tank, double t, double h, bool keep, bool* event, bool* end, bool* early, double* reached) {
  *event = *end = *early = false;
  *reached = t + h;
  tank->y += h * tank->u;
  tank->half = tank->y / 2;
  tank->odd = ++tank->count % 2;
  if (tank->y < 100.0) return 0;
  tank->log(0, 3, "error", "the tank is 100% full");
  return 3;
}
int fmi3GetFMUState(Tank* tank, void** state) { *state = memcpy(malloc(sizeof(Tank)), tank, sizeof(Tank)); return 0; }
int fmi3SetFMUState(Tank* tank, void* state) { memcpy(tank, state, offsetof(Tank, log)); return 0; }
int fmi3FreeFMUState(Tank* tank, void** state) { free(*state); *state = 0; return 0; }
int fmi3SerializedFMUStateSize(Tank* tank, void* state, size_t* size) { *size = offsetof(Tank, log); return 0; }
int fmi3SerializeFMUState(Tank* tank, void* state, uint8_t* data, size_t size) { memcpy(data, state, size); return 0; }
int fmi3DeserializeFMUState(Tank* tank, const uint8_t* data, size_t size, void** state) {
  *state = memcpy(calloc(1, sizeof(Tank)), data, size);
  return 0;
}
"""
DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="tank" instantiationToken="{tank}">
  <CoSimulation modelIdentifier="tank" canGetAndSetFMUState="true" canSerializeFMUState="true"/>
  <ModelVariables>
    <Float64 name="u" valueReference="1" causality="input" start="0"/>
    <Float64 name="y" valueReference="2" causality="output"/>
    <Float32 name="half" valueReference="3" causality="output"/>
    <Int64 name="count" valueReference="4" causality="output"/>
    <Boolean name="odd" valueReference="5" causality="output"/>
  </ModelVariables>
  <ModelStructure><Output valueReference="2"/><Output valueReference="3"/><Output valueReference="4"/>
    <Output valueReference="5"/></ModelStructure>
</fmiModelDescription>
"""
SSD = """<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription name="tanks" version="1.0"
    xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon">
  <ssd:System name="tanks"><ssd:Elements>
    <ssd:Component name="a" source="resources/tank.fmu"/><ssd:Component name="b" source="resources/tank.fmu"/>
  </ssd:Elements><ssd:Connections>
    <ssd:Connection startElement="a" startConnector="half" endElement="b" endConnector="u"/>
  </ssd:Connections></ssd:System>
</ssd:SystemStructureDescription>
"""


@pytest.fixture(scope="module")
def tanks(tmp_path_factory):
    """System of two tanks, FMUs of FMI 3.0."""
    from fmpy import platform_tuple, sharedLibraryExtension

    compiler = shutil.which("cc")
    if compiler is None or os.name == "nt":
        pytest.skip("needs a C compiler to make an FMU of FMI 3.0")
    folder = tmp_path_factory.mktemp("tanks")
    (folder / "resources").mkdir()
    wanted = [name for name in functions_of("3.0") if f" {name}(" not in CODE.replace("*", " ")]
    stubs = "\n".join(f"int {name}(void) {{ return 3; }}" for name in wanted)
    (folder / "tank.c").write_text(CODE + stubs)
    library = folder / f"tank{sharedLibraryExtension}"
    subprocess.run([compiler, "-shared", "-fPIC", "-o", library, folder / "tank.c"], check=True)
    with zipfile.ZipFile(folder / "resources" / "tank.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION)
        archive.write(library, f"binaries/{platform_tuple}/{library.name}")
    (folder / "SystemStructure.ssd").write_text(SSD)
    return read_system(folder)


def test_fmi3_values_of_all_sizes_travel(tanks, make_scenario):
    table = simulate(tanks, make_scenario(1.0, 0.125, set={"a.u": 4.0}))
    k = np.arange(9)
    assert np.allclose(table["a.y"], 0.5 * k) and np.allclose(table["a.half"], 0.25 * k)
    assert np.allclose(table["b.y"], 0.125 * 0.25 * k * (k - 1) / 2)
    assert np.array_equal(table["a.count"], k) and np.array_equal(table["a.odd"], k % 2 == 1)


def test_fmi3_state_is_stored_and_restored(tanks, make_scenario, tmp_path):
    scenario = make_scenario(1.0, 0.125, set={"a.u": 4.0})
    whole = simulate(tanks, scenario)
    simulate(tanks, scenario, RunOptions(until=0.375, store=tmp_path / "tanks.state"))
    rest = simulate(tanks, scenario, RunOptions(resume=tmp_path / "tanks.state"))
    assert all(np.array_equal(rest[name], whole[name][3:]) for name in whole)


def test_an_fmu_that_cannot_be_reset_is_made_anew(tanks):
    with Instances() as instances:
        first = instances.instance_of(tanks.components["a"])
        again = instances.instance_of(tanks.components["a"])
        assert again is not first
        again.enter_initialisation(0.0, 1.0)


def test_fmi3_error_arrives_with_its_message(tanks, make_scenario):
    with pytest.raises(
        RunError,
        match="a: failed in the step from t = 0.875 s.*returned 'error'. the tank is 100% full",
    ):
        simulate(tanks, make_scenario(2.0, 0.125, set={"a.u": 100.0}))
