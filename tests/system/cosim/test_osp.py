"""An OspSystemStructure.xml runs here as in libcosim: the same digits, functions and groups included."""

import shutil

import numpy as np
import pytest
from osp_execution import assert_same, rows_of

from shipcosim.cosim import RunOptions, simulate
from shipcosim.cosim.export.osp import write_osp
from shipcosim.fmi.export.builder import build_fmu
from shipcosim.ssp import read_system
from shipcosim.ssp.portability.check import check_for

pytest.importorskip("libcosimpy.CosimExecution", reason="needs libcosim")

HEAD = '<OspSystemStructure xmlns="http://opensimulationplatform.com/MSMI/OSPSystemStructure" version="0.1">'
STEPS = "<BaseStepSize>0.05</BaseStepSize><Algorithm>fixedStep</Algorithm>"
GROUPS = """<ospModelDescription xmlns="http://opensimulationplatform.com/MSMI/OSPModelDescription" version="1.0">
<VariableGroups>{}</VariableGroups></ospModelDescription>"""


def variable(end):
    simulator, _, name = end.partition(".")
    return f'<Variable simulator="{simulator}" name="{name}"/>'


def signal(function, name):
    return f'<Signal function="{function}" name="{name}"/>'


def simulator(name, fmu, step_size=None, **values):
    initial = "".join(
        f'<InitialValue variable="{n}"><Real value="{v}"/></InitialValue>'
        for n, v in values.items()
    )
    step = f' stepSize="{step_size}"' if step_size else ""
    return f'<Simulator name="{name}" source="{fmu}.fmu"{step}><InitialValues>{initial}</InitialValues></Simulator>'


@pytest.fixture
def write(tmp_path, fmus):
    """Function that writes an OspSystemStructure.xml with its FMUs beside it, and gives its path."""

    def write(simulators, functions="", connections="", head=STEPS):
        for name in ("lag", "integrator", "gain"):
            shutil.copy(fmus(name) / f"{name}.fmu", tmp_path)
        path = tmp_path / "OspSystemStructure.xml"
        path.write_text(
            f"{HEAD}{head}<Simulators>{simulators}</Simulators><Functions>{functions}</Functions>"
            f"<Connections>{connections}</Connections></OspSystemStructure>"
        )
        return path

    return write


def joined(*pairs):
    return "".join(
        f"<VariableConnection>{variable(a)}{variable(b)}</VariableConnection>" for a, b in pairs
    )


def through(*pairs):
    """Connections of variables with signals of functions."""
    return "".join(
        f"<SignalConnection>{variable(v)}{signal(*s)}</SignalConnection>" for v, s in pairs
    )


LOOP = (
    simulator("plant", "integrator", y_start=0.3)
    + simulator("filter", "lag", time_constant=0.7, y_start=-0.2)
    + simulator("slow", "lag", step_size=0.15, time_constant=1.3)
    + simulator("law", "gain", factor=-0.9, offset=0.123)
)


def test_a_loop_with_functions_has_libcosims_digits(write, make_scenario):
    functions = '<Sum name="all" inputCount="3"/>'
    connections = joined(
        ("filter.u", "plant.y"), ("plant.y", "slow.u"), ("plant.u", "law.y")
    ) + through(
        ("filter.y", ("all", "in[0]")),
        ("slow.y", ("all", "in[1]")),
        ("plant.y", ("all", "in[2]")),
        ("law.u", ("all", "out")),
    )
    path = write(LOOP, functions, connections)
    system = read_system(path)
    table = simulate(system, make_scenario(3.0, 0.05))
    rows = rows_of(path, system, 60)
    slow = rows.pop("slow.y")
    assert_same(table, rows)
    assert table["slow.y"].values[3::3].tolist() == slow[2::3]


def test_a_linear_transformation_is_one_of_the_connection(write, make_scenario):
    functions = '<LinearTransformation name="half" factor="0.5" offset="0.1"/>'
    connections = joined(("plant.y", "law.u")) + through(
        ("law.y", ("half", "in")), ("plant.u", ("half", "out"))
    )
    path = write(LOOP, functions, connections)
    system = read_system(path)
    table = simulate(system, make_scenario(1.8, 0.05))
    rows = rows_of(path, system, 36)
    del rows["slow.y"]
    assert_same(table, rows)
    # y' = 0.5 (-0.9 y + 0.123) + 0.1, explicit with one step's delay
    y, u = table["plant.y"].values, 0.5 * table["law.y"].values + 0.1
    assert abs(y[1:] - (y[:-1] + 0.05 * u[:-1])).max() < 1e-15


