"""At night: the exercise of paper I's allocators is what its scenario gives."""

import gzip

import pytest
from learn.test_paper_i import check_weights, exercise

from shipcosim.learn import paper_i


def test_exercise_is_what_its_scenario_gives(root, tmp_path):
    import importlib.util

    from shipcosim.series import write_table

    spec = importlib.util.spec_from_file_location(
        "write_exercise", root / "docs" / "generators" / "write_exercise.py"
    )
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    write_table(script.training_set(script.exercise()), tmp_path / "exercise.csv")
    assert (tmp_path / "exercise.csv").read_bytes() == gzip.decompress(paper_i.RECORD.read_bytes())


@pytest.mark.parametrize("kind", paper_i.RECIPES)
def test_shipped_weights_of_five_signals_are_what_training_gives_again(kind, exercise):
    check_weights(kind, 2, 5, exercise)
