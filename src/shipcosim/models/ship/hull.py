"""Loads of the water on a moving hull: a sum of named contributions, each zero if unused.

Every contribution is a function of the velocity through the water (u, v, r) and of `HullParameters`. A hull uses those
for which it has coefficients; a new effect is one more function here, with coefficients that are zero by default.
"""

from dataclasses import dataclass
from functools import cached_property

from shipcosim.models.core.constants import GRAVITY
from shipcosim.models.core.maths import Arithmetic, exp, hypot, maximum, minimum, where
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import acts, quantity, required

_UNUSED = "not used by this ship"
_TINY = 1e-30
_SPEED_SQUARED = 0.25**2 * GRAVITY  # m/s2: of Froude number 0.25 over the length; 1
_SLOW = 0.02**2


def _unused(unit, description):
    return quantity(0.0, unit, description, _UNUSED)


def _mmg(product):
    """A hydrodynamic derivative of the MMG standard method."""
    return quantity(
        0.0,
        "1",
        f"MMG derivative, {product}, over rho/2 L d U^2, of N over rho/2 L^2 d U^2",
        _UNUSED,
    )


@dataclass(frozen=True, kw_only=True)
class HullParameters:
    """Mass and hydrodynamics of a hull. A coefficient that is left out is zero: its contribution is left out too.

    Coefficients are named as in the source: ``X_rvu`` multiplies r v u in surge; ``mod`` stands for one absolute value,
    ``Y_modrv`` multiplies v abs(r).
    """

    mass: float = required("kg", "mass", share=0.01, minimum=1.0)
    inertia_yaw: float = required("kg.m2", "moment of inertia in yaw", share=0.01, minimum=1.0)
    centre_of_gravity_x: float = quantity(
        0.0, "m", "centre of gravity forward of the origin", "origin in it"
    )
    A11: float = required("kg", "added mass in surge", share=0.03)
    A22: float = required("kg", "added mass in sway", share=0.03)
    A26: float = required("kg.m", "added mass, sway by yaw", share=0.03)
    A62: float = required("kg.m", "added mass, yaw by sway", share=0.03)
    A66: float = required("kg.m2", "added moment of inertia", share=0.03)
    added_mass_coriolis: float = quantity(
        1.0,
        "1",
        "share of C_A(nu_r) nu_r; 0 for coefficients that contain it already",
        "Fossen 2021",
        minimum=0.0,
    )

    current_acceleration: float = quantity(
        0.0,
        "1",
        "share of the force (M_RB + M_A) nu_c_dot of the water's acceleration; 0 leaves it out",
        "neutral: the current holds between changes, Fossen 2021",
        minimum=0.0,
        maximum=1.0,
    )
    water_density: float = quantity(
        1025.0, "kg/m3", "density of the water", "sea water", minimum=1.0
    )
    length: float = required("m", "length between perpendiculars", minimum=0.1)
    breadth: float = required("m", "breadth", minimum=0.1)
    draught: float = required("m", "draught", minimum=0.1)
    cross_flow_drag: float = quantity(
        0.0,
        "1",
        "cross-flow drag coefficient, uniform over the length",
        _UNUSED,
        share=0.05,
        minimum=0.0,
    )
    lift: float = quantity(
        0.0, "N.s2/m2", "side force of lift over abs(u_r) v_r", _UNUSED, share=0.1, maximum=0.0
    )
    lift_x: float = quantity(
        0.0, "m", "where the lift acts, forward of the origin", _UNUSED, share=0.1
    )

    X_u: float = _unused("N.s/m", "linear damping in surge")
    Y_v: float = _unused("N.s/m", "linear damping in sway")
    Y_r: float = _unused("N.s/rad", "linear damping, sway by yaw")
    N_v: float = _unused("N.s", "linear damping, yaw by sway")
    N_r: float = _unused("N.m.s/rad", "linear damping in yaw")
    linear_damping_speed: float = quantity(
        0.0,
        "m/s",
        "speed over which the linear damping fades, by exp(-(U/this)^2); 0: the same at all speeds",
        "neutral",
        minimum=0.0,
    )

    X_uu: float = quantity(
        0.0, "N.s2/m2", "quadratic damping in surge, u abs(u)", _UNUSED, share=0.05
    )
    Y_modvv: float = _unused("N.s2/m2", "quadratic damping in sway, v abs(v)")
    N_modrr: float = _unused("N.m.s2/rad2", "quadratic damping in yaw, r abs(r)")

    X_vv: float = _unused("N.s2/m2", "v v")
    X_rr: float = _unused("N.s2/rad2", "r r")
    X_rv: float = _unused("N.s2/(m.rad)", "r v")
    X_uvv: float = _unused("N.s3/m3", "u v v")
    X_rvu: float = _unused("N.s3/(m2.rad)", "r v u")
    X_urr: float = _unused("N.s3/(m.rad2)", "u r r")
    X_umodv: float = _unused("N.s2/m2", "u abs(v)")
    Y_uv: float = _unused("N.s2/m2", "abs(u) v")
    Y_ur: float = _unused("N.s2/(m.rad)", "u r")
    Y_uur: float = _unused("N.s3/(m2.rad)", "u u r")
    Y_uuv: float = _unused("N.s3/m3", "u u v")
    Y_vvv: float = _unused("N.s3/m3", "v v v")
    Y_rrr: float = _unused("N.s3/rad3", "r r r")
    Y_rrv: float = _unused("N.s3/(m.rad2)", "r r v")
    Y_vvr: float = _unused("N.s3/(m2.rad)", "v v r")
    Y_modrv: float = _unused("N.s2/(m.rad)", "v abs(r)")
    Y_modrr: float = _unused("N.s2/rad2", "r abs(r)")
    Y_modvr: float = _unused("N.s2/(m.rad)", "r abs(v)")
    N_uv: float = _unused("N.s2/m", "u v")
    N_ur: float = _unused("N.s2/rad", "abs(u) r")
    N_uur: float = _unused("N.s3/(m.rad)", "u u r")
    N_uuv: float = _unused("N.s3/m2", "u u v")
    N_vvv: float = _unused("N.s3/m2", "v v v")
    N_rrr: float = _unused("N.m.s3/rad3", "r r r")
    N_rrv: float = _unused("N.s3/rad2", "r r v")
    N_vvr: float = _unused("N.s3/(m.rad)", "v v r")
    N_modvv: float = _unused("N.s2/m", "v abs(v)")
    N_modrv: float = _unused("N.s2/rad", "v abs(r)")
    N_modvr: float = _unused("N.s2/rad", "r abs(v)")

    mmg_X_vv: float = _mmg("v' v'")
    mmg_X_vr: float = _mmg("v' r'")
    mmg_X_rr: float = _mmg("r' r'")
    mmg_X_vvvv: float = _mmg("v' v' v' v'")
    mmg_Y_v: float = _mmg("v'")
    mmg_Y_r: float = _mmg("r'")
    mmg_Y_vvv: float = _mmg("v' v' v'")
    mmg_Y_vvr: float = _mmg("v' v' r'")
    mmg_Y_vrr: float = _mmg("v' r' r'")
    mmg_Y_rrr: float = _mmg("r' r' r'")
    mmg_N_v: float = _mmg("v'")
    mmg_N_r: float = _mmg("r'")
    mmg_N_vvv: float = _mmg("v' v' v'")
    mmg_N_vvr: float = _mmg("v' v' r'")
    mmg_N_vrr: float = _mmg("v' r' r'")
    mmg_N_rrr: float = _mmg("r' r' r'")

    mass_scale: float = quantity(
        1.0,
        "1",
        "factor on mass and moment of inertia together; added mass stays",
        "neutral",
        minimum=0.01,
    )
    drag_growth: float = quantity(
        0.0,
        "1",
        "power of speed by which the quadratic damping in surge grows more than u abs(u), equal at Froude number 0.25",
        "neutral",
        minimum=-1.0,
        maximum=4.0,
    )
    drag_scale: float = quantity(
        1.0, "1", "factor on linear and quadratic damping in surge", "neutral", minimum=0.0
    )
    cross_flow_scale: float = quantity(
        1.0,
        "1",
        "factor on the cross-flow drag and on MMG's third order; without drag, on linear and quadratic damping in sway "
        "and yaw",
        "neutral",
        minimum=0.0,
    )

    @cached_property
    def contributions(self):
        """Names of the contributions for which this hull has coefficients."""
        return tuple(
            name
            for name, (_, names) in CONTRIBUTIONS.items()
            if any(acts(getattr(self, coefficient)) for coefficient in names)
        )

    @cached_property
    def rigid_body(self):
        """Mass and moment of inertia with their scale. [kg, kg.m2]"""
        return self.mass_scale * self.mass, self.mass_scale * self.inertia_yaw

    @cached_property
    def coriolis(self):
        """Share of the added mass' Coriolis load, A11 with that share, A22, and the mean of A26 and A62."""
        share = self.added_mass_coriolis
        return share, share * self.A11, self.A22, 0.5 * (self.A26 + self.A62)

    @cached_property
    def linear(self):
        """Coefficients X_u, Y_v, Y_r, N_v, N_r with their scales."""
        along, across = self._damping_scales
        return (
            along * self.X_u,
            across * self.Y_v,
            across * self.Y_r,
            across * self.N_v,
            across * self.N_r,
        )

    @cached_property
    def quadratic(self):
        """Coefficients X_uu, Y_modvv, N_modrr with their scales."""
        along, across = self._damping_scales
        return along * self.X_uu, across * self.Y_modvv, across * self.N_modrr

    @cached_property
    def strips(self):
        """Half the length l, and k l with k = ρ C_d T / 2, of the cross flow. [m, kg/m]"""
        half = 0.5 * self.length
        return (
            half,
            0.5
            * self.water_density
            * self.cross_flow_drag
            * self.draught
            * half
            * self.cross_flow_scale,
        )

    @property
    # With a cross-flow model the scale acts there; otherwise on the damping coefficients.
    def _damping_scales(self):
        return self.drag_scale, 1.0 if "cross_flow" in self.contributions else self.cross_flow_scale

    @cached_property
    def inverse_mass(self):
        """Elements 11, 22, 26, 62, 66 of the inverse of M_RB + M_A."""
        # M = [m + A11, 0, 0; 0, m22, m26; 0, m62, m66], with m x_G coupling sway and yaw.
        mass, inertia = self.rigid_body
        static = mass * self.centre_of_gravity_x
        m22 = mass + self.A22
        m26 = static + self.A26
        m62 = static + self.A62
        m66 = inertia + self.A66
        # Surge is decoupled; the sway-yaw block is inverted in closed form.
        determinant = m22 * m66 - m26 * m62
        return (
            1.0 / (mass + self.A11),
            m66 / determinant,
            -m26 / determinant,
            -m62 / determinant,
            m22 / determinant,
        )


