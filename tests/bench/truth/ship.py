"""The ship in numbers, and how far each number of one drawn ship lies from them.

Sources: nominal-model.md, parameters.md and the tables beside them in the project's reference; every tolerance is a
standard deviation of nominal-model.md, section Tolerances.
"""

from dataclasses import dataclass, fields, replace

import numpy as np

from truth.form import SPEEDS

WATER_DENSITY = 1025.0
GRAVITY = 9.81
LENGTH = 33.9
DRAUGHT = 2.786
BREADTH = 9.6
PROPELLER_DIAMETER = 1.9
UNIT_X = -14.02
UNIT_Y = (-2.0, 2.0)
TUNNEL_X = 14.48
TOW_X = -17.0
BOLLARD_AHEAD, BOLLARD_ASTERN = 0.8208, 0.418
TUNNEL_THRUST = 6.83e-3
AZIMUTH_RPM_MAX, TUNNEL_RPM_MAX = 203.0, 1780.0

DRAG_SPEED = 1.2  # at which resistance by another power is the same [m/s]
CROSS_SPEED = 0.3  # and the load of cross flow [m/s]

N_STRIPS = 21
STRIP_X = (np.arange(N_STRIPS) + 0.5) / N_STRIPS * LENGTH - LENGTH / 2

TOLERANCE = {
    "mass": 0.01,
    "added_mass": 0.03,
    "crossflow": 0.05,
    "drag": 0.05,
    "lift": 0.10,
    "side_force": 0.10,
    "wind": 0.03,
    "ahead": 0.01,
    "other_quadrants": 0.05,
    "tunnel": 0.02,
    "position": 0.02,
    "azimuth": np.radians(0.2),
    "azimuth_rpm": 0.1,
    "tunnel_rpm": 1.0,
}

# Thrust along the axis over 1/2 rho (Va^2 + (0.7 pi n D)^2) pi/4 D^2, at beta = atan2(Va, 0.7 pi n D) = -180, -177.5
# ... 180 deg: the table that nominal-model.md describes (first quadrant from the 1260 points of the PMAzimuth FMU,
# elsewhere the scaled B4-70 series), read off every 2.5 deg.
BETA_STEP = np.radians(2.5)
THRUST_COEFFICIENT = np.array(
    """
    -0.2201 -0.2195 -0.2135 -0.2018 -0.1842 -0.1623 -0.1397 -0.1192 -0.0996 -0.0771 -0.0501 -0.0221
    0.0034 0.0277 0.0560 0.0903 0.1267 0.1606 0.1935 0.2307 0.2732 0.3161 0.3561 0.3975
    0.4467 0.5014 0.5524 0.5967 0.6459 0.7123 0.7870 0.8372 0.8318 0.7713 0.6898 0.6270
    0.5985 0.5976 0.6028 0.6088 0.6214 0.6448 0.6745 0.7026 0.7266 0.7515 0.7837 0.8239
    0.8651 0.8963 0.9099 0.9056 0.8900 0.8707 0.8512 0.8316 0.8116 0.7913 0.7696 0.7445
    0.7155 0.6853 0.6531 0.6096 0.5440 0.4604 0.3855 0.3517 0.3686 0.4121 0.4453 0.4492
    0.4322 0.3970 0.3620 0.3273 0.2930 0.2591 0.2257 0.1927 0.1601 0.1280 0.0964 0.0651
    0.0341 0.0073 -0.0080 -0.0249 -0.0430 -0.0637 -0.0886 -0.1180 -0.1508 -0.1866 -0.2263 -0.2701
    -0.3168 -0.3652 -0.4151 -0.4664 -0.5180 -0.5687 -0.6180 -0.6639 -0.6990 -0.7130 -0.7021 -0.6763
    -0.6545 -0.6323 -0.6261 -0.6256 -0.6258 -0.6297 -0.6406 -0.6564 -0.6715 -0.6843 -0.6977 -0.7130
    -0.7263 -0.7311 -0.7232 -0.7023 -0.6706 -0.6322 -0.5936 -0.5610 -0.5360 -0.5137 -0.4886 -0.4603
    -0.4329 -0.4079 -0.3802 -0.3436 -0.2988 -0.2548 -0.2220 -0.2050 -0.2010 -0.2047 -0.2114 -0.2174
    -0.2201
    """.split(),
    dtype=float,
)
BETA = np.linspace(-180.0, 180.0, THRUST_COEFFICIENT.size)

