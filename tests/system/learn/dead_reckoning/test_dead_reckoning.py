"""Dead reckoning learned: worlds apart, inputs, networks, filter, regions."""

import json
from dataclasses import replace
from math import log, sqrt

import numpy as np
import pytest
import torch
from ships import parameters

from dead_reckoning.paper_ii_worlds import worlds_of_test
from shipcosim.learn.dead_reckoning import inputs, motion_filter, paper_ii, recipes, worlds
from shipcosim.learn.dead_reckoning.regions import TIMES, calibrated
from shipcosim.learn.networks import Recurrent
from shipcosim.learn.results import markdown
from shipcosim.models.core.networks import read_arrays
from shipcosim.models.environment.wind_loads import WindParameters, wind_loads
from shipcosim.models.prediction import velocity_network
from shipcosim.models.propulsion.mapped import MapParameters, mapped_thrust
from shipcosim.models.ship.hull import HullParameters

FILTER = ("motion-filter", "kinetic", "last-position")


@pytest.fixture
def weights(root):
    return root / "fmus" / "dead_reckoning" / "weights"


def record_of(n=120, many=3, seed=1):
    """A made-up record: slow commands, noise, and GNSS lost for a while."""
    rng = np.random.default_rng(seed)
    slow = np.cumsum(rng.normal(size=(len(worlds.MEASURED), many, n)), axis=-1) * 0.1
    measured = dict(zip(worlds.MEASURED, slow, strict=True))
    measured["valid"] = np.ones((many, n))
    measured["valid"][:, 60:90] = 0.0
    return worlds.Record(measured, measured["x"] + 0.1, measured["y"], {})


def test_no_world_serves_two_purposes():
    purposes = [
        set(one) for one in (worlds.TRAINING, worlds.CALIBRATION, worlds.TUNING, worlds.HELD_OUT)
    ]
    assert sum(map(len, purposes)) == len(set.union(*purposes))
    drawn = [worlds.drawn(seed) for seed in (*worlds.TRAINING, *worlds.CALIBRATION, *worlds.TUNING)]
    held_out = worlds_of_test(worlds.HELD_OUT)
    weather = {(world.wave_height, world.current_to) for world in [*drawn, *held_out]}
    assert len(weather) == len(drawn) + len(held_out)


def test_the_test_has_every_sea_state_from_every_direction():
    given = worlds_of_test(worlds.HELD_OUT)
    assert len({(world.wave_height, round(world.wind_from[1], 6)) for world in given}) == 48
    assert {(world.wave_height, world.wind_speed[1]) for world in given} == set(worlds.SEA_STATES)


def test_nothing_true_is_measured():
    """The names of signals that a law sees: sensors, commands, and what the allocator asks."""
    assert {signal.partition(".")[0] for signal in worlds.MEASURED.values()} <= {
        "sensors",
        "allocator",
        *worlds.UNITS,
    }


def test_the_known_model_is_that_of_the_files():
    hull, wind, known = (
        parameters(HullParameters, "osv"),
        parameters(WindParameters, "osv"),
        motion_filter.KNOWN,
    )
    assert motion_filter.MASS_SURGE == pytest.approx(hull.mass + hull.A11, rel=1e-3)
    assert motion_filter.MASS_SWAY == pytest.approx(hull.mass + hull.A22, rel=1e-3)
    for name, unit, mass in (
        ("bow", "bow_1", motion_filter.MASS_SWAY),
        ("ahead", "port", motion_filter.MASS_SURGE),
    ):
        thrust = mapped_thrust(20.0, thruster=parameters(MapParameters, "osv", unit))
        assert known[name] * 400.0 == pytest.approx(thrust / mass, rel=1e-2)
    mast = 3.0**0.12  # of the wind at 30 m over that at 10 m
    for angle in (0.0, 0.5, 1.5, 2.5):
        X, Y, _ = wind_loads(10.0 / mast, angle, wind=wind)
        forward = 100.0 * (
            known["wind_surge_1"] * np.cos(angle) + known["wind_surge_3"] * np.cos(3.0 * angle)
        )
        side = 100.0 * (
            known["wind_sway_1"] * np.sin(angle) + known["wind_sway_3"] * np.sin(3.0 * angle)
        )
        assert forward * motion_filter.MASS_SURGE == pytest.approx(X, abs=4e3)
        assert side * motion_filter.MASS_SWAY == pytest.approx(Y, abs=8e3)


@pytest.mark.parametrize("correlation", [0.0, 0.6, 0.95])
def test_mutual_information_of_normal_numbers_is_the_closed_form(correlation):
    rng = np.random.default_rng(1)
    x, z = rng.normal(size=(2, 1500))
    y = correlation * x + sqrt(1.0 - correlation**2) * z
    assert inputs.mutual_information(x, y) == pytest.approx(
        -0.5 * log(1.0 - correlation**2), abs=0.06
    )


@pytest.mark.parametrize("name", list(paper_ii.RECIPES))
def test_torch_and_numpy_give_the_same_velocity(name):
    recipe = replace(paper_ii.RECIPES[name], most_epochs=1)
    record = record_of()
    arrays, epochs = paper_ii.trained(recipe, record, lambda done, total: None)
    again, _ = paper_ii.trained(recipe, record, lambda done, total: None)
    assert len(epochs) == 2 and all((arrays[key] == again[key]).all() for key in arrays)
    design = velocity_network.design(arrays)
    history = paper_ii.features_of(record)[:, 20:30]
    network = _torch_of(arrays, recipe)
    x = (history[..., design.surge.inputs] - design.surge.mean) / design.surge.std
    wanted = network(torch.from_numpy(x).float())[:, -1, 0].detach().numpy()
    found = (
        velocity_network.velocity(history, design.surge) - design.surge.velocity_mean
    ) / design.surge.velocity_std
    np.testing.assert_allclose(found, wanted, atol=1e-5)


