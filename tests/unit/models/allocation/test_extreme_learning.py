"""Paper I's allocators as they are evaluated: the matrix form, thrusts of commands, missing units."""

from dataclasses import replace

import numpy as np
import pytest
from ships import FOLDER, parameters

from shipcosim.models.allocation import extreme_learning as elm
from shipcosim.models.core.networks import read_arrays

UNITS = parameters(elm.ExtremeLearningParameters, "osv")
WEIGHTS = FOLDER.parents[1] / "fmus" / "paper_i_allocator" / "weights"
ALL = (True,) * 6


def network(allocator, signals=6, variant="paper-i-cutoff"):
    chosen = replace(UNITS, allocator=allocator, signals=signals)
    return chosen, elm.network_of(read_arrays(WEIGHTS / f"{variant}.npz"), chosen)


def after(tau, steps, allocator, signals=6, available=ALL):
    """State after so many steps of one request."""
    chosen, found = network(allocator, signals)
    state = elm.at_rest(tau, parameters=chosen)
    for _ in range(steps):
        state = elm.step(state, tau, available, 0.05, parameters=chosen, design=found)
    return state


@pytest.mark.parametrize("variant", ["paper-i", "paper-i-cutoff"])
@pytest.mark.parametrize(
    ("allocator", "signals", "inputs"), [(1, 6, 3), (1, 5, 3), (2, 6, 9), (2, 5, 8)]
)
def test_network_has_the_papers_structure_and_gives_its_matrix_form(
    variant, allocator, signals, inputs
):
    _, found = network(allocator, signals, variant)
    x = np.linspace(-0.7, 0.9, inputs) * np.array(found.scale)
    W, beta = np.array(found.hidden), np.array(found.output)
    assert W.shape == (20, inputs) and beta.shape == (signals, 20)
    hidden = 1.0 / (1.0 + np.exp(-(W @ (x / found.scale) + found.bias)))
    np.testing.assert_allclose(elm.evaluate(found, tuple(x)), beta @ hidden, rtol=1e-6, atol=1e-6)


def test_thrust_is_quadratic_in_the_command_and_ends_at_the_limits():
    state = after((3e5, 2e5, 4e6), 1, 1)
    for command, thrust, low, high, most, least in zip(
        state.commands,
        state.thrusts,
        (-204.0, -204.0, -276.0, -276.0, -21.5, -21.5),
        (204.0, 204.0, 276.0, 276.0, 28.7, 28.7),
        UNITS.of_units("thrust_max"),
        UNITS.of_units("thrust_min"),
        strict=True,
    ):
        share = min(command / high, 1.0) if command > 0.0 else min(command / low, 1.0)
        assert thrust == pytest.approx(share**2 * (most if command > 0.0 else least), rel=1e-6)


def test_load_is_that_of_the_thrusts():
    state = after((1e5, 5e4, 1e6), 1, 1)
    bow, stern, main = state.thrusts[:2], state.thrusts[2:4], state.thrusts[4:]
    assert state.tau_X == pytest.approx(sum(main))
    assert state.tau_Y == pytest.approx(sum(bow) + sum(stern))
    moment = (
        37.0 * bow[0]
        + 35.0 * bow[1]
        - 31.0 * stern[0]
        - 33.0 * stern[1]
        + 6.0 * (main[0] - main[1])
    )
    assert state.tau_N == pytest.approx(moment)


def test_main_propellers_get_one_command_with_either_number_of_signals():
    """Of allocator 1 both are one network: each output has weights of its own, and the targets are the same."""
    six, five = after((1e5, 2e4, 0.0), 1, 1, 6), after((1e5, 2e4, 0.0), 1, 1, 5)
    assert six.commands == pytest.approx(five.commands) and six.commands[4] == pytest.approx(
        six.commands[5]
    )
    *_, port, starboard = after((1e5, 2e4, 0.0), 3, 2, 5).commands
    assert port == starboard


def test_allocator_1_answers_at_once_and_allocator_2_over_steps():
    request = (2e5, 0.0, 0.0)
    first, later = after(request, 1, 1).commands[4], after(request, 2, 1).commands[4]
    assert first == later > 5.0
    slow = [after(request, steps, 2).commands[4] for steps in (1, 5, 40)]
    assert 0.0 < slow[0] < 0.5 * first and slow[0] < slow[1] < slow[2]


@pytest.mark.parametrize("allocator", [1, 2])
def test_nothing_holds_either_allocator_to_the_rates(allocator):
    """A step of the request moves the pitch by far more than the 1.44 deg/s that the thruster follows."""
    assert after((2e5, 0.0, 0.0), 1, allocator).commands[4] > 10.0 * 1.44 * 0.05


def test_a_missing_unit_gets_nothing_and_nobody_takes_over():
    whole, without = (
        after((0.0, 1e5, 3e6), 1, 1),
        after((0.0, 1e5, 3e6), 1, 1, available=(False, *ALL[1:])),
    )
    assert without.commands[0] == without.thrusts[0] == 0.0 and without.saturated
    assert without.commands[1:] == whole.commands[1:]


def test_a_command_beyond_the_exercise_is_said_to_be_saturated():
    assert after((2e6, 0.0, 0.0), 1, 1).saturated and not after((1e4, 0.0, 0.0), 1, 1).saturated
