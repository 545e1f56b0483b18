"""At night: a cause that is there for one spell, by name, course and size over time."""

import pytest
from diagnose.test_courses import (
    answer_of,
    test_page_and_words_say_when_it_is_there,
    test_the_cause_is_named_with_its_course,
    test_the_size_over_time_has_the_truth_within_its_band,
)

from shipcosim.diagnose.explanation.course import SPELL


@pytest.fixture(scope="module")
def answered(tmp_path_factory):
    return answer_of(SPELL, "spell", tmp_path_factory)
