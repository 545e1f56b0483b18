"""What was said of a log with mistakes in it, held against what is in it."""

import re
from dataclasses import dataclass, replace

import numpy as np
import xarray

from mistakes.mistakes import MISTAKES, POSITION, with_mistakes
from shipcosim.diagnose.log.checks.examine import examine
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.log.repair import read_anew
from shipcosim.diagnose.log.roles import role_of
from shipcosim.errors import ShipcosimError

RATE_NEAR = 0.015  # of a clock: largest error of the logarithm of its rate
PUT_RIGHT = 0.1  # of what a channel changes: how far off it may be once put right
ASKED_UNIT = re.compile(r'Say the unit: (\w+) = \{column = "\w+", unit = "(\w+)"\}')
"""How a refusal asks for the unit of a channel."""


@dataclass(frozen=True)
class Answer:
    """How one log was answered.

    Attributes
    ----------
    source, seed, mistakes, declared
        The log.
    outcome : str
        "right": all mistakes that can be seen are named and put right, and nothing wrong; "wrong": something else is
        named, or the log that is put right is not the right one; "among":
        nothing wrong is named, and of the readings left open one is right; "beside": none of them is; "part": one of
        two is named; "silent": nothing is said; "not visible": the same where no mistake can be seen in the log. A log
        that is refused with the question for a unit is "beside" if another unit is right. Else the question is
        answered, and the rest of the log counts, but as "among" instead of "right": the reader left it open.
    said : tuple of (str, float, bool)
        Each finding in words, its probability, whether it is right; those left open are not among them.
    open : tuple of str
        What was left open, in words, among it the question with which a log was refused.
    hidden : tuple of str
        Mistakes that cannot be seen in the log.
    """

    source: str
    seed: int
    mistakes: tuple[str, ...]
    declared: bool
    outcome: str
    said: tuple
    open: tuple[str, ...]
    hidden: tuple[str, ...] = ()


def as_table(log, declared):
    """The log as a file would be read: with its units in the headers or without."""
    units = {role: role_of(role).unit if declared else "" for role in log}
    columns = {
        role: ("time", values, {"units": units[role]})
        for role, values in log.items()
        if role != "time"
    }
    return read_log(
        xarray.Dataset(columns, {"time": ("time", log["time"], {"units": units["time"]})})
    )


def answered(log, source, seed, names, declared, hidden=()):
    """The answer to a log with some mistakes, of which some cannot be seen."""
    try:
        table = as_table(with_mistakes(log, names), declared)
    except ShipcosimError as refusal:
        return _answered_after_question(refusal, log, source, seed, tuple(names), declared, hidden)
    with np.errstate(all="ignore"):
        found = examine(table)
    expected = [MISTAKES[name] for name in names]
    sure = [finding for finding in found if not getattr(finding, "alternatives", ())]
    left_open = [finding for finding in found if getattr(finding, "alternatives", ())]
    hits = [next((m for m in expected if _is(finding, m)), None) for finding in sure]
    said = tuple(
        (_words(finding), finding.probability, hit is not None)
        for finding, hit in zip(sure, hits, strict=True)
    )
    open_words = tuple(
        f"{_words(finding)} / {' / '.join(finding.alternatives)}" for finding in left_open
    )
    visible = [MISTAKES[name] for name in names if name not in hidden]
    outcome = _outcome(expected, visible, hits, left_open)
    if outcome == "right" and not _is_put_right(log, with_mistakes(log, names), sure, visible):
        outcome = "wrong"
    return Answer(source, seed, tuple(names), declared, outcome, said, open_words, tuple(hidden))


def _answered_after_question(refusal, log, source, seed, names, declared, hidden):
    """The answer to a log that is refused with the question for a unit; any other refusal is raised."""
    question = ASKED_UNIT.search(str(refusal))
    if question is None:
        raise refusal
    reading = "{} is in {}".format(*question.groups())
    remaining = tuple(name for name in names if MISTAKES[name].said != reading)
    if remaining == names:
        return Answer(source, seed, names, declared, "beside", (), (str(refusal),), tuple(hidden))
    # Once the user has given the unit that was asked for, this mistake is gone from the log.
    rest = answered(log, source, seed, remaining, declared, hidden)
    outcome = {"right": "among", "not visible": "among", "silent": "part"}.get(
        rest.outcome, rest.outcome
    )
    return replace(rest, mistakes=names, outcome=outcome, open=(reading, *rest.open))


def _outcome(expected, visible, hits, left_open):
    if any(hit is None for hit in hits):
        return "wrong"
    left = [mistake for mistake in expected if mistake not in hits]
    if left_open:
        return (
            "among" if all(_is_among(finding, left, visible) for finding in left_open) else "beside"
        )
    if not any(mistake in left for mistake in visible):
        return "right" if hits or not expected else "not visible"
    return "part" if hits else "silent"


def _is_put_right(log, wrong, found, visible):
    """Whether the channels that visible mistakes are in are, once put right, those of the right log."""
    clean = read_anew(wrong, found)
    return all(
        _is_near(role, clean[role], log[role]) for mistake in visible for role in mistake.channels
    )


def _is_near(role, clean, right):
    """To a tenth of what the channel changes, headings to 3 degrees; the time base to RATE_NEAR."""
    known = np.isfinite(clean) & np.isfinite(right)
    clean, right = clean[known], right[known]
    if role == "time":
        return abs(np.log(np.ptp(clean) / np.ptp(right))) < RATE_NEAR
    if role == "heading":
        return np.median(np.abs(np.mod(clean - right + 180.0, 360.0) - 180.0)) < 3.0
    if not len(right):
        return True  # what rounding took is not used
    off, size = (
        np.std(one - (np.mean(one) if role in POSITION else 0.0)) for one in (clean - right, right)
    )
    return off < PUT_RIGHT * size


def _is_among(finding, left, visible):
    """Whether a reading says all that is left, but for what cannot be seen."""
    rights = {tuple(left), tuple(mistake for mistake in left if mistake in visible)}
    for reading in (finding.note, *finding.alternatives):
        said = {mistake for mistake in left if mistake.said in reading}
        rest = reading
        for mistake in said:
            rest = rest.replace(mistake.said, "")
        if said and any(said == set(right) for right in rights) and not _says_more(rest):
            return True
    return False


def _says_more(rest):
    """Whether there is more in the words of a reading than joints and the unit that was stated."""
    return any(
        word in rest for word in (" has ", " have ", " is ", " are ", " must ", " pass ", " runs ")
    )


def _is(finding, mistake):
    if (
        finding.cause != mistake.cause
        or set(finding.channels) != set(mistake.channels)
        or finding.segments
    ):
        return False
    if mistake.rate is None:
        return True
    return abs(np.log(finding.parameters["rate"].estimate / mistake.rate)) < RATE_NEAR


def _words(finding):
    rate = finding.parameters.get("rate")
    size = f" {rate.estimate:.4g}" if rate else ""
    where = f" in {len(finding.segments)} parts" if finding.segments else ""
    return f"{finding.cause} {','.join(finding.channels)}{size}{where}: {finding.note}"
