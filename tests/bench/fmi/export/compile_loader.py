"""Compiles the loader: ``pip install -e .[native]``, then ``python tests/bench/fmi/export/compile_loader.py``.

That compiler brings the headers and start-up code of every platform, so the bytes do not depend on the machine.
"""

import hashlib
import subprocess
import sys
from pathlib import Path

from shipcosim.fmi.export.loader import FOLDER, SUFFIXES, loader_for
from shipcosim.temporary import temporary_folder

SOURCES = {
    "linux64": ("fmu.c", "interpreter.c", "system_posix.c"),
    "win64": ("fmu.c", "interpreter.c", "system_windows.c"),
}
OPTIONS = (
    "-shared",
    "-O2",
    "-g0",
    "-s",
    "-std=c11",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-fvisibility=hidden",
)
OPTIONS_FOR = {
    "linux64": (
        "-target",
        "x86_64-linux-gnu.2.17",
        "-fPIC",
        "-Wl,-z,nodelete",
        "-Wl,-z,now",
        "-ldl",
        "-lpthread",
    ),
    "win64": ("-target", "x86_64-windows-gnu", "-lpsapi"),
}


def digest(platform: str) -> str:
    """SHA-256 of the sources and options of a platform's loader, which contains it as text."""
    files = [*SOURCES[platform], "interpreter.h", "system.h"]
    texts = [(FOLDER / name).read_bytes().replace(b"\r\n", b"\n") for name in files]
    options = repr((OPTIONS, OPTIONS_FOR[platform])).encode()
    return hashlib.sha256(b"".join([*texts, options])).hexdigest()


def compile_loader(platform: str, out: Path) -> Path:
    """Compile the loader of a platform.

    Parameters
    ----------
    platform : str
        Key of `SUFFIXES`.
    out : Path
        Folder for it.

    Returns
    -------
    Path
        The library.
    """
    target = out / f"{platform}{SUFFIXES[platform]}"
    with (
        temporary_folder() as folder
    ):  # takes the import library that the linker leaves for Windows
        library = Path(folder, target.name)
        command = [
            sys.executable,
            "-m",
            "ziglang",
            "cc",
            *SOURCES[platform],
            *OPTIONS,
            *OPTIONS_FOR[platform],
        ]
        command += [f'-DSOURCES="{digest(platform)}"', "-o", str(library)]
        subprocess.run(command, cwd=FOLDER, check=True)
        target.write_bytes(library.read_bytes())
    return target


if __name__ == "__main__":
    for name in SUFFIXES:
        print(compile_loader(name, loader_for(name).parent))
