"""Platforms: their names in FMI 2.0, and how the compiler builds a library for each."""

from __future__ import annotations

import struct
import sys
from functools import partial
from pathlib import Path
from typing import NamedTuple

from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.native.compiler import EXACT, kept, run_compiler
from shipcosim.temporary import temporary_folder

OPTIONS = ("-shared", "-O1", "-g0", "-s", "-fPIC", "-std=c11", "-fvisibility=hidden", EXACT)


class Target(NamedTuple):
    """A platform.

    Parameters
    ----------
    folder : str
        Below binaries/.
    suffix : str
        Of a library.
    triples : tuple of str
        As the compiler calls its processors; several make one file for all of them.
    """

    folder: str
    suffix: str
    triples: tuple[str, ...]


TARGETS = {
    "linux": Target("linux64", ".so", ("x86_64-linux-gnu.2.17",)),
    "windows": Target("win64", ".dll", ("x86_64-windows-gnu",)),
    "macos": Target("darwin64", ".dylib", ("x86_64-macos", "aarch64-macos")),
    "linux-arm": Target("aarch64-linux", ".so", ("aarch64-linux-gnu.2.17",)),
    "windows-arm": Target("aarch64-windows", ".dll", ("aarch64-windows-gnu",)),
}
"""FMI 2.0 has no names for ARM: those folders are FMI 3.0's, which FMPy knows. The library for macOS holds both."""


def own_target() -> str:
    """The platform of this machine."""
    return {"win32": "windows", "darwin": "macos"}.get(sys.platform, "linux")


def targets_of(given: str) -> list[str]:
    """Platforms in a comma-separated text; this platform if it is empty.

    Raises
    ------
    ShipcosimError
        There is no such platform.
    """
    names = [name.strip() for name in given.split(",") if name.strip()] or [own_target()]
    unknown = [name for name in names if name not in TARGETS]
    if unknown:
        raise ShipcosimError(
            [
                Problem("--targets", f"There is no '{name}'.", suggestion(name, list(TARGETS)))
                for name in unknown
            ]
        )
    return names


def compiled(source: str, target: str) -> bytes:
    """Compile a C text for a platform.

    Raises
    ------
    ShipcosimError
        There is no compiler, or it fails.
    """
    suffix = TARGETS[target].suffix
    made = [
        kept((source, triple, OPTIONS), suffix, partial(_from_compiler, source, triple, suffix))
        for triple in TARGETS[target].triples
    ]
    return made[0] if len(made) == 1 else _universal(made)


def _from_compiler(source, triple, suffix) -> bytes:
    with temporary_folder() as folder:
        Path(folder, "all.c").write_text(source, encoding="utf-8")
        library = Path(folder, f"all{suffix}")
        # The mathematics of Windows is in its C runtime; elsewhere it is a library of its own.
        mathematics = [] if "windows" in triple else ["-lm"]
        arguments = ["-target", triple, *OPTIONS, "all.c", "-o", library.name, *mathematics]
        run_compiler(arguments, folder, f" for {triple}")
        return library.read_bytes()


def _universal(libraries: list[bytes]) -> bytes:
    """Apple's universal file: a table of processors and offsets, then the libraries."""
    # Pages of 16 KiB, as ARM Macs need them: 2¹⁴, which is the alignment 14 in the table.
    page = 1 << 14
    head = struct.pack(">II", 0xCAFEBABE, len(libraries))
    body = b""
    for library in libraries:
        # A Mach-O file begins with its magic number; processor and subtype follow.
        processor, kind = struct.unpack_from("<II", library, 4)
        offset = page + len(body)
        head += struct.pack(">IIIII", processor, kind, offset, len(library), 14)
        # Fill up to the next page, so that the next library starts at one.
        body += library + bytes(-len(library) % page)
    return head + bytes(page - len(head)) + body
