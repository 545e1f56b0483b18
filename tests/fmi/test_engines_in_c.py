"""libcosim and ecos as libraries of a program that is not Python, tests/fmi/engines.c, with the DP ship's FMUs."""

import importlib.util
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from shipcosim.cli.project import build_stale
from shipcosim.cosim import simulate
from shipcosim.cosim.export.osp import osp_files
from shipcosim.scenario import Scenario
from shipcosim.ssp import pack, read_fmu, read_system

STEPS, H = 100, 0.05


@pytest.fixture
def run(compiled, only_numpy, tmp_path):
    """run(arguments) -> the value that the program prints among what the engine logs."""
    program = compiled("engines.c")

    def run(*arguments):
        path = os.pathsep.join([str(only_numpy), "/usr/bin", "/bin"])
        done = subprocess.run(
            [program, *map(str, arguments)],
            capture_output=True,
            text=True,
            cwd=tmp_path,
            env={"PATH": path},
            timeout=60,
        )
        assert done.returncode == 0, done.stderr[-2000:]
        values = [line for line in done.stdout.splitlines() if line[:1].isdigit() or line[:1] == "-"]
        assert len(values) == 1
        return float(values[0])

    return run


@pytest.fixture
def library(needs):
    """library(package, path in it) -> the engine's library."""

    def library(package, path):
        found = importlib.util.find_spec(package) or needs(package)
        return Path(found.origin).parent / path

    return library


def test_libcosim_gives_the_digits_of_our_master(root, run, library, tmp_path):
    """Started from its own configuration file."""
    scenario, fmus = Scenario(stop_time=STEPS * H, step_size=H), build_stale(root)
    system = read_system(root / "ssp" / "gunnerus_dp", fmus=[fmus])
    for name, content in osp_files(system, scenario)[0].items():
        (tmp_path / name).write_bytes(content)
    reference = read_fmu(fmus / "vessel.fmu").variables["x"].value_reference
    file, where = tmp_path / "OspSystemStructure.xml", library("libcosimpy", "libcosimc/libcosimc.so")
    found = run("libcosim", where, file, "vessel", reference, STEPS)
    assert found == float(simulate(system, scenario)["vessel.x"][-1]) != 0.0


def test_ecos_gives_the_digits_that_it_gives_in_python(root, run, library, tmp_path, needs):
    if shutil.which("unzip") is None:
        needs("unzip", "ecos calls it.")
    where = library("ecospy", "binaries/libecosc.so")
    ecospy = pytest.importorskip("ecospy", reason="ecos is not installed", exc_type=(ImportError, OSError))
    file = tmp_path / "gunnerus_dp.ssp"
    pack(root / "ssp" / "gunnerus_dp", [build_stale(root)], file)
    with ecospy.EcosSimulation(ssp_path=str(file), step_size=H) as simulation:
        simulation.init()
        simulation.step(STEPS)
        expected = simulation.get_real("vessel::x")
        simulation.terminate()
    assert run("ecos", where, file, "vessel::x", H, STEPS) == expected != 0.0
