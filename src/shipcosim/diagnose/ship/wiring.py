"""Connections of thrusters that contradict the names of their connectors; the log decides whether they are wrong."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipcosim.models.core.maths import Arithmetic
from shipcosim.models.core.motion import Load
from shipcosim.series import conversion
from shipcosim.ssp import System

_AXES = ("X", "Y", "N")
_DRIVES = ("rpm", "azimuth")


@dataclass(frozen=True)
class Wiring:
    """Connections that contradict the names of their connectors.

    Attributes
    ----------
    loads : dict of str to (3, 3) array
        By thruster: X, Y, N that the ship gets, of the thruster's own.
    drives : dict of str to dict of str to (str, float)
        By thruster, then ``rpm`` and ``azimuth``: whose logged speed or direction it gets, and by which factor.
    odd : dict of str to str
        What is wrong, by thruster.
    """

    loads: dict[str, np.ndarray]
    drives: dict[str, dict[str, tuple[str, float]]]
    odd: dict[str, str]

    def loaded(self, name: str, load: Load) -> Load:
        """The load that the ship gets of a thruster's."""
        if name not in self.loads:
            return load
        surge, sway, yaw = (
            sum(share * axis for share, axis in zip(row, load, strict=True))
            for row in self.loads[name]
        )
        return surge, sway, yaw

    def driven(
        self, name: str, units: Mapping[str, tuple[Arithmetic, Arithmetic]]
    ) -> tuple[Arithmetic, Arithmetic]:
        """Speed and direction that a thruster gets, of those logged by thruster."""
        logged = [self.drives.get(name, {}).get(kind, (name, 1.0)) for kind in _DRIVES]
        speed, direction = (factor * units[source][i] for i, (source, factor) in enumerate(logged))
        return speed, direction


def wiring_of(system: System, vessel: str, thrusters: Sequence[str]) -> Wiring | None:
    """Connections of a system that contradict the names of its connectors.

    Parameters
    ----------
    system : System
    vessel : str
    thrusters : sequence of str

    Returns
    -------
    Wiring or None
        None where all is as named.
    """
    loads = {}
    drives = {}
    odd = {}
    # Load of each thruster: its matrix of connections should be the identity.
    for name in thrusters:
        matrix = _matrix(system, vessel, name)
        if not np.allclose(matrix, np.eye(3), rtol=1e-9, atol=1e-12):
            loads[name] = matrix
            odd[name] = f"its load reaches {vessel} as {_words_for(matrix)}"
        # Drive of each thruster: it should be its own logged speed and direction.
        drives[name] = _driven(system, name, thrusters)
        for kind, (source, factor) in drives[name].items():
            if source != name or abs(factor - 1.0) > 1e-9:
                what = (
                    f"{factor:g} times {source}_{kind}"
                    if abs(factor - 1.0) > 1e-9
                    else f"{source}_{kind}"
                )
                odd[name] = "; ".join(
                    filter(None, (odd.get(name), f"its {kind} comes from {what}"))
                )
    return Wiring(loads, drives, odd) if odd else None


def put_right(wiring: Wiring, name: str) -> Wiring | None:
    """The wiring with one thruster corrected by the names of its connectors; None if nothing contradicts them."""
    rest = {other: why for other, why in wiring.odd.items() if other != name}
    loads, drives = (
        {k: v for k, v in part.items() if k != name} for part in (wiring.loads, wiring.drives)
    )
    return replace(wiring, loads=loads, drives=drives, odd=rest) if rest else None


def _matrix(system: System, vessel: str, name: str) -> np.ndarray:
    """Share of each axis of a thruster's load in each axis of the ship's."""
    matrix = np.zeros((3, 3))
    for connection in system.connections:
        (source, output) = connection.source
        # Factors of the connections between load outputs and load inputs.
        (target, slot) = connection.target
        if (
            source == name
            and target == vessel
            and output.startswith("tau_")
            and slot.startswith("tau_")
        ):
            matrix[_AXES.index(slot[4]), _AXES.index(output[4])] += connection.factor
    return matrix


def _words_for(matrix: np.ndarray) -> str:
    """A matrix in words: ``X: Y, Y: -1 Y, N: nothing``."""
    rows = []
    for axis, row in zip(_AXES, matrix, strict=True):
        terms = [
            name if share == 1.0 else f"{share:g} {name}"
            for share, name in zip(row, _AXES, strict=True)
            if share
        ]
        rows.append(f"{axis}: {' + '.join(terms) or 'nothing'}")
    return ", ".join(rows)


def _driven(system: System, name: str, thrusters: Sequence[str]) -> dict[str, tuple[str, float]]:
    """Whose logged speed and direction a thruster gets from the system's inputs, and by which factor."""
    sources = {}
    for connection in system.connections:
        (source, given) = connection.source
        (target, variable) = connection.target
        other, _, kind = given.rpartition("_")
        if (
            source is None
            and target == name
            and variable == f"{kind}_in"
            and kind in _DRIVES
            and other in thrusters
        ):
            # The unit conversion is no oddity: divide it out of the factor.
            unit = system.components[name].variables[variable].unit
            plain, _ = conversion(system.inputs[given].unit, unit)
            sources[kind] = other, connection.factor / plain
    return sources
