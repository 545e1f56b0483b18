"""The training loop: it learns, it repeats itself bit by bit, and it knows when to stop."""

from dataclasses import replace

import numpy as np
import torch

from shipcosim.learn import paper_v
from shipcosim.learn.results import Trained, npz_bytes, report_of, write_trained
from shipcosim.learn.training import Schedule, fit, repeatable

TINY = replace(
    paper_v.RECIPES["paper-v"],
    batches=20,
    sequences=4,
    samples=16,
    schedule=Schedule(most_epochs=2),
)


def quiet(done, total):
    pass


def test_a_second_training_gives_the_same_bytes():
    one, two = (paper_v.train(TINY, quiet) for _ in range(2))
    assert npz_bytes(one.arrays) == npz_bytes(two.arrays)
    assert one.epochs == two.epochs


def test_another_seed_gives_other_weights():
    other = replace(TINY, schedule=replace(TINY.schedule, seed=2))
    assert npz_bytes(paper_v.train(TINY, quiet).arrays) != npz_bytes(
        paper_v.train(other, quiet).arrays
    )


def fitted(held_out, most_epochs=50):
    """Epochs of a straight line through the origin, which has to become steeper, and the line."""
    inputs = torch.linspace(-1.0, 1.0, 32).reshape(4, 8, 1)
    with repeatable(1):
        line = torch.nn.Linear(1, 1, bias=False)
        torch.nn.init.zeros_(line.weight)

        def losses(batch):
            x, y = batch
            return {"error": ((line(x) - y) ** 2).mean()}

        batches = [(x, 3.0 * x) for x in inputs]
        schedule = Schedule(learning_rate=0.05, most_epochs=most_epochs)
        return fit(
            line, losses, batches, [(inputs[0], held_out * inputs[0])], schedule, quiet
        ), line.weight.item()


def test_it_finds_a_straight_line():
    epochs, slope = fitted(held_out=3.0)
    assert abs(slope - 3.0) < 0.01 and epochs[-1]["held out"] < 1e-3 < epochs[0]["held out"]


def test_it_stops_when_held_out_data_has_not_improved_for_three_epochs_and_keeps_the_best():
    epochs, slope = fitted(held_out=1.0)
    losses = [epoch["held out"] for epoch in epochs]
    assert len(epochs) < 50 and int(np.argmin(losses)) == len(epochs) - 4
    assert abs(slope - 1.0) < 0.2


def test_progress_counts_mini_batches():
    told = []
    paper_v.train(TINY, lambda done, total: told.append((done, total)))
    assert told == [(count, 36) for count in range(1, 37)]


def test_the_report_says_what_there_is_to_say(tmp_path):
    trained = Trained(
        {"a": np.ones(3)},
        "A line.",
        7,
        {"samples": 3},
        {"rate": 0.1},
        [{"training": 2.0, "held out": 1.5}],
        ["Note."],
    )
    files = write_trained(trained, tmp_path, "line", time=12.0, processor_time=10.0)
    assert [file.name for file in files] == ["line.npz", "line.json", "line.md"]
    page = files[2].read_text(encoding="utf-8")
    for text in (
        "A line.",
        "Note.",
        "seed 7",
        "12 s by the clock",
        "| samples | 3 |",
        "| 1 | 2 | 1.5 |",
        "torch",
    ):
        assert text in page
    assert report_of(trained, "line")["epochs"] == [{"training": 2.0, "held out": 1.5}]
    with np.load(files[0]) as found:
        np.testing.assert_array_equal(found["a"], np.ones(3))