# Wind load over relative wind speed squared against the direction the air flows to, from the bow: N, N and N m per
# (m/s)^2 at 0, 10 ... 180 deg (gunnerus_33p9_wind_load_coefficients.csv).
WIND_LOAD = np.array(
    [
        [
            33.813,
            34.126,
            34.748,
            34.669,
            32.414,
            27.199,
            20.016,
            12.647,
            6.0174,
            0,
            -5.1004,
            -10.771,
            -17.154,
        ]
        + [-23.420, -27.911, -29.712, -29.593, -28.926, -28.611],
        [
            0,
            19.441,
            40.860,
            64.668,
            87.873,
            104.72,
            112.01,
            112.26,
            110.25,
            109.24,
            110.44,
            112.99,
            113.45,
        ]
        + [106.57, 89.423, 65.498, 41.126, 19.474, 0],
        [
            0,
            -138.24,
            -244.01,
            -312.54,
            -324.61,
            -267.60,
            -158.66,
            -31.170,
            94.948,
            218.48,
            346.66,
            483.34,
            614.48,
        ]
        + [698.60, 688.03, 578.55, 410.10, 216.37, 0],
    ]
)

# The same of the shorter ship (gunnerus_28p9_wind_coefficients.csv) made dimensional with this ship's areas (85 and
# 210 m2) and 36.25 m: another shape for the rough truth.
OTHER_WIND_LOAD = (
    0.615
    * np.array([85.0, 210.0, 210.0 * 36.25])[:, None]
    * np.array(
        [
            [0.62, 0.72, 0.86, 0.82, 0.61, 0.37, 0.12, -0.05, -0.14, -0.18, -0.20, -0.29, -0.40]
            + [-0.47, -0.51, -0.59, -0.65, -0.59, -0.53],
            [
                0,
                0.09,
                0.26,
                0.46,
                0.58,
                0.73,
                0.81,
                0.82,
                0.83,
                0.85,
                0.86,
                0.87,
                0.88,
                0.90,
                0.83,
                0.66,
                0.40,
                0.22,
                0,
            ],
            [
                0,
                -0.014,
                -0.029,
                -0.04,
                -0.045,
                -0.041,
                -0.035,
                -0.013,
                0.02,
                0.04,
                0.075,
                0.093,
                0.114,
            ]
            + [0.148, 0.149, 0.135, 0.10, 0.05, 0],
        ]
    )
)


@dataclass
class Coefficients:
    """Coefficients of the ships of a batch; the last axis of every array is the ship (absent for a single one)."""

    mass: np.ndarray  # [kg]
    inertia: np.ndarray  # [kg m2]
    added: np.ndarray  # (4, n) A11, A22, A26, A66 [kg, kg, kg m, kg m2]
    drag: np.ndarray  # at the power's reference speed [N s2/m2]
    drag_power: np.ndarray  # of the speed [1]
    strips: np.ndarray  # (strips, n) load of a strip over its sway speed squared [N s2/m2]
    cross_flow_power: np.ndarray  # of the sway speed [1]
    lift: np.ndarray  # [N s2/m2]
    side_spin: np.ndarray  # (2, n) side force of the units by propeller speed [1]
    side_flow: np.ndarray  # (2, n) and by speed of the water [1]
    propeller: np.ndarray  # (2, 145, n) thrust coefficient at the angles of BETA [1]
    tunnel: np.ndarray  # [N/rpm2]
    tunnel_fading: np.ndarray  # thrust falls as exp(-(fading * speed ahead)^2) [s/m]
    unit_x: np.ndarray  # (2, n) [m]
    unit_y: np.ndarray  # (2, n) [m]
    tunnel_x: np.ndarray  # [m]
    wind: np.ndarray  # (3, 37, n) as WIND_LOAD, round the full circle
    hull_loss: (
        np.ndarray
    )  # (2, 37, n) share of the units' thrust that the hull takes, round the full circle [1]
    azimuth_error: np.ndarray  # (2, n) real minus logged [rad]
    rpm_error: np.ndarray  # (3, n) logged minus real [rpm]
    drive_time: np.ndarray  # (3, n) lag of the propeller speeds [s]
    rolls: np.ndarray  # 1 for a ship that rolls, 0 for one that does not [1]
    damping: np.ndarray  # (3, n) linear, in surge, sway and yaw [N s/m, N s/m, N m s]
    memory: (
        np.ndarray
    )  # (3, n) of the force that remembers, as added mass in slow motion [kg, kg, kg m2]
    memory_time: np.ndarray  # (3, n) for how long it does [s]

    @classmethod
    def stack(cls, ships):
        """Many single ships as one batch."""
        return cls(
            **{
                f.name: np.stack([getattr(ship, f.name) for ship in ships], axis=-1)
                for f in fields(cls)
            }
        )


