"""Networks in torch, and their weights as the arrays that `shipcosim.models.core.networks` evaluates."""

import numpy as np
import torch

Arrays = dict[str, np.ndarray]


class Recurrent(torch.nn.Module):
    """LSTM layers of one width, and a dense layer without activation.

    Parameters
    ----------
    inputs, width, layers, outputs : int
        Inputs, units of each LSTM layer, number of LSTM layers, outputs. [1]
    dropout : float
        Share of the last LSTM layer's outputs that is left out in training. [1]
    """

    def __init__(self, inputs: int, width: int, layers: int, outputs: int, dropout: float = 0.0):
        super().__init__()
        self.lstm = torch.nn.LSTM(inputs, width, layers, batch_first=True)
        self.dropout = torch.nn.Dropout(dropout) if dropout > 0.0 else torch.nn.Identity()
        self.dense = torch.nn.Linear(width, outputs)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        """Outputs for sequences that begin with an empty memory.

        Parameters
        ----------
        x : (sequences, samples, inputs) tensor
            Inputs. [1]

        Returns
        -------
        (sequences, samples, outputs) tensor
            Outputs. [1]
        """
        return self.dense(self.dropout(self.lstm(x)[0]))


def arrays_of(network: Recurrent, name: str) -> Arrays:
    """Weights of a network.

    Parameters
    ----------
    network : Recurrent
        The network.
    name : str
        Its name, before those of the arrays.

    Returns
    -------
    dict of str to array
        ``NAME.lstm.1.weights`` (4 width, inputs + width) for inputs and memory, ``NAME.lstm.1.bias`` (4 width,), the
        gates in the order input, forget, cell, output; the same of the other layers; ``NAME.dense.weights`` and
        ``NAME.dense.bias``. [1]
    """
    arrays: Arrays = {}
    for layer in range(network.lstm.num_layers):
        # PyTorch keeps separate weights and biases for input and memory; join them for evaluation.
        of = {key: getattr(network.lstm, f"{key}_l{layer}").detach().numpy() for key in KEYS}
        weights = np.concatenate([of["weight_ih"], of["weight_hh"]], axis=1)
        arrays[f"{name}.lstm.{layer + 1}.weights"] = weights
        # Both biases enter only as their sum.
        arrays[f"{name}.lstm.{layer + 1}.bias"] = of["bias_ih"] + of["bias_hh"]
    arrays[f"{name}.dense.weights"] = network.dense.weight.detach().numpy().copy()
    arrays[f"{name}.dense.bias"] = network.dense.bias.detach().numpy().copy()
    return arrays


KEYS = ("weight_ih", "weight_hh", "bias_ih", "bias_hh")
