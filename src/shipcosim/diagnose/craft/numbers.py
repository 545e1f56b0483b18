"""Numbers of a craft that a log can teach, by which the ship's file is corrected."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from shipcosim.diagnose.craft.thresholds import FACTOR_E, MOST, TYPICAL_CURRENT
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.thrusters import astern_numbers, thrust_numbers

DAMPING = {
    "surge": ("X_u", "X_uu"),
    "sway": ("Y_v", "Y_modvv"),
    "yaw": ("N_r", "N_modrr"),
}
"""By axis, the coefficients of damping with the velocity and with its square: both take energy out."""
COUPLINGS = {
    "surge": ("X_vv", "X_rv", "X_rr"),
    "sway": ("Y_r", "Y_ur", "Y_uv", "Y_modrr"),
    "yaw": ("N_v", "N_ur", "N_uv", "N_modvv"),
}
"""By axis, coefficients of either sign by which another velocity acts on it."""
AXES = ("surge", "sway", "yaw")


@dataclass(frozen=True)
class CraftNumber:
    """A number of a craft: a coefficient of hers, or a factor on several that the file has.

    Attributes
    ----------
    name : str
        In words.
    axis : str
        That it acts on; empty of thrust and wind, which act on several.
    paths : tuple of str
        Numbers of the ship that it changes.
    given : float
        By the ship's file; 1 of a factor.
    spread : float
        Standard deviation about `given` before any log is seen. Of a coefficient that the file does not have, that
        of one whose load is as large as those that are commanded.
    sign : int
        That it may have: 1, -1, or 0 for either.
    unit : str
    is_factor : bool
        Its coordinate is a logarithm: a factor of e either way is one step. Else it may go to zero.
    is_of_file : bool
        The file has it, or should have: it is free from the start.
    """

    name: str
    axis: str
    paths: tuple[str, ...]
    given: float
    spread: float
    sign: int
    unit: str = "1"
    is_factor: bool = False
    is_of_file: bool = True

    @property
    def start(self) -> float:
        """Coordinate of the file's value; a learned value is expected within about 1 of it."""
        return 0.0 if self.is_factor else self.given / self.step

    @property
    def step(self) -> float:
        """Size of one unit of the coordinate, if it is not a logarithm."""
        return (self.sign or 1) * self.spread

    def value(self, coordinate: Any) -> Any:
        """The number by its coordinate, a float or an array."""
        if not self.is_factor:
            return self.step * coordinate
        return self.given * np.exp(np.clip(coordinate, -MOST, MOST))

    def on(self, model: ShipModel, value: Any) -> ShipModel:
        """The ship with this number, a float or an array."""
        if not self.is_factor:
            return model.with_values({self.paths[0]: value})
        values = {}
        # A factor on thrust acts on what a loss leaves.
        for path in self.paths:
            old = model.get(path)
            values[path] = 1.0 - value * (1.0 - old) if path.endswith("_loss") else value * old
        return model.with_values(values)


def with_numbers(model: ShipModel, numbers: Sequence[CraftNumber], values: Any) -> ShipModel:
    """The ship with some numbers, whose values are along the first axis."""
    for number, value in zip(numbers, values, strict=True):
        model = number.on(model, value)
    return model


