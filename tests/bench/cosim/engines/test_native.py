"""At night: every scenario with compiled models against Python."""

from cosim.engines.test_native import CLOSE, OPTIMISED, both, compiler, far_off

from shipcosim.scenario import read_scenario

AMPLIFY = ("optimal", "four_azimuths", "as_printed")
"""In names of scenarios whose allocator enlarges rounding: by equations of an optimiser, by a network's weights of 1e7."""


def test_every_scenario_is_that_of_python_but_for_rounding(root):
    off = {}
    for path in sorted((root / "scenarios").rglob("*.toml")):
        scenario = read_scenario(path)
        python, native = both(scenario, min(scenario.stop_time, 120.0))
        close = OPTIMISED if any(name in path.stem for name in AMPLIFY) else CLOSE
        off |= {f"{path.stem}: {name}": v for name, v in far_off(python, native, close).items()}
    assert not off
