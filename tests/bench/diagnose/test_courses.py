"""At night: a cause that is there for one spell, and one that looks like exchanged labels until it begins."""

import numpy as np
import pytest
from diagnose import twin
from diagnose.test_courses import (
    answer_of,
    test_page_and_words_say_when_it_is_there,
    test_the_cause_is_named_with_its_course,
    test_the_size_over_time_has_the_truth_within_its_band,
)

from shipcosim.diagnose.explanation.course import RAMP, SPELL
from shipcosim.diagnose.pipeline import find_causes
from truth import draw


@pytest.fixture(scope="module")
def answered(tmp_path_factory):
    return answer_of(SPELL, "spell", tmp_path_factory)


def test_a_cause_that_begins_is_not_taken_for_exchanged_labels_before_it(tmp_path):
    """The swap of port and starboard in the first half gains 57 nats over steady causes, the course 112."""
    log = tmp_path / "log.csv"
    draw("hold", 9602, onset=True).save(log)
    (finding,) = find_causes(str(log), twin.system()).findings
    assert finding.label == "thruster_interaction"
    assert finding.segments[0][0] == pytest.approx(1086.0, abs=60.0)


def test_a_growing_loss_is_not_a_steady_one_and_a_varying_current(tmp_path):
    """The shaft turns slower than logged, by more and more. The course alone gains 16 nats over both steady causes."""
    log = draw("hold", 93002, causes=0, minutes=30).log
    (speed,) = (column for column in log.columns if column.startswith("port_rpm"))
    log[speed] *= np.linspace(1.0, 1.3, len(log))
    log.to_csv(tmp_path / "log.csv", index=False)
    (finding,) = find_causes(tmp_path / "log.csv", twin.system()).findings
    assert finding.label == "thrust_loss of port" and finding.course == RAMP
