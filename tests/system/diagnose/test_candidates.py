"""No cause is a sure candidate of an unknown, nor both a candidate and not testable: on craft, trial and real logs."""

from craft import draw as draw_craft

from shipcosim.diagnose.checked_log import ReadLog
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.pipeline import problem_of, verdict_on
from shipcosim.diagnose.statement import stated

SURE = 0.99


def agrees(found):
    """What is said of causes does not contradict itself."""
    candidates = {
        one.cause: one.probability for one in (*found.candidates, *found.indistinguishable)
    }
    said = {*candidates, *(finding.cause for finding in found.findings)}
    assert not said & {*found.not_testable}, found.verdict
    assert found.verdict != "unknown" or all(chance < SURE for chance in candidates.values()), (
        candidates
    )


def of_craft(seed, fault, change):
    drawn = draw_craft(seed, fault=fault, change=change)
    return stated(
        verdict_on(
            problem_of(ReadLog(read_log(drawn.log), drawn.model, read_catalogue())), lambda *_: None
        )
    )


def test_candidates_of_a_drawn_craft_do_not_contradict_what_is_not_testable():
    found = of_craft(203, "exchanged", "none")  # a steady spin, which tells no labels
    agrees(found)
    assert {"channel_swap", "sign"} <= {*found.not_testable}
