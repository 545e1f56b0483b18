"""The catalogue of causes, read from one file each, and their hypotheses: each cause at each place of one ship."""

import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Literal

from pydantic import ValidationError

from shipcosim.diagnose.finding import ParameterEstimate, label_of
from shipcosim.diagnose.hypotheses.cause import Cause, CauseParameter, Fault
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.models.propulsion.azimuth import AzimuthParameters
from shipcosim.scenario.reader import complaint_of, read_toml
from shipcosim.series import conversion
from shipcosim.ssp import AnyPath


@dataclass(frozen=True)
class HypothesisParameter:
    """A parameter of a cause on one ship; all in the unit of the ship's numbers, except `unit` and `factor`.

    Attributes
    ----------
    name, unit : str
        As reported.
    paths : tuple of str
        Numbers of the ship that take its value.
    neutral, typical, tolerance : float
    bounds : tuple of two floats
    factor : float
        Reported value over that of the numbers.
    """

    name: str
    unit: str
    paths: tuple[str, ...]
    neutral: float
    typical: float
    tolerance: float
    bounds: tuple[float, float]
    factor: float

    @property
    def path(self) -> str:
        """The first of the numbers, which stands for all of them."""
        return self.paths[0]

    def estimate(self, value: float, std: float, given: float | None = None) -> ParameterEstimate:
        """An estimate in the unit that is reported, from a value and its deviation in that of the numbers."""
        return ParameterEstimate(value * self.factor, abs(std * self.factor), self.unit, given)


@dataclass(frozen=True)
class Hypothesis:
    """A cause at one place of one ship.

    Attributes
    ----------
    definition : Cause
        As its file has it.
    component : str or None
        Where it sits, if it can sit at several.
    parameters : tuple of HypothesisParameter
    """

    definition: Cause
    component: str | None
    parameters: tuple[HypothesisParameter, ...]

    @property
    def cause(self) -> str:
        """Name of the cause."""
        return self.definition.cause

    @property
    def label(self) -> str:
        """``thrust_loss of port``."""
        return label_of(self.cause, self.component)

    @property
    def paths(self) -> set[str]:
        """All numbers of the ship that it changes."""
        return {path for parameter in self.parameters for path in parameter.paths}

    def vector_of(self, parameter: HypothesisParameter) -> tuple[str, ...]:
        """Numbers that a parameter is a vector with, where the law is one of vectors that turn; else none."""
        if self.definition.law != "turning":
            return ()
        first = self.parameters.index(parameter) // 2 * 2
        return tuple(other.path for other in self.parameters[first : first + 2])


def parameters_of(hypotheses: Iterable[Hypothesis]) -> list[HypothesisParameter]:
    """Parameters of several hypotheses, in their order."""
    return [parameter for hypothesis in hypotheses for parameter in hypothesis.parameters]


def paths_of(hypotheses: Iterable[Hypothesis]) -> set[str]:
    """Numbers of the ship that several hypotheses change."""
    return {path for hypothesis in hypotheses for path in hypothesis.paths}


def read_catalogue(folder: AnyPath | None = None) -> dict[str, Cause]:
    """All causes by name: our own, and those of a folder.

    Parameters
    ----------
    folder : path, optional
        With further .toml files; one with the name of a known cause replaces it.

    Returns
    -------
    dict of str to Cause

    Raises
    ------
    ShipcosimError
        With everything that is wrong in the files.
    """
    of_folder: dict[str, Cause] = {}
    problems = []
    for path in sorted(Path(folder).iterdir()) if folder else []:
        if not path.name.endswith(".toml"):
            continue
        try:
            cause = read_cause(path)
        except ShipcosimError as error:
            problems += error.problems
            continue
        if cause.cause in of_folder:
            message = f"'{cause.cause}' is the cause of another file in this folder too."
            problems.append(Problem(str(path), message, "Give one of them another name."))
        of_folder[cause.cause] = cause
    if problems:
        raise ShipcosimError(problems)
    return {**_shipped(), **of_folder}


def read_cause(path: Path) -> Cause:
    """Read the file of a cause.

    Raises
    ------
    ShipcosimError
        With everything that is wrong in it.
    """
    try:
        return Cause.model_validate(read_toml(path, "Causes")[1])
    except ShipcosimError as error:
        problems = error.problems
    except ValidationError as error:
        problems = []
        for detail in error.errors():
            key = ".".join(map(str, detail["loc"]))
            where = f"{path}, {key}" if key else str(path)
            problems.append(Problem(where, *complaint_of(detail, Cause)))
    page = "See docs/add-a-cause.md for what a cause's file holds."
    raise ShipcosimError(
        [replace(problem, remedy=f"{problem.remedy} {page}".strip()) for problem in problems]
    )


