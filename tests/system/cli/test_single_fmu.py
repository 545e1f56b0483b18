"""One FMU runs by itself, of every version and form: its inputs from a table, its parameters set."""

import random
import re
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import c_fmus
import numpy as np
import pytest
from conformance.c_parts import build_c
from conformance.fmus import build_part
from hypothesis import given, settings
from hypothesis import strategies as st

import shipcosim as sc
from shipcosim.calls.arguments import without_none
from shipcosim.checks import check_any
from shipcosim.cli.commands.simulate import simulate
from shipcosim.series import read_table
from shipcosim.ssp import (
    Component,
    System,
    default_step_size,
    read_fmu,
    read_system,
    settings_for,
    step_remarks,
    with_values,
)
from shipcosim.ssp.flatten.own_steps import with_whole_steps
from shipcosim.ssp.xml.document import Findings


def test_it_runs_on_inputs_of_a_table_with_a_value_set(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "inputs.csv").write_text(
        "time [s],u [m]\n" + "".join(f"{0.25 * i},{i}\n" for i in range(9))
    )
    simulate(
        str(build_part("gain")),
        2.0,
        0.25,
        inputs="inputs.csv",
        settings=["factor=3"],
        out=tmp_path / "out",
    )
    table = read_table(tmp_path / "out" / "result.nc")
    assert table["gain.y"].values == pytest.approx(3.0 * np.maximum(np.arange(9) - 1.0, 0.0))
    assert table["gain.y"].attrs["units"] == "m"


def test_parameters_are_named_with_and_without_the_component():
    system = read_system(build_part("gain"))
    assert settings_for(system, {"factor": 2, "gain.shift": 1, "u": 4, "gain.u": 5}) == {
        "gain.factor": 2,
        "gain.shift": 1,
        "u": 5,
    }
    with pytest.raises(sc.ShipcosimError, match="factr"):
        with_values(system, settings_for(system, {"factr": 2}))


@pytest.mark.parametrize(
    "name", ["decay_1_cs", "decay_1_me", "decay_2_me", "decay_3_cs", "decay_3_me", "matrix"]
)
def test_every_version_and_form_runs_by_itself(name, needs, tmp_path):
    if c_fmus.compiler() is None:
        needs("a C compiler")
    path = build_c(name, tmp_path)
    system = read_system(path)
    step = 1 / 16
    table = sc.simulate(system, stop_time=1.0, step_size=step)
    if name == "matrix":
        assert [signal for signal in table if signal.startswith("echo.")]
        return
    n = np.arange(17)
    exact = np.exp(-2 * n * step) if name.endswith("me") else (1 - 2 * step) ** n
    assert table[f"{name}.x"].values == pytest.approx(exact, rel=1e-6)


def _with_experiment(fmu, target, experiment):
    """The FMU with another default experiment."""
    with zipfile.ZipFile(fmu) as before, zipfile.ZipFile(target, "w") as after:
        for name in before.namelist():
            data = before.read(name)
            if name == "modelDescription.xml":
                data = re.sub(rb"<DefaultExperiment[^>]*/>", b"", data)
                where = data.index(b"<ModelVariables>")
                data = data[:where] + experiment.encode() + data[where:]
            after.writestr(name, data)
    return target


@given(
    duration=st.sampled_from([-1.0, 0.0, 5e-324, 1e-3, 1.0, 1.7e308]),
    step=st.sampled_from([None, 5e-324, 1e-13, 1e-3, 1.0, 1.7e308]),
)
def test_steps_and_runs_of_any_length_give_a_step_size(duration, step):
    fmu = replace(read_fmu(build_part("gain")), experiment=without_none({"stepSize": step}))
    system = System("gain", "gain.fmu", {"gain": Component("gain", fmu, step_size=step)})
    assert default_step_size(system, 0.0, duration) >= 0.0
    for is_libcosims in (False, True):
        (fitted,) = with_whole_steps(system.components, 0.1, Findings(), is_libcosims).values()
        assert fitted.step_size is None or fitted.step_size > 0.0


@given(
    start=st.sampled_from([0.0, 0.1, 1.0, 1000.0]),
    duration=st.sampled_from([0.5, 1.0, 12.5663706143592, 3600.0]),
    step=st.sampled_from([None, 1e-3, 0.3, 0.1, 5.0]),
)
@settings(max_examples=40, deadline=None)
def test_a_step_size_is_found_for_every_stop_time(start, duration, step):
    fmu = replace(read_fmu(build_part("gain")), experiment=without_none({"stepSize": step}))
    system = System("gain", "gain.fmu", {"gain": Component("gain", fmu)})
    found = default_step_size(system, start, start + duration)
    n = duration / found
    assert n == pytest.approx(max(1, round(n)), rel=1e-6)
    if step is None:
        assert n == pytest.approx(500)
    elif duration / step == pytest.approx(round(duration / step), rel=1e-9):
        assert found == step and not step_remarks(system, start, start + duration)
    else:
        (remark,) = step_remarks(system, start, start + duration)
        assert f"{step:.9g} s does not divide" in remark.found and f"{found:.9g} s" in remark.found


