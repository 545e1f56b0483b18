"""Training of paper I's allocators: the exercise it is trained on, the pseudo-inverse, the weights that are shipped."""

import numpy as np
import pytest
from ships import FOLDER, parameters

from shipcosim.learn import paper_i
from shipcosim.models.core.networks import read_arrays
from shipcosim.models.propulsion.mapped import MapParameters

WEIGHTS = FOLDER.parents[1] / "fmus" / "paper_i_allocator" / "weights"
THRUSTERS = ("bow_1", "bow_2", "stern_1", "stern_2", "port", "starboard")


@pytest.fixture(scope="module")
def exercise():
    return paper_i.read_exercise()


def test_exercise_has_the_papers_rows_its_limits_and_its_rates(exercise):
    loads, commands = exercise
    assert loads.shape == (7800, 3) and commands.shape == (7800, 6)
    np.testing.assert_allclose(commands.max(axis=0), [204, 204, 276, 276, 28.7, 28.7])
    np.testing.assert_allclose(commands.min(axis=0), [-204, -204, -276, -276, -21.5, -21.5])
    quickest = np.abs(np.diff(commands, axis=0)).max(axis=0) / 0.05
    np.testing.assert_allclose(
        quickest, [parameters(MapParameters, "osv", name).command_rate for name in THRUSTERS]
    )


def test_thrusters_work_one_after_the_other_but_for_the_main_propellers(exercise):
    _, commands = exercise
    at_work = np.abs(commands[:, :5]) > 0.0
    assert at_work.sum(axis=1).max() <= 1
    np.testing.assert_array_equal(commands[:, 4], commands[:, 5])


def test_output_weights_are_those_of_least_squares(exercise):
    """Among weights of one layer none has a smaller error on what it is trained on."""
    inputs, targets = paper_i.samples(*exercise, 2, 6)
    found = paper_i.fitted(inputs, targets)
    hidden = paper_i.hidden_layer(found, inputs)
    residual = hidden @ found["output"].T - targets
    assert np.abs(hidden.T @ residual).max() < 1e-6 * np.abs(hidden.T @ targets).max()


def test_previous_commands_are_those_of_the_row_before(exercise):
    inputs, targets = paper_i.samples(*exercise, 2, 5)
    assert inputs.shape == (7800, 8) and targets.shape == (7800, 5)
    np.testing.assert_array_equal(inputs[1:, 3:], targets[:-1])


@pytest.mark.parametrize("kind", paper_i.RECIPES)
@pytest.mark.parametrize(("allocator", "signals"), [(1, 6), (2, 6)])
def test_shipped_weights_are_what_training_gives_again(kind, allocator, signals, exercise):
    check_weights(kind, allocator, signals, exercise)


def check_weights(kind, allocator, signals, exercise):
    """The layers are the same digits; outputs agree over the exercise as far as the pseudo-inverse's digits reach."""
    inputs, targets = paper_i.samples(*exercise, allocator, signals)
    trained = paper_i.fitted(inputs, targets, cutoff=paper_i.RECIPES[kind].cutoff)
    every = read_arrays(WEIGHTS / f"{kind}.npz")
    shipped = {name: every[f"{allocator}.{signals}.{name}"] for name in trained}
    for name in ("scale", "hidden", "bias"):
        np.testing.assert_array_equal(trained[name], shipped[name])
    again, before = (
        paper_i.hidden_layer(one, inputs) @ one["output"].T for one in (trained, shipped)
    )
    np.testing.assert_allclose(again, before, atol=1e-3)
