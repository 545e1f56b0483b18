"""Every feature of the standard gives its closed form, however it is written down, also read and written again.

A feature is one file in features/, see `conformance.cases`.
"""

import numpy as np
import pytest
from conformance.cases import cases, write

import shipcosim as sc

EACH = {name: case for name, case in cases().items() if not case.gap}
QUICK = ("folder, 1.0", "ssp, 2.0, other prefixes")
"""Forms that CI runs; the others, each of which differs from these in one thing, run at night."""
FORMED = [(name, form) for name, case in EACH.items() for form in case.forms]
IN_CI = [(name, form) for name, form in FORMED if form in QUICK or len(EACH[name].versions) == 1]


def run(system, case):
    """Table of a case's run."""
    return sc.simulate(system, **case.keywords())


def assert_closed_form(table, case):
    assert table["time"].values.tolist() == pytest.approx(case.times().tolist(), abs=1e-12)
    for signal in case.expect:
        values, wanted = table[signal].values, case.closed_form(signal)
        if np.issubdtype(wanted.dtype, np.number) and not isinstance(values[0], str):
            assert values == pytest.approx(wanted, rel=case.tolerance, abs=case.tolerance), signal
        else:
            assert values.tolist() == wanted.tolist(), signal


@pytest.mark.parametrize(("name", "form"), IN_CI)
def test_a_feature_gives_its_closed_form(name, form, tmp_path):
    check_feature(name, form, tmp_path)


def check_feature(name, form, tmp_path):
    case = EACH[name]
    system = sc.read(write(case, tmp_path, form))
    assert_closed_form(run(system, case), case)
    remarks = "\n".join(map(str, system.check()))
    assert not [text for text in case.remarks if text not in remarks], remarks


@pytest.mark.parametrize("name", [name for name, case in EACH.items() if not case.remarks])
def test_what_is_right_makes_no_error_and_no_remark_but_of_unconnected_inputs_and_loops(
    name, tmp_path
):
    problems = sc.read(write(EACH[name], tmp_path, EACH[name].forms[0])).check()
    expected = ("Unconnected inputs", "An algebraic loop")
    assert [str(problem) for problem in problems if not problem.found.startswith(expected)] == []


@pytest.mark.parametrize("name", EACH)
@pytest.mark.parametrize("form", QUICK)
def test_read_and_written_again_it_is_the_same_system(name, form, tmp_path):
    case = EACH[name]
    if form not in case.forms:
        pytest.skip("this case exists in one version of the standard")
    system = sc.read(write(case, tmp_path / "before", form))
    system.write(tmp_path / "after.ssp")
    again = sc.read(tmp_path / "after.ssp")
    assert flat(again.checked()) == flat(system.checked())
    if form != "folder, 1.0":
        assert_closed_form(run(again, case), case)


def flat(system):
    """What a system is, without where it stands."""
    parts = {
        name: (c.start, c.step_size, c.implementation) for name, c in system.components.items()
    }
    wires = [
        (c.source, c.target, c.factor, c.offset, c.mapping, c.initial) for c in system.connections
    ]
    return parts, wires, system.inputs, system.outputs, system.parameters, system.experiment
