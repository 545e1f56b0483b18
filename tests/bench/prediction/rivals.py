"""Every predictor behind the one interface: the FMUs, and simple ones that know less or assume less."""

import importlib.util
from functools import cache
from pathlib import Path

import numpy as np
from ships import ship

from shipcosim.angles import wrap
from shipcosim.fmi import Parameters
from shipcosim.interfaces import MotionPredictor
from shipcosim.interfaces.predictor import HORIZONS, Prediction
from shipcosim.models.control.observer import DpShip
from shipcosim.models.core.kinematics import to_ned
from shipcosim.models.core.motion import Motion
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.prediction.predictor_inputs import air_velocity
from shipcosim.models.prediction.surroundings import SurroundingsParameters

ROOT = Path(__file__).resolve().parents[3]
NONE = (0.0, 0.0, 0.0)  # no regions
DEGREE = np.pi / 180.0


@cache
def fmu_class(name: str) -> type:
    """The class of an FMU of the project."""
    spec = importlib.util.spec_from_file_location(
        f"measured_{name}", ROOT / "fmus" / name / f"{name}.py"
    )
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return next(c for c in vars(module).values() if getattr(c, "__module__", "") == module.__name__)


class ConstantVelocity(MotionPredictor):
    """Velocity over ground and yaw rate stay as they are estimated."""

    def begin(self, known):
        return None

    def follow(self, state, known, since):
        return None

    def predict(self, state, known):
        x, y, psi, u, v, r = known.ship
        north, east = to_ned(psi, u, v)
        ahead = (Motion(x + h * north, y + h * east, wrap(psi + h * r), u, v, r) for h in HORIZONS)
        return Prediction(tuple(ahead), NONE, NONE)


class WithoutCurrent(fmu_class("predictor")):
    """The kinetic predictor without an estimate of the current: the bias is held as a force."""

    def predict(self, state, known):
        force = to_ned(known.ship.psi, *known.bias[:2])
        held = dict(zip(HELD, (0.0, 0.0, *force, known.bias[2]), strict=True))
        return super().predict(state._replace(**held, thrust_error=NONE), known)


class KineticOfTheThesis(fmu_class("predictor")):
    """The kinetic predictor of the thesis: wind and thrust, no bias, no current."""

    def predict(self, state, known):
        none = dict.fromkeys(HELD, 0.0)
        return super().predict(state._replace(**none, thrust_error=NONE), known)


HELD = ("current_north", "current_east", "force_north", "force_east", "moment")


