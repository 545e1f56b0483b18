"""FMU of the consequence analysis of a DP ship with up to six units."""

from shipcosim.fmi import Output, Parameters
from shipcosim.interfaces import NumberedRequest
from shipcosim.models.allocation.consequences import (
    Averaged,
    ConsequenceParameters,
    averaged,
    failures_of,
    held_share,
    units_of,
)
from shipcosim.models.core.maths import minimum, number
from shipcosim.models.core.sampling import samples_due

LOST = ("1", "2", "3", "4", "5", "6", "group_1", "group_2", "group_3")


class ConsequenceAnalysis(NumberedRequest):
    """Whether the ship keeps position and heading after each single failure, under the load of now."""

    share = Output("1", "share of the mean load that the units hold, force and moment; at most 10")
    share_without_1 = Output("1", "the same after the loss of unit 1")
    share_without_2 = Output("1", "the same after the loss of unit 2")
    share_without_3 = Output("1", "the same after the loss of unit 3")
    share_without_4 = Output("1", "the same after the loss of unit 4")
    share_without_5 = Output("1", "the same after the loss of unit 5")
    share_without_6 = Output("1", "the same after the loss of unit 6")
    share_without_group_1 = Output("1", "the same after the loss of all units of group 1")
    share_without_group_2 = Output("1", "the same after the loss of all units of group 2")
    share_without_group_3 = Output("1", "the same after the loss of all units of group 3")
    force_share = Output(
        "1", "share of the mean force that they hold, whatever their moment; at most 10"
    )
    force_share_without_1 = Output("1", "the same after the loss of unit 1")
    force_share_without_2 = Output("1", "the same after the loss of unit 2")
    force_share_without_3 = Output("1", "the same after the loss of unit 3")
    force_share_without_4 = Output("1", "the same after the loss of unit 4")
    force_share_without_5 = Output("1", "the same after the loss of unit 5")
    force_share_without_6 = Output("1", "the same after the loss of unit 6")
    force_share_without_group_1 = Output("1", "the same after the loss of all units of group 1")
    force_share_without_group_2 = Output("1", "the same after the loss of all units of group 2")
    force_share_without_group_3 = Output("1", "the same after the loss of all units of group 3")
    least_share = Output("1", "least `share` after a single failure")
    least_force_share = Output("1", "least `force_share` after a single failure")
    heading_loss_alarm = Output(
        "1", "after some single failure position and heading are not held together", start=False
    )
    position_loss_alarm = Output(
        "1", "after some single failure the position is not held", start=False
    )

    model = Parameters(ConsequenceParameters)

    def start(self):
        self.analysed = samples_due(self.start_time, self.model.analysis_period) - 1
        self.units = units_of(self.model)
        self.failures = failures_of(self.model)
        self.average = Averaged((0.0, 0.0, 0.0), 0.0)
        self._analyse()

    def step(self, t, h):
        tau = self.tau_X_cmd, self.tau_Y_cmd, self.tau_N_cmd
        self.average = averaged(self.average, tau, h, parameters=self.model)
        due = samples_due(t, self.model.analysis_period)
        if self.analysed < due:
            self.analysed = due
            self._analyse()

    def _analyse(self):
        load = tuple(part / (self.average.weight + 1e-12) for part in self.average.load)
        now = tuple(number(getattr(self, name)) for name in self.AVAILABLE)
        factor = self.model.dynamic_factor
        self.least_share = self._look("share", load, now, 1.0)
        self.least_force_share = self._look("force_share", load, now, 0.0)
        self.heading_loss_alarm = self.least_share < factor
        self.position_loss_alarm = self.least_force_share < factor

    def _look(self, name, load, now, heading):
        """Shares of the load, intact and after each failure; gives the least of them."""
        intact = least = held_share(load, now, units=self.units, heading=heading)
        setattr(self, name, intact)
        for lost, left in zip(LOST, self.failures, strict=True):
            # A failure that takes no unit changes nothing.
            share = intact
            if left:
                usable = tuple(a * b for a, b in zip(now, left, strict=True))
                share = held_share(load, usable, units=self.units, heading=heading)
                least = minimum(least, share)
            setattr(self, f"{name}_without_{lost}", share)
        return least
