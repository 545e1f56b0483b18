"""Sobol indices: of a system whose indices are known, with runs that fail, from parameters with a tolerance."""

import shutil
from pathlib import Path

import numpy as np
import pandas
import pytest
from sweep.projects import built_project, work_in
from typer.testing import CliRunner

import shipcosim
from shipcosim.cli import app
from shipcosim.errors import ShipcosimError
from shipcosim.sweep import plan_of, read_study

FMU = '''
"""A sum with a product in it."""

from shipcosim.fmi import Fmu, Output, Parameter


class Sum(Fmu):
    """y = a + b + c d."""

    y = Output("m", "sum")
    a = Parameter(0.0, "m", "alone")
    b = Parameter(0.0, "m", "alone")
    c = Parameter(0.0, "m", "with d")
    d = Parameter(0.0, "1", "with c")
    fails_above = Parameter(1e9, "m", "value of b above which a step raises")

    def start(self):
        self.y = 0.0

    def step(self, t, h):
        if self.b > self.fails_above:
            raise ValueError("b is too large")
        self.y = self.a + self.b + self.c * self.d
'''
SSD = """<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription name="sums" version="1.0"
    xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
    xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">
  <ssd:System name="sums">
    <ssd:Elements>
      <ssd:Component name="one" type="application/x-fmu-sharedlibrary" source="resources/sum.fmu"/>
    </ssd:Elements>
  </ssd:System>
</ssd:SystemStructureDescription>
"""
SSV = """<?xml version="1.0" encoding="UTF-8"?>
<ssv:ParameterSet version="1.0" name="stated"
    xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon">
  <ssv:Parameters>PARAMETERS</ssv:Parameters>
</ssv:ParameterSet>
"""
STATED = """
    <ssv:Parameter name="one.NAME">
      <ssv:Real value="0.0"/>
      <ssc:Annotations><ssc:Annotation type="shipcosim.tolerance"><tolerance value="TOLERANCE"/></ssc:Annotation>
      </ssc:Annotations>
    </ssv:Parameter>"""
TOLERANCES = {"a": 1.0, "b": 2.0, "c": 1.0, "d": 1.0}
FIRST_ORDER = {"one.a": 1 / 6, "one.b": 4 / 6, "one.c": 0.0, "one.d": 0.0}
TOTAL = {"one.a": 1 / 6, "one.b": 4 / 6, "one.c": 1 / 6, "one.d": 1 / 6}
STUDY = """
scenario = "one_step"

[sample]
method = "saltelli"
runs   = 128

[sample.of]
"one.*" = { tolerance = true }

[[quantity]]
name   = "sum"
signal = "one.y"
reduce = "final"

[[view]]
kind     = "bars"
table    = "indices"
only     = { quantity = "sum" }
category = "parameter"
value    = ["total", "first_order"]
"""


@pytest.fixture(scope="module")
def sums(tmp_path_factory):
    stated = "".join(
        STATED.replace("NAME", n).replace("TOLERANCE", str(t)) for n, t in TOLERANCES.items()
    )
    files = {
        "fmus/sum/sum.py": FMU,
        "ssp/sums/SystemStructure.ssd": SSD,
        "ssp/sums/resources/stated.ssv": SSV.replace("PARAMETERS", stated),
        "scenarios/one_step.toml": 'system = "sums"\nparameters = "stated"\nstop_time = 0.1\nstep_size = 0.1\n',
        "studies/sensitivity.toml": STUDY,
    }
    return built_project(tmp_path_factory.mktemp("sums"), files)


@pytest.fixture
def project(sums, tmp_path, monkeypatch):
    """Folder of the project, as the working folder; its study is that of the test alone."""
    shutil.copytree(sums / "studies", tmp_path / "studies")
    return work_in(tmp_path, sums, monkeypatch)


def write(text, name="own"):
    path = Path("studies") / f"{name}.toml"
    path.write_text(text)
    return path


def swept(study="sensitivity", out="out", **options):
    options.setdefault("workers", 1)
    return shipcosim.sweep(study, out=out, engine="fmpy", **options)


def test_known_indices_lie_in_their_intervals_and_the_largest_comes_first(project):
    found = swept().tables["indices"].set_index("parameter")
    assert len(found) == 4 and found.index[0] == "one.b" and (found["blocks"] == 128).all()
    for name, known in (("first_order", FIRST_ORDER), ("total", TOTAL)):
        for parameter, value in known.items():
            assert (
                found.loc[parameter, f"{name}_low"] <= value <= found.loc[parameter, f"{name}_high"]
            ), (
                name,
                parameter,
            )
    assert found["total"].is_monotonic_decreasing
    widths = found["total_high"] - found["total_low"]
    assert 0.02 < widths.min() and widths.max() < 0.6


