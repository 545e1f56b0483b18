"""FMUs unpacked for a run, and the modules that Python FMUs import into this process.

PythonFMU puts each FMU's resources on the one `sys.path` and imports from there. Without care a second FMU with a
module of the same name runs the first one's code. FMUs of our own shell have names unique to their content and write
nothing: they are unpacked once, in the cache, and imported once by a process.
"""

import hashlib
import os
import re
import shutil
import sys
import time
import zipfile
import zlib
from pathlib import Path
from typing import Self

from shipcosim.errors import ShipcosimError
from shipcosim.library import cache
from shipcosim.ssp import unpack
from shipcosim.ssp.xml.archive import entries
from shipcosim.temporary import temporary_folder

UNUSED = 30 * 86400.0
"""After which an FMU leaves the cache. [s]"""


class UnpackedFmus:
    """Folders of unpacked FMUs. At the end, temporary ones and their modules are removed."""

    def __enter__(self) -> Self:
        self._temporary = temporary_folder()
        self._root = Path(self._temporary.name).resolve()
        self._folders = {}
        return self

    def __exit__(self, *_):
        # Another run may unpack to the same path: it must not find the modules of this one.
        for name in self._imported(self._root):
            del sys.modules[name]
        sys.path[:] = [entry for entry in sys.path if not entry.startswith(f"{self._root}{os.sep}")]
        self._temporary.cleanup()

    def folder(self, fmu: Path) -> Path:
        """Folder of an FMU, unpacked at the first call; its modules come before all others."""
        if fmu not in self._folders:
            self._folders[fmu] = _in_cache(fmu) or self._unpacked(fmu)
        if self._root in self._folders[fmu].parents:
            # Forget modules of other FMUs that are named like one in this FMU; who has imported them keeps them.
            folder = self._folders[fmu]
            modules = {path.stem for path in (folder / "resources").glob("*")}
            for name in self._imported(self._root) - self._imported(folder):
                if name.partition(".")[0] in modules:
                    del sys.modules[name]
        return self._folders[fmu]

    def _unpacked(self, fmu):
        folder = self._root / str(len(self._folders))
        unpack(fmu, folder)
        return folder

    @staticmethod
    def _imported(folder):
        """Names of the modules that come from a folder."""
        files = {
            name: getattr(module, "__file__", None) or ""
            for name, module in list(sys.modules.items())
        }
        return {name for name, file in files.items() if file.startswith(f"{folder}{os.sep}")}


def _in_cache(fmu: Path) -> Path | None:
    """Cache folder of an FMU of our shell; None for others, or if the cache cannot be written."""
    try:
        digest = hashlib.sha256(fmu.read_bytes()).hexdigest()[:32]
        folder = (cache() / "unpacked" / digest).resolve()
        if folder.is_dir() and not _is_intact(fmu, folder):
            shutil.rmtree(folder)
        if not folder.is_dir():
            # True if all code of an FMU goes by a name that follows from its content; see `fmi.export.bundle`.
            names = entries(fmu)
            resources = {
                name.split("/")[1]
                for name in names
                if name.startswith("resources/") and not name.endswith("/")
            }
            scripts = [
                name.removesuffix(".py")
                for name in resources
                if re.fullmatch(r"\w+_[0-9a-f]{16}\.py", name)
            ]
            has_a_name_of_its_own = len(scripts) == 1 and resources == {
                f"{scripts[0]}.py",
                f"{scripts[0]}_code",
                "slavemodule.txt",
            }
            if not has_a_name_of_its_own:
                return None
            _unpack_into_cache(fmu, folder)
        # A fresh time stamp keeps the folder in the cache; unused ones are removed.
        os.utime(folder)
    except (OSError, zipfile.BadZipFile, ShipcosimError):
        return None
    return folder


def _is_intact(fmu: Path, folder: Path) -> bool:
    """Whether a folder of the cache holds the files of an FMU in their sizes and with their check sums."""
    with zipfile.ZipFile(fmu) as archive:
        for part in archive.infolist():
            path = folder / part.filename
            if part.is_dir():
                continue
            if not path.is_file() or path.stat().st_size != part.file_size:
                return False
            if zlib.crc32(path.read_bytes()) != part.CRC:
                return False
    return True


def _unpack_into_cache(fmu: Path, folder: Path) -> None:
    """Unpack to a temporary folder and rename: the cache never holds half an FMU."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    # Clean up here, where a new FMU comes in: the cache cannot grow without limit.
    for other in folder.parent.iterdir():
        if time.time() - other.stat().st_mtime > UNUSED:
            shutil.rmtree(other, ignore_errors=True)
    with temporary_folder(folder.parent, unfinished=True) as name:
        unpacked = Path(name, "fmu")
        unpack(fmu, unpacked)
        try:
            unpacked.rename(folder)
        except OSError:
            if not folder.is_dir():  # else another process was first
                raise
