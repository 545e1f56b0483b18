"""The loads that a model has on the ship along the measured motion: of each thruster, of the wind, of the hull."""

from dataclasses import dataclass, replace

import numpy as np

from shipcosim.diagnose.comparison.measured_force import MeasuredForce
from shipcosim.diagnose.ship.dynamics import loads
from shipcosim.diagnose.ship.inputs import Record
from shipcosim.diagnose.ship.measured_motion import at_rows
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.models.core.motion import Load, Motion
from shipcosim.models.ship.hull import hull_loads


@dataclass(frozen=True)
class Commanded:
    """Loads by a model along a measured motion, unsmoothed.

    Attributes
    ----------
    thrusters : dict of str to (3, n) array
        By thruster. [N, N, N.m]
    hull : (3, n) array
        Of the water on the hull.
    wind : (3, n) array or None
        None where the log has no wind.
    """

    thrusters: dict[str, np.ndarray]
    hull: np.ndarray
    wind: np.ndarray | None

    @property
    def thrust(self) -> np.ndarray:
        """Load of all thrusters together, (3, n) array."""
        return sum(self.thrusters.values(), np.zeros_like(self.hull))


def commanded_by(record: Record, measured: MeasuredForce, model: ShipModel) -> Commanded:
    """The loads of a model along what a log shows.

    Parameters
    ----------
    record : Record
    measured : MeasuredForce
        Of the log.
    model : ShipModel
        With surrogates of third-party FMUs.

    Returns
    -------
    Commanded
    """
    inputs = record.inputs(model)
    # Inputs belong to the steps between rows: the motion at their beginning.
    motion = measured.motion
    size = record.time.size
    steps = at_rows(motion, slice(-1))
    # Loads by the model at the measured velocities; only the thrusters and the wind are taken from
    # them.
    by_part = {name: _rows(load, size) for name, load in loads(steps, inputs, model).items()}
    hull = _rows(hull_loads(motion.u, motion.v, motion.r, hull=model.parts["hull"]), size)
    return Commanded({name: by_part[name] for name in model.thrusters}, hull, by_part.get("wind"))


def _rows(load: Load, size: int) -> np.ndarray:
    """A load as (3, n) array; of values for each step only, the last is held at the last row."""
    # Components may be scalars or series: bring all to the same length, and repeat the last step
    # for the last row.
    rows = np.stack(
        [np.broadcast_to(axis, np.broadcast_shapes(*map(np.shape, load))) for axis in load]
    )
    rows = np.broadcast_to(rows if rows.ndim > 1 else rows[:, None], (3, max(rows.shape[-1], 1)))
    return np.pad(rows, ((0, 0), (0, size - rows.shape[1])), mode="edge")


def moving_mass(motion: Motion, model: ShipModel) -> np.ndarray:
    """Loads that turning asks of the rigid body, C_RB(ν) ν, (3, n) array. [N, N, N.m]"""
    hull = model.parts["hull"]
    mass = hull.rigid_body[0]
    ahead = hull.centre_of_gravity_x
    # Rigid body about an origin ahead of which the centre of gravity lies (Fossen's C_RB).
    u = motion.u
    v = motion.v
    r = motion.r
    return mass * np.stack([-r * (v + ahead * r), r * u, ahead * r * u])


def late(commanded: Commanded, rows: float) -> Commanded:
    """Commanded forces of thrusters that act some rows later."""
    # Interpolate between rows, as the delay need not be a whole number of them.
    at = np.arange(commanded.hull.shape[1])
    moved = {
        name: np.stack([np.interp(at - rows, at, axis) for axis in load])
        for name, load in commanded.thrusters.items()
    }
    return replace(commanded, thrusters=moved)
