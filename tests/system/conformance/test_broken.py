"""Each system of the suite, broken in one place, is refused: with the file, the line, what was found and a remedy."""

import re

import pytest
from conformance.cases import FORMS, cases, line_of, write

import shipcosim as sc
from shipcosim.ssp import check_system

GAPS = {name: case for name, case in cases().items() if case.gap}
TWINS = [(name, number) for name, case in cases().items() for number in range(len(case.twins))]


@pytest.mark.parametrize("form", ["folder, 1.0", "ssd, 2.0"])
@pytest.mark.parametrize(("name", "number"), TWINS)
def test_broken_in_one_place_it_is_refused_with_place_and_remedy(name, number, form, tmp_path):
    case = cases()[name]
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


@pytest.mark.parametrize("name", GAPS)
def test_what_is_not_done_is_refused_with_a_sentence(name, tmp_path):
    case = GAPS[name]
    path = write(case, tmp_path, case.forms[0])
    with pytest.raises((sc.ShipcosimError, KeyError), match=re.escape(case.gap)):
        table = sc.simulate(sc.read(path), **case.keywords())
        [table[signal] for signal in case.expect]  # texts are missing among the results
