"""FMUs from C for what our shell does not make: other versions of FMI, model exchange, arrays. See `c_fmus`.

``decay``: x' = u - k x, x(0) = 1, k = 2; as co-simulation by Euler's rule. ``matrix``: y = A u of FMI 3.0.
"""

import tempfile
from pathlib import Path

import c_fmus
from cosim.slaves.test_fmi_versions import ECHO, MADE, _echo_description

DECAY = """
#define NX 1
#define NZ 0
#define STATES {0}
static void start(M* m) { m->r[0] = 1; m->r[3] = 2; }
static void equations(M* m) { m->r[1] = m->r[2] - m->r[3] * m->r[0]; }
static void indicators(M* m, double* z) {}
static void event(M* m) {}
static int completed(M* m) { return 0; }
"""
VARIABLES = [("x", 0, "output", "Real", None), ("der(x)", 1, "local", "Real", None)]
VARIABLES += [("u", 2, "input", "Real", 0.0), ("k", 3, "parameter", "Real", 2.0)]
FORMS = {
    "cs": ("CoSimulation",),
    "me": ("ModelExchange",),
    "both": ("ModelExchange", "CoSimulation"),
}


def build_c(name, folder):
    """FMU of a name: ``matrix``, or ``decay_1_cs``, with the version of FMI and the form."""
    folder.mkdir(parents=True, exist_ok=True)
    # Other processes may read or make the same file: it is there whole or not at all.
    with tempfile.TemporaryDirectory(dir=folder) as temporary:
        fmu = _built(name, Path(temporary))
        return fmu.replace(folder / fmu.name)


def _built(name, folder):
    if name == "matrix":
        return c_fmus.build(folder, "echo", "3.0", "", _echo_description(), code=f"{ECHO}{MADE}\n")
    model, version, form = name.split("_")
    forms, n_states = FORMS[form], 0 if form == "cs" else 1
    text = c_fmus.describe(name, f"{version}.0", VARIABLES, forms, n_states, 0)
    return c_fmus.build(folder, name, f"{version}.0", DECAY, text, forms[0])
