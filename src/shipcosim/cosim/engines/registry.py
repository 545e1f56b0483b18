"""The engines that can run a system: our own master, in Python or compiled, libcosim and ecos."""

from shipcosim.cosim.engines import ecos, libcosim
from shipcosim.cosim.master.run import run
from shipcosim.errors import Problem, ShipcosimError

OWN = {"fmpy": run, "native": run}
"""Our own master: in Python, and with models and loop compiled."""

OTHERS = {"libcosim": libcosim.run, "ecos": ecos.run}
"""Masters of others."""

ENGINES = OWN | OTHERS
"""Functions from a checked system, a scenario and `RunOptions` to a table."""

OWN_OPTIONS = ("start_time", "until", "resume", "store", "isolate")
"""Options that only our own master knows."""


def engines_missing() -> dict[str, Problem]:
    """Engines that are not installed, with what to install."""
    missing = {}
    for name, module in {"libcosim": libcosim, "ecos": ecos}.items():
        try:
            module.check_installed()
        except ShipcosimError as error:
            missing[name] = error.problems[0]
    return missing