@cache
def read_faults() -> dict[str, Fault]:
    """All kinds of faults of the log and of the connections, by name."""
    faults = (Fault.model_validate(content) for content in _contents("faults"))
    return {fault.fault: fault for fault in faults}


@cache
def _shipped() -> dict[str, Cause]:
    """Our own causes by name."""
    causes = (Cause.model_validate(content) for content in _contents("causes"))
    return {cause.cause: cause for cause in causes}


def _contents(folder: str) -> Iterator[dict]:
    """Contents of our own .toml files in a folder, by name of the file."""
    place = files("shipcosim.diagnose.hypotheses").joinpath(folder)
    for path in sorted(place.iterdir(), key=lambda path: path.name):
        if path.name.endswith(".toml"):
            yield tomllib.loads(path.read_text(encoding="utf-8"))


def hypotheses_of(
    catalogue: Mapping[str, Cause],
    model: ShipModel,
    sought_in: Literal["every log", "sea trials"] = "every log",
) -> list[Hypothesis]:
    """Every cause at every place of a ship where it can be.

    Parameters
    ----------
    catalogue : dict of str to Cause
    model : ShipModel
    sought_in : str
        ``"sea trials"``: also those that are only sought there.

    Returns
    -------
    list of Hypothesis
        Without causes whose numbers the ship does not have, and those that no fit finds.
    """
    places = {"ship": [None], "thruster": model.thrusters, "azimuth": model.azimuths}
    causes = [cause for cause in catalogue.values() if cause.sought_in in ("every log", sought_in)]
    placed = [_on(cause, place, model) for cause in causes for place in places[cause.for_each]]
    hypotheses = [hypothesis for hypothesis in placed if hypothesis]
    alone = {path for hypothesis in hypotheses if hypothesis.component for path in hypothesis.paths}
    # Whether a cause of all azimuth thrusters together is that of the only one.
    return [
        hypothesis
        for hypothesis in hypotheses
        if not (
            hypothesis.component is None
            and len(hypothesis.paths) == 1
            and hypothesis.paths <= alone
        )
    ]


def _on(cause: Cause, component: str | None, model: ShipModel) -> Hypothesis | None:
    """A cause at one place of a ship; None if she lacks one of its numbers, or it is a share of 0."""
    parameters = []
    for name, parameter in cause.parameters.items():
        paths = [path for pattern in parameter.of for path in _paths(pattern, component, model)]
        if not paths or not all(model.has(path) for path in paths):
            return None
        parameters.append(_parameter(name, parameter, tuple(paths), component, model))
        if parameters[-1].typical == 0.0:
            return None
    return Hypothesis(cause, component, tuple(parameters))


def _paths(pattern: str, component: str | None, model: ShipModel) -> list[str]:
    """Numbers of the ship that a pattern of a cause's file means."""
    pattern = (
        pattern.replace("vessel.", f"{model.vessel}.", 1)
        if pattern.startswith("vessel.")
        else pattern
    )
    if "{azimuths}" in pattern:
        turning = [
            name
            for name in model.thrusters
            if name in model.azimuths or isinstance(model.parts[name], AzimuthParameters)
        ]
        paths = (pattern.replace("{azimuths}", name) for name in turning)
        return [path for path in paths if model.has(path)]
    return [pattern.replace("{thruster}", component or "")]


def _parameter(
    name: str,
    parameter: CauseParameter,
    paths: tuple[str, ...],
    component: str | None,
    model: ShipModel,
) -> HypothesisParameter:
    """A parameter of a cause in the unit of the ship's numbers."""
    per_model, _ = conversion(parameter.unit, model.about(paths[0])["unit"])
    size = per_model
    if parameter.relative_to:
        size *= model.get(_paths(parameter.relative_to, component, model)[0])
    tolerance = model.tolerances.get(paths[0], parameter.tolerance * abs(size))
    low = parameter.bounds[0] * size
    high = parameter.bounds[1] * size
    if paths[0] in model.referenced:
        tolerance = 0.0  # what is uncertain of it is part of every fit
    return HypothesisParameter(
        name,
        parameter.unit,
        paths,
        model.get(paths[0]),
        parameter.typical * abs(size),
        tolerance,
        (min(low, high), max(low, high)),
        1.0 / per_model,
    )
