"""FMUs unpacked for a run, and the traces that Python FMUs leave in this process.

PythonFMU puts each FMU's resources on the one `sys.path` and imports from there. Without care a second FMU with a
module of the same name runs the first one's code.
"""

import sys
import tempfile
from pathlib import Path

from shipcosim.ssp import unpack


class Unpacked:
    """A folder with FMUs, which a ``with`` statement removes in the end, together with the modules imported from it."""

    def __enter__(self):
        self._temporary = tempfile.TemporaryDirectory(prefix="shipcosim-", ignore_cleanup_errors=True)
        self._root = Path(self._temporary.name).resolve()
        self._folders = {}
        return self

    def __exit__(self, *_):
        for name in self._imported():
            del sys.modules[name]
        sys.path[:] = [entry for entry in sys.path if not Path(entry).is_relative_to(self._root)]
        self._temporary.cleanup()

    def folder(self, fmu: Path) -> Path:
        """Folder of an FMU, unpacked at the first call, its modules ready to be imported before all others."""
        if fmu not in self._folders:
            self._folders[fmu] = self._root / str(len(self._folders))
            unpack(fmu, self._folders[fmu])
        self._make_room(self._folders[fmu])
        return self._folders[fmu]

    def _make_room(self, folder):
        """Forget modules of other FMUs that have the name of one in this FMU; who has imported them keeps them."""
        own = {path.stem for path in (folder / "resources").glob("*")}
        for name, file in self._imported().items():
            if name.partition(".")[0] in own and not file.is_relative_to(folder):
                del sys.modules[name]

    def _imported(self):
        """Modules that come from FMUs of this run, with their files."""
        files = {name: getattr(module, "__file__", None) for name, module in list(sys.modules.items())}
        return {name: Path(file) for name, file in files.items() if file and Path(file).is_relative_to(self._root)}