PAIR = '''
from shipcosim.fmi import Fmu, Input, Output, Parameter


class Pair(Fmu):
    """Two integrators."""

    a = Input("N", "first rate")
    b = Input("N", "second rate")
    c = Output("N", "first integral")
    d = Output("N", "second integral")
    c_start = Parameter(0.0, "N", "at the start")
    d_start = Parameter(0.0, "N", "at the start")

    def start(self):
        self.c, self.d = self.c_start, self.d_start

    def step(self, t, h):
        self.c += h * self.a
        self.d += h * self.b
'''
PORTS = """<Generic name="port"><Force name="into"><Variable ref="a" unit="N"/><Variable ref="b"/></Force>
<Force name="from"><Variable ref="c"/><Variable ref="d"/></Force></Generic>
<Generic name="back"><Force name="out of"><Variable ref="c"/><Variable ref="d"/></Force>
<Force name="in to"><Variable ref="a"/><Variable ref="b"/></Force></Generic>
<Force name="given"><Variable ref="c"/><Variable ref="d"/></Force>
<Force name="taken"><Variable ref="a"/><Variable ref="b"/></Force>"""


@pytest.fixture
def pairs(write, tmp_path):
    """Function that writes a system of simulators with groups of variables."""
    source = tmp_path / "pair.py"
    source.write_text(PAIR)
    build_fmu(source, tmp_path)
    (tmp_path / "pair_OspModelDescription.xml").write_text(GROUPS.format(PORTS))
    return write


def grouped(tag, one, other):
    return f"<{tag}Connection>{one}{other}</{tag}Connection>"


def group(simulator, name):
    return f'<VariableGroup simulator="{simulator}" name="{name}"/>'


def test_groups_and_groups_in_them_are_connected_one_by_one(pairs, make_scenario):
    simulators = simulator("one", "pair", c_start=1.0, d_start=-2.0) + simulator(
        "two", "pair", c_start=0.5
    )
    path = pairs(
        simulators, "", grouped("VariableGroup", group("one", "port"), group("two", "back"))
    )
    system = read_system(path)
    ends = {(".".join(c.source), ".".join(c.target)) for c in system.connections}
    assert ends == {("two.c", "one.a"), ("two.d", "one.b"), ("one.c", "two.a"), ("one.d", "two.b")}
    assert_same(simulate(system, make_scenario(1.0, 0.05)), rows_of(path, system, 20))


def test_a_vector_sum_adds_groups_number_by_number(pairs, make_scenario):
    names = {"one": 1.0, "two": 0.1, "three": 0.3}
    simulators = "".join(
        simulator(n, "pair", c_start=v, d_start=-7.0 * v) for n, v in names.items()
    )
    simulators += simulator("all", "pair")
    connections = "".join(
        grouped(
            "SignalGroup", group(name, "given"), f'<SignalGroup function="sum" name="in[{i}]"/>'
        )
        for i, name in enumerate(names)
    ) + grouped("SignalGroup", '<SignalGroup function="sum" name="out"/>', group("all", "taken"))
    path = pairs(simulators, '<VectorSum name="sum" inputCount="3" dimension="2"/>', connections)
    system = read_system(path)
    table = simulate(system, make_scenario(1.0, 0.05))
    assert_same(table, rows_of(path, system, 20))
    assert table["all.c"].values[-1] == pytest.approx(1.4, 1e-12)
    assert table["all.d"].values[-1] == pytest.approx(-9.8, 1e-12)


def test_a_sum_survives_a_stop_in_between(write, make_scenario):
    connections = joined(
        ("filter.u", "plant.y"), ("plant.y", "slow.u"), ("plant.u", "law.y")
    ) + through(
        ("filter.y", ("all", "in[0]")), ("slow.y", ("all", "in[1]")), ("law.u", ("all", "out"))
    )
    system = read_system(write(LOOP, '<Sum name="all" inputCount="2"/>', connections))
    scenario, kept = make_scenario(1.8, 0.05), []
    whole = simulate(system, scenario)
    simulate(system, scenario, RunOptions(until=0.65, store=kept.append))
    rest = simulate(system, scenario, RunOptions(resume=kept[0]))
    assert rest["law.y"].values.tolist() == whole["law.y"].values[13:].tolist()


def test_an_event_on_a_summed_input_acts_on_the_sum(write, make_scenario):
    connections = joined(("plant.y", "filter.u")) + through(
        ("filter.y", ("all", "in[0]")), ("plant.y", ("all", "in[1]")), ("law.u", ("all", "out"))
    )
    simulators = LOOP.replace(' stepSize="0.15"', "")
    system = read_system(write(simulators, '<Sum name="all" inputCount="2"/>', connections))
    events = [{"time": 0.2, "bias": {"law.u": 1.0}}, {"time": 0.4, "override": {"law.u": 3.0}}]
    table = simulate(system, make_scenario(0.6, 0.05, events=events))
    added = table["filter.y"].values + table["plant.y"].values
    assert table["law.u"].values[:4].tolist() == added[:4].tolist()
    assert table["law.u"].values[4:8].tolist() == (added[4:8] + 1.0).tolist()
    assert table["law.u"].values[8:].tolist() == [3.0] * 5
    theirs = simulate(
        system, make_scenario(0.6, 0.05, events=events), RunOptions(engine="libcosim")
    )
    assert all(
        theirs[name].values.tolist() == column.values.tolist()
        for name, column in table.data_vars.items()
    )


