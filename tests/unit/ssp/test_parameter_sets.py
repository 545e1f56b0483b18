"""The parameter sets in ssp/ are what ssp/write_parameter_sets.py writes from the ships' files; and what these say."""

import importlib.util
from math import pi

import numpy as np
import pytest
from ships import SHIPS, ship

from shipcosim.models.core.tables import parse
from shipcosim.models.ship.vessel import DriftParameters
from shipcosim.ssp import check_file, write_ssv

THESIS = ("thesis", "thesis-28m9")


@pytest.fixture(scope="session")
def writer(root):
    spec = importlib.util.spec_from_file_location(
        "write_parameter_sets", root / "ssp" / "write_parameter_sets.py"
    )
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def sets(writer):
    """Function from a ship to all her quantities by component."""
    return lambda name: ship(name).parameter_set(
        writer.components(ship(name).systems[0], ship(name))
    )


@pytest.mark.parametrize(
    ("name", "system"), [(name, system) for name in SHIPS for system in ship(name).systems]
)
def test_parameter_file_holds_the_numbers_of_the_ship(system, name, writer, root, tmp_path):
    write_ssv(tmp_path / "again.ssv", name, writer.values(system, ship(name)))
    committed = root / "ssp" / system / "resources" / f"{name}.ssv"
    assert committed.read_bytes() == (tmp_path / "again.ssv").read_bytes()
    assert not [problem for problem in check_file(committed) if problem.severity == "error"]


@pytest.mark.parametrize("name", SHIPS)
def test_every_number_has_unit_description_and_origin(name, sets):
    for component, values in sets(name).items():
        for parameter, quantity in values.items():
            assert quantity.unit and quantity.description and quantity.origin, (
                f"{component}.{parameter}"
            )
            assert quantity.tolerance >= 0.0


@pytest.mark.parametrize("name", ["gunnerus-33m9", "gunnerus-28m9"])
def test_tolerances_are_those_of_the_nominal_model(name, sets):
    """Shares of the value: mass and inertia 1 %, added mass 3 %, drag 5 %, and so on; positions 0.02 m."""
    shares = {
        "vessel": dict(
            mass=0.01,
            inertia_yaw=0.01,
            A11=0.03,
            A22=0.03,
            A26=0.03,
            A66=0.03,
            X_uu=0.05,
            wind_load_scale=0.03,
        ),
        "port": dict(side_force_coefficient=0.1, thrust_scale=0.01, thrust_scale_outside=0.05),
        "tunnel": dict(thrust_coefficient=0.02),
    }
    if name == "gunnerus-33m9":
        shares["vessel"] |= dict(cross_flow_drag=0.05, lift=0.1)
    for component, expected in shares.items():
        for parameter, share in expected.items():
            quantity = sets(name)[component][parameter]
            assert quantity.tolerance == pytest.approx(share * abs(quantity.value), rel=0.03), (
                parameter
            )
    places = (("port", "x"), ("starboard", "y"), ("tunnel", "x"))
    assert [sets(name)[c][axis].tolerance for c, axis in places] == [0.02] * 3


def test_a_set_that_changes_a_number_says_its_own_origin(sets):
    short, long = sets("gunnerus-28m9"), sets("gunnerus-33m9")
    for component, values in short.items():
        for parameter, quantity in values.items():
            changed = quantity.value != long[component][parameter].value
            assert not changed or quantity.origin != long[component][parameter].origin, parameter


@pytest.mark.parametrize(
    "name, x, y, tunnel_x",
    [
        ("gunnerus-33m9", -14.02, 2.0, 14.48),
        ("thesis", -14.02, 2.0, 14.48),
        ("gunnerus-28m9", -13.22, 2.7, 13.08),
        ("thesis-28m9", -13.22, 2.7, 13.08),
    ],
)
def test_thrusters_are_where_the_nominal_model_has_them(name, x, y, tunnel_x, sets):
    found = sets(name)
    assert [found[c]["x"].value for c in ("port", "starboard", "tunnel")] == [x, x, tunnel_x]
    assert [found[c]["y"].value for c in ("port", "starboard")] == [-y, y]
    assert [found[c]["neighbour_y"].value for c in ("port", "starboard")] == [y, -y]
    places = ("port_x", "port_y", "starboard_x", "starboard_y", "tunnel_x")
    assert [found["allocator"][place].value for place in places] == [x, -y, x, y, tunnel_x]


@pytest.mark.parametrize("name", ["gunnerus-33m9", *THESIS])
def test_limits_are_those_of_the_thesis(name, sets):
    unit = sets(name)["port"]
    assert [unit[limit].value for limit in ("thrust_min", "thrust_max", "thrust_rate")] == [
        -30e3,
        60e3,
        1e3,
    ]
    assert unit["azimuth_rate"].value == pytest.approx(10.0 / 180.0 * pi)


def test_the_ship_of_paper_v_has_her_own_hull_and_the_thrusters_of_the_thesis(sets):
    """Paper V, Table I: 28.9 m, 9.6 m, 2.8 m, tunnel within 30 kN. The rest is of either parent."""
    found, hull, thesis = (sets(name) for name in ("thesis-28m9", "gunnerus-28m9", "thesis"))
    vessel = {parameter: quantity.value for parameter, quantity in found["vessel"].items()}
    assert (vessel["length"], vessel["breadth"], vessel["draught"]) == (28.9, 9.6, 2.8)
    changed = {
        parameter for parameter, value in vessel.items() if value != hull["vessel"][parameter].value
    }
    assert changed == {"draught"}
    assert (
        found["tunnel"]["thrust_max"].value == found["allocator"]["tunnel_thrust_max"].value == 30e3
    )
    for component in ("port", "starboard", "tunnel"):
        places = {"x", "y", "neighbour_x", "neighbour_y"}
        assert {p for p, q in found[component].items() if q != thesis[component][p]} <= places
    assert found["reference"] == thesis["reference"] and found["controller"] == hull["controller"]


def test_drift_is_that_of_the_source_at_its_frequencies_and_near_between_them(shared):
    """Peaks: 36 kN/m2 in X, 162 kN/m2 in Y, 369 kN.m/m2 in N. The table keeps four digits."""
    path = shared / "reference/data/gunnerus_33p9_veres_wave_drift_U0.csv"
    source = np.genfromtxt(path, delimiter=",", skip_header=2)
    source = source[source[:, 0] <= 2.6].reshape(-1, 19, 5)
    table = drift_of("gunnerus-33m9").reshape(-1, 19, 5)
    kept = np.isin(source[:, 0, 0], table[:, 0, 0])
    np.testing.assert_allclose(table, source[kept], rtol=5e-4, atol=0.08)
    for column, tolerance in ((2, 19.0), (3, 48.0), (4, 30.0)):
        for heading in range(19):
            between = np.interp(source[:, 0, 0], table[:, 0, 0], table[:, heading, column])
            np.testing.assert_allclose(
                between, source[:, heading, column], rtol=5e-4, atol=tolerance
            )


def test_drift_of_the_short_ship_is_scaled_with_length():
    scale = 28.9 / 33.9
    scaled = drift_of("gunnerus-33m9") * [1.0, 1.0, scale, scale, scale**2]
    np.testing.assert_allclose(drift_of("gunnerus-28m9"), scaled, rtol=1e-4)


def drift_of(name):
    return np.array(parse(ship(name).parameters(DriftParameters, "vessel").drift_table))