def _torch_of(arrays, recipe):
    """The network of surge in torch, from its arrays."""
    put = {
        name.removeprefix("surge."): torch.from_numpy(one).float()
        for name, one in arrays.items()
        if "surge" in name
    }
    if not recipe.recurrent:
        network = paper_ii.SingleLayer(4, recipe.width[0])
        named = {"hidden.weight": "hidden.weights", "hidden.bias": "hidden.bias"}
        named |= {"dense.weight": "dense.weights", "dense.bias": "dense.bias"}
        network.load_state_dict({key: put[name] for key, name in named.items()})
        return network
    network = Recurrent(4, recipe.width[0], 1, 1)
    both, bias = put["lstm.1.weights"], put["lstm.1.bias"]
    state = {
        "lstm.weight_ih_l0": both[:, :4],
        "lstm.weight_hh_l0": both[:, 4:],
        "lstm.bias_ih_l0": bias,
    }
    state |= {
        "lstm.bias_hh_l0": 0.0 * bias,
        "dense.weight": put["dense.weights"],
        "dense.bias": put["dense.bias"],
    }
    network.load_state_dict(state)
    return network


def test_while_gnss_is_lost_its_values_are_not_used():
    record, arrays = record_of(), {}
    arrays, _ = paper_ii.trained(
        replace(paper_ii.RECIPES["paper-ii"], most_epochs=1), record, lambda *_: None
    )
    lost = record.measured["valid"] < 0.5
    spoilt = {name: np.where(lost, 1e3, record.measured[name]) for name in ("x", "y", "u", "v")}
    other = record._replace(measured=record.measured | spoilt)
    for law, design in (
        (velocity_network, velocity_network.design(arrays)),
        (recipes.filter_law, recipes.design_of("kinetic")),
    ):
        a, b = (motion_filter.reckoned(one, law, design)[89] for one in (record, other))
        np.testing.assert_array_equal((a.x, a.y), (b.x, b.y))


def test_learning_finds_the_numbers_of_the_ship_that_made_the_record():
    """Of an exact record, in which bow tunnels push harder and the wind less than known."""
    n, many, rng = 240, 4, np.random.default_rng(2)
    true = recipes.design_of("kinetic")
    true = true._replace(bow=1.3 * true.bow, wind_sway_1=0.6 * true.wind_sway_1)
    record = record_of(n, many)
    m = record.measured
    m |= {name: 0.0 * m["x"] for name in ("psi", *(f"command_{k}" for k in range(1, 7)))}
    m["command_1"] = 160.0 * np.sin(np.arange(n) / 20.0 + rng.uniform(0.0, 6.0, (many, 1)))
    m["wind_speed"], m["wind_from"] = (
        6.0 + 3.0 * np.sin(np.arange(n) / 20.0) + 0.0 * m["x"],
        1.0 + 0.0 * m["x"],
    )
    m["valid"] = np.zeros((many, n))
    states = motion_filter.reckoned(record, recipes.filter_law, true)
    for name, field in (
        ("x", "x"),
        ("y", "y"),
        ("second_x", "x"),
        ("second_y", "y"),
        ("u", "u"),
        ("v", "v"),
    ):
        m[name] = np.stack([getattr(state, field) for state in states], axis=-1)
    m["x"][:, 0] = m["second_x"][:, 0]
    m["valid"][:, :60] = 1.0
    found, epochs = motion_filter.fitted(record, lambda done, total: None, iterations=12)
    assert epochs[-1]["cost"] < 0.1 * epochs[0]["cost"]
    assert found.bow == pytest.approx(true.bow, rel=0.1)
    assert found.wind_sway_1 == pytest.approx(true.wind_sway_1, rel=0.15)


def test_a_region_covers_nine_of_ten_and_follows_the_sea():
    rng = np.random.default_rng(1)

    def cases(n):
        time, sea = rng.uniform(0.0, 60.0, n), rng.uniform(0.0, 0.2, n)
        return time, sea, (0.3 + 0.02 * time) * (1.0 + 4.0 * np.sqrt(sea)) * abs(rng.normal(size=n))

    region = calibrated(*cases(20000))
    time, sea, error = cases(20000)
    radii = np.interp(time, TIMES, region["region.radii"]) * (
        1.0 + region["region.sea_share"] * np.sqrt(sea)
    )
    assert np.mean(error <= radii) == pytest.approx(0.9, abs=0.015)
    calm = sea < 0.05
    assert all(
        np.mean((error <= radii)[part]) == pytest.approx(0.9, abs=0.04) for part in (calm, ~calm)
    )
    assert region["region.sea_share"] > 0.0 and (np.diff(region["region.radii"]) >= 0.0).all()


@pytest.mark.parametrize("name", [*FILTER, *paper_ii.RECIPES])
def test_weights_and_pages_are_those_of_their_report(name, weights):
    report = json.loads((weights / f"{name}.json").read_text(encoding="utf-8"))
    assert (weights / f"{name}.md").read_text(encoding="utf-8") == markdown(report)
    assert report["weights"] == sum(
        one.size for one in read_arrays(weights / f"{name}.npz").values()
    )
    assert report["processor_time_s"] < 1200.0
    if name in recipes.UNLEARNED:
        arrays = read_arrays(weights / f"{name}.npz")
        assert all(arrays[key] == one for key, one in recipes.design_of(name)._asdict().items())
    else:
        assert report["data"]["seeds of the worlds"] == "1 to 12"
        assert report["data"]["seeds of the worlds that calibrate the region"] == "200 to 223"
