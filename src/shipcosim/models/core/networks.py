"""Trained networks: dense layers and LSTM layers with their memory, from weights as arrays.

References
----------
Hochreiter, Schmidhuber, Long short-term memory, Neural Computation 9, 1997; with the forget gate of Gers, Schmidhuber,
Cummins, Learning to forget, Neural Computation 12, 2000.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np


class Layer(NamedTuple):
    """Weights of a layer.

    Parameters
    ----------
    weights : (outputs, inputs) array
        Of a dense layer. Of an LSTM layer of n units (4 n, inputs + n), for inputs and memory: rows of the input gate,
        the forget gate, the cell and the output gate. [1]
    bias : (outputs,) array
        Added to them. [1]
    """

    weights: np.ndarray
    bias: np.ndarray


class Memory(NamedTuple):
    """State of an LSTM layer between samples.

    Parameters
    ----------
    output, cell : (..., n) array
        Last outputs of the layer, and the contents of its cells. [1]
    """

    output: np.ndarray
    cell: np.ndarray


class Network(NamedTuple):
    """LSTM layers and a dense layer without activation.

    Parameters
    ----------
    lstm : tuple of Layer
        LSTM layers, in their order. [1]
    dense : Layer
        The last layer. [1]
    """

    lstm: tuple[Layer, ...]
    dense: Layer


def read_arrays(path: Path) -> dict[str, np.ndarray]:
    """Read the arrays of an .npz file.

    Parameters
    ----------
    path : Path
        The file. [no unit]

    Returns
    -------
    dict of str to array
        Arrays by their names, in double precision. [as their names say]

    Raises
    ------
    OSError, ValueError
        The file cannot be read, or is no .npz file of numbers.
    """
    with np.load(path, allow_pickle=False) as file:
        return {name: np.asarray(file[name], dtype=float) for name in file.files}


def network_of(arrays: Mapping[str, np.ndarray], name: str) -> Network:
    """A network from its arrays.

    Parameters
    ----------
    arrays : mapping of str to array
        ``NAME.lstm.1.weights``, ``NAME.lstm.1.bias`` and so on for each LSTM layer, ``NAME.dense.weights`` and
        ``NAME.dense.bias``. [1]
    name : str
        Name of the network.

    Returns
    -------
    Network
        [1]

    Raises
    ------
    KeyError
        An array is missing.
    """
    # The number of layers follows from the names of the arrays.
    layers = sum(key.startswith(f"{name}.lstm.") and key.endswith(".bias") for key in arrays)
    names = [*(f"lstm.{number}" for number in range(1, layers + 1)), "dense"]
    *lstm, last = (
        Layer(arrays[f"{name}.{layer}.weights"], arrays[f"{name}.{layer}.bias"]) for layer in names
    )
    return Network(tuple(lstm), last)


def members_of(arrays: Mapping[str, np.ndarray]) -> tuple[Network, ...]:
    """The members of an ensemble from its arrays.

    Parameters
    ----------
    arrays : mapping of str to array
        ``member1.lstm.1.weights`` and so on, as of `network_of`. [1]

    Returns
    -------
    tuple of Network
        [1]
    """
    count = sum(name.startswith("member") and name.endswith("dense.bias") for name in arrays)
    return tuple(network_of(arrays, f"member{number}") for number in range(1, count + 1))


def evaluate_members(
    members: Sequence[Network], x: np.ndarray, memory: Sequence[tuple[Memory, ...]]
) -> tuple[list[np.ndarray], tuple[tuple[Memory, ...], ...]]:
    """Outputs of all members for one sample.

    Parameters
    ----------
    members : sequence of Network
        The networks.
    x : (..., inputs) array
        Inputs. [1]
    memory : sequence of tuples of Memory
        Of the sample before; empty before the first one. [1]

    Returns
    -------
    list of (..., outputs) arrays, and tuple
        Outputs by member; memory after the sample. [1; 1]
    """
    memory = memory or [empty_memory(member, x.shape[:-1]) for member in members]
    pairs = [evaluate(net, x, kept) for net, kept in zip(members, memory, strict=True)]
    return [pair[0] for pair in pairs], tuple(pair[1] for pair in pairs)


def empty_memory(network: Network, shape: tuple[int, ...] = ()) -> tuple[Memory, ...]:
    """Memory before the first sample.

    Parameters
    ----------
    network : Network
        The network.
    shape : tuple of int
        Shape of the inputs before their last axis. [1]

    Returns
    -------
    tuple of Memory
        Zeros for each LSTM layer. [1]
    """
    sizes = [(*shape, len(layer.bias) // 4) for layer in network.lstm]
    return tuple(Memory(np.zeros(size), np.zeros(size)) for size in sizes)


def dense(x: np.ndarray, layer: Layer) -> np.ndarray:
    """A dense layer without activation.

    Parameters
    ----------
    x : (..., inputs) array
        Inputs. [1]
    layer : Layer
        Weights. [1]

    Returns
    -------
    (..., outputs) array
        W x + b. [1]
    """
    return x @ layer.weights.T + layer.bias


def lstm_step(x: np.ndarray, memory: Memory, layer: Layer) -> Memory:
    """One sample of an LSTM layer.

    Parameters
    ----------
    x : (..., inputs) array
        Inputs. [1]
    memory : Memory
        Of the sample before. [1]
    layer : Layer
        Weights. [1]

    Returns
    -------
    Memory
        Outputs of this sample, and contents of the cells. [1]

    Notes
    -----
    The gates are 1/(1 + e^-z) = (1 + tanh(z/2))/2, so that one hyperbolic tangent serves all.
    """
    n = memory.cell.shape[-1]
    # One matrix product gives all four gates.
    z = dense(np.concatenate((x, memory.output), axis=-1), layer)
    # sigmoid(z) = (1 + tanh(z/2)) / 2: halve all but the cell input, then take one tanh.
    z[..., : 2 * n] *= 0.5
    z[..., 3 * n :] *= 0.5
    z = np.tanh(z, out=z)
    into = z[..., :n]
    keep = z[..., n : 2 * n]
    new = z[..., 2 * n : 3 * n]
    out = z[..., 3 * n :]
    # c = f c + i g, with sigmoid gates written by tanh; output = o tanh(c).
    cell = 0.5 * ((1.0 + keep) * memory.cell + (1.0 + into) * new)
    return Memory(0.5 * (1.0 + out) * np.tanh(cell), cell)


def evaluate(
    network: Network, x: np.ndarray, memory: tuple[Memory, ...]
) -> tuple[np.ndarray, tuple[Memory, ...]]:
    """Outputs of a network for one sample.

    Parameters
    ----------
    network : Network
        Weights. [1]
    x : (..., inputs) array
        Inputs. [1]
    memory : tuple of Memory
        Of the sample before, as `empty_memory` before the first. [1]

    Returns
    -------
    tuple of (..., outputs) array and tuple of Memory
        Outputs, memory after this sample. [1, 1]
    """
    # Each layer feeds the next one.
    kept = []
    for layer, before in zip(network.lstm, memory, strict=True):
        kept.append(lstm_step(x, before, layer))
        x = kept[-1].output
    return dense(x, network.dense), tuple(kept)
