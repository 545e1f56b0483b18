"""Components in model exchange that are wired together are integrated as one system: against the analytic solution.

Two FMUs of one state each, x' = u - k x, wired u_a = -w x_b and u_b = w x_a: a damped oscillation,
x_a = e^(-k t) (cos w t - sin w t), x_b = e^(-k t) (sin w t + cos w t) from x_a = x_b = 1.
"""

import json
from dataclasses import replace

import c_fmus
import numpy as np
import pytest
from conformance.c_parts import build_c
from conformance.texts import SPACES

import shipcosim as sc
from shipcosim.cosim import RunError, simulate
from shipcosim.cosim.master.groups import exchanged_at_steps, inner_connections
from shipcosim.cosim.master.plan import make_plan
from shipcosim.ssp import Component, Connection, System, read_fmu, read_system

W, K = 5.0, 2.0


@pytest.fixture
def oscillator(tmp_path, needs):
    if c_fmus.compiler() is None:
        needs("a C compiler")

    def made(form="me", versions="22"):
        parts = [build_c(f"decay_{version}_{form}", tmp_path) for version in versions]
        text = f"""<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription version="1.0" name="oscillator" {SPACES}><ssd:System name="oscillator">
<ssd:Elements>
  <ssd:Component name="a" source="{parts[0].name}"/><ssd:Component name="b" source="{parts[1].name}"/>
</ssd:Elements>
<ssd:Connections>
  <ssd:Connection startElement="b" startConnector="x" endElement="a" endConnector="u">
    <ssc:LinearTransformation factor="-{W}"/></ssd:Connection>
  <ssd:Connection startElement="a" startConnector="x" endElement="b" endConnector="u">
    <ssc:LinearTransformation factor="{W}"/></ssd:Connection>
</ssd:Connections>
</ssd:System></ssd:SystemStructureDescription>"""
        (tmp_path / "SystemStructure.ssd").write_text(text)
        return read_system(tmp_path)

    return made


def errors(table):
    """Largest error of both states, of their largest value."""
    t = table["time"].values
    exact = (
        np.exp(-K * t) * (np.cos(W * t) - np.sin(W * t)),
        np.exp(-K * t) * (np.sin(W * t) + np.cos(W * t)),
    )
    return max(
        np.abs(table[f"{name}.x"].values - one).max() for name, one in zip("ab", exact, strict=True)
    )


@pytest.mark.parametrize("versions", ["22", "11", "33", "12", "23"])
def test_wired_models_follow_the_analytic_solution_at_any_step(oscillator, versions):
    table = sc.simulate(oscillator(versions=versions), stop_time=2.0, step_size=0.125)
    assert table.attrs["integrated_together"] == "a, b"
    assert errors(table) < 1e-5


def test_exchange_at_steps_needs_thousands_of_them_for_one_per_cent_and_less(oscillator):
    system = oscillator()
    stepped = {
        h: errors(sc.simulate(system, stop_time=1.0, step_size=h, order="gauss-seidel"))
        for h in (0.01, 0.001)
    }
    together = errors(sc.simulate(system, stop_time=1.0, step_size=0.01))
    assert stepped[0.01] > 1e-2 and stepped[0.001] > 1e-3  # of first order
    assert together < 1e-5 * stepped[0.01] / 1e-2


def test_an_input_that_an_event_holds_is_held(oscillator):
    events = [{"time": 0.5, "override": {"b.u": 0.0}}]
    table = sc.simulate(oscillator(), stop_time=1.0, step_size=0.125, events=events)
    x = table["b.x"].values
    assert "the run itself changes b.u" in table.attrs["remarks"]
    assert x[5:] == pytest.approx(x[4] * np.exp(-K * 0.125 * np.arange(1, 5)), rel=1e-6)


def test_one_by_one_in_co_simulation_or_where_the_order_is_another(oscillator):
    assert (
        "integrated_together"
        not in sc.simulate(oscillator("cs"), stop_time=1.0, step_size=0.125).attrs
    )
    for options in ({"order": "gauss-seidel"}, {"isolate": True}):
        table = sc.simulate(oscillator(), stop_time=1.0, step_size=0.125, **options)
        assert "integrated_together" not in table.attrs
        (remark,) = during(table)
        assert remark.startswith(
            "a and b run in model exchange, wired together, but not as one system: "
        )
        assert "held for 0.125 s" in remark


def test_what_is_integrated_together_earns_no_remark(oscillator):
    for kind in ((), ("cs",)):
        assert during(sc.simulate(oscillator(*kind), stop_time=1.0, step_size=0.125)) == []


def during(run):
    """Remarks that the run itself made, without those on its files."""
    before = {str(remark) for remark in run.remarks}
    return [remark for remark in json.loads(run.attrs["remarks"]) if remark not in before]


def test_components_with_event_indicators_are_integrated_by_themselves_and_that_is_said(oscillator):
    """The FMUs here have none, so this asks the plan of a run, of a system whose description says that b has one."""
    system = oscillator()
    b = system.components["b"]
    eventful = replace(b, fmu=replace(b.fmu, n_event_indicators=1))
    system = replace(system, components={**system.components, "b": eventful})
    plan = make_plan(system, sc.Scenario(stop_time=1.0, step_size=0.125), {}, {}, 0.0)
    assert inner_connections(plan) == []
    (remark,) = exchanged_at_steps(plan, [], "", 0.125)
    assert "not as one system: b can have events of state (event indicators)." in remark


SWITCH = """
#define NX 0
#define NZ 1
#define STATES {0}
static void start(M* m) {}
static void equations(M* m) {}
static void indicators(M* m, double* z) { z[0] = m->r[0] - 0.5; }
static void event(M* m) { m->r[1] = m->r[0] > 0.5; }
static int completed(M* m) { return 0; }
"""


def test_event_indicators_that_a_description_does_not_list_are_refused_in_a_group(tmp_path, needs):
    # FMI 3.0 tells their number only while it runs; a group would never look at them.
    if c_fmus.compiler() is None:
        needs("a C compiler")
    ends = [("u", 0, "input", "Real", 0.0), ("y", 1, "output", "Real", None)]
    text = c_fmus.describe("switch", "3.0", ends)
    fmu = read_fmu(c_fmus.build(tmp_path, "switch", "3.0", SWITCH, text, "ModelExchange"))
    parts = {name: Component(name, fmu) for name in "ab"}
    system = System("two", "two.ssd", parts, (Connection(("a", "y"), ("b", "u")),))
    with pytest.raises(RunError, match="a has 1 event indicators that its modelDescription.xml"):
        simulate(system, sc.Scenario(stop_time=1.0, step_size=0.5))


def test_run_again_it_is_the_same(oscillator):
    system = oscillator()
    one, two = (sc.simulate(system, stop_time=1.0, step_size=0.25) for _ in range(2))
    assert one["a.x"].values.tolist() == two["a.x"].values.tolist()
