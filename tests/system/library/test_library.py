"""What has a name is found: in the project around, then in what the package ships; FMUs are built once into a cache."""

import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from shipcosim import library
from shipcosim.errors import ShipcosimError
from shipcosim.library import building

LAG = '''"""FMU."""
from shipcosim.fmi import Fmu, Output


class Lag(Fmu):
    """A lag."""

    y = Output("m", "what comes out")

    def step(self, t, h):
        self.y = t
'''


@pytest.fixture
def project(root, tmp_path, monkeypatch):
    """Empty project, the working folder of the test, with a system and a scenario of its own."""
    folder = tmp_path / "ssp" / "barge"
    folder.mkdir(parents=True)
    shutil.copy(root / "ssp" / "otter_open" / "SystemStructure.ssd", folder)
    (tmp_path / "scenarios" / "failures").mkdir(parents=True)
    (tmp_path / "scenarios" / "failures" / "tow.toml").write_text(
        'description = "A tow"\n', encoding="utf-8"
    )
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def wheel(tmp_path, monkeypatch):
    """Folder like that of a package that came with a wheel, with one FMU; the cache is another folder."""
    (tmp_path / "package" / "shipped" / "fmus" / "lag").mkdir(parents=True)
    (tmp_path / "package" / "shipped" / "fmus" / "lag" / "lag.py").write_text(LAG, encoding="utf-8")
    monkeypatch.setattr(building, "PACKAGE", tmp_path / "package")
    monkeypatch.setattr(building, "shipped", lambda: tmp_path / "package" / "shipped")
    monkeypatch.setenv("SHIPCOSIM_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(building, "_digest", building._digest.__wrapped__)
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    return tmp_path


@pytest.mark.parametrize(
    "kind, name",
    [
        ("scenario", "four_corner"),
        ("scenario", "sensors/compass_runs_off"),
        ("system", "gunnerus_dp"),
        ("ship", "otter"),
        ("example", "gunnerus_log"),
    ],
)
def test_what_the_package_ships_is_found_from_anywhere(kind, name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert library.find(kind, name).exists()


@pytest.mark.parametrize("kind", library.KINDS)
def test_everything_shipped_has_a_line_of_its_own(kind, tmp_path):
    entries = library.entries(kind, tmp_path)
    assert entries and all(entry.line and "cannot be read" not in entry.line for entry in entries)
    assert len({entry.line for entry in entries}) == len(entries)


def test_what_is_in_the_project_goes_before_what_is_shipped(project):
    (project / "ssp" / "barge").rename(project / "ssp" / "otter_open")
    assert library.find("system", "otter_open") == project / "ssp" / "otter_open"
    assert library.find("scenario", "failures/tow").is_relative_to(project)
    assert library.find("system", "gunnerus_dp").is_relative_to(library.shipped())


def test_folder_of_results_does_not_hide_the_system_of_its_name(project):
    (project / "barge").mkdir()
    assert library.find("system", "barge") == project / "ssp" / "barge"


def test_path_goes_before_a_name(project):
    (project / "gunnerus_dp").mkdir()
    shutil.copy(project / "ssp" / "barge" / "SystemStructure.ssd", project / "gunnerus_dp")
    assert library.find("system", "gunnerus_dp") == Path("gunnerus_dp")


@pytest.mark.parametrize(
    "kind, near", [("scenario", "four_cornr"), ("system", "barg"), ("fmu", "vesel")]
)
def test_what_is_not_there_is_answered_with_what_is(kind, near, project):
    with pytest.raises(ShipcosimError, match=f"{near}: There is no such .*Did you mean"):
        library.find(kind, near)


def test_files_that_cannot_be_read_are_listed_all_the_same(project):
    (project / "scenarios" / "broken.toml").write_bytes(b"\xff = [")
    (project / "ssp" / "barge" / "SystemStructure.ssd").write_text("<", encoding="utf-8")
    lines = {
        entry.name: entry.line for kind in ("scenario", "system") for entry in library.entries(kind)
    }
    assert lines["broken"] == lines["barge"] == "(its file cannot be read)"


def test_system_outside_of_any_project_gets_none_of_our_fmus(project, tmp_path_factory):
    somewhere = tmp_path_factory.mktemp("download")
    assert library.fmus(somewhere / "foreign.ssp#Variant.ssd") == []
    assert library.fmus(project / "ssp" / "barge")[0] == project / "build" / "fmus"
    assert (library.fmus(project / "ssp" / "barge")[1] / "vessel.fmu").is_file()


def test_folder_of_ships_alone_is_a_project(tmp_path):
    (tmp_path / "ships").mkdir()
    assert library.project_of(tmp_path / "ships") == tmp_path


def test_fmus_of_a_wheel_are_built_once_into_the_cache(wheel):
    (folder,) = library.fmus()
    fmu = folder / "lag.fmu"
    built = fmu.stat().st_mtime_ns
    assert folder.is_relative_to(wheel / "cache") and library.fmus() == [folder]
    assert fmu.stat().st_mtime_ns == built
    (wheel / "package" / "shipped" / "fmus" / "lag" / "lag.py").write_text(
        LAG + "\n# newer\n", encoding="utf-8"
    )
    assert library.fmus() != [folder]


def test_two_that_build_at_once_leave_one_whole_folder(wheel, monkeypatch):
    """The building itself is made one after another here; what is raced for is the folder."""
    from shipcosim.fmi.export import builder

    def build_all(root, out):
        (out / "lag.fmu").write_bytes(b"whole")

    monkeypatch.setattr(builder, "build_all", build_all)
    with ThreadPoolExecutor(8) as pool:
        folders = list(pool.map(lambda _: library.fmus()[0], range(8)))
    assert len(set(folders)) == 1 and (folders[0] / "lag.fmu").read_bytes() == b"whole"
    assert [path.name for path in folders[0].parent.iterdir()] == [folders[0].name]


def test_build_that_fails_leaves_nothing(wheel):
    (wheel / "package" / "shipped" / "fmus" / "lag" / "lag.py").write_text("1 +", encoding="utf-8")
    with pytest.raises(ShipcosimError):
        library.fmus()
    assert list((wheel / "cache" / "fmus").iterdir()) == []


def test_cache_that_cannot_be_written_is_said_with_the_remedy(wheel):
    (wheel / "cache").write_text("a file", encoding="utf-8")
    with pytest.raises(ShipcosimError, match="cannot be written.*SHIPCOSIM_CACHE"):
        library.fmus()


@pytest.mark.parametrize("inside", ["", "a/b"])
def test_a_file_as_the_cache_is_said_with_the_variable(tmp_path, monkeypatch, inside):
    (tmp_path / "cache").write_text("a file", encoding="utf-8")
    monkeypatch.setenv("SHIPCOSIM_CACHE", str(tmp_path / "cache" / inside))
    with pytest.raises(ShipcosimError, match="cache is a file. Set SHIPCOSIM_CACHE to a folder"):
        library.places.cache()
