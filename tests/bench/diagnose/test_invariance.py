"""At night: the same log told otherwise gets the same answer, turned accordingly; no truth is asked."""

import pytest
from diagnose.test_invariance import TURN, agree, answer, drawn

from trial import variants

LATE = 86400.0  # [s]


def same(cause, component, values):
    return cause, component, values


def test_turning_the_earth_leaves_a_thruster_as_it_is(answer):
    turned = answer("azimuth_offset", "turned", lambda log: variants.turned(log, TURN))
    agree(answer("azimuth_offset"), turned, same, 0.5)


def test_another_origin_of_time_changes_nothing(answer):
    later = answer("azimuth_offset", "later", lambda log: variants.shifted(log, LATE))
    agree(answer("azimuth_offset"), later, same, 0.1)


def test_every_second_row_still_names_the_cause(answer):
    agree(
        answer("azimuth_offset"), answer("azimuth_offset", "thinned", variants.thinned), same, 2.0
    )


def test_rows_between_the_rows_still_name_the_cause(answer):
    agree(
        answer("azimuth_offset"),
        answer("azimuth_offset", "thickened", variants.thickened),
        same,
        2.0,
    )


def test_mirroring_the_ship_mirrors_a_tow(answer):
    check_mirrored("tow", answer)


def test_mirroring_the_ship_mirrors_a_turned_thruster(answer):
    check_mirrored("azimuth_offset", answer)


def check_mirrored(cause, answer):
    agree(
        answer(cause), answer(cause, "mirrored", variants.mirrored), variants.mirrored_finding, 0.5
    )
