"""At night: every scenario with compiled models against Python."""

import pytest
from cosim.engines.test_native import both, by_python, compiler, far_off

from shipcosim.scenario import read_scenario

AMPLIFIES = {
    "box_qp.py",
    "sqp.py",
}  # an optimiser's iterations turn rounding of its inputs into 1e-9 of its outputs


def test_every_scenario_is_that_of_python_but_for_rounding(root):
    off = {}
    for path in sorted((root / "scenarios").rglob("*.toml")):
        scenario = read_scenario(path)
        python, native = both(scenario, min(scenario.stop_time, 120.0))
        if not any(name in text for name in AMPLIFIES for text in by_python(native).values()):
            off |= {
                f"{path.stem}: {name}": value for name, value in far_off(python, native).items()
            }
    assert not off
