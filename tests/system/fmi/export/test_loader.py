"""The loader as it is kept: compiled from the sources beside it, whole, and for old systems too."""

import re
import shutil
import subprocess
import zipfile

import pytest
from fmi.export.compile_loader import digest

from shipcosim.fmi.export.loader import SUFFIXES, loader_for

REMEDY = "Run `python tests/bench/fmi/export/compile_loader.py`."


@pytest.mark.parametrize("platform", SUFFIXES)
def test_the_loader_was_compiled_from_the_sources_that_stand_here(platform):
    assert digest(platform).encode() in loader_for(platform).read_bytes(), REMEDY


@pytest.mark.parametrize("platform", SUFFIXES)
def test_it_has_every_function_of_the_binary_that_it_stands_for(platform, lag):
    """Among the names in the files, as far as they are text."""
    with zipfile.ZipFile(lag) as archive:
        folder = f"binaries/{platform}/"
        ours = archive.read(f"{folder}lag{SUFFIXES[platform]}")
        (other,) = [n for n in archive.namelist() if n.startswith(folder) and "/lag." not in n]
        other = archive.read(other)
    found, wanted = (
        set(re.findall(rb"\x00(fmi2[A-Z][A-Za-z]+)(?=\x00)", data)) for data in (ours, other)
    )
    assert len(wanted) >= 34 and wanted <= found


def test_it_runs_with_the_c_library_of_systems_ten_years_old(needs):
    """As every wheel of manylinux2014 has to: no symbol newer than glibc 2.17."""
    objdump = shutil.which("objdump") or needs("objdump")
    said = subprocess.run(
        [objdump, "-T", loader_for("linux64")], capture_output=True, text=True, check=True
    ).stdout
    versions = {
        tuple(map(int, version.split("."))) for version in re.findall(r"GLIBC_([0-9.]+)", said)
    }
    assert versions and max(versions) <= (2, 17)
