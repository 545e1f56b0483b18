"""Writes the parameter sets of R/V Gunnerus as SSV files, from the numbers and origins in shipcosim.models.

Run `python ssp/write_parameter_sets.py` after a number has changed; a test compares the files with what this writes.
"""

from pathlib import Path

from shipcosim.models.ships import COMPONENTS, SHIPS, parameter_set
from shipcosim.ssp import parameter, write_ssv

HERE = Path(__file__).parent
SYSTEMS = {
    "gunnerus_dp": tuple(COMPONENTS),
    "gunnerus_open": ("vessel", "port", "starboard", "tunnel"),
}


def values(ship, components):
    """Parameters of those components of a ship that a system has."""
    for component, quantities in parameter_set(ship).items():
        if component in components:
            for name, q in quantities.items():
                unit = q.unit if isinstance(q.value, float) and q.unit != "1" else None
                text = f"{q.description}; {q.origin}"
                yield parameter(f"{component}.{name}", q.value, unit, text, tolerance=q.tolerance or None)


if __name__ == "__main__":
    for system, components in SYSTEMS.items():
        for ship in SHIPS:
            write_ssv(HERE / system / "resources" / f"{ship}.ssv", ship, values(ship, components))
