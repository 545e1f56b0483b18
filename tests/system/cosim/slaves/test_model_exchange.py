"""Model exchange: FMUs made from C, integrated by CVode, held against closed forms and scipy."""

from dataclasses import replace

import c_fmus
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from shipcosim.cosim import RunError, RunOptions, repeat, simulate
from shipcosim.cosim.master.run import Simulation
from shipcosim.cosim.master.time_grid import time_grid_of
from shipcosim.cosim.slaves.instances import Instances
from shipcosim.cosim.slaves.interface_type import interface_type_of
from shipcosim.errors import ShipcosimError
from shipcosim.scenario import Scenario
from shipcosim.ssp import Component, Connection, System, read_fmu

VERSIONS = ("1.0", "2.0", "3.0")
NOTHING = """
static void indicators(M* m, double* z) {}
static void event(M* m) {}
static int completed(M* m) { return 0; }
"""
MODELS = {
    "decay": """
#define NX 1
#define NZ 0
#define STATES {0}
static void start(M* m) { m->r[0] = 1; m->r[3] = 2; }
static void equations(M* m) { m->r[1] = m->r[2] - m->r[3] * m->r[0]; }
"""
    + NOTHING,
    "pol": """
#define NX 2
#define NZ 0
#define STATES {0, 1}
static void start(M* m) { m->r[0] = 2; m->r[4] = 5; }
static void equations(M* m) {
  m->r[2] = m->r[1]; m->r[3] = m->r[4] * (1 - m->r[0] * m->r[0]) * m->r[1] - m->r[0];
}
"""
    + NOTHING,
    "ball": """
#define NX 2
#define NZ 1
#define STATES {0, 1}
static void start(M* m) { m->r[0] = 1; m->r[4] = 0.7; m->r[5] = 9.81; }
static void equations(M* m) { m->r[2] = m->i[1] ? 0 : m->r[1]; m->r[3] = m->i[1] ? 0 : -m->r[5]; }
static void indicators(M* m, double* z) { z[0] = m->i[1] ? 1 : m->r[0]; }
static void event(M* m) {
  if (m->r[0] > 1e-9 || m->r[1] >= 0 || m->i[1]) return;
  m->r[0] = 0; m->r[1] *= -m->r[4]; m->i[0]++;
  if (m->r[1] < 0.1) { m->i[1] = 1; m->r[1] = 0; }
}
static int completed(M* m) { return 0; }
""",
    "stair": """
#define NX 0
#define NZ 0
#define STATES {0}
static void start(M* m) { m->r[1] = 0.3; }
static void equations(M* m) { m->r[0] = m->time; }
static void indicators(M* m, double* z) {}
static void event(M* m) {
  if (m->time >= m->r[1] * (m->i[0] + 1) - 1e-12) m->i[0]++;
  m->next = m->r[1] * (m->i[0] + 1);
}
static int completed(M* m) { return 0; }
""",
    "saw": """
#define NX 1
#define NZ 0
#define STATES {0}
static void start(M* m) {}
static void equations(M* m) { m->r[1] = 1; }
static void indicators(M* m, double* z) {}
static void event(M* m) { if (m->r[0] >= 1) { m->r[0] -= 1; m->i[0]++; m->again = m->r[0] >= 1; } }
static int completed(M* m) { return m->r[0] >= 1; }
""",
    "relay": """
#define NX 1
#define NZ 1
#define STATES {0}
static void start(M* m) {}
static void equations(M* m) { m->r[1] = m->i[0] ? 1 : -1; }
static void indicators(M* m, double* z) { z[0] = m->r[2] - 0.5; }
static void event(M* m) { int on = m->r[2] > 0.5; m->again = on != m->i[0]; m->i[0] = on; }
static int completed(M* m) { return 0; }
""",
    "restless": """
#define NX 0
#define NZ 0
#define STATES {0}
static void start(M* m) {}
static void equations(M* m) {}
static void indicators(M* m, double* z) {}
static void event(M* m) { if (m->i[0] == 1) m->again = 1; if (m->i[0] == 2) m->next = m->time;
  if (m->i[0] == 3) m->ends = 1; }
static int completed(M* m) { return 0; }
""",
}
VARIABLES = {
    "decay": [("x", 0, "output", "Real", None), ("der(x)", 1, "local", "Real", None)]
    + [("u", 2, "input", "Real", 0.0), ("k", 3, "parameter", "Real", 2.0)],
    "pol": [("x", 0, "output", "Real", None), ("v", 1, "output", "Real", None)]
    + [("der(x)", 2, "local", "Real", None), ("der(v)", 3, "local", "Real", None)]
    + [("mu", 4, "parameter", "Real", 5.0)],
    "ball": [("h", 0, "output", "Real", None), ("v", 1, "output", "Real", None)]
    + [("der(h)", 2, "local", "Real", None), ("der(v)", 3, "local", "Real", None)]
    + [("e", 4, "parameter", "Real", 0.7), ("n", 0, "output", "Integer", None)],
    "stair": [("y", 0, "output", "Real", None), ("every", 1, "parameter", "Real", 0.3)]
    + [("n", 0, "output", "Integer", None)],
    "saw": [
        ("x", 0, "output", "Real", None),
        ("der(x)", 1, "local", "Real", None),
        ("n", 0, "output", "Integer", None),
    ],
    "relay": [("x", 0, "output", "Real", None), ("der(x)", 1, "local", "Real", None)]
    + [("u", 2, "input", "Real", 0.0), ("on", 0, "output", "Integer", None)],
    "restless": [("y", 0, "output", "Real", None), ("how", 0, "input", "Integer", 0)],
}
SIZES = {
    "decay": (1, 0),
    "pol": (2, 0),
    "ball": (2, 1),
    "stair": (0, 0),
    "saw": (1, 0),
    "relay": (1, 1),
}


