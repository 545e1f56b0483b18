"""Parameters of a ship as in an SSV."""

from collections.abc import Iterator, Mapping
from typing import Any

from shipcosim.ships.folder import Ship
from shipcosim.ssp import parameter


def parameter_values(ship: Ship, components: Mapping[str, tuple[type, ...]]) -> Iterator[Any]:
    """Parameters of a ship's components, as `write_ssv` takes them.

    Parameters
    ----------
    ship : Ship
    components : mapping of str to tuple of type
        By component its classes of parameters.

    Raises
    ------
    ShipcosimError
        With everything that is missing or wrong.
    """
    for component, quantities in ship.parameter_set(components).items():
        for name, q in quantities.items():
            # Dimensionless and text values have no unit; the description carries the origin.
            unit = q.unit if isinstance(q.value, float) and q.unit != "1" else None
            text = f"{q.description}; {q.origin}"
            if q.uncertainty:
                text += f"; sources from {q.uncertainty[0]:g} to {q.uncertainty[1]:g}"
            yield parameter(
                f"{component}.{name}", q.value, unit, text, tolerance=q.tolerance or None
            )
