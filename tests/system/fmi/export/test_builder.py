import os
import sys
import zipfile

import pytest
from fmpy.validation import validate_fmu

from shipcosim.errors import ShipcosimError
from shipcosim.fmi.export import builder

NEWCOMER = '''
from shipcosim.fmi import Fmu, Input, Output, Parameter
from shipcosim.models.propulsion.thruster import thrust_after


class Thruster(Fmu):
    """Thruster with a thrust limit and a first-order lag."""

    thrust_cmd = Input("N", "commanded thrust")
    thrust = Output("N", "delivered thrust")
    thrust_max = Parameter(40e3, "N", "largest thrust in either direction")
    time_constant = Parameter(2.0, "s", "time constant of the lag")

    def step(self, t, h):
        self.thrust = thrust_after(self.thrust, self.thrust_cmd, h, self.thrust_max, self.time_constant)
'''
THRUST_AFTER = """
from shipcosim.models.core.maths import exp


def thrust_after(thrust, command, h, limit, time_constant):
    return thrust + (max(-limit, min(limit, command)) - thrust) * (1 - exp(-h / time_constant))
"""


def test_the_newcomers_thruster_runs_as_written(own_shipcosim, build, load):
    own_shipcosim("v1", thruster=THRUST_AFTER)
    fmu = build("thruster", NEWCOMER)
    assert validate_fmu(str(fmu)) == []
    thruster = load(fmu).start(thrust_max=100.0, time_constant=1.0)
    thruster.set(thrust_cmd=500.0)
    assert thruster.step(20, read="thrust")[-1] == pytest.approx(
        100.0 * (1 - 2.718281828459045**-2.0)
    )


def test_two_versions_of_shipcosim_run_side_by_side(own_shipcosim, build, load):
    own_shipcosim("v1", thruster=THRUST_AFTER)
    old = load(build("thruster", NEWCOMER, out="old")).start()
    own_shipcosim("v2", thruster="def thrust_after(*_):\n    return 2.0\n")
    new = load(build("thruster", NEWCOMER, out="new")).start()
    assert new.step(read="thrust") == [2.0] and old.step(read="thrust") == [0.0]


def test_an_fmu_with_every_type_passes_validation(lag):
    assert validate_fmu(str(lag)) == []


def test_the_same_source_gives_the_same_bytes_wherever_and_whenever(build, sources):
    first = build("lag", sources.lag)
    old = os.umask(0o077)
    try:
        second = build("lag", sources.lag, out="elsewhere", folder="other")
    finally:
        os.umask(old)
    assert first.read_bytes() == second.read_bytes()
    assert second.stat().st_mode & 0o777 == 0o644


def test_another_source_gives_another_guid_and_module(build, sources):
    first, second = build("lag", sources.lag), build("lag", sources.lag + "\n", out="other")
    inside = [set(zipfile.ZipFile(path).namelist()) for path in (first, second)]
    guids = [
        zipfile.ZipFile(path).read("modelDescription.xml").split(b"guid=")[1][:40]
        for path in (first, second)
    ]
    assert inside[0] != inside[1] and guids[0] != guids[1]


def test_the_archive_holds_binaries_documentation_and_no_builder(tmp_path, sources):
    folder = tmp_path / "lag"
    folder.mkdir()
    (folder / "lag.py").write_text(sources.lag)
    (folder / "README.md").write_text("a < b")
    (folder / "reference.csv").write_text("time [s]\n0\n")
    with zipfile.ZipFile(builder.build_fmu(folder / "lag.py", tmp_path)) as archive:
        names = archive.namelist()
        assert b"a &lt; b" in archive.read("documentation/index.html")
    assert {
        "binaries/linux64/lag.so",
        "binaries/win64/lag.dll",
        "documentation/reference.csv",
    } <= set(names)
    left_out = ("builder", "bundle", "description.py", "units", "resources/pythonfmu")
    assert not [name for name in names if any(part in name for part in left_out)]


