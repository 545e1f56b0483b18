"""From a measured log to what the simulation gets wrong, why, and what a system with that in it gains.

The room can be called: ``shipcosim.diagnose(log, system)`` is `shipcosim.diagnose.pipeline.diagnose`, whether a module
of the room was imported before or not.
"""

from __future__ import annotations

import os
import sys
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray

    from shipcosim.diagnose.pipeline import Progress
    from shipcosim.diagnose.reference.reference import Reference
    from shipcosim.diagnose.result import Diagnosis
    from shipcosim.ssp import System, SystemStructure


class _Room(ModuleType):
    """This package as a function of its name."""

    def __call__(
        self,
        log: str | os.PathLike | xarray.Dataset,
        system: str | os.PathLike | SystemStructure | System,
        channels: str | os.PathLike | None = None,
        causes: str | os.PathLike | None = None,
        progress: Progress | None = None,
        *,
        out: str | os.PathLike | None = None,
        reference: str | os.PathLike | Reference | None = None,
    ) -> Diagnosis:
        """Diagnose a log, see `shipcosim.diagnose.pipeline.diagnose`."""
        from shipcosim.diagnose.pipeline import diagnose

        return diagnose(log, system, channels, causes, progress, out=out, reference=reference)


sys.modules[__name__].__class__ = _Room
