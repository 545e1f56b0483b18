"""Co-simulation: `simulate` runs a system through a scenario and returns the table of all signals."""

from shipcosim.cosim.engines.registry import ENGINES, engines_missing
from shipcosim.cosim.export.fmu import export_fmu
from shipcosim.cosim.master.inputs import interpolated
from shipcosim.cosim.master.run import Interrupted, RunError
from shipcosim.cosim.repeat import repeat
from shipcosim.cosim.replay import replay
from shipcosim.cosim.simulate import simulate
from shipcosim.cosim.systems import system_of
from shipcosim.cosim.variations import Variation, simulate_many
from shipcosim.options import RunOptions
from shipcosim.snapshot import Snapshot, read_snapshot, write_snapshot

__all__ = [
    "ENGINES",
    "Interrupted",
    "RunError",
    "RunOptions",
    "Snapshot",
    "Variation",
    "engines_missing",
    "export_fmu",
    "interpolated",
    "read_snapshot",
    "repeat",
    "replay",
    "simulate",
    "simulate_many",
    "system_of",
    "write_snapshot",
]