def test_building_leaves_no_trace_in_the_process(build, sources):
    modules, path = set(sys.modules), list(sys.path)
    build(
        "adder",
        sources.adder.format(module="amounts", name="Adder"),
        amounts="def amount():\n    return 1.0\n",
    )
    assert sys.path == path and not [name for name in set(sys.modules) - modules if "adder" in name]


HEAD = "from shipcosim.fmi import *\nclass A(Fmu):\n"
STEP = "\n    def step(self, t, h): pass\n"


@pytest.mark.parametrize(
    "script, expected",
    [
        ("a = 1\n", "no class that is an Fmu"),
        (f"{HEAD}    pass\nclass B(Fmu): pass\n", "2 FMUs \\(A, B\\)"),
        ("from shipcosim.fmi import *\nclass A(Fmu:\n", "bad.py, line 2"),
        (f"{HEAD}    x = Input('N', 'x'){STEP}", "no output"),
        (f"{HEAD}    x = Output('N', 'x')\n", "no step"),
        (f"{HEAD}\n    x = Parameter(2, 's', 'x')\n", "bad.py, line 4: TypeError.*write 2.0"),
        (f"{HEAD}    log = Output('N', 'x')\n", "bad.py, line 2: TypeError.*log"),
        (f"{HEAD}    x = Output('N s', 'x'){STEP}", "x: unit 'N s'"),
        (
            f"{HEAD}    thrust = Output('N', 'x')\n    def step(self, t, h):\n        self.thrst = 1.0\n",
            "line 5 sets self.thrst, .*Did you mean 'thrust'",
        ),
        (
            "import shipcosim.nothing\n",
            "line 1: ModuleNotFoundError: No module named 'shipcosim.nothing'",
        ),
    ],
)
def test_what_is_wrong_with_a_script_is_said_with_its_place(build, script, expected):
    with pytest.raises(ShipcosimError, match=expected):
        build("bad", script)


def test_a_base_class_in_the_same_file_is_no_second_fmu(build):
    text = f"{HEAD}    x = Output('N', 'x'){STEP}class B(A): pass\n"
    assert build("pair", text).is_file()


def test_build_all_builds_what_can_be_built_and_reports_the_rest(tmp_path, sources):
    for name, text in {"good": sources.lag, "Good": sources.lag, "broken": "def\n"}.items():
        (tmp_path / "fmus" / name).mkdir(parents=True, exist_ok=True)
        (tmp_path / "fmus" / name / f"{name}.py").write_text(text)
    with pytest.raises(ShipcosimError) as caught:
        builder.build_all(tmp_path / "fmus", ["good", "Good", "broken", "goood"], tmp_path / "out")
    text = str(caught.value)
    assert "no FMU 'goood'" in text and "Did you mean 'good'" in text
    assert "broken.py, line 1" in text and "where case does not count" in text
    assert [
        path.name for path in builder.build_all(tmp_path / "fmus", ["good"], tmp_path / "out")
    ] == ["good.fmu"]


def test_a_place_that_cannot_be_written_is_reported_and_nothing_left(
    tmp_path, sources, monkeypatch
):
    (tmp_path / "lag.py").write_text(sources.lag)
    (tmp_path / "file").write_text("")
    with pytest.raises(ShipcosimError, match="cannot be written"):
        builder.build_fmu(tmp_path / "lag.py", tmp_path / "file")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(ShipcosimError, match="No space left"):
        builder.build_fmu(tmp_path / "lag.py", tmp_path / "out")
    assert list((tmp_path / "out").iterdir()) == []


def test_a_missing_script_and_an_impossible_name_are_reported(tmp_path):
    with pytest.raises(ShipcosimError, match=r"there is no lag\.py"):
        builder.build_fmu(tmp_path / "lag.py", tmp_path)
    (tmp_path / "2-lags.py").write_text("")
    with pytest.raises(ShipcosimError, match="cannot name an FMU"):
        builder.build_fmu(tmp_path / "2-lags.py", tmp_path)