@pytest.fixture(scope="session")
def model(tmp_path_factory, needs):
    """Function: an FMU of a model in a version of FMI, both forms in it where the version can."""
    if c_fmus.compiler() is None:
        needs("a C compiler")
    folder, made = tmp_path_factory.mktemp("models"), {}

    def make(name, version, forms=("ModelExchange",), **more):
        key = f"{name}_{version[0]}_{'_'.join(form[:2] for form in forms)}"
        if key not in made:
            if version == "3.0" and forms != ("CoSimulation",):
                more = {"needsCompletedIntegratorStep": "true"} | more
            text = c_fmus.describe(
                key, version, VARIABLES[name], forms, *SIZES.get(name, (0, 0)), **more
            )
            made[key] = c_fmus.build(folder, key, version, MODELS[name], text, forms[0])
        return made[key]

    return make


@pytest.fixture
def run_model(model, make_scenario):
    """Function: table of a run of one model, called ``m``."""

    def run(
        name,
        version,
        stop_time,
        step_size,
        forms=("ModelExchange",),
        wanted="any",
        more=(),
        **scenario,
    ):
        component = Component("m", read_fmu(model(name, version, forms)), implementation=wanted)
        system = System("one", "one.ssd", {"m": component}, **dict(more))
        return simulate(system, make_scenario(stop_time, step_size, **scenario))

    return run


@pytest.mark.parametrize("version", VERSIONS)
def test_a_decay_follows_its_exponential(run_model, version):
    table = run_model("decay", version, 2.0, 0.1, set={"m.k": 3.0, "m.u": 1.5})
    t = table["time"].values
    assert np.allclose(table["m.x"], 0.5 + 0.5 * np.exp(-3.0 * t), rtol=2e-6)


@pytest.mark.parametrize("version", VERSIONS)
def test_an_input_that_jumps_acts_from_its_step_on(run_model, version):
    events = [{"time": 0.5, "override": {"m.u": 4.0}}]
    table = run_model("decay", version, 1.0, 0.25, events=events)
    before = np.exp(-2.0 * 0.5)
    after = 2.0 + (before - 2.0) * np.exp(-2.0 * np.array([0.25, 0.5]))
    assert np.allclose(table["m.x"], [1.0, np.exp(-0.5), before, *after], rtol=2e-6)


@pytest.mark.parametrize("version", VERSIONS)
def test_van_der_pol_is_that_of_scipy(run_model, version):
    table = run_model("pol", version, 20.0, 0.1)
    t = table["time"].values
    x = solve_ivp(
        lambda t, s: [s[1], 5 * (1 - s[0] ** 2) * s[1] - s[0]],
        (0, 20),
        [2, 0],
        "LSODA",
        t,
        rtol=1e-10,
        atol=1e-12,
    )
    assert np.allclose(table["m.x"], x.y[0], atol=2e-4)


