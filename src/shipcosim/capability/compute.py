"""From a ship to her capability: all conditions and directions, intact and after each failure."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from shipcosim.capability.balance import Actuator, largest_share
from shipcosim.capability.conditions import CONDITIONS, DIRECTIONS, DYNAMIC_FACTOR, Condition
from shipcosim.capability.loads import level_1_parts
from shipcosim.capability.particulars import Hull
from shipcosim.capability.result import LEVEL_1, SIMULATOR, Capability, Case
from shipcosim.capability.sectors import pieces, sectors
from shipcosim.capability.simulator import simulated_parts
from shipcosim.capability.thrust import BETA_MISC, Thruster, ventilation
from shipcosim.capability.vessel import Simulated, Vessel
from shipcosim.errors import Problem, ShipcosimError, suggestion


def cases_of(vessel: Vessel, groups: Iterable[Sequence[str]] = ()) -> tuple[Case, ...]:
    """The ship intact, without each thruster, without each bus of several, and without each group.

    Parameters
    ----------
    vessel : Vessel
    groups : iterable of sequence of str
        Names of thrusters that one failure takes out together, as of one switchboard.

    Returns
    -------
    tuple of Case

    Raises
    ------
    ShipcosimError
        There is no thruster of some name.
    """
    names = [thruster.name for thruster in vessel.thrusters]
    given = [tuple(dict.fromkeys(group)) for group in groups]
    unknown = dict.fromkeys(name for group in given for name in group if name not in names)
    if unknown:
        raise ShipcosimError(
            [Problem("--failure", f"'{n}' is no thruster.", suggestion(n, names)) for n in unknown]
        )
    # A set of thrusters occurs once, however it is lost. Each single thruster counts, as the
    # notation asks for the worst single failure.
    lost = {
        frozenset(group): f"without {' and '.join(group)}"
        for group in [*((name,) for name in names), *given]
    }
    # A bus with one thruster is the loss of this thruster; it is listed already.
    for bus, fed in vessel.buses.items():
        if len(fed) > 1:
            lost[frozenset(fed)] = f"without bus {bus} ({' and '.join(fed)})"
    # Names in the order of the system, so that the tables are the same each time.
    return (
        Case("intact", ()),
        *(Case(name, tuple(n for n in names if n in group)) for group, name in lost.items()),
    )


def capability_of(vessel: Vessel, groups: Iterable[Sequence[str]] = ()) -> Capability:
    """Static capability of a ship by the formulae of Level 1, and by the simulator's own models.

    Parameters
    ----------
    vessel : Vessel
    groups : iterable of sequence of str
        As for `cases_of`.

    Returns
    -------
    Capability
    """
    cases = cases_of(vessel, groups)
    shares: dict[str, list[list[NDArray]]] = {LEVEL_1: [], SIMULATOR: []}
    # Both methods see the same failures: the formulae of Level 1, and the simulator's models.
    for case in cases:
        working, failed = case.split(vessel.thrusters)
        shares[LEVEL_1].append([level_1_share(vessel.hull, working, failed, c) for c in CONDITIONS])
        shares[SIMULATOR].append(
            [simulated_share(vessel.simulated, working, c) for c in CONDITIONS]
        )
    # Used thrust is 1 / share. A share of 0 (nothing can be balanced) becomes infinite.
    with np.errstate(divide="ignore"):
        return Capability(
            vessel, cases, {method: 1.0 / np.array(share) for method, share in shares.items()}
        )


def level_1_share(
    hull: Hull, working: Sequence[Thruster], failed: Sequence[Thruster], condition: Condition
) -> NDArray:
    """Largest balanced share of a condition's load, by the formulae of Level 1.

    Parameters
    ----------
    hull : Hull
    working, failed : sequence of Thruster
    condition : Condition

    Returns
    -------
    (directions,) array
        Weather from each of `DIRECTIONS`. [1]
    """
    # Available thrust: nominal, times losses (beta_misc), times what ventilation leaves, without
    # the forbidden sectors.
    actuators = [
        _actuator(
            t, BETA_MISC * ventilation(t, hull, condition, DIRECTIONS), sectors(t, working, failed)
        )
        for t in working
    ]
    # The weather turns around the ship; wind, waves and current come from the same direction.
    return largest_share(actuators, _load(level_1_parts(hull, condition, DIRECTIONS)))


def simulated_share(ship: Simulated, working: Sequence[Thruster], condition: Condition) -> NDArray:
    """Share of thrust by the simulator's loads; the thrusters give up to their limits."""
    # The simulator's thrusters lose nothing by neighbours here: no sectors, and all of the thrust.
    limited = [replace(t, **vars(ship.limits[t.name])) for t in working]
    actuators = [_actuator(t, np.ones(len(DIRECTIONS)), ()) for t in limited]
    return largest_share(actuators, _load(simulated_parts(ship, condition, DIRECTIONS)))


def _actuator(thruster: Thruster, left: NDArray, narrowed: Sequence) -> Actuator:
    return Actuator(thruster.x, thruster.y, pieces(thruster, narrowed), left)


def _load(parts: dict[str, NDArray]) -> NDArray:
    # The dynamic factor covers what a static balance leaves out (DNV-ST-0111).
    return DYNAMIC_FACTOR * sum(parts.values(), np.zeros((len(DIRECTIONS), 3)))
