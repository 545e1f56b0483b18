"""The start: values go round until every input equals what feeds it."""

import numpy as np
import pytest

from shipcosim.cosim import RunError, simulate


def test_start_values_reach_the_end_of_a_chain_of_direct_feedthrough(make_system, make_scenario):
    parts = {f"g{i}": ("gain", {"factor": 2.0}) for i in range(6)}
    parts["g5"] = ("gain", {"factor": 2.0, "u": 1.0})
    links = [f"g{i + 1}.y -> g{i}.u" for i in range(5)]
    table = simulate(make_system(parts, links), make_scenario(0.1, 0.1))
    assert [float(table[f"g{i}.y"][0]) for i in range(6)] == [64.0, 32.0, 16.0, 8.0, 4.0, 2.0]


def test_a_loop_of_direct_feedthrough_starts_at_its_solution(make_system, make_scenario):
    loop = {"a": ("gain", {"factor": 0.5, "offset": 3.0}), "b": ("gain", {"factor": -0.5})}
    table = simulate(make_system(loop, ["a.y -> b.u", "b.y -> a.u"]), make_scenario(1.0, 0.1))
    assert np.allclose(table["a.y"], 3.0 / 1.25, rtol=1e-15)


@pytest.mark.parametrize("factor", [1.0, -1.0, 1.5])
def test_a_loop_that_does_not_settle_is_named(make_system, make_scenario, factor):
    loop = {"a": ("gain", {"factor": factor, "offset": 1.0}), "b": "gain", "lag": "lag"}
    system = make_system(loop, ["a.y -> b.u", "b.y -> a.u", "b.y -> lag.u"])
    with pytest.raises(RunError, match=r"does not settle.*a\.u, b\.u") as error:
        simulate(system, make_scenario(1.0, 0.1))
    assert error.value.table.sizes["time"] == 0


def test_types_other_than_real_reach_the_start_too(make_system, make_scenario):
    parts = {"a": ("meter", {"number": 4}), "b": "meter", "c": "meter"}
    table = simulate(
        make_system(parts, ["a.number_seen -> b.number", "b.number_seen -> c.number"]),
        make_scenario(),
    )
    assert np.all(table["c.number_seen"] == 4)


STOCK = """
from pythonfmu import Fmi2Slave, Fmi2Causality, Fmi2Initial, Fmi2Variability, Real


class Ship(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.length, self.area, self.y = 2.0, 0.0, 0.0
        fixed = {"variability": Fmi2Variability.fixed}
        self.register_variable(Real("length", causality=Fmi2Causality.parameter, **fixed))
        self.register_variable(Real("y", causality=Fmi2Causality.output))
        calculated = {"causality": Fmi2Causality.calculatedParameter, "initial": Fmi2Initial.calculated}
        self.register_variable(Real("area", getter=lambda: self.length**2, **calculated, **fixed))

    def exit_initialization_mode(self):
        self.y = self.length

    def do_step(self, t, h):
        return True
"""


def test_calculated_parameters_reach_the_parameters_they_feed(pythonfmu_code, make_scenario):
    system = pythonfmu_code(STOCK, ["stock.area -> other.length"])
    table = simulate(system, make_scenario(set={"stock.length": 3.0}))
    assert (float(table["stock.y"][0]), float(table["other.y"][0])) == (3.0, 9.0)
