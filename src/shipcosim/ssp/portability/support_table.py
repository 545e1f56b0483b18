"""Table of features that other tools do not support as the standard says, if they read a system file themselves.

Every entry is what the tool did when tried (libcosimpy 0.0.6, ecospy 0.7.2); tests run them again
and compare. `shipcosim simulate --engine` differs: each engine gets the system as we read it.
"""

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from shipcosim.ssp.portability import (
    connection_features,
    osp_features,
    parameter_features,
    structure_features,
)
from shipcosim.ssp.portability.subject import Found, Subject

IGNORED = "goes on without it, and says nothing"
MISREAD = "takes it for something else, and says nothing"
REFUSED = "refuses the system"
CRASHES = "crashes"
TOLD = "has to be told it in the call"
VERDICTS = {
    "ignored": IGNORED,
    "misread": MISREAD,
    "refused": REFUSED,
    "crashes": CRASHES,
    "told": TOLD,
}
HOSTS = ("libcosim", "ecos")


@dataclass(frozen=True)
class Feature:
    """A feature of a system that a tool does not take as the standard means it.

    Parameters
    ----------
    name, about : str
        Its key, and what it is.
    becomes : mapping of str to str
        By tool: what that does with it. A tool that is not in it does it right.
    remedy : str
        How the system can be written so that it means the same there.
    find : callable
        Places where a Subject has it, each with what is there: (place, what).
    """

    name: str
    about: str
    becomes: Mapping[str, str]
    remedy: str
    find: Callable[[Subject], Found]


def _feature(name: str, entry: dict[str, str]) -> Feature:
    module, function = entry.pop("find").split(".")
    about, remedy = entry.pop("about"), entry.pop("remedy")
    becomes = {tool: VERDICTS[verdict] for tool, verdict in entry.items()}
    return Feature(name, about, becomes, remedy, getattr(FINDERS[module], function))


FINDERS = {
    "connection_features": connection_features,
    "osp_features": osp_features,
    "parameter_features": parameter_features,
    "structure_features": structure_features,
}
TABLE = Path(__file__).with_suffix(".toml").read_text("utf-8")
FEATURES = tuple(_feature(name, entry) for name, entry in tomllib.loads(TABLE).items())
"""In the order in which a check reports them."""
