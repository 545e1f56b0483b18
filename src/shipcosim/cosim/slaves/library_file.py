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

    name = platform_tuple if fmi_version == "3" else platform
    binaries = Path(folder) / "binaries"
    file = f"{identifier}{sharedLibraryExtension}"
    library = binaries / name / file
    if library.is_file():
        if not _is_unusable(library):
            return ""
        found = f"binaries/{name}/{file} is cut off, or for another platform."
        return f"{found} Export or copy the FMU again."
    # A folder without a file is no binary.
    there = sorted(path.name for path in binaries.glob("*") if any(path.glob("*")))
    if name not in there:
        return f"The FMU brings binaries for: {', '.join(there) or 'no platform'}; this is {name}."
    others = ", ".join(sorted(path.name for path in (binaries / name).iterdir()))
    return f"Its modelIdentifier asks for binaries/{name}/{file}. There is: {others}."


def _is_unusable(library: Path) -> bool:
    """True if a library of Linux is for another processor, or ends before its last part: loading that may kill us."""
    if sys.platform != "linux":
        return False
    heads = []
    for file in (library, Path("/proc/self/exe")):
        with file.open("rb") as opened:
            heads.append(opened.read(HEAD))
    head, own = heads
    # Format, width and processor are those of the program that loads it.
    if (head[:6], head[18:20], len(head)) != (own[:6], own[18:20], HEAD):
        return True
    # Where the table of sections begins, how long an entry is, and how many there are.
    start, entry, count = struct.unpack("<40xQ10xHHxx", head)
    return start + entry * count > library.stat().st_size
