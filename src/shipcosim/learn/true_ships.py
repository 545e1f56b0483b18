"""True ships of simulated records: their distance from the models, their parameters, the runs."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import fields
from typing import Any, NamedTuple, TypeVar

import numpy as np

from shipcosim.cosim import system_of
from shipcosim.models.core.tables import text
from shipcosim.scenario import Scenario
from shipcosim.ssp import Component, System

Drawn = TypeVar("Drawn")
Record = TypeVar("Record")
STRIPS = 0.30
WIND = 0.15
POWER = 0.15
DAMPING = 0.4
MEMORY = 0.25
NOISE = 0.2
"""Most at distance 1: of the drag factor at five places along the hull, of the wind load factors at eight directions,
of powers of speed from 2, of linear damping over the quadratic one at `SPEEDS`, of the added mass that remembers, of
the errors of sensors. [1]"""
SPEEDS = (1.0, 0.3, 0.02)  # m/s, m/s, rad/s


class TrueLoads(NamedTuple):
    """Form of a ship that her model does not have, for the FMU `rough_vessel`.

    Parameters
    ----------
    along : (5,) array
        Factors of cross-flow drag from stern to bow. [1]
    around : (8, 3) array
        Factors of wind load X, Y, N every 45 deg, wind from the bow first. [1]
    powers : (2,) array
        Of speed, in resistance and cross flow. [1]
    damping : (3,) array
        Linear damping. [N s/m, N s/m, N m s/rad]
    memory : (3,) array
        Share of the added mass that remembers, in surge, sway and yaw. [1]
    """

    along: np.ndarray
    around: np.ndarray
    powers: np.ndarray
    damping: np.ndarray
    memory: np.ndarray

    def values(self) -> dict[str, float | str]:
        """Start values of the component `vessel`."""
        # Close the circle: 360 deg repeats 0 deg, so that the table interpolates across the bow.
        around = np.vstack([self.around, self.around[:1]])
        return {
            "vessel.strip_factors": text(zip(np.linspace(-1.0, 1.0, 5), self.along, strict=True)),
            "vessel.wind_factors": text(np.column_stack([np.arange(0.0, 361.0, 45.0), around])),
            **_named(("drag_power", "cross_flow_power"), self.powers),
            **_named(("X_u", "Y_v", "N_r"), self.damping),
            **_named(("memory_surge", "memory_sway", "memory_yaw"), self.memory),
        }


def factors(
    rng: np.random.Generator, size: int | tuple[int, int], most: float, distance: float
) -> np.ndarray:
    """Factors about 1, drawn uniformly.

    Parameters
    ----------
    rng : Generator
        Where they are drawn.
    size : int or tuple of int
        Shape of the array. [1]
    most : float
        They differ from 1 by at most this, at distance 1. [1]
    distance : float
        How far truth and nominal model are apart. [1]

    Returns
    -------
    array of this shape
        [1]
    """
    return 1.0 + distance * most * rng.uniform(-1.0, 1.0, size)


def system_with(system: str, parameters: str, components: dict[str, str] | None = None) -> System:
    """A system with the parameters of a ship.

    Parameters
    ----------
    system, parameters : str
        Their names.
    components : dict of str to str, optional
        FMUs in the place of those of the system.

    Returns
    -------
    System
        Read anew.
    """
    scenario = Scenario(
        system=system,
        parameters=[parameters],
        components=components or {},
        stop_time=1.0,
        step_size=0.1,
    )
    return system_of(scenario)


def known_to(component: Component, *kinds: type) -> list[Any]:
    """Parameters as a component has them.

    Parameters
    ----------
    component : Component
        As a predictor, which knows the ship by her parameter set.
    kinds : types
        Dataclasses of parameters whose names the component has.

    Returns
    -------
    list
        One of each kind.
    """
    return [
        kind(**{field.name: component.start[field.name] for field in fields(kind)})
        for kind in kinds
    ]


def sailed(
    sail: Callable[[Drawn], Record],
    drawn: Sequence[Drawn],
    processes: int,
    progress: Callable[[int, int], Any] | None,
) -> Iterator[Record]:
    """Results of several co-simulations, in their order.

    Parameters
    ----------
    sail : callable
        Co-simulates one; a function of a module.
    drawn : sequence
        What is sailed.
    processes : int
        How many sail at a time. [1]
    progress : callable, optional
        Called with how many are done, and of how many.
    """
    # Worker processes run the co-simulations; results keep the order of the draws.
    with ProcessPoolExecutor(processes) as pool:
        for done, record in enumerate(pool.map(sail, drawn), 1):
            yield record
            if progress is not None:
                progress(done, len(drawn))


def _named(names: Sequence[str], numbers: np.ndarray) -> dict[str, float]:
    return {f"vessel.{name}": number for name, number in zip(names, numbers.tolist(), strict=True)}
