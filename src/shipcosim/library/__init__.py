"""What has a name: scenarios, studies, systems, ships, FMUs and examples of a user's project and of the package.

`find` is the one look-up of names, for commands and Python: a path first, then a name in the project around, then one
in what the package ships. `entries` lists them, `fmus` gives the folders of built FMUs.
"""

from shipcosim.library.building import build_stale, built_fmus, fmus
from shipcosim.library.finding import (
    SYSTEMS,
    check_is_system,
    files_of,
    find,
    find_any,
    find_parameters,
    scenarios,
)
from shipcosim.library.names import KINDS, Entry, entries, fmu_sources, line_of, named, names
from shipcosim.library.places import cache, project_of, roots, shipped

__all__ = [
    "KINDS",
    "SYSTEMS",
    "Entry",
    "build_stale",
    "built_fmus",
    "cache",
    "check_is_system",
    "entries",
    "files_of",
    "find",
    "find_any",
    "find_parameters",
    "fmu_sources",
    "fmus",
    "line_of",
    "named",
    "names",
    "project_of",
    "roots",
    "scenarios",
    "shipped",
]
