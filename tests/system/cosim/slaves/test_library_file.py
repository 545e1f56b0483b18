"""A library that is cut, of another platform or misnamed is refused before it is loaded, and `check` says so."""

import sys
import zipfile

import c_fmus
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as some

import shipcosim as sc
from shipcosim.cosim import RunError

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="reads the header of ELF")
CODE = """
#define NX 1
#define NZ 1
#define STATES {0}
static void start(M* m) {}
static void equations(M* m) { m->r[1] = 1; }
static void indicators(M* m, double* z) { z[0] = 1; }
static void event(M* m) {}
static int completed(M* m) { return 0; }
"""
SEVERAL = settings(
    max_examples=25, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck)
)


@pytest.fixture(scope="module")
def whole(tmp_path_factory, needs):
    """An FMU that runs."""
    if c_fmus.compiler() is None:
        needs("a C compiler")
    variables = [("x", 0, "output", "Real", None), ("der(x)", 1, "local", "Real", None)]
    text = c_fmus.describe("whole", "2.0", variables, ("ModelExchange",), 1, 1)
    folder = tmp_path_factory.mktemp("libraries")
    return c_fmus.build(folder, "whole", "2.0", CODE, text, "ModelExchange")


@pytest.fixture
def refused(whole, tmp_path):
    """Function that changes the bytes or the name of the library, and gives what check and a run say."""

    def of(change, name="whole"):
        path = tmp_path / "changed.fmu"
        with zipfile.ZipFile(whole) as archive, zipfile.ZipFile(path, "w") as new:
            for entry in archive.namelist():
                data = archive.read(entry)
                is_library = entry.startswith("binaries/")
                new.writestr(
                    entry.replace("whole.so", f"{name}.so"), change(data) if is_library else data
                )
        checked = "\n".join(map(str, sc.check(path).failures))
        with pytest.raises(RunError) as caught:
            sc.simulate(path, stop_time=1.0, step_size=0.5)
        return checked, str(caught.value)

    return of


def test_the_whole_library_runs(whole):
    assert "binaries" not in str(sc.check(whole).failures)
    assert sc.simulate(whole, stop_time=1.0, step_size=0.5).table.sizes["time"] == 3


@SEVERAL
@given(some.floats(0.0, 0.999))
def test_a_library_that_is_cut_anywhere_is_refused(refused, share):
    for text in refused(lambda data: data[: int(share * len(data))]):
        assert "whole.so is cut off, or for another platform." in text


@pytest.mark.parametrize(
    "change",
    [
        lambda data: data[:18] + b"\xf3\x00" + data[20:],  # RISC-V
        lambda data: data[:4] + b"\x01" + data[5:],  # 32 bits
        lambda data: b"MZ" + data[2:],
        lambda data: b"no library at all, but as long as the header of one would have been",
    ],
    ids=["processor", "width", "Windows", "text"],
)
def test_a_library_of_another_platform_is_refused(refused, change):
    for text in refused(change):
        assert "whole.so is cut off, or for another platform." in text


@pytest.mark.parametrize("name", ["other", "Whole", "libwhole", "whole.1"])
def test_a_library_of_another_name_is_refused(refused, name):
    for text in refused(lambda data: data, name):
        assert "It has no binaries/linux64/whole.so" in text
        assert f"It has: binaries/linux64/{name}.so." in text
