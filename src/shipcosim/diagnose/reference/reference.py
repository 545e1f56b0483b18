"""The reference: what logs of a ship that is well leave uncertain of her numbers, in a file that people can open."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from shipcosim.diagnose.inference.thresholds import ENOUGH
from shipcosim.diagnose.reference.thresholds import DAY_TO_DAY, NEGLIGIBLE, ORDINARY
from shipcosim.diagnose.ship.model import ANY_CAUSE, ShipModel
from shipcosim.errors import Problem, ShipcosimError, error_at
from shipcosim.series import write_file
from shipcosim.ssp import AnyPath

SCHEMA = "shipcosim-reference/1"
FILE = "reference.json"
"""Name of the file in the folder that a calibration leaves."""


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class KnownNumber(_Strict):
    """A number of the ship: as the system has it, and as the logs would have it, all in `unit`.

    Attributes
    ----------
    name : str
        ``place.name``.
    unit : str
    nominal, tolerance : float
        Of the system, before the logs.
    estimate, std : float
        By the logs.
    """

    name: str
    unit: str
    nominal: float
    tolerance: float = Field(gt=0.0)
    estimate: float
    std: float = Field(ge=0.0)


class ReferenceLog(_Strict):
    """A log that a reference was made from: name and SHA-256 of its file, rows, first and last time in s."""

    name: str
    sha256: str = ""
    rows: int
    span_s: tuple[float, float]


class Reference(_Strict):
    """What logs of a ship that is well leave uncertain of her numbers; the content of reference.json.

    Attributes
    ----------
    schema_ : str
    shipcosim : str
        Version that made it.
    system : str
        Name of the ship's system.
    system_sha256 : str
        Fingerprint of her numbers and tolerances before the logs.
    tolerance_scale : float
        Times the stated tolerances within which the logs were explained.
    form_scale : float
        How far the form of her loads may differ from the model's, over what is usual.
    logs : tuple of ReferenceLog
    ordinary_errors : dict of str to float
        Gain of unmodelled errors in these logs, by kind: what is no change when it is seen again. [nats]
    dispersion : float
        How much more the parts of the logs differ than by their noise, mean square: 1 where the model's form is right.
    numbers : tuple of KnownNumber
    correlation : tuple of tuple of float
        Of the numbers' errors, row by row.
    """

    schema_: Literal["shipcosim-reference/1"] = Field(alias="schema")
    shipcosim: str
    system: str
    system_sha256: str
    tolerance_scale: float
    form_scale: float
    logs: tuple[ReferenceLog, ...]
    ordinary_errors: dict[str, float]
    dispersion: float
    numbers: tuple[KnownNumber, ...]
    correlation: tuple[tuple[float, ...], ...]

    @model_validator(mode="after")
    def _square(self) -> Reference:
        count = len(self.numbers)
        if len(self.correlation) != count or any(len(row) != count for row in self.correlation):
            raise ValueError(
                f"correlation: {count} rows of {count} numbers are wanted, one for each of numbers"
            )
        return self

    @property
    def covariance(self) -> np.ndarray:
        """Covariance of the numbers, (n, n) array in their units."""
        std = np.array([number.std for number in self.numbers])
        return std[:, None] * np.array(self.correlation) * std

    def as_json(self) -> str:
        """The content of the file."""
        content = self.model_dump(by_alias=True)
        rows = ",\n    ".join(
            json.dumps([round(value, 6) for value in row]) for row in content.pop("correlation")
        )
        numbers = ",\n    ".join(
            json.dumps(number, ensure_ascii=False) for number in content.pop("numbers")
        )
        head = json.dumps(content, indent=2, ensure_ascii=False).removesuffix("\n}")
        return f'{head},\n  "numbers": [\n    {numbers}\n  ],\n  "correlation": [\n    {rows}\n  ]\n}}\n'

    def write(self, path: AnyPath) -> None:
        """Write the file; it is there completely or not at all."""
        write_file(path, self.as_json().encode())


def read_reference(path: AnyPath | Reference) -> Reference:
    """Read a reference.

    Parameters
    ----------
    path : path or Reference
        The file, or the folder that a calibration left; one that is read already is given back.

    Returns
    -------
    Reference

    Raises
    ------
    ShipcosimError
        If there is none, or it is not as the schema says.
    """
    if isinstance(path, Reference):
        return path
    file = Path(path) / FILE if Path(path).is_dir() else Path(path)
    try:
        return Reference.model_validate_json(file.read_bytes())
    except OSError as error:
        remedy = "Give the folder or the file that `shipcosim calibrate` left."
        raise error_at(str(file), "There is no such reference.", remedy) from error
    except ValidationError as error:
        problems = [
            Problem(f"{file}: {'.'.join(map(str, e['loc']))}", e["msg"]) for e in error.errors()
        ]
        raise ShipcosimError(problems) from error


def is_same(first: float, other: float) -> bool:
    """Whether two values of a number are the same, except for what a file rounds."""
    return bool(np.isclose(first, other, rtol=1e-6, atol=1e-9))


def fingerprint(ship: ShipModel, names: list[str]) -> str:
    """SHA-256 of some numbers of a ship and of their tolerances."""
    content = [
        [name, float(ship.get(name)), float(ship.tolerances.get(name, 0.0))] for name in names
    ]
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()


def with_reference(ship: ShipModel, reference: Reference) -> ShipModel:
    """A ship as a reference knows her: its estimates, and what it leaves uncertain, instead of her tolerances.

    Parameters
    ----------
    ship : ShipModel
        With the system's own numbers, or already with the estimates.
    reference : Reference

    Returns
    -------
    ShipModel

    Raises
    ------
    ShipcosimError
        If the reference is of another ship.
    """
    # The numbers of the ship must be those that the reference was made from, or its estimates.
    problems = []
    for number in reference.numbers:
        if not ship.has(number.name):
            problems.append(
                Problem(number.name, "The ship of this system has no such number.", _REMEDY)
            )
        elif not any(is_same(ship.get(number.name), v) for v in (number.nominal, number.estimate)):
            message = f"The system has {ship.get(number.name):g}, the reference was made from {number.nominal:g}."
            problems.append(Problem(number.name, message, _REMEDY))
    if problems:
        raise ShipcosimError(problems)
    # Start from the estimates, with the principal axes of their covariance instead of tolerances.
    moved = ship.with_values({number.name: number.estimate for number in reference.numbers})
    # Unmodelled errors that the healthy logs showed are no news, up to some multiple.
    ordinary = {
        kind: ORDINARY * gain for kind, gain in reference.ordinary_errors.items() if gain > 0.0
    }
    # Dispersion above 1 shows an error of the model's form, which raises the gain of any cause.
    ordinary[ANY_CAUSE] = ENOUGH * max(reference.dispersion - 1.0, 0.0)
    return replace(moved, directions=_directions(reference), ordinary_errors=ordinary)


_REMEDY = "Calibrate again with this system: shipcosim calibrate."


def _directions(reference: Reference) -> tuple[dict[str, float], ...]:
    """Independent changes of one standard deviation: principal axes of what is uncertain, in units of tolerances.

    What a number may differ by from day to day is added. Axes along which next to nothing is uncertain are left out.
    """
    names = [number.name for number in reference.numbers]
    # Covariance in units of the tolerances, plus the change of a number from day to day.
    unit = reference.tolerance_scale * np.array([number.tolerance for number in reference.numbers])
    spread = reference.covariance / unit[:, None] / unit + DAY_TO_DAY**2 * np.eye(unit.size)
    # Eigenvectors of the covariance; each direction is one, scaled to its standard deviation.
    variance, axes = np.linalg.eigh(spread)
    wanted = [i for i in np.argsort(-variance) if variance[i] > NEGLIGIBLE**2]
    return tuple(
        dict(zip(names, map(float, unit * axes[:, i] * np.sqrt(variance[i])), strict=True))
        for i in wanted
    )
