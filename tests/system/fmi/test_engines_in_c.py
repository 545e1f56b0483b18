"""libcosim and ecos as libraries of a program that is not Python, engines.c, with the DP ship's FMUs."""

import importlib.util
import os
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest

from shipcosim.cosim import simulate
from shipcosim.cosim.export.osp import osp_files
from shipcosim.library import build_stale
from shipcosim.scenario import Scenario
from shipcosim.ssp import pack, read_fmu, read_system

STEPS, H, SET = 100, 0.05, "ship"
SSD, SSV = (
    f"http://ssp-standard.org/SSP1/SystemStructure{kind}"
    for kind in ("Description", "ParameterValues")
)


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
            timeout=600,
        )
        assert done.returncode == 0, done.stderr[-2000:]
        values = [
            line for line in done.stdout.splitlines() if line[:1].isdigit() or line[:1] == "-"
        ]
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
    file, where = (
        tmp_path / "OspSystemStructure.xml",
        library("libcosimpy", "libcosimc/libcosimc.so"),
    )
    found = run("libcosim", where, file, "vessel", reference, STEPS)
    assert found == float(simulate(system, scenario)["vessel.x"][-1]) != 0.0


def with_sets_on_components(root, fmus, folder):
    """The DP ship as an SSP in which each component has its parameter set, named `SET`: ecos passes over a system's."""
    ssd = ElementTree.parse(root / "ssp" / "gunnerus_dp" / "SystemStructure.ssd")
    components = read_system(root / "ssp" / "gunnerus_dp", fmus=[fmus]).components
    for element in ssd.iter(f"{{{SSD}}}Component"):
        values = ElementTree.SubElement(element, f"{{{SSD}}}ParameterBindings")
        for kind in (
            f"{{{SSD}}}ParameterBinding",
            f"{{{SSD}}}ParameterValues",
            f"{{{SSV}}}ParameterSet",
        ):
            values = ElementTree.SubElement(values, kind)
        values.attrib.update(version="1.0", name=SET)
        values = ElementTree.SubElement(values, f"{{{SSV}}}Parameters")
        component = components[element.get("name")]
        for name, value in component.start.items():
            parameter = ElementTree.SubElement(values, f"{{{SSV}}}Parameter", name=name)
            ElementTree.SubElement(
                parameter, f"{{{SSV}}}{component.fmu.variables[name].type}", value=str(value)
            )
    shutil.copytree(root / "ssp" / "gunnerus_dp", folder)
    for prefix, name in {
        "ssd": SSD,
        "ssv": SSV,
        "ssc": SSD.replace("Description", "Common"),
    }.items():
        ElementTree.register_namespace(prefix, name)
    ssd.write(folder / "SystemStructure.ssd")
    pack(folder, [fmus], folder / "dp.ssp")
    return folder / "dp.ssp"


def test_ecos_gives_the_digits_that_it_gives_in_python(root, run, library, tmp_path, needs):
    if shutil.which("unzip") is None:
        needs("unzip", "ecos calls it.")
    where = library("ecospy", "binaries/libecosc.so")
    ecospy = pytest.importorskip(
        "ecospy", reason="ecos is not installed", exc_type=(ImportError, OSError)
    )
    file = with_sets_on_components(root, build_stale(root), tmp_path / "dp")
    with ecospy.EcosSimulation(ssp_path=str(file), step_size=H) as simulation:
        simulation.init(parameter_set=SET)
        simulation.step(STEPS)
        expected = simulation.get_real("vessel::x")
        simulation.terminate()
    assert run("ecos", where, file, "vessel::x", H, STEPS, SET) == expected != 0.0