def hull_loads(u_r: Arithmetic, v_r: Arithmetic, r: Arithmetic, *, hull: HullParameters) -> Load:
    """Hydrodynamic loads on a hull: the sum of all contributions for which it has coefficients.

    Parameters
    ----------
    u_r, v_r, r : float or (...) array or tensor
        Velocity relative to the water and yaw rate. [m/s, m/s, rad/s]
    hull : HullParameters
        The hull.

    Returns
    -------
    tuple of three, like u_r
        X, Y, N. [N, N, N.m]

    References
    ----------
    Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, eq. 2.1 to 2.3;
    each contribution names its own.
    """
    # Zero in the arithmetic of the velocities.
    X = Y = N = 0.0 * u_r
    for name in hull.contributions:
        dX, dY, dN = _LOADS[name](u_r, v_r, r, hull=hull)
        X = X + dX
        Y = Y + dY
        N = N + dN
    return X, Y, N


def added_mass_coriolis(
    u: Arithmetic, v: Arithmetic, r: Arithmetic, *, hull: HullParameters
) -> Load:
    """Coriolis and centripetal loads of the added mass, -C_A(ν_r) ν_r.

    Parameters and returns as `hull_loads`.

    References
    ----------
    Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, ch. 6.
    """
    share, A11, A22, A26 = hull.coriolis
    # C_A(ν) ν with a = A11 u and b = A22 v + A26 r: (b r, -a r, a v - b u) moved to the right side.
    # The last part is the Munk moment.
    surge = A11 * u
    sway = share * (A22 * v + A26 * r)
    return sway * r, -surge * r, surge * v - sway * u