def test_a_system_of_osp_is_exported_with_its_sums_and_has_libcosims_digits_again(
    write, make_scenario, tmp_path
):
    connections = joined(
        ("filter.u", "plant.y"), ("plant.y", "slow.u"), ("plant.u", "law.y")
    ) + through(
        ("filter.y", ("all", "in[0]")), ("slow.y", ("all", "in[1]")), ("law.u", ("all", "out"))
    )
    simulators = LOOP.replace(' stepSize="0.15"', "")
    system, scenario = (
        read_system(write(simulators, '<Sum name="all" inputCount="2"/>', connections)),
        make_scenario(),
    )
    write_osp(system, scenario, tmp_path / "again")
    assert (
        '<Sum name="sum_0" inputCount="2"/>'
        in (tmp_path / "again" / "OspSystemStructure.xml").read_text()
    )
    assert read_system(tmp_path / "again").connections != ()
    assert_same(simulate(system, scenario), rows_of(tmp_path / "again", system, 10))


@pytest.mark.parametrize("order", ["jacobi", "gauss-seidel"])
def test_a_sum_is_the_closed_form_of_its_terms(write, make_scenario, order):
    connections = through(
        ("plant.y", ("all", "in[0]")), ("filter.y", ("all", "in[1]")), ("law.u", ("all", "out"))
    )
    simulators = simulator("plant", "integrator", y_start=0.25) + simulator(
        "filter", "lag", y_start=0.5
    )
    simulators += simulator("law", "gain", factor=2.0)
    system = read_system(write(simulators, '<Sum name="all" inputCount="2"/>', connections))
    table = simulate(system, make_scenario(1.0, 0.05), RunOptions(order=order))
    decay = 0.5 * np.exp(-table["time"].values)
    wanted = 2.0 * (0.25 + (decay if order == "gauss-seidel" else np.r_[0.5, decay[:-1]]))
    np.testing.assert_allclose(table["law.y"].values, wanted, rtol=1e-12)


def errors_for_libcosim(path):
    return [str(problem) for problem in check_for("libcosim", path) if problem.severity == "error"]


def test_libcosim_refuses_a_file_without_an_algorithm_and_the_check_says_so(write):
    path = write(LOOP, head="<BaseStepSize>0.05</BaseStepSize>")
    with pytest.raises(AssertionError, match="Invalid algorithm choice"):
        rows_of(path, read_system(path), 1)
    (said,) = errors_for_libcosim(path)
    assert "without an algorithm: libcosim refuses the system" in said


def test_libcosim_drops_the_second_target_of_a_function_and_the_check_says_so(write, make_scenario):
    simulators = (
        simulator("plant", "integrator", y_start=0.5)
        + simulator("one", "gain")
        + simulator("two", "gain")
    )
    connections = through(
        ("plant.y", ("f", "in")), ("one.u", ("f", "out")), ("two.u", ("f", "out"))
    )
    path = write(simulators, '<LinearTransformation name="f" factor="2"/>', connections)
    system = read_system(path)
    ours, theirs = simulate(system, make_scenario()), rows_of(path, system, 10)
    assert (ours["one.y"][-1], ours["two.y"][-1]) == (1.0, 1.0)
    assert (theirs["one.y"][-1], theirs["two.y"][-1]) == (1.0, 0.0)
    (said,) = errors_for_libcosim(path)
    assert "A second connection from f:out: libcosim goes on without it" in said


def test_libcosim_does_not_find_groups_by_the_name_of_the_file_and_the_check_says_so(
    pairs, tmp_path
):
    path = pairs(
        simulator("one", "pair") + simulator("two", "pair"),
        "",
        grouped("VariableGroup", group("one", "port"), group("two", "back")),
    )
    assert errors_for_libcosim(path) == []
    (tmp_path / "pair.fmu").rename(tmp_path / "renamed.fmu")
    path.write_text(path.read_text().replace("pair.fmu", "renamed.fmu"))
    (tmp_path / "pair_OspModelDescription.xml").rename(tmp_path / "renamed_OspModelDescription.xml")
    assert len(read_system(path).connections) == 4
    with pytest.raises(AssertionError, match="Unable to create execution"):
        rows_of(path, read_system(path), 1)
    said = errors_for_libcosim(path)
    assert (
        len(said) == 2
        and "one: Variable groups that are not in pair_OspModelDescription.xml" in said[0]
    )
