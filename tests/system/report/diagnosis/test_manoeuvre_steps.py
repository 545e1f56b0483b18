"""What to sail, step by step."""

import re

import numpy as np

from shipcosim.diagnose.experiment.manoeuvres import Manoeuvre, library
from shipcosim.report.diagnosis.manoeuvre_steps import manoeuvre_steps


def test_manoeuvre_is_told_step_by_step_from_start_to_end(diagnosis):
    model = diagnosis.basis.problem.model
    for manoeuvre in library(model):
        rows = manoeuvre_steps(manoeuvre)
        assert rows[0][0].startswith("0–") and all(doing for _, doing in rows)
        assert max(int(re.search(r"–(\d+) s", when).group(1)) for when, _ in rows) == round(
            60 * manoeuvre.minutes
        )
        assert all(any(push.thruster in doing for _, doing in rows) for push in manoeuvre.pushes)


def test_box_is_told_with_its_corners():
    box = Manoeuvre(
        "box", ((90.0, 30.0, 0.0, 0.0), (90.0, 30.0, 30.0, 0.0), (60.0, 30.0, 30.0, np.pi / 2))
    )
    assert manoeuvre_steps(box) == [
        ("0–90 s", "move to 30 m ahead"),
        ("90–180 s", "move to 30 m ahead and 30 m to starboard"),
        ("180–240 s", "turn to 90° clockwise of the first heading"),
    ]
