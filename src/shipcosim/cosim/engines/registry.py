"""The engines that can run a system: our own master, in Python or compiled, libcosim and ecos."""

from shipcosim.cosim.engines import ecos, libcosim
from shipcosim.cosim.master.run import run
from shipcosim.errors import Problem, ShipcosimError

ENGINES = {
    "auto": run,
    "fmpy": run,
    "native": run,
    "libcosim": libcosim.run,
    "ecos": ecos.run,
}
"""Functions from a checked system, a scenario and `RunOptions` to a table."""

OWN = ("auto", "fmpy", "native")
"""Engines that are our own master: as it pays, in Python, and with models and loop compiled."""

OWN_OPTIONS = ("start_time", "until", "resume", "store", "isolate", "realtime", "profile")
"""Options that only our own master knows."""


def engines_missing() -> dict[str, Problem]:
    """Engines that are not installed, and what to install."""
    missing = {}
    for name, module in {"libcosim": libcosim, "ecos": ecos}.items():
        try:
            module.check_installed()
        except ShipcosimError as error:
            missing[name] = error.problems[0]
    return missing
