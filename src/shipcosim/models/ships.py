"""Parameter sets of whole ships: every number with its unit, origin and tolerance.

The defaults of the parameter classes are gunnerus-33m9. Another ship is what differs from it. Tolerances are standard
deviations within which a number counts as known; where a set does not say, those of the default hold, relative to size.
"""

import math
from dataclasses import fields
from typing import Any, NamedTuple

from shipcosim.models.allocation.pseudo_inverse import AllocationParameters
from shipcosim.models.control.observer import DpShip, ObserverParameters
from shipcosim.models.control.pid import ControlParameters
from shipcosim.models.control.reference import ReferenceParameters
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.propulsion.thruster import AzimuthParameters, TunnelParameters
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.load_tables import DRIFT_28M9, WIND_28M9
from shipcosim.models.ship.vessel import DriftParameters

SHIPS = ("gunnerus-33m9", "gunnerus-28m9", "thesis")
COMPONENTS = {
    "vessel": (HullParameters, WindParameters, DriftParameters),
    "port": (AzimuthParameters,),
    "starboard": (AzimuthParameters,),
    "tunnel": (TunnelParameters,),
    "reference": (ReferenceParameters,),
    "controller": (DpShip, ObserverParameters, ControlParameters, WindParameters),
    "allocator": (AllocationParameters,),
    "predictor": (HullParameters, WindParameters, DriftParameters),
}
"""Component of the system: its parameter classes."""

_SIMVAL = "SIMVAL/VeSim model of R/V Gunnerus before lengthening, MCSim_python, grade B"
_THESIS = "Skulstad 2021: propeller-only curve of paper V, grade A as thesis data"
_UNUSED = "not used by this ship"
_OSP = "OSP demo case of the short ship, grade B"


class Quantity(NamedTuple):
    """A number of a parameter set.

    Parameters
    ----------
    value : float, int, bool or str
        Value; a table is a str.
    unit, description, origin : str
        FMI's spelling of the unit, one line of text, where the number comes from.
    tolerance : float
        Standard deviation within which it counts as known, in its unit.
    """

    value: Any
    unit: str
    description: str
    origin: str
    tolerance: float


def parameter_set(ship):
    """All parameters of a ship's components.

    Parameters
    ----------
    ship : str
        One of `SHIPS`.

    Returns
    -------
    dict of dict of Quantity
        By component and parameter.

    Raises
    ------
    ValueError
        No such ship.

    Examples
    --------
    >>> parameter_set("gunnerus-28m9")["tunnel"]["x"].value
    13.08
    """
    if ship not in SHIPS:
        raise ValueError(f"no ship '{ship}'. There is: {', '.join(SHIPS)}.")
    return {
        component: {
            field.name: _quantity(field, _CHANGES[ship].get(component, {}).get(field.name))
            for kind in kinds
            for field in fields(kind)
        }
        for component, kinds in COMPONENTS.items()
    }


def parameters(kind, ship, component):
    """The parameters of a ship's component as the dataclass that the models take.

    Parameters
    ----------
    kind : type
        A class of `COMPONENTS`.
    ship : str
        One of `SHIPS`.
    component : str
        Key of `COMPONENTS`.

    Returns
    -------
    instance of kind

    Examples
    --------
    >>> parameters(HullParameters, "gunnerus-28m9", "vessel").length
    28.9
    """
    values = parameter_set(ship)[component]
    return kind(**{field.name: values[field.name].value for field in fields(kind)})


def _quantity(field, change):
    about = field.metadata
    unit, description = about["unit"], about["description"]
    if change is None:
        return Quantity(field.default, unit, description, about["origin"], about["tolerance"])
    value, origin, *tolerance = change
    known = tolerance[0] if tolerance else _same_share(field, value)
    return Quantity(value, unit, description, origin, known)


def _same_share(field, value):
    """The default's tolerance, as a share of the value where the default has a size."""
    tolerance = field.metadata["tolerance"]
    return tolerance * abs(value / field.default) if tolerance and field.default else tolerance


def _polynomial(text):
    """Coefficients of the source with 5 % tolerance (assumed, as for drag)."""
    pairs = (item.split() for item in text.split(";"))
    return {name: (float(value), _SIMVAL, 0.05 * abs(float(value))) for name, value in pairs}


_POLYNOMIAL_28M9 = _polynomial(
    "X_vv 2880.5065; X_rr -29267.3371; X_rv -323707.1228; X_uvv -2371.1792; X_rvu 33926.4945; X_urr 83774.6548;"
    "X_umodv 619.643; Y_uv -31000.2779; Y_ur 277765.7816; Y_uur 11112.4159; Y_uuv 777.3214; Y_vvv -11198.6727;"
    "Y_rrr 21117955.8908; Y_rrv -12912371.0982; Y_vvr 102679.0573; Y_modrv 485260.3423; Y_modvv -21640.6686;"
    "Y_modrr -1020386.1325; Y_modvr 321944.5769; N_uv 309051.5592; N_ur -2413124.664; N_uur -187538.9302;"
    "N_uuv -14041.6851; N_vvv -56669.589; N_rrr -179720233.7453; N_rrv -585678.1567; N_vvr -4278941.6707;"
    "N_modrv 1626540.037; N_modvv 116643.7578; N_modrr -9397835.7612; N_modvr -2258197.6812; X_uu -2100"
)

