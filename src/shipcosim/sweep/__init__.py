"""Many runs: what varies over a scenario, run on all cores or a cluster, as one table.

`read_study` reads a study file, `plan_of` lays out its runs and checks them with the system, `run_study` runs those
that are not on disk yet. The room can be called: ``shipcosim.sweep(study)`` is the function of this name in
`shipcosim.calls`.
"""

import sys

from shipcosim import CallableRoom
from shipcosim.sweep.layout import plan_of
from shipcosim.sweep.plan import ColumnOf, Plan, PlannedRun
from shipcosim.sweep.reader import read_study
from shipcosim.sweep.records import Study
from shipcosim.sweep.sweeping import Swept, run_study

__all__ = ["ColumnOf", "Plan", "PlannedRun", "Study", "Swept", "plan_of", "read_study", "run_study"]

sys.modules[__name__].__class__ = CallableRoom
