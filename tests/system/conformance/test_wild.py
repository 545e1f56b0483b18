"""Files of the wild: what breaks a standard and has only one meaning runs, with a remark; `--strict` refuses it.

A kind of flaw is one file in wild/, written like those in features/ (see `conformance.cases`).
"""

import pytest
import typer
from conformance.cases import HERE, read_cases, write
from conformance.test_features import assert_closed_form

import shipcosim as sc
from shipcosim.cli.commands.check import check
from shipcosim.cli.commands.simulate import simulate
from shipcosim.cli.outcomes.exits import FAILED, guarded
from shipcosim.errors import ShipcosimError
from shipcosim.ssp import check_system, read_system

WILD = read_cases(HERE / "wild")


@pytest.fixture
def path(flaw, tmp_path):
    return write(WILD[flaw], tmp_path)


def run(case, path):
    system = read_system(path)
    return sc.simulate(
        system, **{"stop_time": case.stop_time, "step_size": case.step_size} | case.run
    )


@pytest.mark.parametrize("flaw", WILD)
def test_it_runs_as_its_only_meaning_with_the_remark_that_belongs_to_it(flaw, path):
    assert_closed_form(run(WILD[flaw], path), WILD[flaw])
    problems = check_system(path)
    said = "\n".join(str(problem) for problem in problems if problem.flaw)
    assert [problem for problem in problems if problem.severity == "error"] == []
    assert [text for text in WILD[flaw].remarks if text not in said] == [], said


@pytest.mark.parametrize("flaw", WILD)
def test_strict_refuses_it_with_the_same_words_and_a_remedy(flaw, path):
    with pytest.raises(ShipcosimError) as caught:
        read_system(path, strict=True)
    said = "\n".join(map(str, caught.value.problems))
    assert [text for text in WILD[flaw].remarks if text not in said] == [], said
    assert all(problem.severity == "error" and problem.remedy for problem in caught.value.problems)


@pytest.mark.parametrize(
    "flaw", [name for name, case in WILD.items() if case.top == "SystemStructure.ssd"]
)
def test_read_for_changes_and_written_it_is_without_flaw_of_form_or_runs_the_same(
    flaw, path, tmp_path
):
    sc.read(path).write(tmp_path / "written.ssp")
    assert_closed_form(run(WILD[flaw], tmp_path / "written.ssp"), WILD[flaw])


@pytest.mark.parametrize("flaw", ["empty_elements"])
def test_the_commands_say_it_and_refuse_it_with_strict(flaw, path, capsys):
    guarded(check)([str(path)])
    assert "remark: " in capsys.readouterr().out
    with pytest.raises(typer.Exit) as caught:
        guarded(check)([str(path)], strict=True)
    assert caught.value.exit_code == FAILED
    with pytest.raises(ShipcosimError, match="startElement"):
        simulate(str(path), strict=True)