def linear_damping(u: Arithmetic, v: Arithmetic, r: Arithmetic, *, hull: HullParameters) -> Load:
    """Linear damping, -D ν_r; where there is a `linear_damping_speed` U_0 it is -D ν_r exp(-U²/U_0²).

    Parameters and returns as `hull_loads`.

    References
    ----------
    Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, ch. 6. The exponential:
    forceSurgeDamping.m of his MSS toolbox, where it blends linear into quadratic damping in surge.
    """
    X_u, Y_v, Y_r, N_v, N_r = hull.linear
    fading = hull.linear_damping_speed
    if acts(fading):
        # Damping of a ship that hardly makes way; with speed the other contributions take over. Compiled code comes
        # here with a speed of 0 too, where nothing fades.
        share = exp(-(u * u + v * v) / where(fading > 0.0, fading * fading, 1.0))
        share = where(fading > 0.0, share, 1.0)
        u = share * u
        v = share * v
        r = share * r
    return X_u * u, Y_v * v + Y_r * r, N_v * v + N_r * r


def quadratic_damping(u: Arithmetic, v: Arithmetic, r: Arithmetic, *, hull: HullParameters) -> Load:
    """Quadratic damping of each velocity, X_uu u abs(u) and its like.

    With a `drag_growth` p the damping in surge is X_uu u abs(u) ((u/u_0)² + 0.02²)^(p/2), where u_0 is the speed of
    Froude number 0.25; the small term keeps it finite at rest.

    Parameters and returns as `hull_loads`.

    References
    ----------
    Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, ch. 6. Waves make the
    resistance grow faster than the square of speed (Molland, Turnock and Hudson, Ship Resistance and Propulsion,
    Cambridge, 2017); a power is assumed.
    """
    X_uu, Y_vv, N_rr = hull.quadratic
    # X_uu u |u|, always against the motion.
    X = X_uu * u * abs(u)
    if acts(hull.drag_growth):
        # Another power of speed, equal at Froude number 0.25: F_n² = u² / (g L).
        X = X * (u * u / (_SPEED_SQUARED * hull.length) + _SLOW) ** (0.5 * hull.drag_growth)
    return X, Y_vv * v * abs(v), N_rr * r * abs(r)


