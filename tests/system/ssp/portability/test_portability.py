"""The table of what other tools make of a system's features is what they do: each is run on systems with one of them.

The systems are those of tests/system/conformance, whose results in each tool are recorded on
docs/interoperability.md, and those in systems/, which are run here. A verdict is of the file as a whole, so that it
is one of those of its features.
"""

import importlib.util
import json
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import c_fmus
import pytest
from conformance import cases as conformance
from conformance import recording
from conformance.recording import CRASHES, FORMED, REFUSED, RIGHT, WRONG

from shipcosim.cosim import engines_missing
from shipcosim.errors import ShipcosimError
from shipcosim.ssp import check_file
from shipcosim.ssp.portability import support_table as hosts
from shipcosim.ssp.portability.check import check_for
from shipcosim.ssp.portability.support_table import FEATURES, HOSTS

HERE = Path(__file__).resolve().parent
OWN = {path.stem: conformance._case(path) for path in sorted((HERE / "systems").glob("*.toml"))}
VERDICTS = {WRONG: {hosts.IGNORED, hosts.MISREAD, hosts.TOLD}, REFUSED: {hosts.REFUSED}}
VERDICTS |= {CRASHES: {hosts.CRASHES, hosts.TOLD}, RIGHT: {hosts.TOLD}}


def verdicts_of(host, path):
    """What the table says of a system, as a set."""
    found = check_for(host, path)
    return {
        v
        for f in FEATURES
        for v in f.becomes.values()
        if any(f": {host} {v}." in p.found for p in found)
    }


def assert_foretold(host, path, recorded):
    said = verdicts_of(host, path)
    if recorded == RIGHT:
        assert said <= VERDICTS[RIGHT]
    else:
        assert said & VERDICTS[recorded], said


def interface_type_of(case):
    """How a case is written down as a folder or, where it can only be of SSP 2.0, an archive."""
    return "folder, 1.0" if "1.0" in case.versions else "ssp, 2.0"


