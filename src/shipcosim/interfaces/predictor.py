"""Interface of the predictors of the motion to come, from what a ship knows."""

from functools import partial
from math import ceil, inf
from typing import Any, NamedTuple

from shipcosim.fmi import Fmu, Input, Output, Parameter, Parameters
from shipcosim.models.control.pid import Desired
from shipcosim.models.core.maths import choose, maximum, where
from shipcosim.models.core.motion import Motion
from shipcosim.models.core.sampling import samples_due
from shipcosim.models.prediction.predictor_inputs import Known
from shipcosim.models.prediction.regions import FORESIGHT, RegionParameters, own_errors, widening
from shipcosim.models.ship.mast import MastParameters, wind_from_mast

HORIZONS = (10.0, 30.0, 60.0)  # s, as the outputs are named
NO_LOAD = 1.0  # N and N.m, below which no thruster gets a command
FARTHEST = 1e7  # m and rad, beyond which a prediction has diverged
SHOWN = ("x", "y", "psi", "position_region", "heading_region")
NO_GOAL = 1e9  # m, where no reference model goes: nobody says where she goes to


class Prediction(NamedTuple):
    """Outputs of a predictor, each with one value for each horizon.

    Parameters
    ----------
    motions : tuple of Motion
        The ship at the horizons.
    position_regions : tuple of float
        Radii of circles about the predicted places that have the true ones in 90 % of cases just after all thrust was
        lost, with a good record of the predictor's own; 0 where nobody has calibrated them. [m]
    heading_regions : tuple of float
        Half-widths about the predicted headings, likewise. [rad]
    learned : float
        Share of a learned correction that is in the prediction. [1]
    """

    motions: tuple[Motion, ...]
    position_regions: tuple[float, ...]
    heading_regions: tuple[float, ...]
    learned: float = 0.0


def thrust_is_lost(known: Known) -> bool:
    """Whether no thruster gets a command."""
    X, Y, N = (abs(load) < NO_LOAD for load in known.thrusters)
    return X & Y & N