def lift(u: Arithmetic, v: Arithmetic, r: Arithmetic, *, hull: HullParameters) -> Load:
    """Side force by lift of a hull at an angle of attack, which acts at one point.

    Parameters and returns as `hull_loads`.

    References
    ----------
    Assumed form, abs(u_r) v_r; coefficient and point of attack are fitted (nominal model, equation of motion).
    """
    # Lift acts at one point: its moment is the force times the lever.
    Y = hull.lift * abs(u) * v
    return 0.0 * u, Y, hull.lift_x * Y


def cross_flow(u: Arithmetic, v: Arithmetic, r: Arithmetic, *, hull: HullParameters) -> Load:
    """Cross-flow drag: drag of each strip by its own sway velocity, integrated over the length in closed form.

    With k = rho C_d T / 2 and half the length l,

        Y = -k ∫ abs(v + x r) (v + x r) dx,  N = -k ∫ x abs(v + x r) (v + x r) dx,  x from -l to l.

    With w = r l, the larger M and the smaller m of abs(v) and abs(w), and q = m / abs(w) these are

        Y = -2 k l v (M + m² / 3M),  N = -k l² w M (1/2 + q² - q⁴/6).

    Parameters and returns as `hull_loads`.

    References
    ----------
    Strip-wise cross-flow drag: Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021,
    ch. 6. The closed form of the integrals is derived here.
    """
    # Sway speed of a strip: v + x r, from v - w to v + w with w = r l.
    half, k = hull.strips
    w = r * half
    sway = abs(v)
    yaw = abs(w)
    # The integral has two cases, by which of |v| and |w| is larger. Written with both, it needs no
    # branch.
    larger = maximum(sway, yaw)
    smaller = minimum(sway, yaw)
    # q = m / |w|: 1 if sway dominates; the small number avoids 0 / 0 at rest.
    q = smaller / (yaw + _TINY)
    q = q * q
    Y = -2.0 * k * v * (larger + smaller * smaller / (3.0 * larger + _TINY))
    return 0.0 * u, Y, -k * half * w * larger * (0.5 + q - q * q / 6.0)


