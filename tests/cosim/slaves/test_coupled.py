"""Components in model exchange that are wired together are integrated as one system: against the analytic solution.

Two FMUs of one state each, x' = u - k x, wired u_a = -w x_b and u_b = w x_a: a damped oscillation,
x_a = e^(-k t) (cos w t - sin w t), x_b = e^(-k t) (sin w t + cos w t) from x_a = x_b = 1.
"""

import c_fmus
import numpy as np
import pytest
from conformance.c_parts import build_c
from conformance.texts import SPACES

import shipcosim as sc
from shipcosim.ssp import read_system

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
    exact = np.exp(-K * t) * (np.cos(W * t) - np.sin(W * t)), np.exp(-K * t) * (np.sin(W * t) + np.cos(W * t))
    return max(np.abs(table[f"{name}.x"].values - one).max() for name, one in zip("ab", exact, strict=True))


@pytest.mark.parametrize("versions", ["22", "11", "33", "12", "23"])
def test_wired_models_follow_the_analytic_solution_at_any_step(oscillator, versions):
    table = sc.simulate(oscillator(versions=versions), stop_time=2.0, step_size=0.125)
    assert table.attrs["integrated_together"] == "a, b"
    assert errors(table) < 1e-5


def test_exchange_at_steps_needs_thousands_of_them_for_one_per_cent_and_less(oscillator):
    system = oscillator()
    stepped = {h: errors(sc.simulate(system, stop_time=1.0, step_size=h, order="gauss-seidel")) for h in (0.01, 0.001)}
    together = errors(sc.simulate(system, stop_time=1.0, step_size=0.01))
    assert stepped[0.01] > 1e-2 and stepped[0.001] > 1e-3  # of first order
    assert together < 1e-5 * stepped[0.01] / 1e-2


def test_an_input_that_an_event_holds_is_held(oscillator):
    events = [{"time": 0.5, "override": {"b.u": 0.0}}]
    table = sc.simulate(oscillator(), stop_time=1.0, step_size=0.125, events=events)
    x = table["b.x"].values
    assert x[5:] == pytest.approx(x[4] * np.exp(-K * 0.125 * np.arange(1, 5)), rel=1e-6)


def test_one_by_one_in_co_simulation_or_where_the_order_is_another(oscillator):
    assert "integrated_together" not in sc.simulate(oscillator("cs"), stop_time=1.0, step_size=0.125).attrs
    table = sc.simulate(oscillator(), stop_time=1.0, step_size=0.125, order="gauss-seidel")
    assert "integrated_together" not in table.attrs


def test_run_again_it_is_the_same(oscillator):
    system = oscillator()
    one, two = (sc.simulate(system, stop_time=1.0, step_size=0.25) for _ in range(2))
    assert one["a.x"].values.tolist() == two["a.x"].values.tolist()
