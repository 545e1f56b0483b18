"""At night: the other engines on the whole run of the four corners."""

from cosim.engines.test_engines import agree_on_the_four_corners, engine


def test_engines_agree_on_the_four_corners(root, engine):
    agree_on_the_four_corners(root, engine, stop_time=1100.0)
