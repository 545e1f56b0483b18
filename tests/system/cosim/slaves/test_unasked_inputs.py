"""Inputs that nobody gives a value are not set, in any version of FMI: some FMUs refuse it."""

import c_fmus
import pytest

import shipcosim
from shipcosim.cosim.slaves.fmi1 import Slave1
from shipcosim.cosim.slaves.fmi2 import Slave2
from shipcosim.cosim.slaves.fmi3 import Slave3

MODEL = """
#define NX 1
#define NZ 0
#define STATES {0}
static void start(M* m) { m->r[2] = 1; }
static void equations(M* m) { m->r[1] = m->r[2]; }
static void indicators(M* m, double* z) {}
static void event(M* m) {}
static int completed(M* m) { return 0; }
"""
VARIABLES = [
    ("x", 0, "output", "Real", None),
    ("der(x)", 1, "local", "Real", None),
    ("u", 2, "input", "Real", 1.0),
]


@pytest.mark.parametrize("form", ["CoSimulation", "ModelExchange"])
@pytest.mark.parametrize("version", ["1.0", "2.0", "3.0"])
def test_an_input_is_set_only_where_somebody_gives_a_value(
    version, form, tmp_path, monkeypatch, needs
):
    if c_fmus.compiler() is None:
        needs("a C compiler")
    text = c_fmus.describe("plain", version, VARIABLES, (form,), 1, 0)
    path = c_fmus.build(tmp_path, "plain", version, MODEL, text, form)
    prepared = []
    slave = {"1.0": Slave1, "2.0": Slave2, "3.0": Slave3}[version]
    setter = slave.setter

    def watched(self, kind, variables, buffer):
        prepared.extend(variable.name for variable in variables)
        return setter(self, kind, variables, buffer)

    monkeypatch.setattr(slave, "setter", watched)
    shipcosim.simulate(path, stop_time=1.0, step_size=0.1)
    assert "u" not in prepared
    shipcosim.simulate(path, stop_time=1.0, step_size=0.1, set={"u": 2.0})
    assert "u" in prepared