def polynomial(u: Arithmetic, v: Arithmetic, r: Arithmetic, *, hull: HullParameters) -> Load:
    """Manoeuvring polynomial of the SIMVAL project, without its terms in Xudot, Yvdot, Yrdot and Nvdot.

    Those terms are C_A(ν_r) ν_r written out and come from `added_mass_coriolis`, so that they are counted once.

    The source has u v in sway and u r in yaw, for a ship that goes ahead. Here they are abs(u) v and abs(u) r, so that
    they damp astern too, as of a hull mirrored fore and aft; u r in sway and u v in yaw change sign with it.

    Parameters and returns as `hull_loads`.

    References
    ----------
    Structure after OMAE2015-41789, as in MCSim_python, RVG_maneuvering_3DOF_python/vesselmodel.py.
    """
    p = hull
    # Powers and products, each once.
    av = abs(v)
    ar = abs(r)
    rv = r * v
    vv = v * v
    rr = r * r
    uu = u * u
    # What damps does so ahead and astern.
    speed = abs(u)
    # Surge, sway and yaw as in the source, grouped by common factors.
    X = (
        p.X_vv * vv
        + p.X_rr * rr
        + p.X_rv * rv
        + u * (p.X_uvv * vv + p.X_rvu * rv + p.X_urr * rr + p.X_umodv * av)
    )
    Y = (
        p.Y_uv * (speed * v)
        + p.Y_ur * (u * r)
        + uu * (p.Y_uur * r + p.Y_uuv * v)
        + vv * (p.Y_vvv * v + p.Y_vvr * r)
        + rr * (p.Y_rrr * r + p.Y_rrv * v)
        + p.Y_modrv * v * ar
        + r * (p.Y_modrr * ar + p.Y_modvr * av)
    )
    N = (
        p.N_uv * (u * v)
        + p.N_ur * (speed * r)
        + uu * (p.N_uur * r + p.N_uuv * v)
        + vv * (p.N_vvv * v + p.N_vvr * r)
        + rr * (p.N_rrr * r + p.N_rrv * v)
        + v * (p.N_modvv * av + p.N_modrv * ar)
        + p.N_modvr * r * av
    )
    return X, Y, N


