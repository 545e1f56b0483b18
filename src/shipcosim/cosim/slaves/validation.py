"""Checks of an FMU beyond what a system needs: its description by FMPy's validator, what its binary needs."""

import os
import re
import subprocess
from pathlib import Path

from shipcosim.cosim.slaves.library_file import library_problem
from shipcosim.cosim.slaves.unpacked import UnpackedFmus
from shipcosim.errors import Problem
from shipcosim.ssp.fmu.reader import describe_fmu
from shipcosim.ssp.xml.document import Findings

LONGEST = 10.0
"""Time limit for the system's loader to list the libraries of a binary. [s]"""


def validation_problems(path: Path) -> list[Problem]:
    """What FMPy's validator finds in an FMU, as errors; its binaries are not loaded.

    Parameters
    ----------
    path : Path
        Of the FMU.
    """
    from fmpy.validation import validate_fmu

    texts = (" ".join(str(raw_text).split()) for raw_text in validate_fmu(str(path)))
    # FMPy passes on what Python says where an index leads to no variable.
    unreadable = {
        "list index out of range": "An index of ModelStructure or of a derivative leads to no variable."
    }
    texts = (unreadable.get(text, text) for text in texts)
    remedy = "FMI does not allow it; export the FMU again."
    return [Problem(str(path), text, remedy) for text in dict.fromkeys(texts) if text]


def library_problems(path: Path) -> list[Problem]:
    """Errors of an FMU's libraries for this platform, and libraries that they need and that are missing.

    The others only on Linux with glibc: its loader lists them without running any code of the binary.

    Parameters
    ----------
    path : Path
        Of the FMU.
    """
    from fmpy import platform, platform_tuple

    fmu = describe_fmu(path, Findings())
    if fmu is None or not {platform, platform_tuple} & set(fmu.platforms):
        return []  # the check of the description says so
    loader = next(Path("/").glob("lib*/ld-linux-*.so.*"), None)
    with UnpackedFmus() as unpacked:
        folder = unpacked.folder(path)
        version = fmu.fmi_version[0]
        texts = [
            library_problem(folder, version, fmu.identifier(interface))
            for interface in fmu.interfaces
        ]
        problems = [Problem(str(path), text) for text in dict.fromkeys(texts) if text]
        if problems or loader is None:
            return problems
        for name in (platform, platform_tuple):
            for binary in sorted(folder.glob(f"binaries/{name}/*.so")):
                listing = [loader, "--list", binary]
                listed = subprocess.run(listing, capture_output=True, timeout=LONGEST, check=False)
                needed = re.findall(
                    rb"(?m)^\s*(\S+) => not found|: (\S+): cannot open shared object file",
                    listed.stdout + listed.stderr,
                )
                problems += [
                    Problem(
                        f"{path}, binaries/{name}/{binary.name}",
                        f"It needs {os.fsdecode(library)}, which is not here.",
                        "Install it, or put its folder into LD_LIBRARY_PATH.",
                    )
                    for library in dict.fromkeys(
                        library_name or other for library_name, other in needed
                    )
                ]
    return problems
