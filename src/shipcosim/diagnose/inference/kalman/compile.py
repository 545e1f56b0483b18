"""Compiles the filter: ``pip install -e .[native]``, then ``python -m shipcosim.diagnose.inference.kalman.compile``.

That compiler brings the headers of every platform, so the bytes do not depend on the machine.
"""

import hashlib
import subprocess
import sys
import tempfile
from pathlib import Path

from shipcosim.diagnose.inference.kalman import FOLDER, library_for

TARGETS = {
    "linux-x86_64": "x86_64-linux-gnu.2.17",
    "linux-arm64": "aarch64-linux-gnu.2.17",
    "win32-x86_64": "x86_64-windows-gnu",
    "darwin-x86_64": "x86_64-macos",
    "darwin-arm64": "aarch64-macos",
}
"""Names of platforms in Python and in the compiler."""
OPTIONS = (
    "-shared",
    "-O3",
    "-g0",
    "-s",
    "-fPIC",
    "-std=c11",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-fvisibility=hidden",
    "-lm",
)
EXACT = "-ffp-contract=off"  # no fused operations: the same result on every machine
NAMED = (
    "-Wl,-install_name,kalman.dylib"  # without it a library for macOS holds where it was compiled
)


def digest(platform: str) -> str:
    """SHA-256 of all that the filter of a platform is compiled from; the library holds it as text."""
    source = (FOLDER / "kalman.c").read_bytes().replace(b"\r\n", b"\n")
    return hashlib.sha256(source + repr(_options(platform)).encode()).hexdigest()


def _options(platform: str) -> list[str]:
    named = [NAMED] if platform.startswith("darwin") else []
    return ["-target", TARGETS[platform], *OPTIONS, EXACT, *named]


def compile_filter(platform: str, out: Path) -> Path:
    """Compile the filter.

    Parameters
    ----------
    platform : str
        Key of `TARGETS`.
    out : Path
        Folder for it.

    Returns
    -------
    Path
        The library.
    """
    target = out / library_for(platform).name
    with (
        tempfile.TemporaryDirectory() as folder
    ):  # takes the import library that the linker leaves for Windows
        library = Path(folder, target.name)
        command = [sys.executable, "-m", "ziglang", "cc", "kalman.c", *_options(platform)]
        # The digest in the library tells whether it was compiled from the present source.
        command += [f'-DSOURCES="{digest(platform)}"', "-o", str(library)]
        subprocess.run(command, cwd=FOLDER, check=True)
        target.write_bytes(library.read_bytes())
    return target


if __name__ == "__main__":
    for name in TARGETS:
        print(compile_filter(name, FOLDER))
