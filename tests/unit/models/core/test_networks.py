"""Networks in NumPy: what torch gives, and what closed forms say."""

import numpy as np
import pytest

from shipcosim.models.core.networks import (
    Layer,
    Memory,
    dense,
    empty_memory,
    evaluate,
    lstm_step,
    network_of,
)


def test_a_cell_whose_gates_are_open_sums_what_comes_in():
    """All gates open, a cell that takes its input as it is: the contents grow by tanh(x) a sample."""
    layer = Layer(
        np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 0.0]]),
        np.array([50.0, 50.0, 0.0, 50.0]),
    )
    memory = Memory(np.zeros(1), np.zeros(1))
    for count in range(1, 5):
        memory = lstm_step(np.array([0.3]), memory, layer)
        assert memory.cell == pytest.approx(count * np.tanh(0.3))
        assert memory.output == pytest.approx(np.tanh(count * np.tanh(0.3)))


def test_a_closed_forget_gate_leaves_no_memory():
    layer = Layer(
        np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 0.0]]),
        np.array([50.0, -50.0, 0.0, 50.0]),
    )
    found = lstm_step(np.array([0.3]), Memory(np.array([0.7]), np.array([9.0])), layer)
    assert found.cell == pytest.approx(np.tanh(0.3))


def test_a_dense_layer_is_a_matrix_and_a_bias():
    layer = Layer(np.array([[1.0, 2.0], [0.0, -1.0], [3.0, 0.0]]), np.array([0.5, 0.0, -1.0]))
    np.testing.assert_array_equal(dense(np.array([2.0, 1.0]), layer), [4.5, -1.0, 5.0])


def test_many_sequences_at_once_are_each_of_them():
    rng = np.random.default_rng(3)
    arrays = {"net.dense.weights": rng.normal(size=(2, 4)), "net.dense.bias": rng.normal(size=2)}
    arrays |= {
        "net.lstm.1.weights": rng.normal(size=(16, 7)),
        "net.lstm.1.bias": rng.normal(size=16),
    }
    network, inputs = network_of(arrays, "net"), rng.normal(size=(5, 6, 3))
    together, memory = [], empty_memory(network, (5,))
    for k in range(6):
        found, memory = evaluate(network, inputs[:, k], memory)
        together.append(found)
    for number in range(5):
        memory = empty_memory(network)
        for k in range(6):
            found, memory = evaluate(network, inputs[number, k], memory)
            np.testing.assert_allclose(found, together[k][number], rtol=1e-12)