def numbers_of(model: ShipModel, typical: dict[str, np.ndarray]) -> list[CraftNumber]:
    """Numbers that can be learned of a craft, those of her file first.

    Parameters
    ----------
    model : ShipModel
        As her file has her.
    typical : dict of str to array
        Root mean squares along the log: of surge, sway and yaw rate under ``"motion"``, of the commanded loads on each
        axis under ``"loads"``.

    Returns
    -------
    list of CraftNumber
    """
    # Numbers of the file first: thrust, inertia, damping, and the hull's derivatives as groups.
    thrust = thrust_of(model)
    numbers = [thrust] if thrust else []
    vessel = model.vessel
    numbers.append(_factor("inertia in yaw", "yaw", (f"{vessel}.inertia_yaw", f"{vessel}.A66")))
    for axis in AXES:
        for name, words in zip(
            DAMPING[axis], ("with the velocity", "with its square"), strict=True
        ):
            text = f"damping in {axis} {words}"
            numbers.append(_coefficient(text, axis, name, -1, model, typical))
    for name, words in (
        ("cross_flow_drag", "drag across the hull"),
        ("lift", "side force by lift"),
    ):
        if model.get(f"{vessel}.{name}"):
            numbers.append(_factor(words, "sway", (f"{vessel}.{name}",)))
    for letter, axis in zip("XYN", AXES, strict=True):
        paths = tuple(path for path in model.numbers if path.startswith(f"{vessel}.mmg_{letter}_"))
        paths = tuple(path for path in paths if model.get(path))
        if paths:
            numbers.append(_factor(f"derivatives of {axis} (MMG)", axis, paths))
    # Coefficients that couple the axes, of either sign.
    numbers += [
        _coefficient(f"{axis} by {_product(name)}", axis, name, 0, model, typical)
        for axis in AXES
        for name in COUPLINGS[axis]
    ]
    if model.get(f"{vessel}.A22") > 0.0:
        numbers.append(_factor("added mass in sway", "sway", (f"{vessel}.A22",), is_of_file=False))
    if "wind" in typical:
        numbers.append(_factor("wind load", "", (f"{vessel}.wind_load_scale",), is_of_file=False))
    # One thruster against the others, and thrust astern against that ahead.
    if thrust and len(thrust.paths) > 1:
        numbers += [
            _factor(f"thrust of {path.rpartition('.')[0]}", "", (path,), is_of_file=False)
            for path in thrust.paths
        ]
    astern = astern_numbers(model)
    if astern:
        numbers.append(_factor("thrust astern", "", astern, is_of_file=False))
    return sorted(numbers, key=lambda number: not number.is_of_file)


def current_numbers() -> list[CraftNumber]:
    """A steady current of usual size: what may look like another craft."""
    paths = {way: f"water.current_{way}" for way in ("north", "east")}
    return [
        CraftNumber(f"water towards {way}", "", (path,), 0.0, TYPICAL_CURRENT, 0)
        for way, path in paths.items()
    ]


def thrust_of(model: ShipModel) -> CraftNumber | None:
    """The factor on the thrust of all thrusters."""
    paths = thrust_numbers(model)
    return _factor("thrust", "", paths) if paths else None


def _factor(
    name: str, axis: str, paths: tuple[str, ...], *, is_of_file: bool = True
) -> CraftNumber:
    return CraftNumber(name, axis, paths, 1.0, FACTOR_E, 1, "1", True, is_of_file)


def _product(name: str) -> str:
    """What a coefficient multiplies: "u v" of N_uv."""
    product = name.partition("_")[2]
    if not product.startswith("mod"):
        return " ".join(product)
    first, other = product.removeprefix("mod")
    return f"{other} |{first}|"


def _coefficient(
    text: str, axis: str, name: str, sign: int, model: ShipModel, typical: dict[str, np.ndarray]
) -> CraftNumber:
    """A coefficient of the hull, by her file or of a size that would matter."""
    # Size at which the coefficient's load equals a typical commanded load at typical speeds.
    speeds = dict(zip("uvr", typical["motion"], strict=True))
    basis = np.prod([speeds[factor] for factor in name.partition("_")[2].removeprefix("mod")])
    size = float(typical["loads"][AXES.index(axis)] / max(basis, 1e-12))
    path = f"{model.vessel}.{name}"
    given = model.get(path)
    spread = FACTOR_E * abs(given) if given else size
    unit = model.about(path).get("unit", "1")
    is_of_file = bool(given) or sign != 0
    return CraftNumber(text, axis, (path,), given, spread, sign, unit, is_of_file=is_of_file)