def test_a_study_that_stopped_and_one_on_two_workers_give_the_same_indices(project):
    write('extends = "sensitivity"\n[sample]\nruns = 16\n')
    whole = swept("own", out="whole")
    part = swept("own", out="part", at_most=50)
    assert part.tables["indices"]["blocks"].tolist() == 4 * [50 // 6]
    assert "without 8 of 16 blocks, 8 since not all of it is done" in part.about["remarks"][0]
    rest = swept("own", out="part", workers=2)
    pandas.testing.assert_frame_equal(rest.tables["indices"], whole.tables["indices"])
    assert "remarks" not in rest.about
    assert (project / "part/indices.csv").read_bytes() == (
        project / "whole/indices.csv"
    ).read_bytes()


def test_a_failed_run_takes_its_block_with_it_and_that_is_said(project):
    whole = swept(out="whole").runs
    limit = float(whole["one.b"].max()) - 1e-9
    write(f'extends = "sensitivity"\n[set]\n"one.fails_above" = {limit!r}\n')
    called = CliRunner().invoke(
        app, ["sweep", "own", "--engine", "fmpy", "--workers", "1", "--out", "out"]
    )
    failed = whole.index[whole["one.b"] > limit]
    blocks = {number // 6 for number in failed}
    left = 128 - len(blocks)
    assert (
        f"without {len(blocks)} of 128 blocks, {len(blocks)} since a run of it failed"
        in called.stdout
    )
    assert pandas.read_csv("out/indices.csv")["blocks"].tolist() == 4 * [left]
    kept = np.array([number for number in range(len(whole)) if number // 6 not in blocks])
    reference = _total_of_b(whole["sum"].to_numpy()[kept].reshape(-1, 6))
    found = pandas.read_csv("out/indices.csv").set_index("parameter")
    assert found.loc["one.b", "total"] == pytest.approx(reference, rel=1e-9)


def _total_of_b(blocks):
    """Jansen's estimate of the total index of the second parameter; a block is A, AB of each parameter, B."""
    variance = np.var(np.concatenate([blocks[:, 0], blocks[:, -1]]))
    return float(np.mean((blocks[:, 0] - blocks[:, 2]) ** 2) / 2.0 / variance)


def test_command_prints_the_indices_and_the_page_draws_them(project):
    write('extends = "sensitivity"\n[sample]\nruns = 32\n')
    called = CliRunner().invoke(app, ["sweep", "own", "--engine", "fmpy", "--workers", "1"])
    lines = called.stdout.splitlines()
    at = lines.index("Sobol indices of sum:")
    assert called.exit_code == 0 and lines[at + 2].split()[0] == "one.b"
    page = (project / "results/own/report.html").read_text(encoding="utf-8")
    assert "is not drawn" not in page and "total, first_order by parameter" in page


def test_indices_are_given_for_each_level_of_other_factors(project):
    write(
        'extends = "sensitivity"\n[sample]\nruns = 8\n'
        '[[factor]]\nname = "shift"\n[[factor.case]]\nlabel = "none"\n'
        '[[factor.case]]\nlabel = "failing"\nset = { "one.fails_above" = -100.0 }\n'
    )
    found = swept("own")
    assert found.tables["indices"]["shift"].tolist() == 4 * ["none"]
    assert any("sum, shift failing: no indices" in remark for remark in found.about["remarks"])


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (
            '"one.*" = { distribution = "norm" }',
            r"line 9: 'one\.\*' stands for each parameter with a tolerance",
        ),
        (
            '"two.*" = { tolerance = true }',
            r"line 9: No parameter set states a tolerance of two\.\*",
        ),
        ('"one.a" = { tolerance = true, also = ["one.e"] }', "line 9: .*'e'"),
    ],
)
def test_a_mistake_in_what_is_sampled_is_said_at_its_line(project, line, said):
    path = write(STUDY.replace('"one.*" = { tolerance = true }', line))
    with pytest.raises(ShipcosimError, match=said):
        plan_of(read_study(path))


def test_signals_that_go_together_are_one_parameter(project):
    path = write(
        STUDY.replace('"one.*"', '"one.c" = { tolerance = true, also = ["one.d"] }\n"one.*"')
    )
    plan = plan_of(read_study(path))
    assert [one.name for one in plan.samples.columns] == ["one.c", "one.a", "one.b"]
    assert len(plan) == 128 * 5 and all(
        plan.run(n).values["one.c"] == plan.run(n).values["one.d"] for n in range(9)
    )