@pytest.mark.parametrize(
    ("experiment", "stop_time", "n_rows", "n_remarks"),
    [
        ('<DefaultExperiment startTime="0" stopTime="4"/>', 0.5, 501, 0),
        ('<DefaultExperiment startTime="1" stopTime="4"/>', None, 501, 0),
        ('<DefaultExperiment stopTime="12.5663706143592" stepSize="0.25"/>', 0.5, 3, 0),
        ('<DefaultExperiment stopTime="1" stepSize="0.3"/>', None, 4, 1),
        ("", 2.0, 501, 0),
    ],
)
def test_a_stop_time_alone_is_enough(tmp_path, experiment, stop_time, n_rows, n_remarks):
    fmu = _with_experiment(build_part("gain"), tmp_path / "own.fmu", experiment)
    run = sc.simulate(str(fmu), stop_time=stop_time)
    assert run.sizes["time"] == n_rows and len(run.remarks) == n_remarks
    ends = stop_time or float(re.search('stopTime="(.*?)"', experiment)[1])
    assert run["time"][-1] == pytest.approx(ends)


@pytest.mark.parametrize("given_value", [None, 3.0])
def test_an_input_is_set_only_if_somebody_gives_a_value(given_value, tmp_path, needs):
    """The FMU counts how often its input is set."""
    if c_fmus.compiler() is None:
        needs("a C compiler")
    variables = [("u", 1, "input", "Real", 1.0), ("n", 0, "output", "Integer", None)]
    model = """
#define NX 0
#define NZ 0
#define STATES {0}
static void start(M* m) { m->r[1] = 1; m->r[2] = 1; }
static void equations(M* m) { m->i[0] = m->r[1] != m->r[2]; }
static void indicators(M* m, double* z) {}
static void event(M* m) {}
static int completed(M* m) { return 0; }
"""
    text = c_fmus.describe("counts", "2.0", variables, ("CoSimulation",))
    # The FMU's value differs from the start value that its description states: setting it would show.
    text = text.replace('start="1.0"', 'start="1.5"')
    fmu = c_fmus.build(tmp_path, "counts", "2.0", model, text)
    run = sc.simulate(
        str(fmu),
        stop_time=1.0,
        step_size=0.5,
        set={} if given_value is None else {"u": given_value},
    )
    assert run["counts.n"].values[-1] == (given_value is not None)


VALUES = ("", "0", "-1", "1e400", "furlong", "input", "output", "parameter", "local", "NaN", "true")
VALUES += ("continuous", "fixed", "exact", "99999999999", "\u00e9")


def spoilt(rng, text):
    """A description with one attribute or element removed, exchanged, misspelt or doubled, as exporters write them."""
    attribute = rng.choice(list(re.finditer(r' ([\w:]+)="([^"]*)"', text)))
    element = rng.choice(list(re.finditer(r"<(\w+)[^<>]*/>", text)))
    others = [one[2] for one in re.finditer(r' ([\w:]+)="([^"]*)"', text)]
    begin, end, put = rng.choice(
        [
            (*attribute.span(), ""),
            (*attribute.span(2), rng.choice([*VALUES, *others])),
            (*attribute.span(2), rng.choice(VALUES)),
            (*attribute.span(1), f"{attribute[1]}x"),
            (*element.span(), ""),
            (*element.span(), 2 * element[0]),
            (*element.span(1), rng.choice(("Unknown", "Real", "Unit", "ScalarVariable"))),
        ]
    )
    return text[:begin] + put + text[end:]


def check_and_validator(seed, folder):
    """Whether check, and whether the validator of FMPy find an error in an FMU whose description is spoilt."""
    from fmpy.validation import validate_fmu

    rng = random.Random(seed)
    original = build_part(rng.choice(("gain", "ramp", "echo")))
    fmu = Path(folder) / "spoilt.fmu"
    with zipfile.ZipFile(original) as before, zipfile.ZipFile(fmu, "w") as after:
        for name in before.namelist():
            content = before.read(name)
            if name == "modelDescription.xml":
                content = spoilt(rng, content.decode()).encode()
            after.writestr(name, content)
    found = any(problem.severity == "error" for problem in check_any(str(fmu)))
    try:
        return found, bool(validate_fmu(str(fmu)))
    except Exception:
        return found, True


def test_check_finds_what_the_validator_of_fmpy_finds_and_nothing_in_a_sound_fmu(tmp_path):
    verdicts = [check_and_validator(f"ci {number}", tmp_path) for number in range(40)]
    assert all(found == theirs for found, theirs in verdicts)
    assert 10 < sum(found for found, _ in verdicts) < 40


@pytest.mark.skipif(sys.platform != "linux", reason="the loader of Linux lists what is missing")
def test_check_names_a_library_that_a_binary_needs_and_that_is_not_here(tmp_path, needs):
    if c_fmus.compiler() is None:
        needs("a C compiler")
    (tmp_path / "empty.c").write_text("int deep(void) { return 1; }")
    (tmp_path / "model.c").write_text("int deep(void); int near(void) { return deep(); }")
    make = [c_fmus.compiler(), "-shared", "-fPIC", "-o"]
    deep, binary = tmp_path / "libdeep.so", tmp_path / "gain.so"
    subprocess.run([*make, deep, tmp_path / "empty.c"], check=True)
    subprocess.run([*make, binary, tmp_path / "model.c", deep], check=True)
    deep.unlink()
    original, fmu = build_part("gain"), tmp_path / "needy.fmu"
    with zipfile.ZipFile(original) as before, zipfile.ZipFile(fmu, "w") as after:
        for name in before.namelist():
            is_binary = name == "binaries/linux64/gain.so"
            after.writestr(name, binary.read_bytes() if is_binary else before.read(name))
    found = [problem for problem in check_any(str(fmu)) if problem.severity == "error"]
    assert len(found) == 1 and "libdeep.so, which is not here" in found[0].found
    assert not [problem for problem in check_any(str(original)) if problem.severity == "error"]
