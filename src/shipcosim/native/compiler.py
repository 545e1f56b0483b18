"""Libraries of C sources, cached by the hash of the source."""

from __future__ import annotations

import contextlib
import ctypes
import hashlib
import importlib.util
import os
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from shipcosim.errors import error_at
from shipcosim.library import cache
from shipcosim.temporary import replace_file, temporary_folder

OPTIONS = ("-shared", "-O1", "-g0", "-s", "-fPIC", "-std=c11", "-fvisibility=hidden")
EXACT = "-ffp-contract=off"  # no fused operations: what Python computes, to the last bit
SUFFIX = ".dll" if sys.platform == "win32" else ".dylib" if sys.platform == "darwin" else ".so"


def is_installed() -> bool:
    """True if a compiler is installed."""
    return importlib.util.find_spec("ziglang") is not None


def check_installed() -> None:
    """Raise where there is no compiler.

    Raises
    ------
    ShipcosimError
        With what to install.
    """
    if not is_installed():
        raise error_at(
            "engine 'native'",
            "It compiles the models, and there is no compiler.",
            "Install it: pip install 'shipcosim[native]'.",
        )


def libraries(sources: Iterable[str]) -> list[ctypes.CDLL]:
    """Load libraries of C sources; compile those that are not in the cache.

    Parameters
    ----------
    sources : iterable of str
        C texts.

    Raises
    ------
    ShipcosimError
        There is no compiler, it fails, or the cache cannot be written.
    """
    sources = list(sources)
    # Each distinct source once: several components may share their code. The compiler is a process
    # of its own, so threads compile in parallel.
    missing = [source for source in dict.fromkeys(sources) if source not in _LOADED]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        _LOADED.update(
            zip(
                missing,
                (ctypes.CDLL(str(path)) for path in pool.map(_compiled, missing)),
                strict=True,
            )
        )
    return [_LOADED[source] for source in sources]


_LOADED: dict[str, ctypes.CDLL] = {}
"""Libraries that this process has loaded; it never unloads them."""


def keep_digest(made: Path, path: Path) -> None:
    """Write the digest of a file that will lie at a path beside it."""
    digest = hashlib.sha256(made.read_bytes()).hexdigest()
    digest_file = path.with_name(f"{path.name}.sha256")
    part = made.with_name(f"{made.name}.sha256")
    part.write_text(digest)
    os.replace(part, digest_file)


def is_intact(path: Path) -> bool:
    """Whether a file of the cache is there as it was written: a cut one would end the process when it is loaded."""
    try:
        digest = path.with_name(f"{path.name}.sha256").read_bytes()
        return digest == hashlib.sha256(path.read_bytes()).hexdigest().encode()
    except OSError:
        return False


def run_compiler(arguments: Sequence[str], folder: Path | str, goal: str = "") -> None:
    """Call the compiler in a folder; `goal` says in errors what for.

    Raises
    ------
    ShipcosimError
        There is no compiler, or it fails.
    """
    check_installed()
    command = [sys.executable, "-m", "ziglang", "cc", *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        # A crash, as on a full disk, leaves no words.
        reason = done.stderr.strip()[:1000] or f"it ends with code {done.returncode}."
        raise error_at(f"compiler{goal}", f"fails: {reason}")


def kept(key: object, suffix: str, make: Callable[[], bytes]) -> bytes:
    """Read from the cache what was made for a key, or make it. A cache that cannot be written keeps nothing."""
    digest = hashlib.sha256(repr(key).encode()).hexdigest()[:32]
    path = cache() / "native" / f"{digest}{suffix}"
    if path.is_file():
        return path.read_bytes()
    content = make()
    with contextlib.suppress(OSError):
        replace_file(path, content)
    return content


def _compiled(source: str) -> Path:
    # The cached file belongs to source, options and platform: a change of one gives another name.
    key = repr((source, OPTIONS, EXACT, sysconfig.get_platform()))
    path = cache() / "native" / f"{hashlib.sha256(key.encode()).hexdigest()[:32]}{SUFFIX}"
    if is_intact(path):
        return path
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # Compile into a temporary folder, then rename: another process never sees half a file.
        with temporary_folder(path.parent) as folder:
            text = Path(folder, "step.c")
            made = Path(folder, path.name)
            text.write_text(source, encoding="utf-8")
            run_compiler([*OPTIONS, EXACT, text.name, "-o", made.name, "-lm"], folder)
            keep_digest(made, path)
            os.replace(made, path)
    except OSError as error:
        raise error_at(str(path), f"cannot be written: {error.strerror}.") from None
    return path