_VESSEL_28M9 = _POLYNOMIAL_28M9 | {
    "mass": (410_931.81, _SIMVAL),
    "inertia_yaw": (21_450_896.0, _SIMVAL),
    "A11": (79_320.5895, _SIMVAL),
    "A22": (408_192.6004, _SIMVAL),
    "A26": (-331_671.6384, _SIMVAL),
    "A62": (-331_671.6384, _SIMVAL),
    "A66": (12_245_783.9277, _SIMVAL),
    "length": (28.9, "thesis Table 2.2, before lengthening, grade A"),
    "draught": (2.7, "thesis Table 2.2, before lengthening, grade A"),
    "cross_flow_drag": (0.0, _UNUSED),
    "lift": (0.0, _UNUSED),
    "lift_x": (0.0, _UNUSED),
    "wind_table": (WIND_28M9, "MCSim_python, RVG_maneuvering_3DOF_python/vesselmodel.py, grade B"),
    "drift_table": (DRIFT_28M9, "the lengthened ship's, scaled with Lpp (assumed)"),
}

_AZIMUTH_THESIS = {
    "thrust_scale": (0.4804, _THESIS),
    "thrust_scale_outside": (1.0014, _THESIS),
    "inflow": (0.0, "the curve of paper V is over shaft speed alone"),
    "side_force_coefficient": (0.0, "none in the thesis"),
    "torque_max": (28.5e3, "what the curve of paper V needs; beyond the motor's 500 kW at 203 rpm"),
    "power_max": (600e3, "what the curve of paper V needs; beyond the motor's 500 kW"),
}

_TUNNEL_THESIS = {
    "thrust_min": (-30e3, "Skulstad 2021, paper V, Table I; out of the real unit's reach"),
    "thrust_max": (30e3, "Skulstad 2021, paper V, Table I; out of the real unit's reach"),
    "rpm_max": (2100.0, "what 30 kN need"),
    "torque_max": (1600.0, "what 30 kN need"),
    "power_max": (350e3, "what 30 kN need"),
}

_WIND_TABLE_28M9 = {"wind_table": _VESSEL_28M9["wind_table"]}

_DP_SHIP_28M9 = {
    "mass_surge": (490_252.4, "m + A11"),
    "mass_sway": (819_124.41, "m + A22"),
    "mass_sway_yaw": (-331_671.6384, "A26"),
    "mass_yaw": (33_696_679.9, "Iz + A66"),
}

_ALLOCATION_28M9 = {
    "port_x": (-13.22, _OSP),
    "port_y": (-2.7, _OSP),
    "starboard_x": (-13.22, _OSP),
    "starboard_y": (2.7, _OSP),
    "tunnel_x": (13.08, _OSP),
}

_REFERENCE_THESIS = {
    "position_frequency": (2.0 * math.pi / 200.0, "thesis, author's reference model: no leg of 200 s settles"),
    "heading_frequency": (2.0 * math.pi / 200.0, "thesis, author's reference model: no leg of 200 s settles"),
}

_NEXT = "the other unit, thesis, grade A"
_PORT = {"y": (-2.0, "thesis, grade A"), "neighbour_x": (-14.02, _NEXT), "neighbour_y": (2.0, _NEXT)}
_STARBOARD = {"y": (2.0, "thesis, grade A"), "neighbour_x": (-14.02, _NEXT), "neighbour_y": (-2.0, _NEXT)}

_PORT_28M9 = {"x": (-13.22, _OSP, 0.02), "y": (-2.7, _OSP), "neighbour_x": (-13.22, _OSP), "neighbour_y": (2.7, _OSP)}
_STARBOARD_28M9 = {
    "x": (-13.22, _OSP, 0.02),
    "y": (2.7, _OSP),
    "neighbour_x": (-13.22, _OSP),
    "neighbour_y": (-2.7, _OSP),
}

_CHANGES = {
    "gunnerus-33m9": {"port": _PORT, "starboard": _STARBOARD},
    "gunnerus-28m9": {
        "vessel": _VESSEL_28M9,
        "port": _PORT_28M9,
        "starboard": _STARBOARD_28M9,
        "tunnel": {"x": (13.08, _OSP, 0.02)},
        "controller": _DP_SHIP_28M9 | _WIND_TABLE_28M9,
        "allocator": _ALLOCATION_28M9,
        "predictor": _VESSEL_28M9,
    },
    "thesis": {
        "port": _PORT | _AZIMUTH_THESIS,
        "starboard": _STARBOARD | _AZIMUTH_THESIS,
        "tunnel": _TUNNEL_THESIS,
        "reference": _REFERENCE_THESIS,
        "allocator": {"tunnel_thrust_max": (30e3, "Skulstad 2021, paper V, Table I")},
    },
}
