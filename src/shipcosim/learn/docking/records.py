"""Record of one docking: the ship's measurements and levers, and apart from these the truth."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

KNOWN: Mapping[str, str] = {
    "x_meas": "sensors.x_1_meas",
    "y_meas": "sensors.y_1_meas",
    "psi_meas": "sensors.psi_1_meas",
    "u_meas": "sensors.u_1_meas",
    "v_meas": "sensors.v_1_meas",
    "r_meas": "sensors.r_meas",
    "wind_speed_meas": "sensors.wind_speed_meas",
    "wind_from_meas": "sensors.wind_from_meas",
    "port_thrust_cmd": "helmsman.port_thrust_cmd",
    "port_azimuth_cmd": "helmsman.port_azimuth_cmd",
    "port_rpm": "port.rpm",
    "port_azimuth": "port.azimuth_feedback",
    "starboard_thrust_cmd": "helmsman.starboard_thrust_cmd",
    "starboard_azimuth_cmd": "helmsman.starboard_azimuth_cmd",
    "starboard_rpm": "starboard.rpm",
    "starboard_azimuth": "starboard.azimuth_feedback",
    "tunnel_thrust_cmd": "helmsman.tunnel_thrust_cmd",
    "tunnel_rpm": "tunnel.rpm",
}
"""Inputs of a docking predictor by their names, and the signal of the docking system that each is connected to.

Place north and east of where she is to lie at the quay [m], heading clockwise from north in [-pi, pi) [rad], surge
and sway velocity over ground [m/s], yaw rate [rad/s]; apparent wind at the mast, where it comes from clockwise from
the bow [m/s, rad]; levers, as the thrust that they ask for, negative astern, of the tunnel positive to starboard [N];
direction of positive thrust of the azimuths, asked for and measured, clockwise from the bow [rad]; measured shaft
speeds, of the tunnel that of its motor [rpm].
"""
TRUTH = ("x", "y", "psi", "u", "v", "r")
"""The low-frequency ship. [m, m, rad, m/s, m/s, rad/s]"""


@dataclass(frozen=True)
class Record:
    """One docking at 1 Hz, the last 1000 s before she lies at the quay.

    Parameters
    ----------
    seed : int
        Of the docking. [1]
    harbour : int
        Its number, from 1; no predictor knows it. [1]
    time : (1000,) array
        Whole seconds, 0 first. [s]
    known : dict of str to (1000,) array
        What the ship knows, by the names of `KNOWN`.
    truth : dict of str to (1000,) array
        What became of her, by the names of `TRUTH`; targets of training and scoring, never an input.
    """

    seed: int
    harbour: int
    time: np.ndarray
    known: dict[str, np.ndarray]
    truth: dict[str, np.ndarray]
