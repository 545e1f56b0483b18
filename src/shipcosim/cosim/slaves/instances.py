"""FMUs of a system, loaded once and used for many runs."""

from contextlib import ExitStack
from typing import Self

from shipcosim.cosim.slaves.library_slave import LibrarySlave
from shipcosim.cosim.slaves.make import make_slave
from shipcosim.cosim.slaves.slave import SlaveError
from shipcosim.cosim.slaves.unpacked import UnpackedFmus
from shipcosim.ssp import Component


class Instances:
    """Instances of FMUs by component; leaving a ``with`` statement frees them and removes what was unpacked.

    Parameters
    ----------
    unpacked : UnpackedFmus, optional
        The FMUs, where others use them too; unpacked for these instances where it is not given.
    """

    def __init__(self, unpacked: UnpackedFmus | None = None):
        self._shared = unpacked

    def __enter__(self) -> Self:
        self._slaves: dict[str, LibrarySlave] = {}
        self._stack = ExitStack()
        self._unpacked = (
            self._stack.enter_context(UnpackedFmus()) if self._shared is None else self._shared
        )
        return self

    def __exit__(self, *_):
        for name in list(self._slaves):
            self._free(name)
        self._stack.close()

    def instance_of(self, component: Component) -> LibrarySlave:
        """An instance of a component's FMU, with nothing set.

        From the second time on it is the same one, reset; an FMU that cannot be reset is instantiated again.

        Raises
        ------
        SlaveError
            If it cannot be instantiated.
        """
        name = component.name
        fmu = component.fmu
        # A reset is faster than a new instance. If the FMU cannot reset, make a new one.
        if name in self._slaves:
            try:
                self._slaves[name].reset()
                return self._slaves[name]
            except SlaveError:
                self._free(name)
        self._slaves[name] = make_slave(component, self._unpacked.folder(fmu.path))
        return self._slaves[name]

    def _free(self, name):
        self._slaves.pop(name).free()
