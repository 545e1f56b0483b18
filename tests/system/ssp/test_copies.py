"""A copy of an FMU that is no longer that of its source is named on each run."""

import json
import os

import pytest

import shipcosim as sc

WINCH = """
from shipcosim.fmi import Fmu, Output


class Winch(Fmu):
    y = Output("1", "number of its version")

    def step(self, t, h):
        self.y = {}
"""


@pytest.fixture
def change(tmp_path, monkeypatch):
    """Function that writes the source of an FMU of the project in the working folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ssp").mkdir()

    def write(version):
        source = tmp_path / "fmus" / "winch" / "winch.py"
        source.parent.mkdir(parents=True, exist_ok=True)
        source.write_text(WINCH.format(float(version)))
        os.utime(source, (2e9 + version, 2e9 + version))  # later than any FMU

    write(1)
    return write


def run(system):
    done = sc.simulate(system, stop_time=0.2, step_size=0.1)
    remarks = json.loads(done.table.attrs["remarks"])
    return float(done["winch.y"][-1]), [text for text in remarks if "does not run" in text]


@pytest.mark.parametrize("fmu", ["winch", "build/fmus/winch.fmu"])
@pytest.mark.parametrize("target", ["ssp/hoist", "ssp/hoist.ssp", "ssp/hoist.ssd"])
def test_a_stale_copy_is_named(change, tmp_path, fmu, target):
    sc.build_fmu("fmus/winch", "build/fmus")
    system = sc.new("hoist")
    system.add_component("winch", fmu)
    system.write(target)
    assert run(target) == (1.0, [])
    change(2)
    value, remarks = run(target)
    assert value == 1.0 and len(remarks) == 1
    assert "winch.fmu beside the system runs" in remarks[0] and "hoist" in remarks[0]
    # Without the copy the project's runs.
    copy = (
        tmp_path / ("ssp/hoist/" if target == "ssp/hoist" else "ssp/") / "resources" / "winch.fmu"
    )
    if copy.exists():
        copy.unlink()
        assert run(target) == (2.0, [])


def test_a_built_fmu_given_by_its_path_is_built_again(change):
    fmu = "build/fmus/winch.fmu"
    sc.build_fmu("fmus/winch", "build/fmus")
    change(3)
    assert run(fmu) == (3.0, [])
    system = sc.new("hoist")
    change(4)
    system.add_component("winch", fmu)
    assert run(system) == (4.0, [])


def test_an_fmu_without_such_a_name_is_refused_with_those_that_there_are(change):
    with pytest.raises(sc.ShipcosimError, match="Did you mean 'winch'"):
        sc.new("hoist").add_component("winch", "wnch")
