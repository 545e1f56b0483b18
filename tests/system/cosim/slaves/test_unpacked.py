"""FMUs of our shell are unpacked once and imported once; others' leave nothing behind."""

import os
import sys

import pytest

from shipcosim.cosim import simulate
from shipcosim.cosim.slaves import unpacked
from shipcosim.errors import ShipcosimError


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """Folder that is the cache during the test."""
    monkeypatch.setenv("SHIPCOSIM_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def test_an_fmu_of_ours_is_unpacked_and_imported_once(
    make_system, make_scenario, cache, monkeypatch
):
    system = make_system({"lag": ("lag", {"u": 1.0}), "other": ("lag", {"u": 2.0})})
    first = simulate(system, make_scenario())
    (folder,) = (cache / "unpacked").iterdir()
    (entry,) = (path.stem for path in (folder / "resources").glob("lag_*.py"))
    module = sys.modules[f"{entry}_code"]
    monkeypatch.setattr(unpacked, "unpack", None)
    assert simulate(system, make_scenario()).equals(first)
    assert sys.modules[f"{entry}_code"] is module
    assert str(folder) not in "".join(sys.path)


def test_others_fmus_do_not_stay_in_the_cache(pythonfmu_system, make_scenario, cache):
    simulate(pythonfmu_system("float(helper.VALUE)", "VALUE = 1", "VALUE = 2"), make_scenario())
    assert not cache.exists()


def test_a_cache_that_cannot_be_written_is_done_without(make_system, make_scenario, cache):
    cache.write_text("a file where a folder should be")
    assert (
        simulate(make_system({"lag": ("lag", {"u": 1.0})}), make_scenario()).attrs["complete"] == 1
    )


def test_what_nobody_has_used_for_a_month_leaves_the_cache(make_system, make_scenario, cache):
    old, recent = cache / "unpacked" / "old", cache / "unpacked" / "recent"
    for folder, age in ((old, unpacked.UNUSED + 1.0), (recent, unpacked.UNUSED - 3600.0)):
        (folder / "resources").mkdir(parents=True)
        os.utime(folder, (folder.stat().st_mtime - age,) * 2)
    simulate(make_system({"lag": ("lag", {"u": 1.0})}), make_scenario())
    assert not old.exists() and recent.exists() and len(list((cache / "unpacked").iterdir())) == 2


@pytest.mark.parametrize(
    "name", ["Jörg", "a b", "ü ö", "x(86)+y&z", "q'q", "a#b", "100%", "@;,=$!"]
)
@pytest.mark.parametrize("own", [True, False], ids=["ours", "PythonFMU's"])
def test_an_fmu_in_python_runs_from_a_folder_of_any_name(
    make_system, pythonfmu_system, make_scenario, tmp_path, monkeypatch, name, own
):
    # PythonFMU decodes blanks in the address of its resources alone, and a process ended where it found none.
    (tmp_path / name).mkdir()
    monkeypatch.setenv("SHIPCOSIM_CACHE", str(tmp_path / name))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / name))
    if own:
        system = make_system({"lag": ("lag", {"u": 1.0})})
    else:
        system = pythonfmu_system("float(helper.VALUE)", "VALUE = 1", "VALUE = 2")
    assert simulate(system, make_scenario()).attrs["complete"] == 1


def test_a_folder_that_pythonfmu_cannot_read_from_is_named(
    make_system, make_scenario, tmp_path, monkeypatch
):
    monkeypatch.setenv("SHIPCOSIM_CACHE", str(tmp_path / "my%20folder"))
    with pytest.raises(ShipcosimError, match="with '%20' in its name"):
        simulate(make_system({"lag": ("lag", {"u": 1.0})}), make_scenario())
