"""The library of an FMU for this platform: whether it is there, and whole."""

import struct
import sys
from pathlib import Path

HEAD = 64
"""Length of the header of a library of Linux (ELF-64). [bytes]"""


def library_problem(folder: Path, fmi_version: str, identifier: str) -> str:
    """Why an FMU's library cannot be loaded, as sentences; empty where nothing is wrong that is seen from outside.

    Parameters
    ----------
    folder : Path
        Where the FMU is unpacked.
    fmi_version : str
        ``"1"``, ``"2"`` or ``"3"``, which decides how FMI calls this platform.
    identifier : str
        Name of the library without its ending, the modelIdentifier.
    """
    from fmpy import platform, platform_tuple, sharedLibraryExtension

    platform_name = platform_tuple if fmi_version == "3" else platform
    name = f"binaries/{platform_name}/{identifier}{sharedLibraryExtension}"
    library = Path(folder, name)
    if not library.is_file():
        there = sorted(str(path.relative_to(folder)) for path in Path(folder).glob("binaries/*/*"))
        return f"It has no {name}, as which FMI loads it here. It has: {', '.join(there[:9])}."
    if _is_unusable(library):
        return f"{name} is cut off, or for another platform. Export or copy the FMU again."
    return ""


def _is_unusable(library: Path) -> bool:
    """True if a library of Linux is for another processor, or ends before its last part: loading that may kill us."""
    if sys.platform != "linux":
        return False
    with library.open("rb") as opened, open("/proc/self/exe", "rb") as program:
        head = opened.read(HEAD)
        program_head = program.read(HEAD)
    # Format, width and processor are those of the program that loads it.
    if (head[:6], head[18:20], len(head)) != (program_head[:6], program_head[18:20], HEAD):
        return True
    # Where the table of sections begins, how long an entry is, and how many there are.
    start, entry, count = struct.unpack("<40xQ10xHHxx", head)
    return start + entry * count > library.stat().st_size
