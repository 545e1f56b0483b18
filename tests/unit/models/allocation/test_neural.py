"""Our neural allocator: limits that hold whatever the network says, requests met, slipstreams made up for.

Weights here are random: what holds with them holds with any. What training adds is measured in tests/bench/allocation.
"""

from math import pi, radians

import numpy as np
import pytest
from ships import parameters

from shipcosim.models.allocation import (
    neural,
    neural_allocator,
    neural_floats,
    neural_law,
)
from shipcosim.models.allocation.neural import Commands
from shipcosim.models.allocation.neural_allocator import NeuralParameters

GUNNERUS = parameters(NeuralParameters, component="allocator")
H = 0.1


def random_weights(units, random, size=3.0):
    """Weights so large that outputs are anywhere between -1 and 1."""
    sizes = (8 + 5 * units, 16, 2 * units)
    found = {}
    for k, (n, m) in enumerate(zip(sizes[:-1], sizes[1:], strict=True), 1):
        found |= {
            f"{k}.weights": size * random.standard_normal((n, m)) / np.sqrt(n),
            f"{k}.bias": np.zeros(m),
        }
    return found


def named(diameter=0.0, seed=1):
    model = NeuralParameters(**{**vars(GUNNERUS), "azimuth_diameter": diameter})
    return model, neural_allocator.design(model, random_weights(3, np.random.default_rng(seed)))


def requests(kind, runs, random):
    """Loads that try the limits: anywhere, back and forth, far out of reach, nearly nothing."""
    size = np.array([4e4, 4e4, 4e5])
    wild = random.uniform(-1.0, 1.0, (3, runs)) * size[:, None]
    if kind == "out of reach":
        return 100.0 * wild
    if kind == "nearly nothing":
        return 1e-6 * wild
    if kind == "back and forth":
        return np.sign(wild) * size[:, None]
    return wild


@pytest.mark.parametrize("diameter", [0.0, 1.9])
@pytest.mark.parametrize("kind", ["anywhere", "back and forth", "out of reach", "nearly nothing"])
def test_no_limit_is_broken_whatever_the_network_says(kind, diameter):
    count_violations(kind, diameter, runs=100, steps=25)


def count_violations(kind, diameter, runs, steps):
    """Each run has a new request and new missing units in every other step, with power short in between."""
    random = np.random.default_rng(7)
    model, design = named(diameter)
    u, state = design.units, neural_allocator.at_rest(tuple(np.zeros((3, runs))), parameters=model)
    for _ in range(steps):
        tau, on = tuple(requests(kind, runs, random)), random.random((3, runs)) > 0.2
        shares = tuple(np.where(random.random((3, runs)) < 0.2, 0.5, 1.0))
        before, state = (
            state,
            neural_allocator.step(
                state, tau, tuple(on), H, parameters=model, design=design, shares=shares
            ),
        )
        f, a = (
            np.array([values + np.zeros(runs) for values in of]).T
            for of in (state.thrusts, state.azimuths)
        )
        f0, a0 = (
            np.array([values + np.zeros(runs) for values in of]).T
            for of in (before.thrusts, before.azimuths)
        )
        on, most = on.T, u.most * np.array(shares).T
        assert (f <= most + 1e-6).all() and (f >= [-3e4, -3e4, -21.6e3]).all()
        assert (f[~on] == 0.0).all()
        quicker = np.abs(f - f0) > u.rate * H * (1.0 + 1e-9)
        assert not (
            quicker & on & (f0 <= most) & (f0 >= u.least * np.array(shares).T * (u.least < 0.0))
        ).any()
        assert (np.abs(a - a0) <= u.turn * H * (1.0 + 1e-9)).all()
        if diameter == 0.0:
            started = slice(2)
            inside = (a[:, started] >= u.first[started] - 1e-9) & (
                a[:, started] <= u.last[started] + 1e-9
            )
            assert (inside | (f[:, started] <= np.abs(f0[:, started]))).all()


