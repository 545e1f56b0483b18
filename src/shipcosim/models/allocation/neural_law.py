"""One step of the neural allocator: commands of the network, made safe by a quadratic program.

The network's commands keep limits and rates. The program finds the nearest commands that do so and
meet the request best, as `sqp.nearest_step`; commands that already meet it stay as they are.
"""

from typing import Any, NamedTuple

import numpy as np

from shipcosim.models.allocation import neural, neural_floats, sqp
from shipcosim.models.allocation.neural import Commands, Units
from shipcosim.models.allocation.neural_floats import Floats, floats_of
from shipcosim.models.allocation.units import no_thrust
from shipcosim.models.core.maths import Arithmetic, library_of, where
from shipcosim.models.core.motion import Load


class NeuralLaw(NamedTuple):
    """What a step needs of the parameters.

    Parameters
    ----------
    units : Units
        The units that there are. [as its fields say]
    numbers : tuple of int
        Their places among all units. [1]
    weights : tuple of pairs of (k, m) and (m,) arrays
        Matrix and offsets of each layer of the network. [1]
    safety : sqp.Design
        The same units for the quadratic program. [as its fields say]
    floats : Floats
        Units and network for one allocation in floats. [as its fields say]
    """

    units: Units
    numbers: tuple
    weights: tuple
    safety: sqp.OptimalProblem
    floats: Floats


class Remembered(NamedTuple):
    """State of the law: as `units.Allocated`, the smoothed request and what the network proposed.

    Parameters
    ----------
    thrusts, azimuths : tuple of floats or (...) arrays
        Commands of each unit; angles are not wrapped, so that they have no jumps. [N, rad]
    tau_X, tau_Y, tau_N : like a thrust
        Load of these commands, slipstreams considered, body frame. [N, N, N.m]
    saturated : bool or (...) array of bool
        True where limits or missing units keep the commands from meeting the request. [1]
    smooth : tuple of three, like a thrust
        Smoothed request. [N, N, N.m]
    proposed : tuple of two tuples, like thrusts and azimuths of the units that there are
        Commands of the network, before the program that makes them safe. [N, rad]
    """

    thrusts: tuple
    azimuths: tuple
    tau_X: Arithmetic
    tau_Y: Arithmetic
    tau_N: Arithmetic
    saturated: Arithmetic
    smooth: tuple
    proposed: tuple


