"""Writes the parameter sets of the ships in ssp/ships as SSV files into the systems that they name.

Run `python ssp/write_parameter_sets.py` after a number of a ship has changed, or a ship has come; a test compares the
files with what this writes. Which parameters a component has its FMU's source says, `fmus/<name>/<name>.py`.
"""

import importlib.util
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

from shipcosim.errors import ShipcosimError
from shipcosim.ships import Ship, parameter_values, read_ship
from shipcosim.ssp import write_ssv

HERE = Path(__file__).resolve().parent
COMPONENT = "{http://ssp-standard.org/SSP1/SystemStructureDescription}Component"


def ships() -> list[str]:
    """Names of the ships."""
    return sorted(file.parent.name for file in (HERE / "ships").glob("*/ship.toml"))


@cache
def kinds(fmu: str) -> tuple[type, ...]:
    """Classes of parameters of an FMU of ours, in the order of its declaration; none of somebody else's FMU."""
    path = HERE.parent / "fmus" / fmu / f"{fmu}.py"
    if not path.is_file():
        return ()
    spec = importlib.util.spec_from_file_location(f"parameters_of_{fmu}", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    found = next(
        c
        for c in vars(module).values()
        if getattr(c, "__module__", "") == spec.name and hasattr(c, "groups")
    )
    return tuple(group.kind for group in found.groups)


def components(system: str, ship: Ship) -> dict[str, tuple[type, ...]]:
    """Components of a system that a ship has parameters of or should have, with their classes of parameters."""
    found = {}
    for element in ElementTree.parse(HERE / system / "SystemStructure.ssd").iter(COMPONENT):
        name, own = element.get("name"), kinds(Path(element.get("source")).stem)
        if name in ship.entries or any(
            field.default is field.default_factory for kind in own for field in _fields(kind)
        ):
            found[name] = own
    return found


def _fields(kind: type) -> tuple:
    return tuple(kind.__dataclass_fields__.values())


def values(system: str, ship: Ship) -> Iterator:
    """Parameters of a ship in a system, as they stand in the SSV."""
    return parameter_values(ship, components(system, ship))


if __name__ == "__main__":
    try:
        for name in ships():
            ship = read_ship(HERE / "ships" / name)
            for system in ship.systems:
                write_ssv(HERE / system / "resources" / f"{name}.ssv", name, values(system, ship))
    except ShipcosimError as error:
        raise SystemExit(str(error)) from None
