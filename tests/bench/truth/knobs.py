"""What an effect may turn on a ship: one row per knob, one column per ship, neutral unless turned."""

import numpy as np

NEUTRAL = {
    "current_north": 0.0,  # where the water goes [m/s]
    "current_east": 0.0,
    "wind_scale": 1.0,  # of the wind load
    "force_x": 0.0,  # load that turns with the ship [N, N, N m]
    "force_y": 0.0,
    "moment": 0.0,
    "pull_north": 0.0,  # force fixed to the earth, at the stern [N]
    "pull_east": 0.0,
    "port_thrust": 1.0,  # factors of the thrust
    "starboard_thrust": 1.0,
    "tunnel_thrust": 1.0,
    "port_azimuth": 0.0,  # real minus logged [rad]
    "starboard_azimuth": 0.0,
    "port_rpm": 0.0,  # logged minus real [rpm]
    "starboard_rpm": 0.0,
    "tunnel_rpm": 0.0,
    "reverse_thrust": 1.0,
    "interaction": 0.0,  # loss of a unit in the middle of the other's slipstream
    "interaction_width": np.radians(20.0),
    "mass": 1.0,
    "drag": 1.0,
    "crossflow": 1.0,
    "damping": 0.0,  # linear, on the motion through the water, both ways [N s/m]
    "heading_bias": 0.0,  # measured minus true [rad]
    "lever_x": 0.0,  # of the antenna [m]
    "lever_y": 0.0,
    "velocity_scale": 1.0,  # measured over true
    "rate_scale": 1.0,
    "position_scale": 1.0,
    "wind_direction": 0.0,  # measured minus true [rad]
}
SENSOR = (
    "heading_bias",
    "lever_x",
    "lever_y",
    "velocity_scale",
    "rate_scale",
    "position_scale",
    "wind_direction",
)


class Knobs:
    """All knobs of a batch; ``knobs.mass`` is the (n,) row of one, ``knobs.table`` (knobs, n) all of them."""

    def __init__(self, n):
        self.neutral = np.array(list(NEUTRAL.values()))
        self.table = np.repeat(self.neutral[:, None], n, axis=1)
        for row, name in enumerate(NEUTRAL):
            setattr(self, name, self.table[row])
        self.thrust = self.rows("port_thrust", "tunnel_thrust")
        self.azimuth = self.rows("port_azimuth", "starboard_azimuth")
        self.rpm = self.rows("port_rpm", "tunnel_rpm")
        self.sensor = self.rows(SENSOR[0], SENSOR[-1])

    def rows(self, first, last):
        """View of the rows from one knob to another."""
        names = list(NEUTRAL)
        return self.table[names.index(first) : names.index(last) + 1]

    def reset(self, i):
        """Turn all knobs of one ship back."""
        self.table[:, i] = self.neutral