@pytest.mark.parametrize("version", VERSIONS)
def test_a_ball_bounces_when_it_has_to(run_model, version):
    table = run_model("ball", version, 4.0, 0.01)
    t, h, n = table["time"].values, table["m.h"].values, table["m.n"].values
    first, speed = np.sqrt(2 / 9.81), np.sqrt(2 * 9.81)
    bounces = first + np.concatenate([[0.0], np.cumsum(2 * speed * 0.7 ** np.arange(1, 12) / 9.81)])
    rest = int(np.ceil(np.log(0.1 / speed) / np.log(0.7)))
    assert np.array_equal(n, np.minimum(np.searchsorted(bounces, t, side="right"), rest))
    exact = np.where(t < first, 1 - 9.81 * t**2 / 2, 0.0)
    for k in range(1, rest):
        inside = (t >= bounces[k - 1]) & (t < bounces[k])
        since = t - bounces[k - 1]
        exact = np.where(inside, speed * 0.7**k * since - 9.81 * since**2 / 2, exact)
    assert np.allclose(h, exact, atol=2e-6)


@pytest.mark.parametrize("version", VERSIONS)
def test_time_events_come_at_their_times(run_model, version):
    table = run_model("stair", version, 3.0, 0.05)
    t = table["time"].values
    assert np.array_equal(table["m.n"], np.floor(t / 0.3 + 1e-9)) and np.allclose(
        table["m.y"], t, rtol=1e-14
    )


@pytest.mark.parametrize("step_size", [0.05, 2.5])
@pytest.mark.parametrize("version", VERSIONS)
def test_step_events_are_asked_for_after_every_step_of_the_solver(run_model, version, step_size):
    table = run_model("saw", version, 10.0, step_size)
    assert np.allclose(table["m.x"] + table["m.n"], table["time"], atol=1e-9)
    assert table["m.n"][-1] >= 8 and (table["m.x"] < 1.0).all()


@pytest.mark.parametrize("version", VERSIONS)
def test_a_discrete_state_follows_an_input_that_jumps(run_model, version):
    events = [{"time": 0.2, "override": {"m.u": 1.0}}, {"time": 0.4, "override": {"m.u": 0.0}}]
    table = run_model("relay", version, 0.6, 0.1, events=events)
    assert table["m.on"].values.tolist() == [0, 0, 0, 1, 1, 0, 0]
    assert np.allclose(table["m.x"], [0, -0.1, -0.2, -0.1, 0.0, -0.1, -0.2])


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_the_form_that_is_asked_for_runs(run_model, version):
    forms = ("ModelExchange", "CoSimulation")
    exact, euler = np.exp(-2.0), 0.8**10
    values = {
        w: run_model("decay", version, 1.0, 0.1, forms, w)["m.x"][-1]
        for w in ("ModelExchange", "CoSimulation", "any")
    }
    assert values["ModelExchange"] == pytest.approx(exact, rel=1e-5)
    assert (
        values["CoSimulation"] == pytest.approx(euler) and values["any"] == values["CoSimulation"]
    )


def test_a_form_that_is_not_there_is_refused(run_model):
    with pytest.raises(
        ShipcosimError, match="m: decay_2_Mo.fmu offers no CoSimulation. It offers ModelExchange."
    ):
        run_model("decay", "2.0", 1.0, 0.1, wanted="CoSimulation")


def test_models_and_slaves_of_all_versions_run_together(model, make_scenario):
    fmus = [model("decay", version) for version in VERSIONS] + [
        model("decay", "1.0", ("CoSimulation",))
    ]
    parts = {f"m{k}": Component(f"m{k}", read_fmu(fmu), {"k": 1.0}) for k, fmu in enumerate(fmus)}
    lines = tuple(Connection((f"m{k}", "x"), (f"m{k + 1}", "u")) for k in range(3))
    assert [interface_type_of(part) for part in parts.values()] == ["ModelExchange"] * 3 + [
        "CoSimulation"
    ]
    table = simulate(System("chain", "chain.ssd", parts, lines), make_scenario(2.0, 0.002))
    t = table["time"].values

    def chain(t, x):
        return np.array([0.0, *x[:-1]]) - x

    x = solve_ivp(chain, (0, 2), np.ones(4), t_eval=t, rtol=1e-10, atol=1e-12).y
    for k in range(4):
        assert np.allclose(table[f"m{k}.x"], x[k], atol=2e-3), k


@pytest.mark.parametrize(
    ("how", "said"),
    [
        (1, "An event does not settle: discrete states still change after 1000 updates"),
        (2, "It chatters at t = 0.5 s: 100 events within 0 s"),
    ],
)
@pytest.mark.parametrize("version", VERSIONS)
def test_events_without_end_end_the_run_with_their_component(run_model, version, how, said):
    with pytest.raises(RunError, match=f"m: failed in the step from t = 0.5 s. {said}") as caught:
        run_model(
            "restless", version, 1.0, 0.25, events=[{"time": 0.5, "override": {"m.how": how}}]
        )
    assert caught.value.table.sizes["time"] == 3


