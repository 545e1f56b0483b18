"""Predictors of dockings behind one interface: begin, follow each second, predict.

References
----------
Definition; the laws are those of `helm`, `paper_iii` and `docking`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.prediction import docking, helm, paper_iii
from shipcosim.models.prediction.docking import Trained
from shipcosim.models.prediction.helm import Aboard, HelmParameters, Start
from shipcosim.models.prediction.paper_iii import Ensemble
from shipcosim.models.ship.hull import HullParameters


class Model(NamedTuple):
    """The ship's model of herself: hull, wind loads, thrusters.

    Parameters
    ----------
    hull, wind, helm : HullParameters, WindParameters, HelmParameters
        Hull, wind loads and thrusters.
    """

    hull: HullParameters
    wind: WindParameters
    helm: HelmParameters


class State(NamedTuple):
    """State of a law from second to second.

    Parameters
    ----------
    latest : tuple of tuples of four
        As `helm.remembered` gives them. [rad, m/s, m/s, rad/s]
    aboard : Aboard
        Inputs of the predictor now.
    own : Own
        Our law's record, of type `Own`; None for the others. [1]
    memory : tuple of tuples of Memory
        Of networks. [1]
    """

    latest: Start
    aboard: Aboard
    own: Any = None
    memory: tuple = ()


@dataclass(frozen=True)
class Kinetic:
    """The equations of motion alone.

    Parameters
    ----------
    widths : (8,) array
        As `docking.regions` takes them. [m, rad]
    """

    widths: np.ndarray

    def begin(self, aboard: Aboard, model: Model) -> State:
        """State at the start."""
        return State(helm.remembered((), aboard.ship), aboard)

    def follow(self, state: State, aboard: Aboard, model: Model) -> State:
        """State a second later."""
        return state._replace(latest=helm.remembered(state.latest, aboard.ship), aboard=aboard)

    def predict(self, state: State, model: Model) -> tuple[list[tuple], float, State]:
        """North, east and heading in 1 to 30 s, share of what is learned, and the state after it."""
        return [motion[:3] for motion in kinetic(state, model)], 0.0, state


@dataclass(frozen=True)
class PaperIii(Kinetic):
    """The equations of motion with the networks of paper III.

    Parameters
    ----------
    widths : (8,) array
        As `docking.regions` takes them. [m, rad]
    ensemble : Ensemble
        The networks.
    """

    ensemble: Ensemble

    def predict(self, state: State, model: Model) -> tuple[list[tuple], float, State]:
        inputs = paper_iii.inputs(state.aboard)
        expected, memory = paper_iii.errors(inputs, state.memory, self.ensemble)
        return (
            paper_iii.corrected(kinetic(state, model), expected),
            1.0,
            state._replace(memory=memory),
        )


@dataclass(frozen=True)
class Ours(Kinetic):
    """Our hybrid predictor.

    Parameters
    ----------
    widths : (8,) array
        As `docking.regions` takes them. [m, rad]
    trained : Trained
        The ensemble.
    """

    trained: Trained

    def begin(self, aboard: Aboard, model: Model) -> State:
        estimate = docking.begin(aboard, model.helm.position_age)
        return super().begin(aboard, model)._replace(own=estimate)

    def follow(self, state: State, aboard: Aboard, model: Model) -> State:
        estimate = docking.follow(
            state.own, state.aboard, aboard, hull=model.hull, wind=model.wind, helm_=model.helm
        )
        return super().follow(state, aboard, model)._replace(own=estimate)

    def predict(self, state: State, model: Model) -> tuple[list[tuple], float, State]:
        estimate = state.own
        # Equations of motion with the observed load, then the ensemble's correction on top.
        motions = helm.predict(
            state.aboard._replace(ship=estimate.ship), left=estimate.load, **model._asdict()
        )
        inputs = docking.features(state.aboard, estimate, motions[-1], model.hull)
        given, memory = docking.outputs(
            docking.standardised(inputs, self.trained), state.memory, self.trained
        )
        # Outside of the training the kinetic prediction takes over.
        share = float(docking.share_of(inputs, given, self.trained))
        places = docking.corrected(estimate.ship, motions, given)
        if share < 1.0:
            places = docking.blended(kinetic(state, model), places, share)
        return places, share, state._replace(memory=memory)


def kinetic(state: State, model: Model) -> tuple:
    """Motions by the equations of motion, from averages at the start as in paper III.

    Parameters
    ----------
    state : State
        Now.
    model : Model
        The ship.

    Returns
    -------
    tuple of Motion
        One a second. [m, rad, m/s, rad/s]
    """
    start = helm.smoothed(state.latest, state.aboard.ship)
    return helm.predict(state.aboard._replace(ship=start), **model._asdict())


VARIANTS = ("kinetic", "paper-iii", "ours")
"""Names of the laws."""


def law_of(variant: str, arrays: Mapping[str, np.ndarray]) -> Any:
    """Make a law from its trained arrays.

    Parameters
    ----------
    variant : str
        One of `VARIANTS`.
    arrays : mapping of str to array
        Of ``paper-iii``, else of ``ours``, which has the regions of the kinetic law too. [their units]

    Returns
    -------
    Kinetic, PaperIii or Ours
        [as their fields]
    """
    if variant == "kinetic":
        return Kinetic(arrays["kinetic_widths"])
    if variant == "paper-iii":
        return PaperIii(arrays["widths"], paper_iii.ensemble_of(arrays))
    return Ours(arrays["widths"], docking.trained_of(arrays))
