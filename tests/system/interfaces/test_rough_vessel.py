"""The ship of another form is the vessel where every parameter of the form is neutral."""

import importlib.util

import pytest
from ships import equipped

from shipcosim.interfaces import Ship


@pytest.fixture
def sailed(root):
    """Function from the name of an FMU and changed parameters to its outputs over 60 s in wind, waves and a current."""

    def sail(name, **changed):
        spec = importlib.util.spec_from_file_location(
            f"sailed_{name}", root / "fmus" / name / f"{name}.py"
        )
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        kind = next(
            c
            for c in vars(module).values()
            if isinstance(c, type) and issubclass(c, Ship) and c is not Ship
        )
        fmu = equipped(kind(), "vessel")
        for key, value in {"u_start": 0.5, "r_start": 0.01, **changed}.items():
            setattr(fmu, key, value)
        fmu.wind_north, fmu.wind_east, fmu.current_east, fmu.wave_height = -6.0, 4.0, 0.3, 0.4
        fmu.start_time = 0.0
        fmu.start()
        rows = []
        for k in range(600):
            fmu.tau_X_1 = 2e3 * (k > 100)
            fmu.step(0.1 * k, 0.1)
            rows.append(
                [
                    getattr(fmu, variable.name)
                    for variable in fmu.variables
                    if variable.causality == "output"
                ]
            )
        return rows

    return sail


def test_neutral_form_is_the_vessel_to_the_last_digit(sailed):
    assert sailed("rough_vessel") == sailed("vessel")


@pytest.mark.parametrize(
    "changed",
    [
        {"strip_factors": "-1 1.3; 1 0.7"},
        {"cross_flow_power": 1.9},
        {"drag_power": 2.1},
        {"wind_factors": "0 1 1 1; 90 1.1 1 1; 360 1 1 1"},
        {"memory_surge": 0.1},
        {"memory_sway": 0.1},
        {"memory_yaw": 0.1},
    ],
    ids=lambda changed: next(iter(changed)),
)
def test_every_parameter_of_the_form_moves_her_elsewhere(changed, sailed):
    assert sailed("rough_vessel", **changed)[-1] != sailed("vessel")[-1]
