"""Platforms: their names in FMI 2.0, and how the compiler builds a library for each."""

from __future__ import annotations

import contextlib
import hashlib
import struct
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from shipcosim.errors import Problem, ShipcosimError, error_at, suggestion
from shipcosim.library import cache
from shipcosim.native.compiler import EXACT, check_installed
from shipcosim.temporary import replace_file, temporary_folder

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
    check_installed()
    made = [_compiled(source, triple, TARGETS[target].suffix) for triple in TARGETS[target].triples]
    return made[0] if len(made) == 1 else _universal(made)


def _compiled(source, triple, suffix) -> bytes:
    """Compile a library or read it from the cache. A cache that cannot be written keeps nothing."""
    key = hashlib.sha256(repr((source, triple, OPTIONS)).encode()).hexdigest()[:32]
    path = cache() / "native" / f"{key}{suffix}"
    if path.is_file():
        return path.read_bytes()
    library = _from_compiler(source, triple, suffix)
    with contextlib.suppress(OSError):
        replace_file(path, library)
    return library


def _from_compiler(source, triple, suffix) -> bytes:
    with temporary_folder() as folder:
        text = Path(folder, "all.c")
        library = Path(folder, f"all{suffix}")
        text.write_text(source, encoding="utf-8")
        command = [
            sys.executable,
            "-m",
            "ziglang",
            "cc",
            "-target",
            triple,
            *OPTIONS,
            "all.c",
            "-o",
            library.name,
        ]
        # The mathematics of Windows is in its C runtime; elsewhere it is a library of its own.
        command += [] if "windows" in triple else ["-lm"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode:
            raise error_at(f"compiler for {triple}", f"fails: {done.stderr.strip()[:1000]}")
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
