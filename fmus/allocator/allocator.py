"""FMU of the thrust allocator."""

from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.allocation.power import PowerParameters, granted_power, thrust_shares
from shipcosim.models.allocation.pseudo_inverse import AllocationParameters, at_rest, design, step, used_shares
from shipcosim.models.propulsion.failures import PLENTY


class Allocator(Fmu):
    """Thrust allocation by generalised inverse: two azimuth thrusters at fixed angles and a tunnel thruster."""

    tau_X_cmd = Input("N", "requested force forward")
    tau_Y_cmd = Input("N", "requested force to starboard")
    tau_N_cmd = Input("N.m", "requested yaw moment")
    port_available = Input("1", "port azimuth can be used", start=True)
    starboard_available = Input("1", "starboard azimuth can be used", start=True)
    tunnel_available = Input("1", "tunnel thruster can be used", start=True)

    bus_a_power = Input("W", "power that bus A has for thrusters; without any its units count as missing", start=PLENTY)
    bus_b_power = Input("W", "power that bus B has for thrusters; without any its units count as missing", start=PLENTY)
    port_power = Input("W", "power that the port azimuth takes")
    starboard_power = Input("W", "power that the starboard azimuth takes")
    tunnel_power = Input("W", "power that the tunnel thruster takes")

    port_thrust_cmd = Output("N", "commanded thrust of the port azimuth")
    port_azimuth_cmd = Output("rad", "commanded angle of the port azimuth, clockwise from the bow")
    starboard_thrust_cmd = Output("N", "commanded thrust of the starboard azimuth")
    starboard_azimuth_cmd = Output("rad", "commanded angle of the starboard azimuth, clockwise from the bow")
    tunnel_thrust_cmd = Output("N", "commanded thrust of the tunnel thruster, positive to starboard")
    tau_X = Output("N", "force forward that the commands give")
    tau_Y = Output("N", "force to starboard that the commands give")
    tau_N = Output("N.m", "yaw moment that the commands give")
    saturated = Output("1", "limits of thrust or missing units keep the commands from the requested load", start=False)
    port_power_limit = Output("W", "power granted to the port azimuth", start=PLENTY)
    starboard_power_limit = Output("W", "power granted to the starboard azimuth", start=PLENTY)
    tunnel_power_limit = Output("W", "power granted to the tunnel thruster", start=PLENTY)
    bus_a_load = Output("W", "power that the thrusters of bus A take")
    bus_b_load = Output("W", "power that the thrusters of bus B take")

    model = Parameters(AllocationParameters)
    power = Parameters(PowerParameters)

    def start(self):
        self.design = design(self.model)
        self.port_azimuth_cmd = self.model.port_azimuth
        self.starboard_azimuth_cmd = self.model.starboard_azimuth
        self._show(at_rest((self.tau_X_cmd, self.tau_Y_cmd, self.tau_N_cmd)))

    def step(self, t, h):
        tau = (self.tau_X_cmd, self.tau_Y_cmd, self.tau_N_cmd)
        shares, live = self._powered()
        available = (
            self.port_available and live[0],
            self.starboard_available and live[1],
            self.tunnel_available and live[2],
        )
        self._show(step(self.state, tau, available, h, parameters=self.model, design=self.design, shares=shares))

    def _powered(self):
        """Shares of their thrust that power leaves to the units, and whether they have power at all."""
        buses = (self.bus_a_power, self.bus_b_power)
        shares, granted = (1.0, 1.0, 1.0), (PLENTY, PLENTY, PLENTY)
        if min(buses) < PLENTY:
            granted = granted_power(used_shares(self.state, parameters=self.model), buses, parameters=self.power)
            shares = thrust_shares(granted, parameters=self.power)
        self.port_power_limit, self.starboard_power_limit, self.tunnel_power_limit = granted
        taken = zip((self.port_power, self.starboard_power, self.tunnel_power), self.power.buses, strict=True)
        self.bus_a_load = self.bus_b_load = 0.0
        for power, bus in taken:
            if bus < 0.5:
                self.bus_a_load += power
            else:
                self.bus_b_load += power
        return shares, [power > 0.0 for power in granted]

    def _show(self, state):
        self.state = state
        self.port_thrust_cmd, self.starboard_thrust_cmd, self.tunnel_thrust_cmd = state[:3]
        self.tau_X, self.tau_Y, self.tau_N, self.saturated = state[3:]
