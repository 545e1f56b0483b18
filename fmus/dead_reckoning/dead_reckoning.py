"""FMU of dead reckoning: the position goes on while GNSS is lost."""

from pathlib import Path

from shipcosim.fmi import Fmu, Input, Output, Parameter
from shipcosim.models.core.kinematics import to_ned
from shipcosim.models.core.maths import number
from shipcosim.models.core.networks import read_arrays
from shipcosim.models.core.sampling import samples_due
from shipcosim.models.prediction import motion_filter, velocity_network
from shipcosim.models.prediction.outage import Measured, radius, region_of

WEIGHTS = Path(__file__).with_name("weights")
SAMPLE_TIME = 1.0  # s, that of the training


class DeadReckoning(Fmu):
    """GNSS while it works, dead reckoning while it is lost, and the region in which the ship then is."""

    x_meas = Input("m", "north position by GNSS")
    y_meas = Input("m", "east position by GNSS")
    u_meas = Input("m/s", "surge velocity over ground by GNSS")
    v_meas = Input("m/s", "sway velocity over ground by GNSS")
    position_valid = Input("1", "GNSS works", start=True)
    psi_meas = Input("rad", "heading by compass, clockwise from north")
    wind_speed_meas = Input("m/s", "apparent wind speed at the mast")
    wind_from_meas = Input(
        "rad", "direction of the apparent wind at the mast, clockwise from the bow"
    )
    command_1 = Input("1", "actual command of the first bow tunnel, in the unit of its map")
    command_2 = Input("1", "actual command of the second bow tunnel, in the unit of its map")
    command_3 = Input("1", "actual command of the first stern tunnel, in the unit of its map")
    command_4 = Input("1", "actual command of the second stern tunnel, in the unit of its map")
    command_5 = Input("1", "actual command of the port main propeller, in the unit of its map")
    command_6 = Input("1", "actual command of the starboard main propeller, in the unit of its map")

    x_hat = Output("m", "north position: by GNSS, reckoned while it is lost")
    y_hat = Output("m", "east position: by GNSS, reckoned while it is lost")
    u_hat = Output("m/s", "surge velocity over ground as reckoned, at the last sample")
    v_hat = Output("m/s", "sway velocity over ground as reckoned, at the last sample")
    position_region = Output(
        "m", "radius of the circle about the position that has the true one in 90 % of cases"
    )
    lost_for = Output("s", "time since GNSS was lost, at the last sample; 0 while it works")

    variant = Parameter(
        "motion-filter", "1", "which training: the name of a file of weights", origin="choice"
    )

    def start(self):
        arrays = read_arrays(self._weights())
        self.law = "motion_filter" if "bow" in arrays else "velocity_network"
        self.design = self._module().design(arrays)
        self.region = region_of(arrays)
        self.taken = samples_due(self.start_time, SAMPLE_TIME)
        self.state = self._module().start(self._measured(), design=self.design)
        self._show(self.start_time)

    def step(self, t, h):
        due = samples_due(t, SAMPLE_TIME)
        if self.taken < due:
            self.taken = due
            self.state = self._module().step(
                self.state, self._measured(), SAMPLE_TIME, design=self.design
            )
        self._show(t + h)

    def _weights(self):
        known = sorted(file.stem for file in WEIGHTS.glob("*.npz"))
        if self.variant not in known:
            raise ValueError(
                f"variant '{self.variant}': there is none. There are {', '.join(known)}."
            )
        return WEIGHTS / f"{self.variant}.npz"

    def _module(self):
        return motion_filter if self.law == "motion_filter" else velocity_network

    def _measured(self):
        first = self.command_1, self.command_2, self.command_3
        return Measured(
            self.x_meas,
            self.y_meas,
            self.u_meas,
            self.v_meas,
            1.0 if self.position_valid else 0.0,
            self.psi_meas,
            self.wind_speed_meas,
            self.wind_from_meas,
            (*first, self.command_4, self.command_5, self.command_6),
        )

    def _show(self, t):
        """Outputs at t: between samples the reckoned position moves on with its velocity."""
        state = self.state
        since = t - (self.taken - 1) * SAMPLE_TIME
        north, east = to_ned(self.psi_meas, state.u, state.v)
        self.x_hat = self.x_meas if self.position_valid else number(state.x + since * north)
        self.y_hat = self.y_meas if self.position_valid else number(state.y + since * east)
        self.u_hat = number(state.u)
        self.v_hat = number(state.v)
        self.lost_for = number(state.lost_for)
        self.position_region = number(radius(state.lost_for, state.sea, region=self.region))