def test_floats_give_what_arrays_give():
    model, design = named(1.9)
    random = np.random.default_rng(3)
    many = neural_allocator.at_rest(tuple(np.zeros((3, 4))), parameters=model)
    ones = [neural_allocator.at_rest((0.0, 0.0, 0.0), parameters=model) for _ in range(4)]
    for _ in range(20):
        tau = requests("anywhere", 4, random)
        many = neural_allocator.step(
            many, tuple(tau), (True, True, True), H, parameters=model, design=design
        )
        for k, one in enumerate(ones):
            ones[k] = neural_allocator.step(
                one,
                tuple(tau[:, k].tolist()),
                (True, True, True),
                H,
                parameters=model,
                design=design,
            )
    for k, one in enumerate(ones):
        assert all(type(f) is float for f in one.thrusts)
        np.testing.assert_allclose(one.thrusts, [f[k] for f in many.thrusts], rtol=1e-9, atol=1e-6)
        np.testing.assert_allclose(
            one.azimuths, [a[k] for a in many.azimuths], rtol=1e-9, atol=1e-9
        )


@pytest.mark.parametrize("diameter", [0.0, 1.9])
def test_proposals_in_floats_are_those_in_vectors(diameter):
    """Also where units are missing or short of power, and where one has to reverse."""
    _, design = named(diameter)
    random, u = np.random.default_rng(11), design.units
    for kind in ("anywhere", "back and forth", "out of reach", "nearly nothing") * 10:
        tau, smooth = requests(kind, 1, random)[:, 0], requests("anywhere", 1, random)[:, 0]
        usable = np.where(random.random(3) > 0.3, random.choice([0.5, 1.0], 3), 0.0)
        f, a = random.uniform(-3e3, 9e3, 3), random.uniform(-1.0, 1.0, 3) + [0.0, pi, 0.5 * pi]
        a[2] = 0.5 * pi
        lost = neural.taken(f, a, units=u) + np.zeros(3)
        vectors = neural.propose(
            Commands(f, a, smooth), tau, usable, H, units=u, weights=design.weights
        )
        f, a, smooth, tau, usable = (values.tolist() for values in (f, a, smooth, tau, usable))
        of = design.floats
        np.testing.assert_allclose(neural_floats.taken(f, a, of), lost, rtol=1e-12, atol=1e-9)
        found = neural_floats.propose(f, a, smooth, tau, usable, lost.tolist(), H, of)
        for one, other, scale in zip(found, vectors, (1e4, 1.0, 1e4), strict=True):
            np.testing.assert_allclose(one, other, rtol=1e-7, atol=1e-9 * scale)


def test_attainable_request_is_met_even_by_an_untrained_network():
    """The program behind it does so."""
    model, design = named()
    state = neural_allocator.at_rest((0.0, 0.0, 0.0), parameters=model)
    for _ in range(1200):
        state = neural_allocator.step(
            state, (3e3, 4e3, 2e4), (True, True, True), H, parameters=model, design=design
        )
    assert state[2:5] == pytest.approx((3e3, 4e3, 2e4), abs=20.0)


def test_lost_thrust_is_made_up_for():
    """What slipstreams leave of the commands is the load that the law says it gives."""
    model, design = named(1.9)
    state = neural_allocator.at_rest((0.0, 0.0, 0.0), parameters=model)
    for _ in range(600):
        state = neural_allocator.step(
            state, (0.0, 9e3, -4e4), (True, True, True), H, parameters=model, design=design
        )
    thrusts, azimuths = np.array(state.thrusts), np.array(state.azimuths)
    effect = neural.effects(thrusts, azimuths, units=design.units)
    X, Y, N = effect @ thrusts
    assert (X, Y, N * model.yaw_lever) == pytest.approx(state[2:5], abs=30.0)


def test_power_is_that_of_the_interface():
    from shipcosim.models.allocation.units import thruster_power, used_shares

    units = neural_allocator.units_of(GUNNERUS, (194e3, 194e3, 200e3))[0]
    thrusts = (2e4, 5e3, -7e3)
    used = used_shares(thrusts, units.least, units.most)
    expected = thruster_power(tuple(used), (194e3, 194e3, 200e3))
    assert neural.power(np.array(thrusts), units=units) == pytest.approx(float(expected), rel=1e-6)


