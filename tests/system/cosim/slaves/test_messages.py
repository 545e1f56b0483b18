"""What an FMU says of its failure stands under the component that said it, in every version of FMI."""

import json
from itertools import product

import c_fmus
import pytest

from shipcosim.cosim import RunError, RunOptions, simulate
from shipcosim.scenario import Scenario
from shipcosim.ssp import Component, System, read_fmu

# Each instance keeps its name and its logger. It warns where it is made, and fails in the first step after `when`.
MODEL = """
#define NX 1
#define NZ 0
#define STATES {0}
static void start(M* m) {}
static void equations(M* m) { m->r[1] = 1.0; }
static void indicators(M* m, double* z) {}
static void event(M* m) {}
static int completed(M* m) { return 0; }
"""
VARIABLES = [
    ("x", 0, "output", "Real", None),
    ("speed", 1, "output", "Real", None),
    ("when", 2, "parameter", "Real", 1e9),
]
SAYING = {
    "1.0": """
typedef struct { M m; C c; char name[64]; } Named;
void* F(fmiInstantiateSlave)(const char* n, const char* g, const char* w, const char* mime, double timeout, char v,
    char x, C c, char l) {
  Named* m = calloc(1, sizeof(Named)); m->c = c; strcpy(m->name, n); m->m.next = HUGE_VAL; m->m.dirty = 1;
  c.log(m, n, 1, "warning", "start of %s, %d %%", n, 100); return m; }
int F(fmiDoStep)(M* m, double t, double h, char new) {
  Named* d = (Named*)m;
  if (t > m->r[2]) { d->c.log(m, d->name, 3, "error", "%s is empty at %g s", d->name, t); return 3; }
  euler(m, t, h); return 0; }
""",
    "2.0": """
typedef struct { M m; const C* c; char name[64]; } Named;
void* fmi2Instantiate(const char* n, int kind, const char* guid, const char* where, const C* c, int v, int l) {
  Named* m = calloc(1, sizeof(Named)); m->c = c; strcpy(m->name, n); m->m.next = HUGE_VAL; m->m.dirty = 1;
  m->m.i[7] = kind; c->log(c->env, n, 1, "warning", "start of %s, %d %%", n, 100); return m; }
int fmi2DoStep(M* m, double t, double h, int keep) {
  Named* d = (Named*)m;
  if (t > m->r[2]) { d->c->log(d->c->env, d->name, 3, "error", "%s is empty at %g s", d->name, t); return 3; }
  euler(m, t, h); return 0; }
""",
    "3.0": """
typedef void (*Log)(void*, int, const char*, const char*);
typedef struct { M m; Log log; void* env; char name[64]; } Named;
void* fmi3InstantiateCoSimulation(const char* n, const char* t, const char* w, bool v, bool l, bool x, bool y,
    const R* r, size_t nr, void* e, void* log, void* u) {
  Named* m = calloc(1, sizeof(Named)); m->log = (Log)log; m->env = e; strcpy(m->name, n); m->m.next = HUGE_VAL;
  m->m.dirty = 1; m->m.i[7] = 1; char s[99]; sprintf(s, "start of %s, %d %%", n, 100); m->log(e, 1, "warning", s);
  return m; }
int fmi3DoStep(M* m, double t, double h, bool keep, bool* event, bool* ends, bool* early, double* last) {
  Named* d = (Named*)m; char s[99];
  if (t > m->r[2]) { sprintf(s, "%s is empty at %g s", d->name, t); d->log(d->env, 3, "error", s); return 3; }
  euler(m, t, h); *event = *early = *ends = false; *last = t + h; return 0; }
""",
}
REPLACED = {
    "1.0": ("fmiInstantiateSlave", "fmiDoStep"),
    "2.0": ("fmi2Instantiate", "fmi2DoStep"),
    "3.0": ("fmi3InstantiateCoSimulation", "fmi3DoStep"),
}
"""Functions of the adapters of `c_fmus` whose places are taken."""


@pytest.fixture(scope="module")
def tanks(tmp_path_factory, needs):
    """An FMU of each version of FMI."""
    if c_fmus.compiler() is None:
        needs("a C compiler")
    made = {}
    for version, code in SAYING.items():
        folder = tmp_path_factory.mktemp("tank")
        text = c_fmus.describe("tank", version, VARIABLES, ("CoSimulation",))
        # The adapter's functions get other names, so that those of this file can have theirs.
        renamed = "".join(f"#define {name} adapter_{name}\n" for name in REPLACED[version])
        own = "".join(f"#undef {name}\n" for name in REPLACED[version]) + code
        path = c_fmus.build(folder, "tank", version, MODEL + renamed, text, "CoSimulation", own)
        made[version] = read_fmu(path)
    return made


CASES = [(pair, False) for pair in product(SAYING, SAYING)]
CASES += [((version, version), True) for version in SAYING]


@pytest.mark.parametrize("failing", ["left", "right"])
@pytest.mark.parametrize(("versions", "isolate"), CASES)
def test_each_reason_stands_under_its_component(tanks, versions, failing, isolate):
    names = dict(zip(("left", "right"), versions, strict=True))
    parts = {
        name: Component(name, tanks[version], {"when": 0.25 if name == failing else 1e9})
        for name, version in names.items()
    }
    system, other = System("two", "two.ssd", parts), ({"left", "right"} - {failing}).pop()
    with pytest.raises(RunError) as error:
        simulate(system, Scenario(stop_time=1.0, step_size=0.1), RunOptions(isolate=isolate))
    said = str(error.value)
    assert said.startswith(f"{failing}: failed in the step from t = 0.3 s.")
    assert f"{failing} is empty at 0.3 s" in said and other not in said


@pytest.mark.parametrize("versions", list(product(SAYING, SAYING)))
def test_each_warning_stands_under_its_component(tanks, versions):
    """Also where a component's name is how the message begins by chance."""
    names = zip(("s", "st"), versions, strict=True)
    parts = {name: Component(name, tanks[version], {"when": 1e9}) for name, version in names}
    table = simulate(System("two", "two.ssd", parts), Scenario(stop_time=1.0, step_size=0.1))
    remarks = json.loads(table.attrs["remarks"])
    assert remarks == ["s: start of s, 100 %", "st: start of st, 100 %"]
