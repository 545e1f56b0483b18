"""FMUs unpacked for a run, and the imports that Python FMUs leave behind in this process.

PythonFMU puts each FMU's resources on the one `sys.path` and imports from there. Without care a second FMU with a
module of the same name runs the first one's code.
"""

import os
import sys
import tempfile
from pathlib import Path
from typing import Self

from shipcosim.ssp import unpack


class UnpackedFmus:
    """A folder with FMUs, which a ``with`` statement removes in the end, together with the modules imported from it."""

    def __enter__(self) -> Self:
        self._temporary = tempfile.TemporaryDirectory(prefix="shipcosim-", ignore_cleanup_errors=True)
        self._root = Path(self._temporary.name).resolve()
        self._folders = {}
        return self

    def __exit__(self, *_):
        for name in self._imported(self._root):
            del sys.modules[name]
        sys.path[:] = [entry for entry in sys.path if not entry.startswith(f"{self._root}{os.sep}")]
        self._temporary.cleanup()

    def folder(self, fmu: Path) -> Path:
        """Folder of an FMU, unpacked at the first call, its modules ready to be imported before all others."""
        if fmu not in self._folders:
            self._folders[fmu] = self._root / str(len(self._folders))
            unpack(fmu, self._folders[fmu])
        self._forget_namesakes(self._folders[fmu])
        return self._folders[fmu]

    def _forget_namesakes(self, folder):
        """Forget modules of other FMUs that are named like one in this FMU; who has imported them keeps them."""
        own = {path.stem for path in (folder / "resources").glob("*")}
        for name in self._imported(self._root) - self._imported(folder):
            if name.partition(".")[0] in own:
                del sys.modules[name]

    @staticmethod
    def _imported(folder):
        """Names of the modules that come from a folder."""
        files = {name: getattr(module, "__file__", None) or "" for name, module in list(sys.modules.items())}
        return {name for name, file in files.items() if file.startswith(f"{folder}{os.sep}")}