class LinearKalman(MotionPredictor):
    """Extended Kalman filter of motion, current and bias load, with the masses of the DP observer and linear damping.

    Its states are x, y, psi, u, v, r, current north and east, bias north and east, bias moment. It predicts with the
    same model: thrust, current and bias held, wind load of the mean wind at the heading predicted.
    """

    ship = Parameters(DpShip)
    wind = Parameters(WindParameters)
    assumed = Parameters(SurroundingsParameters)

    def begin(self, known):
        force, current = self.assumed.force_std**2, self.assumed.current_std**2
        spread = [
            0.01,
            0.01,
            1e-4,
            0.01,
            0.01,
            1e-5,
            current,
            current,
            force,
            force,
            ARM**2 * force,
        ]
        return (
            np.array([*known.ship, *NONE, 0.0, 0.0]),
            np.diag(spread),
            air_velocity(known),
            known.thrusters,
        )

    def follow(self, state, known, since):
        mean, covariance, air, thrust = state
        keep = np.exp(-since / self.assumed.wind_time)
        air = tuple(
            now + keep * (old - now) for old, now in zip(air, air_velocity(known), strict=True)
        )
        slope = np.column_stack(
            [(self._moved(mean + e, air, thrust, since) - self._moved(mean - e, air, thrust, since)) / (2.0 * e.max())
             for e in np.diag(SMALL)]
        )  # fmt: skip
        mean = self._moved(mean, air, thrust, since)
        covariance = slope @ covariance @ slope.T + self._noise(since)
        gain = covariance[:, :6] @ np.linalg.inv(covariance[:6, :6] + np.diag(MEASURED**2))
        missed = np.array(known.ship) - mean[:6]
        missed[2] = wrap(missed[2])
        return mean + gain @ missed, covariance - gain @ covariance[:6], air, known.thrusters

    def predict(self, state, known):
        mean, _, air, _ = state
        motions, now = [], 0.0
        for horizon in HORIZONS:
            for _ in range(round(horizon - now)):
                mean = self._moved(mean, air, known.thrusters, 1.0)
            now = horizon
            motions.append(Motion(mean[0], mean[1], wrap(mean[2]), *mean[3:6]))
        return Prediction(tuple(motions), NONE, NONE)

    def _moved(self, mean, air, thrust, h):
        p, (_, _, psi, u, v, r), (c_n, c_e, b_n, b_e, b_m) = self.ship, mean[:6], mean[6:]
        cosine, sine = np.cos(psi), np.sin(psi)
        wind = wind_loads(*apparent_wind(psi, u, v, *air), wind=self.wind)
        X, Y, N = (one + other for one, other in zip(thrust, wind, strict=True))
        X += cosine * b_n + sine * b_e - DAMPING * p.damping_surge * (u - cosine * c_n - sine * c_e)
        Y += cosine * b_e - sine * b_n - DAMPING * p.damping_sway * (v - cosine * c_e + sine * c_n)
        N += b_m - DAMPING * p.damping_yaw * r
        det = p.mass_sway * p.mass_yaw - p.mass_sway_yaw**2
        rates = (
            X / p.mass_surge,
            (p.mass_yaw * Y - p.mass_sway_yaw * N) / det,
            (p.mass_sway * N - p.mass_sway_yaw * Y) / det,
        )
        u, v, r = (one + h * rate for one, rate in zip((u, v, r), rates, strict=True))
        middle = psi + 0.5 * h * r
        north, east = to_ned(middle, u, v)
        keep = np.exp(-h / self.assumed.force_time)
        return np.array(
            [
                mean[0] + h * north,
                mean[1] + h * east,
                psi + h * r,
                u,
                v,
                r,
                c_n,
                c_e,
                keep * b_n,
                keep * b_e,
                b_m,
            ]
        )

    def _noise(self, h):
        p, a = self.ship, self.assumed
        force = a.force_std**2 * (1.0 - np.exp(-2.0 * h / a.force_time))
        pushed = a.load_noise * h / np.array([p.mass_surge, p.mass_sway, p.mass_yaw / ARM]) ** 2
        small = 1e-6 * h
        walk = (h * a.current_drift, h * a.current_drift, force, force, ARM**2 * force)
        return np.diag([small, small, small * 1e-2, *pushed, *walk])


DAMPING = 3.0  # over that of the observer, which is of a ship held: 1, 3 and 10 tried on worlds 300 and 301
ARM = 9.0  # m, of forces that turn the ship: her radius of gyration
MEASURED = np.array(
    [0.1, 0.1, 0.2 * DEGREE, 0.03, 0.03, 0.05 * DEGREE]
)  # assumed errors of what is estimated
SMALL = np.array([0.1, 0.1, 0.01, 0.01, 0.01, 0.001, 0.05, 0.05, 100.0, 100.0, 1000.0])  # of slopes


def equipped(kind: type, **others: object) -> MotionPredictor:
    """A predictor with the parameters of the lengthened ship, where she has them."""
    fmu, known = kind(), ship().entries["predictor"]
    for name, entry in known.items():
        if hasattr(fmu, name):
            setattr(fmu, name, entry.value)
    for name, value in others.items():
        setattr(fmu, name, value)
    return fmu


def _learned(variant):
    return lambda: equipped(fmu_class("drift_predictor"), variant=variant)


PREDICTORS = {
    "constant velocity": lambda: equipped(ConstantVelocity),
    "Kalman filter": lambda: equipped(LinearKalman),
    "kinetic of the thesis": lambda: equipped(KineticOfTheThesis),
    "kinetic without current": lambda: equipped(WithoutCurrent),
    "kinetic": lambda: equipped(fmu_class("predictor")),
    "paper IV": _learned("paper-iv"),
    "ours": _learned("ours"),
}
"""Predictor: what makes one."""
WEIGHTS = ROOT / "fmus" / "drift_predictor" / "weights"
NEEDS = {"paper IV": WEIGHTS / "paper-iv.npz", "ours": WEIGHTS / "ours.npz"}


def there() -> list[str]:
    """Predictors whose weights are there."""
    return [name for name in PREDICTORS if name not in NEEDS or NEEDS[name].exists()]
