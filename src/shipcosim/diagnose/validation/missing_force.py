"""The force that a model lacks over a log: what else must have acted on the ship for her to move as she did."""

from dataclasses import dataclass, replace

import numpy as np
import xarray

from shipcosim.diagnose.inference.fitting import Fit, IdentificationProblem
from shipcosim.diagnose.inference.innovations import smoothed
from shipcosim.diagnose.inference.parts import linearised_by_parts
from shipcosim.diagnose.ship.inputs import Record
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.thrusters import dp_thruster_of
from shipcosim.diagnose.validation.thresholds import FEWEST_SECTOR_ROWS, FORCE_TIME, SECTORS
from shipcosim.models.core.kinematics import to_body, to_ned
from shipcosim.models.core.motion import Motion


@dataclass(frozen=True)
class MissingForce:
    """The force that a model lacks.

    Attributes
    ----------
    plain : xarray.Dataset
        What the plain model lacks over the log, as from `missing_force`.
    extended : xarray.Dataset or None
        What it lacks with the causes in it.
    by_angle : dict of str to xarray.Dataset
        Of ``"heading"`` and ``"wind_from"``: mean and standard deviation in sectors, as from `by_sector`.
    thrusters : tuple of str
        Those with a frame of their own.
    """

    plain: xarray.Dataset
    extended: xarray.Dataset | None
    by_angle: dict[str, xarray.Dataset]
    thrusters: tuple[str, ...]


def missing_forces(problem: IdentificationProblem, fit: Fit | None) -> MissingForce:
    """Missing force of the plain model and, after a fit, of the model with the causes."""
    plain = missing_force(problem, problem.model, problem.motion)
    extended = None if fit is None else missing_force(problem, fit.model, fit.motion)
    angles = [name for name in ("heading", "wind_from") if name in plain]
    return MissingForce(
        plain,
        extended,
        {name: by_sector(plain, name) for name in angles},
        tuple(problem.model.azimuths),
    )


def by_sector(force: xarray.Dataset, angle: str) -> xarray.Dataset:
    """Mean and standard deviation of the missing force forward and to starboard in sectors of an angle.

    Parameters
    ----------
    force : xarray.Dataset
        As from `missing_force`.
    angle : str
        ``"heading"`` or ``"wind_from"``.

    Returns
    -------
    xarray.Dataset
        Over ``sector``, the middle of each [deg]: ``surge``, ``sway``, NaN where there are few rows, and
        ``surge_std``, ``sway_std`` [N].
    """
    width = 360.0 / SECTORS
    # Sector of each row, the angle wrapped to a full circle.
    sector = np.minimum((force[angle].values % 360.0 / width).astype(int), SECTORS - 1)
    columns = {}
    for name in ("surge", "sway"):
        values = force[name].values
        groups = [values[(sector == k) & np.isfinite(values)] for k in range(SECTORS)]
        mean = [g.mean() if g.size >= FEWEST_SECTOR_ROWS else np.nan for g in groups]
        spread = [g.std() if g.size >= FEWEST_SECTOR_ROWS else 0.0 for g in groups]
        columns |= {
            name: ("sector", mean, {"units": "N"}),
            f"{name}_std": ("sector", spread, {"units": "N"}),
        }
    return xarray.Dataset(columns, {"sector": (np.arange(SECTORS) + 0.5) * width})


def missing_force(
    problem: IdentificationProblem,
    model: ShipModel,
    motion: Motion,
) -> xarray.Dataset:
    """Reconstruct what a ship model lacks: the smoothed acceleration that nothing explains, times mass and added mass.

    Parameters
    ----------
    problem : IdentificationProblem
        Of one log.
    model : ShipModel
        ``problem.model`` for all that the plain model lacks, ``fit.model`` for what a fit leaves.
    motion : Motion
        Near the measured one; ``problem.motion``, ``fit.motion``.

    Returns
    -------
    xarray.Dataset
        Over ``time``, NaN where what drove the ship is not known: ``surge``, ``sway`` [N], ``yaw`` [N.m]; ``north``,
        ``east`` [N]; by thruster ``NAME_along``, the part in the direction of its positive thrust, and ``NAME_across``,
        clockwise of it [N]. For plots against them: ``heading``, ``wind_from`` relative to the bow [deg],
        ``speed`` over ground [m/s].
    """
    record = problem.record
    # A random walk that may change as fast as the jolts within FORCE_TIME: the unexplained
    # acceleration then takes up all that is missing.
    noise = replace(problem.noise, walk=problem.noise.jolt / FORCE_TIME)
    motion, slow = smoothed(linearised_by_parts(motion, record, model, []), noise, record, motion)
    # Acceleration times mass and added mass; not where the inputs are unknown.
    force = np.where(record.usable[:, None], slow[:, :3] @ model.mass_matrix.T, np.nan)
    return _in_frames(force.T, motion, record, model)


def _in_frames(
    force: np.ndarray, motion: Motion, record: Record, model: ShipModel
) -> xarray.Dataset:
    """Table of a force, (3, n) array in body axes, and of what it may depend on."""
    surge, sway, yaw = force
    # The same force in north-east axes and along each thruster, to see what it goes with.
    north, east = to_ned(motion.psi, surge, sway)
    columns = {
        "surge": (surge, "N", "missing force forward"),
        "sway": (sway, "N", "missing force to starboard"),
        "yaw": (yaw, "N.m", "missing yaw moment"),
        "north": (north, "N", "missing force towards north"),
        "east": (east, "N", "missing force towards east"),
    }
    for name in model.thrusters:
        unit = dp_thruster_of(model, name)
        direction = unit.axis + (record.units[name][1] if unit.pointed else np.zeros(surge.size))
        along, across = to_body(direction, surge, sway)
        columns[f"{name}_along"] = (
            along,
            "N",
            f"missing force in the direction of positive thrust of {name}",
        )
        columns[f"{name}_across"] = (
            across,
            "N",
            f"missing force clockwise of positive thrust of {name}",
        )
    columns["heading"] = np.degrees(motion.psi) % 360.0, "deg", "heading"
    columns["speed"] = np.hypot(motion.u, motion.v), "m/s", "speed over ground"
    if record.wind is not None:
        bow = motion.psi if model.wind_is_true else 0.0
        columns["wind_from"] = (
            np.degrees(record.wind[1] - bow) % 360.0,
            "deg",
            "direction of the wind from the bow",
        )
    about = {"units": "s", "long_name": "time"}
    variables = {
        n: ("time", v, {"units": u, "long_name": text}) for n, (v, u, text) in columns.items()
    }
    return xarray.Dataset(variables, {"time": ("time", record.time, about)})