@pytest.mark.parametrize("isolate", [False, True])
@pytest.mark.parametrize("form", ["ModelExchange", "CoSimulation"])
@pytest.mark.parametrize("version", VERSIONS)
def test_an_fmu_that_ends_the_run_is_an_end_and_no_failure(
    model, make_scenario, version, form, isolate
):
    if (version, form) == ("1.0", "CoSimulation"):
        return  # FMI 1.0 has no such answer
    fmu = read_fmu(model("restless", version, (form,)))
    system = System("one", "one.ssd", {"m": Component("m", fmu)})
    scenario = make_scenario(1.0, 0.25, events=[{"time": 0.5, "override": {"m.how": 3}}])
    table = simulate(system, scenario, RunOptions(isolate=isolate))
    assert table["time"].values.tolist() == [0.0, 0.25, 0.5] and table.attrs["complete"] == 1
    assert "m ends the run at t = 0.5 s." in table.attrs["remarks"]


def test_a_state_that_cannot_be_stored_is_said_before_the_run(
    run_model, model, make_scenario, tmp_path
):
    system = System("one", "one.ssd", {"m": Component("m", read_fmu(model("decay", "2.0")))})
    with pytest.raises(
        ShipcosimError,
        match="m: it runs as model exchange, and the solver's state cannot be stored",
    ):
        simulate(system, make_scenario(), RunOptions(store=tmp_path / "x.state"))


@pytest.mark.parametrize("version", VERSIONS)
def test_runs_of_one_instance_and_repeated_runs_are_equal_to_the_digit(model, version):
    system = System("one", "one.ssd", {"m": Component("m", read_fmu(model("ball", version)))})
    scenario = Scenario(stop_time=2.0, step_size=0.1)
    whole = simulate(system, scenario)
    assert np.array_equal(repeat(whole, system)["m.h"], whole["m.h"])
    with Instances() as instances:
        for _ in range(2):
            simulation = Simulation(system, scenario, time_grid_of(scenario), RunOptions())
            simulation.run(instances, lambda: None)
            simulation.terminate()
            assert np.array_equal(simulation.table(complete=True)["m.h"], whole["m.h"])


def test_a_run_in_one_form_is_not_repeated_in_the_other(model):
    fmu = read_fmu(model("decay", "2.0", ("ModelExchange", "CoSimulation")))
    system = System("one", "one.ssd", {"m": Component("m", fmu, implementation="ModelExchange")})
    table = simulate(system, Scenario(stop_time=1.0, step_size=0.1))
    other = System("one", "one.ssd", {"m": Component("m", fmu)})
    with pytest.raises(ShipcosimError, match="wired"):
        repeat(table, other)


def test_a_parameter_of_fmi_1_cannot_be_connected(model, make_scenario):
    parts = {name: Component(name, read_fmu(model("decay", "1.0"))) for name in ("a", "b")}
    handover = Connection(("a", "k"), ("b", "k"), initial=True)
    with pytest.raises(
        ShipcosimError, match="b.k: its value comes from a connection, but FMI 1.0 has no"
    ):
        simulate(System("two", "two.ssd", parts, (handover,)), make_scenario())


def test_the_tolerance_of_the_default_experiment_is_that_of_the_solver(model, run_model):
    errors = []
    for tolerance in (1e-4, 1e-7, 1e-10):
        fmu = replace(read_fmu(model("decay", "2.0")), experiment={"tolerance": tolerance})
        table = simulate(
            System("one", "one.ssd", {"m": Component("m", fmu)}),
            Scenario(stop_time=1.0, step_size=1.0),
        )
        errors.append(abs(float(table["m.x"][-1]) / np.exp(-2.0) - 1))
    assert errors[0] > 30 * errors[1] > 900 * errors[2] and errors[2] < 1e-8


def test_an_absurd_number_of_states_is_refused_before_any_memory_is_taken(model):
    fmu = replace(read_fmu(model("decay", "2.0")), n_states=4_000_000_000)
    with pytest.raises(
        RunError, match="m: .*4000000000 continuous states; at most 5000 are integrated"
    ):
        simulate(
            System("one", "one.ssd", {"m": Component("m", fmu)}),
            Scenario(stop_time=1.0, step_size=1.0),
        )