@pytest.fixture(scope="module")
def page(root):
    """Verdicts that docs/interoperability.md states, by column and feature."""
    spec = importlib.util.spec_from_file_location(
        "page", root / "docs" / "generators" / "write_interoperability.py"
    )
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.recorded(module.PAGE.read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", recording.rows())
def test_what_a_tool_did_with_a_feature_is_foretold(name, page, tmp_path):
    case = conformance.cases()["connection" if name in FORMED else name]
    path = conformance.write(
        case, tmp_path, FORMED[name][2] if name in FORMED else interface_type_of(case)
    )
    if any(problem.severity == "error" for problem in check_file(path)):
        assert (
            page["shipcosim"].get(recording.rows()[name][1]) != RIGHT
        )  # nothing is foretold of what cannot be read
        return
    for host in HOSTS:
        recorded = page[host].get(recording.rows()[name][1])
        if recorded is None:
            pytest.skip("the page has no such row yet, which tests/system/conformance tells")
        assert_foretold(host, path, recorded)


@pytest.fixture(scope="module", params=HOSTS)
def host(request, needs):
    """Each tool that is installed."""
    if missing := engines_missing().get(request.param):
        needs(request.param, str(missing))
    return request.param


RUN = """
import sys
sys.path[:0] = {tests!r}
from conformance import recording
from ssp.portability import test_portability as test_hosts
recording.cases = lambda: test_hosts.OWN
recording.main(*sys.argv[1:])
"""


@pytest.fixture(scope="module")
def tried(host, tmp_path_factory):
    """Verdicts of the tool on the systems in systems/, each run in a process that may die of it."""
    left, found = list(OWN), {}
    code = RUN.format(tests=[str(HERE.parents[1]), str(HERE.parents[2])])
    while left:
        folder = tmp_path_factory.mktemp(host)
        command = [sys.executable, "-c", code, host, str(folder), *left]
        process = subprocess.run(
            command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, timeout=600
        )
        for line in process.stdout.splitlines():
            if line.startswith('["'):
                name, verdict, _ = json.loads(line)
                found[name] = verdict
        left = [name for name in left if name not in found]
        if left:
            found[left.pop(0)] = CRASHES
    return found


@pytest.mark.parametrize("name", OWN)
def test_what_a_tool_does_with_a_feature_is_foretold(name, host, tried, tmp_path):
    assert_foretold(
        host, conformance.write(OWN[name], tmp_path, interface_type_of(OWN[name])), tried[name]
    )


def test_every_feature_is_in_some_system_that_was_tried(tmp_path):
    cases = [*OWN.values(), *conformance.cases().values()]
    paths = [
        conformance.write(case, tmp_path / str(k), interface_type_of(case))
        for k, case in enumerate(cases)
    ]
    paths += [
        conformance.write(conformance.cases()["connection"], tmp_path / n, f[2])
        for n, f in FORMED.items()
    ]
    remedies = {
        problem.remedy for path in paths for host in HOSTS for problem in check_for(host, path)
    }
    seen = {feature.name for feature in FEATURES if feature.remedy in remedies}
    elsewhere = {
        "fmi_3",
        "form_asked",
        "model_exchange",
        "model_exchange_1",
        "same_guid",
        "set_fmi_1",
    }
    elsewhere |= {"osp_algorithm", "osp_second_target", "osp_group_file"}
    assert {feature.name for feature in FEATURES} - seen <= elsewhere


# FMUs


SSD = """<ssd:SystemStructureDescription version="1.0" name="test"
  xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription">
<ssd:System name="test"><ssd:Elements><ssd:Component name="m" source="resources/{}.fmu"/></ssd:Elements></ssd:System>
</ssd:SystemStructureDescription>"""
STILL = """
#define NX 0
#define NZ 0
#define STATES {0}
static void start(M* m) { m->r[0] = 7; }
static void equations(M* m) {}
static void indicators(M* m, double* z) {}
static void event(M* m) {}
static int completed(M* m) { return 0; }
"""
STEP = {
    "libcosim": """
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
execution = CosimExecution.from_ssp_file(sys.argv[1], 10**8)
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
assert execution.step(3)
value = observer.last_real_values(0, [0])[0]
""",
    "ecos": """
from ecospy import EcosSimulation
simulation = EcosSimulation(ssp_path=sys.argv[1], step_size=0.1)
assert simulation.init()
simulation.step(3)
value = simulation.get_real("m::y")
""",
}
END = "print('value', value, flush=True)\nos._exit(0 if value == 7.0 else 3)\n"


def outcome(host, path):
    """Verdict of a tool on an SSP of one FMU whose output is 7."""
    code = f"import os, sys\n{STEP[host]}{END}"
    process = subprocess.run(
        [sys.executable, "-c", code, str(path)], capture_output=True, timeout=600
    )
    return {0: RIGHT, 1: REFUSED, 3: WRONG}.get(process.returncode, CRASHES)


@pytest.mark.skipif(c_fmus.compiler() is None, reason="needs a C compiler")
@pytest.mark.parametrize("form", ["CoSimulation", "ModelExchange"])
@pytest.mark.parametrize("version", ["1.0", "2.0", "3.0"])
def test_what_a_tool_does_with_an_fmu_of_a_version_and_form_is_foretold(
    host, version, form, tmp_path
):
    name = f"still_{version[0]}_{form}"
    description = c_fmus.describe(name, version, [("y", 0, "output", "Real", None)], (form,))
    fmu = c_fmus.build(tmp_path, name, version, STILL, description, form)
    path = tmp_path / "system.ssp"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("SystemStructure.ssd", SSD.format(name))
        archive.write(fmu, f"resources/{name}.fmu")
    found = outcome(host, path)
    said = verdicts_of(host, path) - {hosts.TOLD}
    assert found == RIGHT and not said or VERDICTS.get(found, set()) & said, (found, said)


def test_two_fmus_of_one_guid_are_one_to_libcosim(tmp_path, needs):
    if missing := engines_missing().get("libcosim"):
        needs("libcosim", str(missing))
    case = conformance.cases()["connection"]
    folder = conformance.write(case, tmp_path, "folder, 1.0")
    first, second = (folder / "resources" / f"{name}.fmu" for name in ("ramp", "gain"))
    with zipfile.ZipFile(first) as archive:
        guid = re.search(rb'guid="[^"]*"', archive.read("modelDescription.xml"))[0]
    with zipfile.ZipFile(second) as archive:
        contents = {entry: archive.read(entry) for entry in archive.namelist()}
    contents["modelDescription.xml"] = re.sub(
        rb'guid="[^"]*"', guid, contents["modelDescription.xml"]
    )
    with zipfile.ZipFile(second, "w") as archive:
        for name, data in contents.items():
            archive.writestr(name, data)
    assert recording.in_libcosim(case, folder)["gain.y"] != case.closed_form("gain.y")[-1]
    (problem,) = [p for p in check_for("libcosim", folder) if p.severity == "error"]
    assert problem.where == "gain" and problem.found.startswith(
        "gain.fmu has the GUID of ramp.fmu: libcosim takes"
    )
    assert [p for p in check_for("ecos", folder) if p.severity == "error"] == []


def test_the_form_that_is_asked_for_is_no_matter_to_the_tools(tmp_path, root):
    """The page on forms states what they did, and its own tests measure it."""
    page = (root / "docs" / "fmi-versions.md").read_text(encoding="utf-8")
    row = next(
        line
        for line in page.splitlines()
        if line.startswith("| both forms, model exchange asked for")
    )
    assert row.split(" | ")[2:4] == [WRONG, WRONG]
    description = c_fmus.describe(
        "both", "2.0", [("y", 0, "output", "Real", None)], ("CoSimulation", "ModelExchange")
    )
    with zipfile.ZipFile(tmp_path / "both.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", description)
    text = (
        SSD.format("both")
        .replace("resources/", "")
        .replace("<ssd:Component ", "<ssd:Component {} ")
    )
    for form, said in (("any", set()), ("CoSimulation", set()), ("ModelExchange", {hosts.IGNORED})):
        (tmp_path / "SystemStructure.ssd").write_text(text.format(f'implementation="{form}"'))
        for host in HOSTS:
            assert verdicts_of(host, tmp_path) - {hosts.TOLD} == said


# what is said


def test_a_finding_names_file_line_element_and_remedy(tmp_path):
    path = conformance.write(conformance.cases()["ssv_on_system"], tmp_path, "folder, 1.0")
    (problem,) = [p for p in check_for("libcosim", path) if p.severity == "error"]
    assert re.fullmatch(r".*system/SystemStructure\.ssd, line \d+: ParameterBinding", problem.where)
    assert "set bound to a system: libcosim goes on without it" in problem.found
    assert "bind_to_components" in problem.remedy


def test_a_system_that_cannot_be_read_is_left_to_the_check(tmp_path):
    (tmp_path / "SystemStructure.ssd").write_text(
        '<ssd:SystemStructureDescription name="test" version="1.0"'
        ' xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"><ssd:System name="test"><ssd:Elements>'
        "<ssd:Component/></ssd:Elements></ssd:System></ssd:SystemStructureDescription>"
    )
    assert check_for("ecos", tmp_path) == []


def test_ecos_reads_no_osp_structure_and_an_unknown_tool_is_refused(tmp_path):
    path = tmp_path / "OspSystemStructure.xml"
    path.write_text("<a/>")
    assert "does not read" in check_for("ecos", path)[0].found
    with pytest.raises(
        ShipcosimError, match="Nothing is known of this tool. There is: ecos, libcosim."
    ):
        check_for("vico", path)