def designed(
    units: Units, numbers: tuple, arrays: dict, least_degraded: tuple, lever_degraded: float
) -> NeuralLaw:
    """Design for some units and a trained network.

    Parameters
    ----------
    units : Units
        The units that there are, in vectors of NumPy. [as its fields say]
    numbers : tuple of int
        Their places among all units. [1]
    arrays : dict of str to array
        Weights: ``1.weights``, ``1.bias`` and so on for each layer. [1]
    least_degraded : tuple of floats
        Least thrust of each unit where another is missing: then units that turn may reverse. [N]
    lever_degraded : float
        A missed yaw moment weighs as a missed force at this distance where a unit is missing. [m]

    Returns
    -------
    NeuralLaw
        What `step` needs.

    Raises
    ------
    ValueError
        The network was trained for another number of units.

    References
    ----------
    Definition.
    """
    # Layers of the network; two outputs for each unit tell how many units it was trained for.
    weights = tuple(
        (arrays[f"{k}.weights"], arrays[f"{k}.bias"]) for k in range(1, len(arrays) // 2 + 1)
    )
    trained = weights[-1][0].shape[-1] // 2
    if trained != len(units.x):
        raise ValueError(
            f"the network was trained for {trained} units, the ship has {len(units.x)}"
        )
    # The same units for the quadratic program, which keeps the limits.
    rows = zip(*(np.asarray(values).tolist() for values in units[:10]), least_degraded, strict=True)
    safety = sqp.designed(tuple(_unit(*row) for row in rows), 0.0, units.lever, lever_degraded)
    return NeuralLaw(units, numbers, weights, safety, floats_of(units, weights))


def _unit(x, y, azimuth, turn, first, last, least, most, rate, full_power, degraded):
    """A unit as the quadratic program needs it."""
    # A unit that does not turn has an interval of one angle; its price is P = c |f|^1.5.
    interval = (first, last) if turn > 0.0 else (azimuth, azimuth)
    return sqp.AllocatedThruster(
        x, y, least, most, degraded, rate, *interval, turn, max(full_power, 1.0) / most**1.5
    )


def resting(tau: Load, azimuths: tuple) -> Remembered:
    """State at the start: no thrust.

    Parameters
    ----------
    tau : tuple of three floats or (...) arrays
        Any load: it gives shape and type only. [N, N, N.m]
    azimuths : tuple of floats
        Angles of the units. [rad]

    Returns
    -------
    Remembered
        The state.

    References
    ----------
    Definition.
    """
    rest = no_thrust(tau, azimuths)
    zero = 0.0 * tau[0]
    return Remembered(*rest, (zero, zero, zero), (rest.thrusts, rest.azimuths))


def step(
    state: Remembered,
    tau: Load,
    available: tuple,
    h: float,
    *,
    design: NeuralLaw,
    shares: tuple | None = None,
    parameters: Any = None,
) -> Remembered:
    """Commands for a requested load, `h` after the last ones.

    Parameters
    ----------
    state : Remembered
        State at the last commands.
    tau : tuple of three floats or (...) arrays
        Requested load, body frame. [N, N, N.m]
    available : tuple of bools or (...) arrays of bool
        Whether the units can be used; one that cannot gives 0 at once and keeps its angle. [1]
    h : float
        Time since the last commands. [s]
    design : NeuralLaw
        Made by `designed`.
    shares : tuple of floats or (...) arrays, optional
        Shares of their limits of thrust that power leaves to the units. [1]
    parameters : any
        Of the FMU, as every law gets them; the design has what is needed of them. [as their fields]

    Returns
    -------
    Remembered
        Commands and the load they give.

    References
    ----------
    As `neural.propose` and `sqp.nearest_step`.
    """
    # Only the units that exist; power may leave them a share of their limits.
    numbers = design.numbers
    left = tuple(shares[k] if shares else 1.0 for k in numbers)
    on = tuple(available[k] for k in numbers)
    zero = 0.0 * tau[0]
    # Missing units have the share 0.
    usable = [where(unit, share + zero, zero) for unit, share in zip(on, left, strict=True)]
    thrusts, azimuths = (tuple(of[k] for k in numbers) for of in (state.thrusts, state.azimuths))
    # Load that slipstreams take from the last commands.
    lost = _taken(thrusts, azimuths, design)
    # Commands of the network, then the nearest ones that keep all limits and meet the request.
    wanted, angles, smooth = _proposed(
        (thrusts, azimuths, state.smooth), tau, usable, lost, h, design
    )
    last = sqp.Turned(thrusts, azimuths, zero, zero, zero, zero > 0.0, (zero, zero, zero))
    asked = (
        tau[0] + lost[0],
        tau[1] + lost[1],
        tau[2] + lost[2],
    )  # within a step the loss hardly changes
    safe = sqp.nearest_step(last, wanted, angles, asked, on, h, design=design.safety, shares=left)
    # Report the load with the slipstreams of the new commands.
    lost = _taken(safe.thrusts, safe.azimuths, design)
    X, Y, N = (
        axis - loss for axis, loss in zip((safe.tau_X, safe.tau_Y, safe.tau_N), lost, strict=True)
    )
    # Put the commands back to their places among all units.
    all_thrusts = list(state.thrusts)
    all_azimuths = list(state.azimuths)
    for k, thrust, azimuth in zip(numbers, safe.thrusts, safe.azimuths, strict=True):
        all_thrusts[k], all_azimuths[k] = thrust, azimuth
    return Remembered(
        tuple(all_thrusts), tuple(all_azimuths), X, Y, N, safe.saturated, smooth, (wanted, angles)
    )


def _proposed(before, tau, usable, lost, h, design):
    """Commands of the network: thrusts, angles, and the smoothed request."""
    # One number each: plain floats are several times as fast.
    if isinstance(tau[0], float):
        thrusts, azimuths, smooth = before
        return neural_floats.propose(thrusts, azimuths, smooth, tau, usable, lost, h, design.floats)
    state = Commands(*(_vector(values) for values in before))
    found = neural.propose(
        state, _vector(tau), _vector(usable), h, units=design.units, weights=design.weights
    )
    return tuple(_entries(vector) for vector in found)


def _taken(thrusts, azimuths, design):
    """Load that slipstreams take: X, Y, N."""
    if isinstance(thrusts[0], float):
        return neural_floats.taken(thrusts, azimuths, design.floats)
    if design.units.tandem is None:
        return 0.0, 0.0, 0.0
    return _entries(neural.taken(_vector(thrusts), _vector(azimuths), units=design.units))


def _vector(values):
    """Arrays or tensors along a new last axis."""
    return library_of(*values).stack(list(values), -1)


def _entries(vector):
    """The entries of the last axis."""
    return tuple(vector[..., k] for k in range(vector.shape[-1]))
