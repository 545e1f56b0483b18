"""Every feature of the standard gives its closed form, however it is written down; broken in one place it is refused.

A feature is one file in features/, see `conformance.cases`.
"""

import re

import c_fmus
import numpy as np
import pytest
from conformance.cases import FORMS, cases, line_of, write

import shipcosim as sc
from shipcosim.ssp import check_system

GAPS = {name: case for name, case in cases().items() if case.gap}
EACH = {name: case for name, case in cases().items() if not case.gap}
FORMED = [(name, form) for name, case in EACH.items() for form in case.forms]
TWINS = [(name, number) for name, case in EACH.items() for number in range(len(case.twins))]


@pytest.fixture(autouse=True)
def compiler(request, needs):
    """What a C compiler is needed for is left out where there is none."""
    case = cases()[request.node.callspec.params["name"]]
    if case.needs_compiler and c_fmus.compiler() is None:
        needs("a C compiler")


def run(system, case):
    """Table of a case's run."""
    given = {"stop_time": case.stop_time, "step_size": case.step_size}
    given = {key: value for key, value in given.items() if key not in case.run}
    return sc.simulate(system, **given)


def assert_closed_form(table, case):
    assert table["time"].values.tolist() == pytest.approx(case.times().tolist(), abs=1e-12)
    for signal in case.expect:
        values, wanted = table[signal].values, case.closed_form(signal)
        if np.issubdtype(wanted.dtype, np.number) and not isinstance(values[0], str):
            assert values == pytest.approx(wanted, rel=case.tolerance, abs=case.tolerance), signal
        else:
            assert values.tolist() == wanted.tolist(), signal


@pytest.mark.parametrize(("name", "form"), FORMED)
def test_a_feature_gives_its_closed_form(name, form, tmp_path):
    case = EACH[name]
    system = sc.read(write(case, tmp_path, form))
    assert_closed_form(run(system, case), case)
    remarks = "\n".join(map(str, system.check()))
    assert not [text for text in case.remarks if text not in remarks], remarks


@pytest.mark.parametrize("name", [name for name, case in EACH.items() if not case.remarks])
def test_what_is_right_makes_no_error_and_no_remark_but_of_unconnected_inputs_and_loops(name, tmp_path):
    problems = sc.read(write(EACH[name], tmp_path, EACH[name].forms[0])).check()
    expected = ("Unconnected inputs", "An algebraic loop")
    assert [str(problem) for problem in problems if not problem.found.startswith(expected)] == []


@pytest.mark.parametrize("form", ["folder, 1.0", "ssd, 2.0"])
@pytest.mark.parametrize(("name", "number"), TWINS)
def test_broken_in_one_place_it_is_refused_with_place_and_remedy(name, number, form, tmp_path):
    case = EACH[name]
    twin = case.twins[number]
    if FORMS[form][1] not in twin.versions or form not in case.forms:
        pytest.skip("this is no fault in this version of the standard")
    problems = check_system(write(case, tmp_path, form, twin))
    errors = [problem for problem in problems if problem.severity == "error"]
    assert len(errors) == 1 + twin.follow, "\n".join(map(str, errors))
    assert twin.says in str(errors[0])
    assert errors[0].remedy
    if twin.at != "-":
        file, line = line_of(case, twin)
        assert re.search(rf"{re.escape(file)}, line {line}\b", errors[0].where), errors[0].where


@pytest.mark.parametrize("name", EACH)
@pytest.mark.parametrize("form", ["folder, 1.0", "ssp, 2.0, other prefixes"])
def test_read_and_written_again_it_is_the_same_system(name, form, tmp_path):
    case = EACH[name]
    if form not in case.forms:
        pytest.skip("this case exists in one version of the standard")
    system = sc.read(write(case, tmp_path / "before", form))
    system.write(tmp_path / "after.ssp")
    again = sc.read(tmp_path / "after.ssp")
    assert flat(again.checked()) == flat(system.checked())
    assert_closed_form(run(again, case), case)


@pytest.mark.parametrize("name", GAPS)
def test_what_is_not_done_is_refused_with_a_sentence(name, tmp_path):
    case = GAPS[name]
    path = write(case, tmp_path, case.forms[0])
    with pytest.raises((sc.ShipcosimError, KeyError), match=re.escape(case.gap)):
        table = run(sc.read(path), case)
        [table[signal] for signal in case.expect]  # texts are missing among the results


def flat(system):
    """What a system is, without where it stands."""
    parts = {name: (c.start, c.step_size, c.implementation) for name, c in system.components.items()}
    wires = [(c.source, c.target, c.factor, c.offset, c.mapping, c.initial) for c in system.connections]
    return parts, wires, system.inputs, system.outputs, system.parameters, system.experiment