def draw_coefficients(rng, mismatch=1.0, rough=False, form=None):
    """One ship whose coefficients lie around the nominal ones as the tolerances say.

    Parameters
    ----------
    rng : numpy.random.Generator
    mismatch : float
        Factor on all tolerances; 0 gives the nominal ship in this truth's forms. [1]
    rough : bool
        A ship of other forms: it rolls, its wind load, cross-flow and resistance have other shapes, and its tunnel
        thruster loses thrust ahead.
    form : Form, optional
        A ship of this form, see `form.draw_form`; the coefficients are those of the same ship without.

    Returns
    -------
    Coefficients
    """

    def near(tolerance, shape=()):
        return 1.0 + mismatch * TOLERANCE[tolerance] * rng.standard_normal(shape)

    def error(tolerance, shape=()):
        return mismatch * TOLERANCE[tolerance] * rng.standard_normal(shape)

    mass = near("mass")
    ship = Coefficients(
        mass=531e3 * mass,
        inertia=43.0e6 * near("mass"),
        added=np.array([26_550.0, 212_400.0, -637_200.0, 19.12e6]) * near("added_mass", 4),
        drag=1645.0 * near("drag") * (DRAG_SPEED**0.15 if rough else 1.0),
        drag_power=np.array(1.85 if rough else 2.0),
        strips=0.5
        * WATER_DENSITY
        * DRAUGHT
        * LENGTH
        / N_STRIPS
        * strip_coefficients(rough)
        * near("crossflow"),
        cross_flow_power=np.array(2.0),
        lift=30e3 * near("lift"),
        side_spin=0.8 * near("side_force", 2),
        side_flow=0.8 * near("side_force", 2),
        propeller=propeller_tables(near("ahead", 2), near("other_quadrants", 2)),
        tunnel=TUNNEL_THRUST * near("tunnel"),
        tunnel_fading=np.array(0.25 if rough else 0.0),
        unit_x=UNIT_X + error("position", 2),
        unit_y=np.array(UNIT_Y) + error("position", 2),
        tunnel_x=TUNNEL_X + error("position"),
        wind=wind_table(near("wind", 3), rough),
        hull_loss=np.zeros((2, 37)),
        azimuth_error=error("azimuth", 2),
        rpm_error=np.append(error("azimuth_rpm", 2), error("tunnel_rpm")),
        drive_time=rng.uniform(1.0, 2.0, 3),
        rolls=np.array(float(rough)),
        damping=np.zeros(3),
        memory=np.zeros(3),
        memory_time=np.ones(3),
    )
    return formed(ship, form) if form else ship


def formed(ship, form):
    """A single ship with her form: drag along the hull and over speed, wind round her, linear damping, memory, roll."""
    strips = ship.strips * form.strips(2 * STRIP_X / LENGTH)
    quadratic = np.array([ship.drag, strips.sum(), (np.abs(STRIP_X) ** 3 * strips).sum()])
    return replace(
        ship,
        drag=ship.drag * DRAG_SPEED ** (2.0 - form.drag_power),
        drag_power=np.array(form.drag_power),
        strips=strips * CROSS_SPEED ** (2.0 - form.cross_flow_power),
        cross_flow_power=np.array(form.cross_flow_power),
        hull_loss=form.hull_loss,
        tunnel_fading=np.array(form.tunnel_fading),
        wind=ship.wind * form.wind,
        rolls=np.array(form.rolls),
        damping=form.damping * quadratic * SPEEDS,
        memory=form.memory * ship.added[[0, 1, 3]],
        memory_time=form.memory_time,
    )


def strip_coefficients(rough):
    """Drag coefficient of each strip: uniform, or (rough) larger towards the ends with the same mean."""
    shape = (
        0.7 + 0.9 * (2 * STRIP_X / LENGTH) ** 2 + 0.1 * (2 * STRIP_X / LENGTH)
        if rough
        else np.ones(N_STRIPS)
    )
    return 1.5 * shape / shape.mean()


def propeller_tables(ahead, elsewhere):
    """Thrust tables of both units, off by one factor in the first quadrant and by another elsewhere, (2, 145)."""
    first = np.interp(BETA, [-180, -30, 0, 32, 60, 180], [0, 0, 1, 1, 0, 0])
    return THRUST_COEFFICIENT * (ahead[:, None] * first + elsewhere[:, None] * (1 - first))


def wind_table(factors, rough):
    """Wind load over wind speed squared every 10 deg round the circle, (3, 37); rough mixes in another ship's."""
    half = (WIND_LOAD + OTHER_WIND_LOAD) / 2 if rough else WIND_LOAD
    other = half[:, -2::-1] * np.array([1.0, -1.0, -1.0])[:, None]
    return factors[:, None] * np.concatenate([half, other], axis=1)
