"""The allocator of paper V: data, losses and networks, against what the paper prints and against NumPy."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from ships import parameters

from shipcosim.learn import paper_v
from shipcosim.learn.networks import Recurrent, arrays_of
from shipcosim.models.allocation import pseudo_inverse
from shipcosim.models.core.networks import empty_memory, evaluate, network_of

ZERO, ONE = torch.zeros(3), torch.ones(3)


class Fixed(torch.nn.Module):
    """Stands for a network that gives the same whatever it is asked."""

    def __init__(self, values):
        super().__init__()
        self.values = torch.as_tensor(values, dtype=torch.float32)

    def forward(self, x):
        return self.values.expand(*x.shape[:-1], -1) if self.values.ndim == 1 else self.values


def losses_of(commands, forces=None, decoded=(0.0, 0.0, 0.0), std=ONE):
    """Losses of commands [N, deg], over their weights."""
    commands = torch.as_tensor(commands, dtype=torch.float32)
    network = paper_v.Autoencoder()
    network.encoder = Fixed(commands / torch.from_numpy(paper_v.RANGES).float())
    network.decoder = Fixed(decoded)
    forces = paper_v.generalised_force(commands) if forces is None else forces
    found = paper_v.losses(network, forces, k4=1e-7, mean=ZERO, std=std)
    return {name: float(one) / k for (name, one), k in zip(found.items(), paper_v.K, strict=True)}


def test_torch_and_numpy_evaluate_the_same():
    torch.manual_seed(1)
    network = Recurrent(3, 64, 2, 5).double()
    found = network_of(arrays_of(network, "net"), "net")
    x = torch.randn(200, 3, dtype=torch.float64)
    memory, given = empty_memory(found), []
    for row in x.numpy():
        one, memory = evaluate(found, row, memory)
        given.append(one)
    np.testing.assert_allclose(given, network(x[None])[0].detach().numpy(), atol=1e-6, rtol=0.0)


def test_the_thrusters_are_where_the_ship_has_them():
    ship = parameters(pseudo_inverse.AllocationParameters, "thesis-28m9")
    b = pseudo_inverse.effect(replace(ship, port_azimuth=0.3, starboard_azimuth=-1.1))
    commands = torch.tensor(
        [700.0, 200.0, np.degrees(0.3), -400.0, np.degrees(-1.1)], dtype=torch.float64
    )
    wanted = pseudo_inverse.load((200.0, -400.0, 700.0), b)
    np.testing.assert_allclose(paper_v.generalised_force(commands).numpy(), wanted, rtol=1e-9)


def test_data_are_what_the_paper_says():
    data = paper_v.data_of(replace(paper_v.RECIPES["paper-v"], batches=100))
    assert data.trained == 90 and data.forces.shape == (100, 8, 128, 3)
    np.testing.assert_allclose(data.forces[:90].mean((0, 1, 2)), 0.0, atol=1e-6)
    np.testing.assert_allclose(data.forces[:90].std((0, 1, 2)), 1.0, atol=1e-4)
    assert (abs(data.commands) <= paper_v.RANGES).all()
    full = paper_v.RECIPES["paper-v"]
    assert full.batches * full.sequences * full.samples == pytest.approx(1e6, rel=1e-3)
    assert full.sequences * full.samples == 1024


def test_commands_that_meet_the_request_within_all_limits_lose_their_power_alone():
    commands = [[[4000.0, 900.0, 45.0, -400.0, -45.0]] * 5]
    found = losses_of(commands)
    assert found["k4 L4"] == pytest.approx(4000**1.5 + 900**1.5 + 400**1.5, rel=1e-5)
    assert [found[name] for name in ("k0 L0", "k2 L2", "k3 L3", "k5 L5")] == pytest.approx(
        [0.0] * 4, abs=1e-3
    )


def test_errors_of_the_force_count_in_standardised_units():
    forces = torch.tensor([[[1.0, -2.0, 0.5]]])
    found = losses_of(
        [[[0.0, 0.0, 0.0, 0.0, 0.0]]],
        forces,
        decoded=(0.0, 0.0, 1.5),
        std=torch.tensor([3e3, 5e3, 9e4]),
    )
    assert found["k0 L0"] == pytest.approx(1.0 + 4.0 + 0.25)
    assert found["k1 L1"] == pytest.approx(1.0 + 4.0 + 1.0)


def test_what_exceeds_a_limit_counts_in_newton_and_degrees():
    found = losses_of([[[-8500.0, 4100.0, 85.0, 0.0, -82.0]]])
    assert found["k2 L2"] == pytest.approx(500.0 + 100.0 + 5.0 + 2.0, rel=1e-5)


def test_changes_above_the_rates_count():
    found = losses_of([[[0.0, 0.0, 0.0, 0.0, 0.0], [1500.0, -900.0, 30.0, 0.0, 0.0]]])
    assert found["k3 L3"] == pytest.approx(500.0 + 20.0, rel=1e-5)


def test_sectors_count_but_give_no_gradient():
    found = losses_of([[[0.0, 0.0, 85.0, 0.0, -99.0], [0.0, 0.0, 85.0, 0.0, 10.0]]])
    assert found["k5 L5"] == pytest.approx(1.5, rel=1e-5)
    network = paper_v.Autoencoder()
    one = paper_v.losses(network, torch.randn(1, 4, 3), k4=1e-7, mean=ZERO, std=ONE)
    assert one["k4 L4"].requires_grad and not one["k5 L5"].requires_grad
