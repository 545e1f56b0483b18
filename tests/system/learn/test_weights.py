"""The weights in the repository are what `shipcosim train allocator` leaves."""

import json
from functools import cache

import numpy as np
import pytest
import torch

from shipcosim.learn import paper_v
from shipcosim.learn.results import markdown
from shipcosim.models.core.networks import empty_memory, evaluate, network_of, read_arrays

KINDS = tuple(paper_v.RECIPES)


class Known(torch.nn.Module):
    """Stands for a network whose outputs are known."""

    def __init__(self, outputs):
        super().__init__()
        self.outputs = torch.from_numpy(outputs).float()

    def forward(self, x):
        return self.outputs


@pytest.fixture
def weights(root):
    return root / "fmus" / "paper_v_allocator" / "weights"


@cache
def drawn(walks):
    return paper_v.data_of(paper_v.RECIPES["paper-v-walks" if walks else "paper-v"])


def data_of(kind):
    return drawn(paper_v.RECIPES[kind].walks)


def report_of(kind, weights):
    return json.loads((weights / f"{kind}.json").read_text(encoding="utf-8"))


def outputs_of(network, inputs):
    """What a network gives for sequences."""
    memory, given = empty_memory(network, inputs.shape[:1]), []
    for k in range(inputs.shape[1]):
        one, memory = evaluate(network, inputs[:, k], memory)
        given.append(one)
    return np.stack(given, 1)


@pytest.mark.parametrize("kind", KINDS)
def test_data_settings_and_pages_are_those_of_the_recipe(kind, weights):
    report, recipe = report_of(kind, weights), paper_v.RECIPES[kind]
    assert report["data"] == json.loads(json.dumps(paper_v._about(recipe, data_of(kind))))
    assert report["settings"] == paper_v._settings(recipe)
    assert report["versions"]["torch"].startswith("2.13.0")
    assert report["processor_time_s"] < 1200.0  # the clock counts what else the machine did
    assert (weights / f"{kind}.md").read_text(encoding="utf-8") == markdown(report)


@pytest.mark.parametrize("kind", ["paper-v", "paper-v-walks"])
def test_weights_have_the_losses_that_their_report_says(kind, weights):
    """On all held-out data, by NumPy, which adds in another order than torch."""
    report, arrays, data = (
        report_of(kind, weights),
        read_arrays(weights / f"{kind}.npz"),
        data_of(kind),
    )
    forces = data.forces[data.trained :].flatten(0, 1)
    code = outputs_of(network_of(arrays, "encoder"), forces.double().numpy())
    network = paper_v.Autoencoder()
    network.encoder, network.decoder = (
        Known(code),
        Known(outputs_of(network_of(arrays, "decoder"), code)),
    )
    mean, std = (paper_v._row(values) for values in (data.mean, data.std))
    found = paper_v.losses(network, forces, k4=paper_v.RECIPES[kind].k4, mean=mean, std=std)
    best = min(report["epochs"], key=lambda epoch: epoch["held out"])
    assert {name: float(one) for name, one in found.items()} == pytest.approx(
        {name: best[name] for name in paper_v.NAMES}, rel=1e-3
    )
