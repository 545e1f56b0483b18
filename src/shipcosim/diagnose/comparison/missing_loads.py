"""Needed against modelled force on each axis, whatever the cause: every large error is reported."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.comparison.axes import AXES, Axis
from shipcosim.diagnose.comparison.commanded import Commanded
from shipcosim.diagnose.comparison.measured_force import MeasuredForce
from shipcosim.diagnose.comparison.thresholds import (
    ABOVE_NOISE,
    GOES_WITH,
    LARGE,
    MENTIONED,
    OFF,
    STEADY,
)
from shipcosim.diagnose.finding import Discrepancy
from shipcosim.diagnose.numerics import noise_by_differences, normal_size, root_mean_square
from shipcosim.diagnose.ship.model import ShipModel

FORCES = {"surge": "surge force", "sway": "side force", "yaw": "yaw moment"}
_SENSES = {
    "surge": ("ahead", "astern"),
    "sway": ("to starboard", "to port"),
    "yaw": ("to starboard", "to port"),
}
_UNITS = {"surge": "N", "sway": "N", "yaw": "N.m"}


@dataclass(frozen=True)
class MissingLoad:
    """Missing load on one axis along a log.

    Attributes
    ----------
    axis : str
        Of `AXES`.
    needed, given, missing : float
        Root mean squares of the load that the motion needs, of what the model gives, and of the difference.
        [N or N.m]
    steady : float
        Mean of the difference.
    correlation : float
        Of what is needed with what is given.
    parts : float
        Largest root mean square of what the model's load is made of: thrusters, water, wind.
    noise : float
        What of the needed load may be noise of the measured velocities.
    std : float
        Standard deviation of `missing`.
    predicted : float
        Error of the simulation's predictions over that of no model, in heading for yaw, in position for the others.
    """

    axis: str
    needed: float
    given: float
    missing: float
    steady: float
    correlation: float
    parts: float
    noise: float
    std: float
    predicted: float = 0.0

    @property
    def share(self) -> float:
        """The difference over what is needed; beyond 1 no load at all would be nearer."""
        return self.missing / max(self.needed, 1e-30)

    @property
    def is_large(self) -> bool:
        """Whether the error is large against the needed load, the model's loads and the noise, and shows in predictions.

        A load that nobody predicts may be that of waves, which moves the ship to and fro and is no error of the model.
        """
        stands_out = (
            self.share > LARGE
            and self.missing > OFF * self.parts
            and self.missing > ABOVE_NOISE * self.noise
        )
        return stands_out and (self.is_steady or self.predicted > LARGE)

    @property
    def is_steady(self) -> bool:
        """Whether most of the difference is always the same."""
        return abs(self.steady) > STEADY * self.missing

    @property
    def discrepancy(self) -> Discrepancy:
        """The missing load as a discrepancy in words."""
        unit = _UNITS[self.axis]
        text = f"{FORCES[self.axis]}: {self._sense()}"
        return Discrepancy(text, None, self.axis, float(self.missing), float(self.std), unit, 1.0)

    def _sense(self) -> str:
        sides = _SENSES[self.axis]
        if self.is_steady:
            # Most of the difference has one sign: report its mean and side.
            side = sides[0] if self.steady > 0.0 else sides[1]
            return f"the model lacks a steady {self._shown(abs(self.steady))} {side}"
        # Else compare size and correlation of modelled and needed load.
        against = f"{self._shown(self.given, self.needed)} rms"
        if self.correlation < -GOES_WITH:
            return f"the model gives the opposite of what the motion needs ({against})"
        if self.correlation < GOES_WITH:
            return f"what the model gives does not go with what the motion needs ({against})"
        if self.given > MENTIONED * self.needed:
            return f"the model gives more than the motion needs ({against})"
        if self.needed > MENTIONED * self.given:
            return f"the model gives less than the motion needs ({against})"
        return f"the model gives as much as the motion needs, but not when it does ({against})"

    def _shown(self, *loads: float) -> str:
        """Loads one against the other, to two digits, with their unit."""
        # Two significant digits, in kilo units where that is shorter.
        unit, factor = (
            (f"k{_UNITS[self.axis]}", 1e-3) if max(loads) >= 1000.0 else (_UNITS[self.axis], 1.0)
        )
        texts = [f"{float(f'{factor * load:.2g}'):g}" for load in loads]
        return f"{' against '.join(texts)} {unit}"


def missing_loads(
    axes: Sequence[Axis],
    commanded: Commanded,
    measured: MeasuredForce,
    model: ShipModel,
    predicted: Mapping[str, float],
) -> list[MissingLoad]:
    """Missing load on each axis, the largest share of the needed load first.

    Parameters
    ----------
    axes : sequence of Axis
    commanded : Commanded
        With the labels as they are.
    measured : MeasuredForce
    model : ShipModel
    predicted : mapping of str to float
        As from `errors_over_none`.

    Returns
    -------
    list of MissingLoad
    """
    noise = _noise(measured, model)
    by_axis = [predicted["heading" if axis.name == "yaw" else "position"] for axis in axes]
    each = zip(axes, by_axis, strict=True)
    loads = [_missing(axis, commanded, float(noise[axis.number]), off) for axis, off in each]
    return sorted(loads, key=lambda load: -load.share)


def _missing(axis: Axis, commanded: Commanded, noise: float, predicted: float) -> MissingLoad:
    # Balance of forces: needed less thrust, water and wind by the model.
    thrust = axis.total(commanded)
    given = thrust + axis.hull + axis.wind
    off = axis.force - given
    # The largest single load: small differences of large loads are within usual model errors.
    parts = max(root_mean_square(load) for load in (thrust, axis.hull, axis.wind))
    # Correlation about zero, as a mean force counts too.
    both = root_mean_square(axis.force) * root_mean_square(given)
    correlation = float((axis.force * given).mean() / both) if both > 0.0 else 0.0
    # Relative standard error of a root mean square of n independent values: 1 / sqrt(2 n).
    blocks = max(off.size / axis.block, 1.0)
    missing = root_mean_square(off)
    return MissingLoad(
        AXES[axis.number],
        root_mean_square(axis.force),
        root_mean_square(given),
        missing,
        float(off.mean()),
        correlation,
        parts,
        noise,
        missing / np.sqrt(2.0 * blocks),
        predicted,
    )


def _noise(measured: MeasuredForce, model: ShipModel) -> np.ndarray:
    """Part of the needed load that comes from white noise of the velocities, (3,) array: by their third differences."""
    kernel = measured.kernel
    white = normal_size(noise_by_differences(np.asarray(measured.velocity, float), 3), axis=1)
    # Derivative by a Gaussian kernel of n rows divides white noise by h sqrt(4 sqrt(pi) n^3);
    # inertia turns it into a load.
    rows = kernel.width / kernel.step
    rates = white / kernel.step / np.sqrt(4.0 * np.sqrt(np.pi) * rows**3)
    return np.diag(model.mass_matrix) * rates