def test_completed_thrusts_meet_what_can_be_met():
    units = neural_allocator.units_of(GUNNERUS)[0]
    angles = np.array([radians(-40.0), radians(130.0), pi / 2])
    effect = neural.effects(np.zeros(3), angles, units=units)
    tau = effect @ np.array([4e3, 3e3, -2e3]) * [1.0, 1.0, units.lever]
    low, high = np.array([1e3, 1e3, -2e4]), np.array([6e4, 6e4, 2e4])
    found, _ = neural.completed(
        np.array([1e3, 1e3, 0.0]), tau, effect, low, high, np.ones(3), units=units
    )
    assert (abs(effect @ found * [1.0, 1.0, units.lever] - tau) < [20.0, 20.0, 60.0]).all()
    np.testing.assert_allclose(
        found, [4e3, 3e3, -2e3], atol=30.0
    )  # where directions nearly cancel they are soft


def test_network_of_another_ship_is_refused():
    with pytest.raises(ValueError, match="trained for 4 units, the ship has 3"):
        neural_allocator.design(GUNNERUS, random_weights(4, np.random.default_rng(1)))


def test_units_without_thrust_are_left_out():
    each = {
        "thrust_max": 1e4,
        "thrust_min": -1e4,
        "thrust_rate": 1e3,
        "azimuth_rate": 0.1,
        "thrust_least": 500.0,
    }
    values = {f"{name}_{k}": value for k in (2, 5) for name, value in each.items()}
    model = neural_allocator.NeuralUnitsParameters(**values, x_2=10.0, x_5=-10.0, yaw_lever=10.0)
    design = neural_allocator.design(model, random_weights(2, np.random.default_rng(1)))
    assert design.numbers == (1, 4)
    state = neural_allocator.at_rest((0.0, 0.0, 0.0), parameters=model)
    for _ in range(100):
        state = neural_allocator.step(
            state, (5e3, 0.0, 0.0), (True,) * 6, H, parameters=model, design=design
        )
    assert [k for k, f in enumerate(state.thrusts) if f != 0.0] == [1, 4]
    assert state.tau_X == pytest.approx(5e3, abs=100.0)


def test_proposal_keeps_rates_by_itself():
    _, design = named()
    u = design.units
    before = Commands(np.array([5e3, 3e3, 1e3]), np.array([0.3, 2.5, pi / 2]), np.zeros(3))
    after = neural.propose(
        before, np.array([9e4, -9e4, 9e5]), np.ones(3), H, units=u, weights=design.weights
    )
    assert (np.abs(after.thrusts - before.thrusts) <= u.rate * H + 1e-9).all()
    assert (np.abs(after.azimuths - before.azimuths) <= u.turn * H + 1e-12).all()


def test_state_holds_the_fields_of_the_interface():
    from shipcosim.models.allocation.units import Allocated

    assert neural_law.Remembered._fields[: len(Allocated._fields)] == Allocated._fields


def as_tensors(values, torch):
    return type(values)(*(torch.as_tensor(v) if isinstance(v, np.ndarray) else v for v in values))


@pytest.mark.parametrize("diameter", [0.0, 1.9])
def test_tensors_give_what_arrays_give_and_have_finite_gradients(diameter):
    """All functions that training runs in torch: `propose` calls them, and `power`."""
    torch = pytest.importorskip("torch")
    random = np.random.default_rng(5)
    _, design = named(diameter)
    u, tau = design.units, requests("anywhere", 6, random).T
    on = np.where(random.random((6, 3)) > 0.3, 1.0, 0.0)
    f, a = random.uniform(1e3, 9e3, (6, 3)), random.uniform(-1.0, 1.0, (6, 3)) + [0.0, pi, 0.0]
    found = neural.propose(Commands(f, a, tau), tau, on, H, units=u, weights=design.weights)
    tensors = as_tensors(u, torch)
    weights = tuple(
        (torch.as_tensor(w).requires_grad_(), torch.as_tensor(b)) for w, b in design.weights
    )
    state = as_tensors(Commands(f, a, tau), torch)
    again = neural.propose(
        state, torch.as_tensor(tau), torch.as_tensor(on), H, units=tensors, weights=weights
    )
    for one, other in zip(found, again, strict=True):
        np.testing.assert_allclose(other.detach().numpy(), one, rtol=1e-9, atol=1e-9)
    spent = neural.power(again.thrusts, units=tensors)
    np.testing.assert_allclose(spent.detach().numpy(), neural.power(found.thrusts, units=u))
    spent.sum().backward()
    assert all(torch.isfinite(matrix.grad).all() for matrix, _ in weights)
