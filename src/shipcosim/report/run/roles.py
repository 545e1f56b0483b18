"""Roles of signals, found by their names alone, so that any system's table makes a page."""

import re
from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass, field

LOAD = re.compile(r"tau_([A-Za-z]\w*)_([XYN])")
FORCE = ("tau_X", "tau_Y")  # of a unit on the ship
NOT_A_SOURCE = ("cmd", "allocated", "bias", "max", "min")


@dataclass(frozen=True)
class Roles:
    """Components of a table that the page treats in their own way; names are '' or None where there is none.

    Parameters
    ----------
    ship : str or None
        Component with x, y and psi.
    reference : str or None
        Component with x_d, y_d and psi_d.
    thrusters : sequence of str
        Components with a thrust, and with a shaft or the force that they give the ship.
    environment : str or None
        Component with the wind over ground.
    harbour : str or None
        Component with wind and current at the ship, where these are not the environment's.
    connectors : dict of str to list of str
        Connector names of every component.
    """

    ship: str | None
    reference: str | None
    thrusters: Sequence[str]
    environment: str | None
    harbour: str | None
    connectors: dict[str, list[str]] = field(repr=False)

    def signal(self, component: str | None, *connectors: str) -> str | None:
        """Name of the first of these connectors that the component has, or None."""
        for connector in connectors:
            if component is not None and connector in self.connectors.get(component, ()):
                return join(component, connector)
        return None

    def anywhere(self, *connectors: str) -> list[str]:
        """Names of all signals whose connector is one of these, in the order asked for."""
        return [
            join(component, c)
            for c in connectors
            for component, has in self.connectors.items()
            if c in has
        ]

    def command(self, unit: str, quantity: str) -> str | None:
        """Signal of a thruster's command: its own input, or the allocator's output of its name."""
        return self.signal(unit, f"{quantity}_cmd") or next(
            iter(self.anywhere(f"{unit.rpartition('.')[2]}_{quantity}_cmd")), None
        )

    def allocators(self) -> list[str]:
        """Components that command several thrusters."""
        return [
            c
            for c, has in self.connectors.items()
            if sum("thrust_cmd" in connector for connector in has) > 1
        ]

    def flagged(self, connector: str) -> dict[str, str]:
        """Signals of this connector by component, as in all components that have 'saturated'."""
        return {
            component: join(component, connector)
            for component, has in self.connectors.items()
            if connector in has
        }

    def ending(self, *ends: str) -> list[str]:
        """Names of all signals whose connector ends so, in the table's order."""
        return [
            join(component, c)
            for component, has in self.connectors.items()
            for c in has
            if c.endswith(ends)
        ]

    def sources(self) -> list[str]:
        """Sources of load on the ship: wind, drift, hull, thrusters, in the table's order."""
        # Loads are named tau_SOURCE_AXIS; commands and limits of loads are no sources.
        on_ship = self.connectors.get(self.ship, ()) if self.ship is not None else ()
        matches = [LOAD.fullmatch(connector) for connector in on_ship]
        return list(dict.fromkeys(m[1] for m in matches if m and m[1] not in NOT_A_SOURCE))


def join(component: str, connector: str) -> str:
    """Signal name; a connector of the outermost system is its name alone."""
    return f"{component}.{connector}" if component else connector


def find_roles(names: Iterable[Hashable]) -> Roles:
    """Roles of the signals in a table.

    Parameters
    ----------
    names : iterable of str
        Signals.

    Returns
    -------
    Roles

    Examples
    --------
    >>> find_roles(["boat.x", "boat.y", "boat.psi", "boat.tau_wind_X", "bow.thrust", "bow.rpm"]).thrusters
    ['bow']
    """
    # Group connectors by component: roles follow from what a component has.
    connectors: dict[str, list[str]] = {}
    for name in names:
        component, _, connector = str(name).rpartition(".")
        connectors.setdefault(component, []).append(connector)

    def having(*wanted: str) -> list[str]:
        return [c for c, has in connectors.items() if set(wanted) <= set(has)]

    def likeness(component: str) -> tuple[bool, int]:
        loads = sum(LOAD.fullmatch(connector) is not None for connector in connectors[component])
        return component.endswith(("vessel", "ship", "hull")), loads

    # Sensors and predictors also have x, y and psi: what is called a ship comes first, then by number of loads.
    ships = sorted(having("x", "y", "psi"), key=likeness, reverse=True)
    # Wind at sea; a ship may repeat it as its input, so others come first.
    winds = having("wind_speed_mean") or having("wind_north", "wind_east")
    environment = next(iter([c for c in winds if c not in ships] or winds), None)
    # A harbour puts out wind and current at the ship; predictors only take them in.
    local = [
        c
        for c in having("wind_north", "current_north")
        if c not in (environment, *having("predicted_at"))
    ]
    return Roles(
        ship=next(iter(ships), None),
        reference=next(iter(having("x_d", "y_d", "psi_d")), None),
        thrusters=[
            c
            for c in having("thrust")
            if {"rpm", "power", "torque"} & set(connectors[c]) or c in having(*FORCE)
        ],
        environment=environment,
        harbour=next((c for c in local if c not in ships), None),
        connectors=connectors,
    )
