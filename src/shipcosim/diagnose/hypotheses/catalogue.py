"""The catalogue of causes: one file each in `effects/`, and what they mean on one ship."""

import tomllib
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from shipcosim.diagnose.result import label_of
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.series import conversion

__all__ = ["Cause", "CauseParameter", "HypothesisParameter", "Hypothesis", "read_catalogue", "hypotheses_of"]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class CauseParameter(_Strict):
    """A parameter of a cause.

    Attributes
    ----------
    of : list of str
        Numbers of the ship that take its value: ``vessel.mass_scale``; ``{thruster}`` stands for the component,
        ``{azimuths}`` for each azimuth thruster at once, whether it turns or not.
    unit : str
        Unit in which it is reported; that of the number is converted.
    typical : float
        Size that matters, as distance from neutral.
    tolerance : float, optional
        Standard deviation that is no cause yet, where the ship's parameter sets do not say.
    bounds : tuple of two floats
        Values beyond are implausible.
    relative_to : str, optional
        Number of the ship whose value typical, tolerance and bounds are multiplied by.
    """

    of: list[str]
    unit: str = "1"
    typical: float
    tolerance: float = 0.0
    bounds: tuple[float, float]
    relative_to: str | None = None


class Cause(_Strict):
    """A cause as its file has it.

    Attributes
    ----------
    cause, sentence, reference : str
    for_each : "ship", "thruster" or "azimuth"
        Where it can sit.
    law : "linear", "vector" or "turning"
        Whether small effects add up; or act by a vector's size and direction, and the cause is sought by directions
        first; or by two vectors, start and end, and it is sought as a linear trend first.
    least : float
        An effect below this share of its typical size is not named.
    companions : list of str
        Numbers that are only known within their tolerance and only matter where this cause acts.
    shape : list of str
        Companions that, taken together, must lie within their tolerances: with another shape it is another cause.
    replaces : list of str
        Numbers that this cause speaks for: their tolerance is left out where it acts.
    special : str, optional
        A simpler cause that this one contains, its parameters several times in the same order.
    parameters : dict of str to CauseParameter
    """

    cause: str
    sentence: str
    reference: str
    for_each: Literal["ship", "thruster", "azimuth"] = "ship"
    law: Literal["linear", "vector", "turning"] = "linear"
    least: float = 0.2
    companions: list[str] = []
    shape: list[str] = []
    replaces: list[str] = []
    special: str | None = None
    parameters: dict[str, CauseParameter]


@dataclass(frozen=True)
class HypothesisParameter:
    """A parameter of a cause on one ship; all in the unit of the ship's numbers, except `unit` and `factor`.

    Attributes
    ----------
    name, unit : str
        As reported.
    paths : tuple of str
        Numbers that it turns.
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


@dataclass(frozen=True)
class Hypothesis:
    """A cause at one place of one ship."""

    effect: Cause
    component: str | None
    parameters: tuple[HypothesisParameter, ...]

    @property
    def cause(self):
        return self.effect.cause

    @property
    def label(self):
        """``thrust_loss of port``."""
        return label_of(self.cause, self.component)


def read_catalogue(folder=None):
    """All causes, our own and those of a folder.

    Parameters
    ----------
    folder : path, optional
        With further .toml files; one with the name of a known cause replaces it.

    Returns
    -------
    dict of str to Effect

    Raises
    ------
    ShipcosimError
        With everything that is wrong in the files.
    """
    found, problems = {}, []
    ours = sorted(files("shipcosim.diagnose.hypotheses").iterdir(), key=lambda path: path.name)
    for path in (*ours, *(sorted(Path(folder).iterdir()) if folder else ())):
        if path.name.endswith(".toml"):
            try:
                effect = Cause.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
                found[effect.cause] = effect
            except (tomllib.TOMLDecodeError, ValidationError) as error:
                problems.append(
                    Problem(str(path), str(error), "See docs/add-a-cause.md for what a cause's file holds.")
                )
    if problems:
        raise ShipcosimError(problems)
    return found


def hypotheses_of(catalogue, model):
    """Every cause at every place of a ship where it can be.

    Parameters
    ----------
    catalogue : dict of str to Cause
    model : ShipModel

    Returns
    -------
    list of Hypothesis
        Without causes whose numbers the ship does not have.
    """
    places = {"ship": [None], "thruster": model.thrusters, "azimuth": model.azimuths}
    found = [_on(effect, place, model) for effect in catalogue.values() for place in places[effect.for_each]]
    return [hypothesis for hypothesis in found if hypothesis]


def _on(effect, component, model):
    parameters = []
    for name, parameter in effect.parameters.items():
        paths = [path for pattern in parameter.of for path in _paths(pattern, component, model)]
        if not paths or not all(model.has(path) for path in paths):
            return None
        parameters.append(_parameter(name, parameter, tuple(paths), component, model))
    return Hypothesis(effect, component, tuple(parameters))


def _paths(pattern, component, model):
    pattern = pattern.replace("vessel.", f"{model.vessel}.", 1) if pattern.startswith("vessel.") else pattern
    if "{azimuths}" in pattern:
        found = (pattern.replace("{azimuths}", name) for name in model.thrusters)
        return [path for path in found if model.has(path)]
    return [pattern.replace("{thruster}", component or "")]


def _parameter(name, parameter, paths, component, model):
    per_model, _ = conversion(parameter.unit, model.about(paths[0])["unit"])
    size = per_model
    if parameter.relative_to:
        size *= model.get(_paths(parameter.relative_to, component, model)[0])
    tolerance = model.tolerances.get(paths[0], parameter.tolerance * size)
    return HypothesisParameter(
        name,
        parameter.unit,
        paths,
        model.get(paths[0]),
        parameter.typical * size,
        tolerance,
        tuple(bound * size for bound in parameter.bounds),
        1.0 / per_model,
    )
