"""Stability margins of the DP loop, computed from the parameters of observer and control law.

The loop is opened where the thrusters act on the ship, axis by axis, the other axes closed. Observer and law are the
functions that run in the controller, linearised by differences at rest; the ship is the model that they use. Around
them go the steps of the co-simulation, the latencies of the sensors and the lag of the thrusters. Positions come less
often than the controller runs, so the loop is periodic: its response is that of the frequency it is excited with.

References
----------
Åström and Murray, Feedback Systems, 2nd ed., Princeton, 2021, chapters 10 and 13; periodic loops: Bittanti and
Colaneri, Periodic Systems, Springer, 2009.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from shipcosim.models.control import observer, pid
from shipcosim.models.control.observer import DpShip, Measurement, ObserverParameters, StateEstimate
from shipcosim.models.control.pid import ControlParameters, ControlState, Desired
from shipcosim.models.core.motion import Motion
from shipcosim.models.core.parameters import quantity

AXES = ("surge", "sway", "yaw")
_ESTIMATE = 15
_CONTROL = 6
_SMALL = 1e-5


@dataclass(frozen=True, kw_only=True)
class Delays:
    """Delays of the loop outside observer and law, in whole samples except the lag."""

    position: float = quantity(
        0.4, "s", "age of a position when the controller gets it", "docs/dp-loop.md", minimum=0.1
    )
    heading: float = quantity(
        0.2, "s", "age of a heading when the controller gets it", "docs/dp-loop.md", minimum=0.1
    )
    command: float = quantity(
        0.2, "s", "from a sample of the controller to the thrusters", "docs/dp-loop.md"
    )
    thruster: float = quantity(
        0.3, "s", "time constant of the thrusters", "docs/dp-loop.md", minimum=1e-3
    )


class Margins(NamedTuple):
    """Margins of one axis.

    Parameters
    ----------
    crossover : float
        Highest frequency at which the loop gain is 1. [rad/s]
    phase : float
        Smallest phase margin. [rad]
    gain : float
        Factor on the loop gain at which the loop is unstable. [1]
    sensitivity : float
        Largest size Ms of the sensitivity 1/(1 + L). [1]
    delay : float
        Further delay at which the loop is unstable. [s]
    """

    crossover: float
    phase: float
    gain: float
    sensitivity: float
    delay: float


class OpenLoop(NamedTuple):
    """The open loop as a periodic linear system, x[k+1] = A[k] x[k] + B d, thruster load y = C x.

    Parameters
    ----------
    transitions : tuple of (n, n) arrays
        A over one period of the positions, sample by sample. [units of the states over those of the states]
    push : (n, 3) array
        B, of a load on the ship over one sample. [units of the states over N or N.m]
    waves : (n, 6) array
        Of wave motion (surge, sway, yaw and their rates) that is measured. [units of the states over m, rad and so on]
    thrust, request : (3, n) array
        C, load of the thrusters; and requested load. [N or N.m over units of the states]
    per_mass : (3, 3) array
        Acceleration of the ship over load. [1/kg, 1/(kg.m), 1/(kg.m2)]
    sample : float
        Sample period. [s]
    """

    transitions: tuple
    push: np.ndarray
    waves: np.ndarray
    thrust: np.ndarray
    request: np.ndarray
    per_mass: np.ndarray
    sample: float


def linear_loop(
    ship: DpShip,
    parameters: ObserverParameters,
    law: ControlParameters,
    delays: Delays,
    wave_frequency: float,
) -> OpenLoop:
    """The linear open loop of all three axes.

    Parameters
    ----------
    ship : DpShip
        The ship, in the observer and as the plant.
    parameters : ObserverParameters
        Of the observer.
    law : ControlParameters
        Of the control law.
    delays : Delays
        Further delays of the loop.
    wave_frequency : float
        Frequency that the wave filter has adapted to. [rad/s]

    Returns
    -------
    OpenLoop
        The open loop.
    """
    # Positions come every `period` samples; ages are whole samples, so delays are shift registers.
    h = parameters.sample_period
    period = round(parameters.position_period / parameters.sample_period)
    late = round(delays.heading / h)
    later = round(delays.position / h)
    queue = max(1, round(delays.command / h))
    plant, push = _ship(ship, h)
    # State vector: ship (6), queue of past motions, observer and law, queue of commands, thruster
    # lag (3).
    sizes = [6, 6 * later, _ESTIMATE + _CONTROL, 3 * queue, 3]
    ends = np.cumsum([0, *sizes])
    body, past, controller, commands, thrust = (
        slice(a, b) for a, b in zip(ends[:-1], ends[1:], strict=True)
    )
    n = ends[-1]
    keep = np.exp(-h / delays.thruster)
    transitions = []
    # One transition per sample of the period; only the first one has a new position.
    for sample in range(period):
        controller_matrix, measured = _controller(
            ship, parameters, law, wave_frequency, float(sample == 0)
        )
        # The ship and her past: the newest motion enters the queue, the others move on.
        a = np.zeros((n, n))
        a[body, body] = plant
        a[past, body] = np.eye(6 * later, 6)
        a[past, past] = np.eye(6 * later, k=-6)
        # Observer and law get motions of the age at which messages arrive: positions and headings
        # differ.
        a[controller, controller] = controller_matrix
        for i, age in enumerate((later, later, late) * 2):
            a[controller, past.start + 6 * (age - 1) + i] = measured[:, i]
        # Requested loads wait in the queue of commands, then pass the thrusters' lag of first
        # order.
        a[commands, controller.stop - 3 : controller.stop] = np.eye(3 * queue, 3)
        a[commands, commands] = np.eye(3 * queue, k=-3)
        a[thrust, thrust] = keep * np.eye(3)
        a[thrust, commands.stop - 3 : commands.stop] = (1.0 - keep) * np.eye(3)
        transitions.append(a)
    # Load on the ship enters at the ship; measured wave motion enters at the newest place of the
    # queue.
    b = np.zeros((n, 3))
    w = np.zeros((n, 6))
    rows = np.eye(n)
    b[body], w[past.start : past.start + 6] = push, np.eye(6)
    request = rows[controller.stop - 3 : controller.stop]
    return OpenLoop(tuple(transitions), b, w, rows[thrust], request, np.linalg.inv(_mass(ship)), h)


def open_loop(loop: OpenLoop, axis: int, frequencies: np.ndarray) -> np.ndarray:
    """Loop gain L of one axis, the other two closed.

    Parameters
    ----------
    loop : OpenLoop
        The open loop.
    axis : int
        0 surge, 1 sway, 2 yaw. [1]
    frequencies : (n,) array
        Frequencies. [rad/s]

    Returns
    -------
    (n,) complex array
        Load of the thrusters for a load on the ship, with opposite sign. [1]
    """
    # Close the other two axes: the thrusters' load acts on the ship there.
    others = [i for i in range(3) if i != axis]
    closed = [a + loop.push[:, others] @ loop.thrust[others] for a in loop.transitions]
    push = loop.push[:, [axis]]
    # L with the sign of negative feedback: the loop is stable far from L = -1.
    return -responses(closed, push, loop.thrust[[axis]], frequencies, loop.sample)[:, 0, 0]


def margins(loop: OpenLoop, axis: int) -> Margins:
    """Margins of one axis, the other two closed.

    Parameters
    ----------
    loop : OpenLoop
        The open loop.
    axis : int
        0 surge, 1 sway, 2 yaw. [1]

    Returns
    -------
    Margins
        The margins; from frequencies that lie 2 % apart, those between them by interpolation.
    """
    # Fine enough in the range of DP: 2 % from one frequency to the next.
    w = np.geomspace(3e-3, 2.0, 300)
    gain = open_loop(loop, axis, w)
    size = np.log(np.abs(gain))
    angle = np.unwrap(np.angle(gain))
    # Crossover: log |L| changes sign. The frequency between is interpolated in the logarithm.
    crossed = np.flatnonzero(size[:-1] * size[1:] < 0.0)
    share = size[crossed] / (size[crossed] - size[crossed + 1])
    at = w[crossed] * (w[crossed + 1] / w[crossed]) ** share
    # Phase margin: distance of the phase from -180 degrees at the crossovers.
    lag = np.mod(
        angle[crossed] + share * (angle[crossed + 1] - angle[crossed]) + np.pi, 2.0 * np.pi
    )
    # Gain margin: real negative L above the last crossover, where the phase passes -180 degrees.
    turned = np.flatnonzero(
        (np.diff(np.sign(np.imag(gain))) != 0) & (np.real(gain)[:-1] < 0.0) & (w[:-1] > at[-1])
    )
    limit = 1.0 / np.abs(gain[turned]).max() if turned.size else np.inf
    phase = np.minimum(lag, 2.0 * np.pi - lag)
    return Margins(
        float(at[-1]),
        float(phase.min()),
        float(limit),
        # Ms = max 1 / |1 + L|. The delay margin is phase margin over frequency.
        float(1.0 / np.abs(1.0 + gain).min()),
        float((lag / at).min()),
    )


def is_stable(loop: OpenLoop) -> bool:
    """True if the closed loop is stable.

    Parameters
    ----------
    loop : OpenLoop
        The open loop; here it is closed.

    Returns
    -------
    bool
        Whether all eigenvalues of the closed loop over one period lie within the unit circle. [1]
    """
    # The product over one period (monodromy matrix): its eigenvalues are the Floquet multipliers.
    over = np.eye(len(loop.push))
    for a in loop.transitions:
        over = (a + loop.push @ loop.thrust) @ over
    return bool(np.abs(np.linalg.eigvals(over)).max() < 1.0)


def _mass(ship):
    """Mass matrix."""
    mass = np.diag([ship.mass_surge, ship.mass_sway, ship.mass_yaw])
    mass[1, 2] = mass[2, 1] = ship.mass_sway_yaw
    return mass


def _ship(ship, h):
    """Transition of (x, y, psi, u, v, r) over a sample, heading 0, and effect of a held load."""
    # M ν̇ + D ν = τ, with τ as a third, constant state: one matrix exponential gives both parts.
    mass = _mass(ship)
    drag = np.linalg.solve(mass, np.diag([ship.damping_surge, ship.damping_sway, ship.damping_yaw]))
    eye = np.eye(3)
    zero = np.zeros((3, 3))
    a = np.block([[zero, eye, zero], [zero, -drag, np.linalg.inv(mass)], [zero, zero, zero]]) * h
    # Series of the exponential to third order; h is short against the ship's time constants.
    held = np.eye(9) + a + a @ a / 2.0 + a @ a @ a / 6.0
    return held[:6, :6], held[:6, 6:]


def _controller(ship, parameters, law, wave_frequency, new):
    """One sample of observer and law, linearised at rest, by state and measurement."""
    design = observer.design(ship, parameters)
    # Central differences: each variable up and down by a small amount, all at once as columns. The
    # functions are those of the controller, so no second derivation can differ.
    scale = np.concatenate([np.full(_ESTIMATE, _SMALL), np.full(_CONTROL, 1.0), np.full(6, _SMALL)])
    scale[6:9] = 1.0
    x = np.concatenate([np.diag(scale), -np.diag(scale)], axis=1)
    states = _ESTIMATE + _CONTROL
    measured = x[_ESTIMATE + _CONTROL :]
    zero = np.zeros(x.shape[1])
    # The frequency of the wave filter is held: it follows the sea slowly.
    pace = np.minimum(1.0, (zero + wave_frequency) / parameters.full_frequency)
    estimate = StateEstimate(*x[:_ESTIMATE])._replace(
        wave_frequency=zero + wave_frequency, wave_power=zero, pace=pace
    )
    state = ControlState(*x[_ESTIMATE:states])
    allocated = state[-3:]
    estimate = observer.step(
        estimate,
        Measurement(Motion(*measured), new, 1.0),
        pid.known_load(state, allocated),
        ship=ship,
        parameters=parameters,
        design=design,
    )
    desired = Desired(*(zero,) * 9)
    calm = (0.0, 0.0, 0.0)
    h = parameters.sample_period
    state = pid.step(state, estimate, desired, calm, h, ship=ship, parameters=law)
    later = np.array([*estimate[:_ESTIMATE], *state])
    # Slope = (f(x + d) - f(x - d)) / 2 d.
    slopes = (later[:, : len(scale)] - later[:, len(scale) :]) / (2.0 * scale)
    return slopes[:, :states], slopes[:, states:]


def responses(
    transitions: list[np.ndarray],
    push: np.ndarray,
    shown: np.ndarray,
    frequencies: np.ndarray,
    h: float,
) -> np.ndarray:
    """Response of a periodic system at its excitation frequency.

    Parameters
    ----------
    transitions : list of (n, n) array
        From each state of a period to the next. [units of the states]
    push : (..., n, m) array
        What each excitation does to the states in a step. [units of the states]
    shown : (q, n) array
        Outputs by the states. [units of the outputs over those of the states]
    frequencies : (w,) array
        [rad/s]
    h : float
        Time step. [s]

    Returns
    -------
    (w, q, m) array
        Complex. [units of the outputs over those of the excitations]
    """
    n, m = push.shape[-2:]
    count = len(transitions)
    # Excitation exp(j ω h k). In the periodic steady state x[k + period] = exp(j ω h period) x[k].
    step = np.exp(1j * h * np.asarray(frequencies))
    turns = step[:, None, None] ** np.arange(count + 1)[:, None, None, None]
    over = np.eye(n)
    forced = np.zeros((len(step), n, m), complex)
    # Pass through one period: transition and forced response.
    for a, turn in zip(transitions, turns, strict=False):
        over = a @ over
        forced = a @ forced + push * turn
    # Solve for the state at the start of the period.
    x = np.linalg.solve(turns[-1] * np.eye(n) - over, forced)
    # Mean over the period of the output, demodulated: the component with the excitation's
    # frequency.
    total = np.zeros((len(step), len(shown), m), complex)
    for a, turn in zip(transitions, turns, strict=False):
        total += shown @ x / turn
        x = a @ x + push * turn
    return total / count