def mmg(u: Arithmetic, v: Arithmetic, r: Arithmetic, *, hull: HullParameters) -> Load:
    """Hull forces of the MMG standard method beside the resistance, with its published derivatives.

    With v' = v/U, r' = r L/U and U² = u² + v²,

        X = ρ/2 L d U² (X_vv v'² + X_vr v' r' + X_rr r'² + X_vvvv v'⁴),
        Y = ρ/2 L d U² (Y_v v' + Y_r r' + Y_vvv v'³ + Y_vvr v'² r' + Y_vrr v' r'² + Y_rrr r'³),

    and N as Y with L² d. The derivatives are of a ship under way: where she turns faster than abs(r') = 2, U is taken
    as abs(r) L/2, so that the loads stay finite at rest (assumed). The cross-flow scale multiplies what is of third
    order in sway and yaw. MMG writes the Munk moment into N_v, and so do the derivatives here: of a hull with the
    Coriolis load of the added mass, the polynomial's ``N_uv`` has to take it out again.

    Parameters and returns as `hull_loads`.

    References
    ----------
    Yasukawa and Yoshimura, Introduction of MMG standard method for ship maneuvering predictions, J Mar Sci Technol 20,
    2015, 37-52; the bound on r' is assumed.
    """
    p = hull
    length = hull.length
    scale = hull.cross_flow_scale
    # ρ/2 L d is the size of all MMG forces.
    size = 0.5 * hull.water_density * length * hull.draught
    # r' = r L / U: with w = L r, products of v' and r' are products of v and w over U².
    w = length * r
    # Bounded below, so that the loads stay finite when the ship turns on the spot.
    U = maximum(hypot(u, v), 0.5 * abs(w)) + _TINY
    vv = v * v
    vw = v * w
    ww = w * w
    # Terms of order 2 need no U; those of order 1 get U, those of order 3 and 4 are divided.
    X = p.mmg_X_vv * vv + p.mmg_X_vr * vw + p.mmg_X_rr * ww + p.mmg_X_vvvv * (vv / U) * (vv / U)
    Y = p.mmg_Y_vvv * vv * v + p.mmg_Y_vvr * vv * w + p.mmg_Y_vrr * v * ww + p.mmg_Y_rrr * ww * w
    N = p.mmg_N_vvv * vv * v + p.mmg_N_vvr * vv * w + p.mmg_N_vrr * v * ww + p.mmg_N_rrr * ww * w
    # First order with U, third order with 1 / U; the scale acts on the cross-flow part.
    Y = U * (p.mmg_Y_v * v + p.mmg_Y_r * w) + scale * Y / U
    N = U * (p.mmg_N_v * v + p.mmg_N_r * w) + scale * N / U
    return size * X, size * Y, size * length * N


CONTRIBUTIONS = {
    "added_mass_coriolis": (added_mass_coriolis, ("added_mass_coriolis",)),
    "linear_damping": (linear_damping, ("X_u", "Y_v", "Y_r", "N_v", "N_r")),
    "quadratic_damping": (quadratic_damping, ("X_uu", "Y_modvv", "N_modrr")),
    "cross_flow": (cross_flow, ("cross_flow_drag",)),
    "lift": (lift, ("lift",)),
    "polynomial": (
        polynomial,
        tuple(
            "X_vv X_rr X_rv X_uvv X_rvu X_urr X_umodv "
            "Y_uv Y_ur Y_uur Y_uuv Y_vvv Y_rrr Y_rrv Y_vvr Y_modrv Y_modrr Y_modvr "
            "N_uv N_ur N_uur N_uuv N_vvv N_rrr N_rrv N_vvr N_modvv N_modrv N_modvr".split()
        ),
    ),
    "mmg": (
        mmg,
        tuple(
            f"mmg_{name}"
            for name in "X_vv X_vr X_rr X_vvvv Y_v Y_r Y_vvv Y_vvr Y_vrr Y_rrr N_v N_r N_vvv N_vvr N_vrr N_rrr".split()
        ),
    ),
}
"""Loads by name: function, and its coefficients; it is left out if all are 0."""

_LOADS = {name: function for name, (function, _) in CONTRIBUTIONS.items()}
