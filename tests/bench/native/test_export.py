"""At night: native FMUs for other platforms have their formats."""

import struct
import zipfile

import pytest
from native.test_export import NEWCOMER, written

from shipcosim.native.export.packing import build_native_fmu
from shipcosim.native.export.targets import TARGETS


@pytest.mark.parametrize("target", TARGETS)
def test_a_library_for_another_platform_has_its_format_and_the_functions_of_fmi(
    written, tmp_path, target
):
    fmu = build_native_fmu(written("winch", NEWCOMER), tmp_path, targets=[target])
    place = TARGETS[target]
    with zipfile.ZipFile(fmu) as archive:
        data = archive.read(f"binaries/{place.folder}/winch{place.suffix}")
    assert (
        formats(data)
        == {
            "linux": ["ELF x86_64"],
            "linux-arm": ["ELF aarch64"],
            "windows": ["PE x86_64"],
            "windows-arm": ["PE aarch64"],
            "macos": ["Mach-O x86_64", "Mach-O aarch64"],
        }[target]
    )
    for name in (
        b"fmi2Instantiate",
        b"fmi2DoStep",
        b"fmi2SetFMUstate",
        b"fmi2GetReal",
        b"fmi2CancelStep",
    ):
        assert data.count(name + b"\0") >= len(place.triples)
    assert b"/work" not in data and b"/home" not in data


def formats(data):
    """What a library says that it is: format and processor."""
    if data[:4] == b"\x7fELF":
        return ["ELF " + {62: "x86_64", 183: "aarch64"}[struct.unpack_from("<H", data, 18)[0]]]
    if data[:2] == b"MZ":
        (start,) = struct.unpack_from("<I", data, 60)
        assert data[start : start + 4] == b"PE\0\0"
        return [
            "PE "
            + {0x8664: "x86_64", 0xAA64: "aarch64"}[struct.unpack_from("<H", data, start + 4)[0]]
        ]
    if data[:4] == b"\xcf\xfa\xed\xfe":
        return [
            "Mach-O "
            + {0x01000007: "x86_64", 0x0100000C: "aarch64"}[struct.unpack_from("<I", data, 4)[0]]
        ]
    assert data[:4] == b"\xca\xfe\xba\xbe"
    (count,) = struct.unpack_from(">I", data, 4)
    places = [struct.unpack_from(">5I", data, 8 + 20 * n) for n in range(count)]
    return [
        one for _, _, offset, size, _ in places for one in formats(data[offset : offset + size])
    ]