class MotionPredictor(Fmu):
    """Variables of every predictor, so that one can take another's place. See docs/prediction.md.

    An FMU of a predictor has a state of its own, and declares three methods:

    - ``begin(known)``: the state at the start,
    - ``follow(state, known, since)``: the state `since` seconds later, from what is known then,
    - ``predict(state, known)``: the `Prediction` from there.

    Regions are the predictor's, widened by its own record: how far she came from where she was foreseen 10 s ago. While
    thrusters act there are none, they are calibrated for the drift.

    They are called once each `prediction_period`, and at the start. Between predictions the outputs hold. `known` is a
    `models.prediction.predictor_inputs.Known`: what is aboard, and nothing else.
    """

    x_hat = Input("m", "estimated north position")
    y_hat = Input("m", "estimated east position")
    psi_hat = Input("rad", "estimated heading, clockwise from north")
    u_hat = Input("m/s", "estimated surge velocity over ground")
    v_hat = Input("m/s", "estimated sway velocity over ground")
    r_hat = Input("rad/s", "estimated yaw rate")
    tau_X_bias = Input(
        "N", "estimated force forward that neither thrust nor measured wind explains"
    )
    tau_Y_bias = Input(
        "N", "estimated force to starboard that neither thrust nor measured wind explains"
    )
    tau_N_bias = Input("N.m", "estimated yaw moment that neither thrust nor measured wind explains")
    tau_X_allocated = Input("N", "force forward that the allocator's commands give")
    tau_Y_allocated = Input("N", "force to starboard that the allocator's commands give")
    tau_N_allocated = Input("N.m", "yaw moment that the allocator's commands give")
    wind_speed_meas = Input("m/s", "measured apparent wind speed at the mast")
    wind_from_meas = Input(
        "rad", "measured direction of the apparent wind at the mast, clockwise from the bow"
    )
    wind_rejected = Input(
        "1", "the anemometer is lost or not believed: the bias has the wind's load", start=False
    )
    x_d = Input("m", "desired north position")
    y_d = Input("m", "desired east position")
    psi_d = Input("rad", "desired heading, clockwise from north")
    x_d_dot = Input("m/s", "desired velocity north")
    y_d_dot = Input("m/s", "desired velocity east")
    r_d = Input("rad/s", "desired yaw rate")
    x_d_ddot = Input("m/s2", "desired acceleration north")
    y_d_ddot = Input("m/s2", "desired acceleration east")
    r_d_dot = Input("rad/s2", "desired yaw acceleration")
    wave_frequency_hat = Input(
        "rad/s", "frequency that the controller's wave filter has adapted to", start=1.0
    )
    x_goal = Input(
        "m", "north position that the reference goes to; as it starts: nobody says", start=NO_GOAL
    )
    y_goal = Input("m", "east position that the reference goes to")
    psi_goal = Input("rad", "heading that the reference goes to, clockwise from north")

    predicted_at = Output(
        "s", "time at which the prediction was made, from which its seconds count"
    )
    x_10 = Output("m", "north position in 10 s")
    y_10 = Output("m", "east position in 10 s")
    psi_10 = Output("rad", "heading in 10 s")
    position_region_10 = Output(
        "m", "radius about the place in 10 s that has the true one in 90 % of cases, or 0"
    )
    heading_region_10 = Output(
        "rad", "half-width about the heading in 10 s that has the true one in 90 %, or 0"
    )
    x_30 = Output("m", "north position in 30 s")
    y_30 = Output("m", "east position in 30 s")
    psi_30 = Output("rad", "heading in 30 s")
    position_region_30 = Output(
        "m", "radius about the place in 30 s that has the true one in 90 % of cases, or 0"
    )
    heading_region_30 = Output(
        "rad", "half-width about the heading in 30 s that has the true one in 90 %, or 0"
    )
    x_60 = Output("m", "north position in 60 s")
    y_60 = Output("m", "east position in 60 s")
    psi_60 = Output("rad", "heading in 60 s")
    position_region_60 = Output(
        "m", "radius about the place in 60 s that has the true one in 90 % of cases, or 0"
    )
    heading_region_60 = Output(
        "rad", "half-width about the heading in 60 s that has the true one in 90 %, or 0"
    )
    learned = Output(
        "1", "share of the learned correction in the prediction; 0 is the equations of motion alone"
    )

    mast = Parameters(MastParameters)
    regions = Parameters(RegionParameters)
    prediction_period = Parameter(1.0, "s", "time between predictions", minimum=0.01)

    def start(self) -> None:
        self.made = samples_due(self.start_time, self.prediction_period)
        known = self._known()
        self.state = self.begin(known)
        self.errors = (0.0, 0.0)
        self.has_diverged = False
        self.lost_for = -1.0
        self.awaited = ((inf, known.ship),) * (ceil(FORESIGHT / self.prediction_period) + 1)
        self._show(known, self.start_time)

    def step(self, t: float, h: float) -> None:
        due = samples_due(t, self.prediction_period)
        if self.made < due:
            known = self._known()
            since = (due - self.made) * self.prediction_period
            self.made = due
            try:
                self.state = self.follow(self.state, known, since)
                self._judge_itself(known, since, t)
            except (ArithmeticError, ValueError) as error:
                self._show_nothing(known, t, error)
            else:
                self._show(known, t)

    def _judge_itself(self, known, since, t):
        """Compare what was foreseen for now with what is known now, and count the time without thrust."""
        awaited = []
        for at, foreseen in self.awaited:
            has_come = at <= t + 1e-6
            judged = partial(
                own_errors, self.errors, known.ship, foreseen, since, regions=self.regions
            )
            self.errors = choose(has_come, judged, lambda: self.errors)
            awaited.append((where(has_come, inf, at), foreseen))
        self.awaited = tuple(awaited)
        self.lost_for = where(thrust_is_lost(known), maximum(self.lost_for, 0.0) + since, -1.0)

    def begin(self, known: Known) -> Any:
        """State at the start."""
        raise NotImplementedError(f"{type(self).__name__} has no begin(self, known)")

    def follow(self, state: Any, known: Known, since: float) -> Any:
        """State `since` seconds later, from what is known then."""
        raise NotImplementedError(f"{type(self).__name__} has no follow(self, state, known, since)")

    def predict(self, state: Any, known: Known) -> Prediction:
        """Prediction from a state, and what is known at the same time."""
        raise NotImplementedError(f"{type(self).__name__} has no predict(self, state, known)")

    def show_state(self, state: Any) -> None:
        """Write outputs that show the state; there are none unless an FMU has some."""

    def _known(self):
        ship = Motion(self.x_hat, self.y_hat, self.psi_hat, self.u_hat, self.v_hat, self.r_hat)
        place = (self.x_d, self.y_d, self.psi_d)
        rates = (self.x_d_dot, self.y_d_dot, self.r_d)
        return Known(
            ship,
            (self.tau_X_bias, self.tau_Y_bias, self.tau_N_bias),
            (self.tau_X_allocated, self.tau_Y_allocated, self.tau_N_allocated),
            *wind_from_mast(
                self.wind_speed_meas, self.wind_from_meas, ship.u, ship.v, ship.r, mast=self.mast
            ),
            1.0 - self.wind_rejected,
            Desired(*place, *rates, self.x_d_ddot, self.y_d_ddot, self.r_d_dot),
            (self.x_goal, self.y_goal, self.psi_goal),
            self.wave_frequency_hat,
        )

    def _show(self, known, t):
        # Numbers of Python raise where a prediction diverges; arrays and C go on with NaN.
        try:
            motions, positions, headings, learned = self.predict(self.state, known)
        except (ArithmeticError, ValueError) as error:
            self._show_nothing(known, t, error)
            return
        is_sound = True
        for motion in motions:
            for value in motion[:3]:
                is_sound = is_sound & (abs(value) < FARTHEST)
        # After what has diverged it begins again: wind and current may be no number either.
        state = self.state
        self.state = choose(is_sound, lambda: state, lambda: self.begin(known))
        self.show_state(self.state)
        foreseen = Motion(
            *(where(is_sound, *pair) for pair in zip(motions[0], known.ship, strict=True))
        )
        self.awaited = (*self.awaited[1:], (where(is_sound, t + FORESIGHT, inf), foreseen))
        wider, wider_heading = widening(self.errors, self.lost_for, regions=self.regions)
        # What has diverged is not shown: the prediction before it stays, with its time.
        self.predicted_at = where(is_sound, t, self.predicted_at)
        self.learned = where(is_sound, learned, self.learned)
        for horizon, motion, position, heading in zip(
            HORIZONS, motions, positions, headings, strict=True
        ):
            shown = (*motion[:3], wider * position, wider_heading * heading)
            for name, value in zip(SHOWN, shown, strict=True):
                output = f"{name}_{horizon:.0f}"
                setattr(self, output, where(is_sound, value, getattr(self, output)))

    def _show_nothing(self, known, t, error):
        """Keep the prediction before, and begin again, as where a prediction is no number."""
        if not self.has_diverged:
            self.log(
                f"the prediction at t = {t:.9g} s diverges ({error}): none is shown", "warning"
            )
        self.has_diverged = True
        self.state = self.begin(known)
        self.show_state(self.state)
        self.awaited = (*self.awaited[1:], (inf, known.ship))
