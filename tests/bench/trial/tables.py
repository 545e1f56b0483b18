"""The trial's table: rates with their 95 % intervals by kind of log, each cause's rate, and what was missed."""

import math
from collections import Counter, defaultdict
from dataclasses import dataclass
from typing import Any

import numpy as np

from trial.runs import KINDS, POOR
from trial.scoring import named_rightly, score

UNJUDGED = {"verdict": "error", "findings": []}
Z = 1.959964
LITTLE = 0.95  # of what the observer misses would be missed anyway: next to nothing to remove
CHANCE = 0.975  # of the draws of a bootstrap
SURE = (0.0, 0.5, 0.8, 0.9, 0.95, 1.0)  # edges of the bins of stated probabilities


@dataclass(frozen=True)
class Row:
    """A row of the table.

    Attributes
    ----------
    label : str
    name : str
        Of the set of logs.
    targets : tuple of str
        For trial, work and hold.
    hit : callable
        Of (result, score): whether it counts as a success, or None where it does not count at all.
    cell : callable, optional
        Of the list of (result, score) instead: the cell's text.
    """

    label: str
    name: str
    targets: tuple
    hit: Any = None
    cell: Any = None


def rates(results, name, kind, hit):
    """Successes and tries.

    Parameters
    ----------
    results : list of dict
        As `runs.run` gives them.
    name, kind : str
        Of the set and the kind of log that count.
    hit : callable
        As in `Row`.

    Returns
    -------
    successes, tries : int
    """
    outcomes = [hit(*pair) for pair in _judged(results, name, kind)]
    outcomes = [outcome for outcome in outcomes if outcome is not None]
    return sum(outcomes), len(outcomes)


def interval(successes, tries):
    """Wilson's 95 % interval of a rate.

    >>> [round(end, 3) for end in interval(98, 100)]
    [0.93, 0.994]
    """
    rate, shrink = successes / tries, 1.0 + Z * Z / tries
    centre = rate + Z * Z / (2 * tries)
    half = Z * math.sqrt(rate * (1 - rate) / tries + Z * Z / (4 * tries * tries))
    return max((centre - half) / shrink, 0.0), min((centre + half) / shrink, 1.0)


def _judged(results, name, kind):
    chosen = [result for result in results if result["set"] == name and result["kind"] == kind]
    return [(r, score(r["answer"], r["diagnosis"] or UNJUDGED, r["span"])) for r in chosen]


def _right(result, judged):
    return judged.right


def _precise(result, judged):
    return judged.precise if judged.named else None


def _wrong(result, judged):
    return judged.named and not judged.precise


def _refused(result, judged):
    return (result["error"] or "").startswith("ShipcosimError")


def _crashed(result, judged):
    return result["error"] is not None and not _refused(result, judged)


def _alarm(result, judged):
    return judged.alarm


def _ambiguous(result, judged):
    return judged.verdict == "ambiguous"


def _of_ambiguous(result, judged):
    return judged.contained if judged.verdict == "ambiguous" else None


def _worse(name, after):
    def hit(result, judged):
        gain = (result["diagnosis"] or UNJUDGED).get(name) or {}
        return gain[after] > gain["bias_observer_m"] if after in gain and judged.named else None

    return hit


def _surely_worse(name):
    def hit(result, judged):
        gain = (result["diagnosis"] or UNJUDGED).get(name) or {}
        return gain["chance_worse"] > CHANCE if "chance_worse" in gain and judged.named else None

    return hit


def _needlessly_worse(name):
    """Surely worse than the observer, though a perfect model with one, on the healthy twin, is not."""
    surely_worse = _surely_worse(name)

    def hit(result, judged):
        worse, gain = surely_worse(result, judged), (result["diagnosis"] or UNJUDGED).get(name)
        return worse and gain["twin_observer_m"] <= gain["bias_observer_m"]

    return hit


def _poor_rows(name):
    """Rows of a set of poor logs: what must not happen, and how often they are refused."""
    words, none = name.replace("_", " "), ("0", "0", "0")
    return (
        Row(f"{words}: a wrong name", name, none, _wrong),
        Row(f"{words}: a crash", name, none, _crashed),
        Row(f"{words}: refused", name, ("", "", ""), _refused),
        Row(f"{words}, healthy: a wrong name", f"healthy_{name}", none, _wrong),
    )


def _two_sigma(pairs):
    hits = [inside for _, judged in pairs if judged.right for inside in judged.within.values()]
    return _cell(sum(hits), len(hits))


def _error(pairs):
    errors = [error for _, judged in pairs if judged.right for error in judged.errors.values()]
    return f"{100 * np.median(errors):.1f} % ({len(errors)})" if errors else ""


def _removed(name, after, floor, before="bias_observer_m"):
    def cell(pairs):
        gains = [result["diagnosis"].get(name) or {} for result, judged in pairs if judged.right]
        left = [(gain[before], gain[after], gain[floor]) for gain in gains if after in gain]
        shares = [
            (first - missed) / (first - min(least, missed))
            for first, missed, least in left
            if least < LITTLE * first
        ]
        return f"{100 * np.median(shares):.0f} % ({len(shares)})" if shares else ""

    return cell


def _seconds(pairs):
    seconds = [result["seconds"] for result, _ in pairs]
    return f"{np.median(seconds):.0f} s, at most {max(seconds):.0f} s" if seconds else ""


GAINS = (("DP", "gain", ("95", "90", "")), ("free drift", "drift", ("90", "85", "")))
EXPLAINED = "error at 60 s removed beyond the bias observer, {}, of what the cause explains, median"
NOT_NOISE = "the same, of what is not noise"
ALONE = "the same, the cause without an observer"
SHARE = "share of what a perfect model would gain, {}, {}, median"
SHARED = {"causes": "after_m", "bias observer": "bias_observer_m", "nameless network": "network_m"}


def _gain_rows(place, name, wanted):
    """Rows of one kind of gain: with an observer on both sides, with one only beside the plain model, and shares."""
    none, with_one = ("", "", ""), "after_observer_m"
    return (
        Row(
            EXPLAINED.format(place),
            "drift",
            wanted,
            cell=_removed(name, with_one, "twin_observer_m"),
        ),
        Row(NOT_NOISE, "drift", none, cell=_removed(name, with_one, "noise_floor_m")),
        Row(ALONE, "drift", none, cell=_removed(name, "after_m", "twin_m")),
        Row(
            f"worse than the bias observer: {place}",
            "drift",
            ("2", "2", "2"),
            _worse(name, with_one),
        ),
        Row("the same, by more than chance", "drift", none, _surely_worse(name)),
        Row(
            "and where a perfect model is not worse itself", "drift", none, _needlessly_worse(name)
        ),
        Row(ALONE, "drift", none, _worse(name, "after_m")),
        *(
            Row(
                SHARE.format(place, label),
                "drift",
                none,
                cell=_removed(name, after, "twin_m", "before_m"),
            )
            for label, after in SHARED.items()
        ),
    )


ROWS = (
    Row("right cause named", "one", ("98", "88", "as honest"), _right),
    Row(
        "right, or said not testable",
        "one",
        ("", "", ""),
        lambda r, s: s.right or (s.excused and not s.alarm),
    ),
    Row(
        "in the reported set (before any manoeuvre)",
        "one",
        ("", "", ""),
        lambda r, s: s.contained if s.alarm else None,
    ),
    Row("the same, of ambiguous answers", "one", ("", "", ""), _of_ambiguous),
    Row(
        "in the reported set after the one prescribed manoeuvre",
        "one sailed",
        ("95", "95", "95"),
        lambda r, s: s.contained,
    ),
    Row("the same, right cause named", "one sailed", ("", "", ""), _right),
    Row("right when it names one", "one", ("99", "98", "95"), _precise),
    Row("effects halved: right", "half", ("95", "", ""), _right),
    Row("20 minutes of log: right", "short", ("95", "", ""), _right),
    Row("with an onset: right", "onset", ("", "", ""), _right),
    Row("false alarm on healthy data", "healthy", ("1", "2", "2"), _alarm),
    Row("the same, a cause named", "healthy", ("1", "2", "2"), lambda r, s: s.named),
    Row("not in the catalogue: unknown", "unknown", ("95", "75", "70"), _right),
    Row("the same, a wrong name", "unknown", ("", "", ""), lambda r, s: s.named),
    Row("two causes: both named, nothing else", "two", ("86", "60", ""), _right),
    Row("two causes: right when it names", "two", ("", "", ""), _precise),
    Row("faults of the data named", "data", ("", "", ""), _right),
    Row("the same, with segment", "data", ("95", "95", "95"), lambda r, s: s.right and s.located),
    Row("parameter error, median", "one", ("5", "7", ""), cell=_error),
    Row("within two sigma", "one", ("90-97", "90-97", ""), cell=_two_sigma),
    *(row for place, name, wanted in GAINS for row in _gain_rows(place, name, wanted)),
    Row("twice the mismatch: right", "mismatch", ("", "", ""), _right),
    Row("twice the mismatch: right when it names one", "mismatch", ("99", "98", "95"), _precise),
    Row(
        "twice the mismatch: false alarm on healthy data", "healthy_mismatch", ("", "", ""), _alarm
    ),
    Row("rough ship: right", "rough", ("", "", ""), _right),
    Row("rough ship: right when it names one", "rough", ("99", "98", "95"), _precise),
    Row("rough ship: false alarm on healthy data", "healthy_rough", ("", "", ""), _alarm),
    Row("another form: right", "form", ("60", "60", ""), _right),
    Row("another form: right when it names one", "form", ("95", "95", ""), _precise),
    Row("another form: false alarm on healthy data", "healthy_form", ("5", "5", ""), _alarm),
    Row("another form, with a reference: right", "form_reference", ("85", "85", ""), _right),
    Row(
        "another form, with a reference: right when it names one",
        "form_reference",
        ("98", "98", ""),
        _precise,
    ),
    Row(
        "another form, with a reference: false alarm on healthy data",
        "healthy_form_reference",
        ("2", "2", ""),
        _alarm,
    ),
    Row(
        "a wrong clock beside a cause: both named, nothing else", "clock", ("86", "60", ""), _right
    ),
    Row("the same, a wrong name", "clock", ("", "", ""), _wrong),
    Row("a few minutes in which causes look alike: ambiguous", "alike", ("", "", ""), _ambiguous),
    Row("the same, a wrong name", "alike", ("", "", ""), _wrong),
    Row(
        "the same, in the reported set, of ambiguous answers", "alike", ("", "", ""), _of_ambiguous
    ),
    Row(
        "after the one prescribed manoeuvre: right cause named",
        "alike sailed",
        ("", "", ""),
        _right,
    ),
    Row(
        "the same, in the reported set",
        "alike sailed",
        ("95", "95", "95"),
        lambda r, s: s.contained,
    ),
    Row("the same, a wrong name", "alike sailed", ("", "", ""), _wrong),
    *(row for name in POOR for row in _poor_rows(name)),
    Row("time", "one", ("30 s", "30 s", "60 s"), cell=_seconds),
)


LEADING = {
    "right cause named": "the hidden cause is named, and nothing else",
    "right when it names one": "what is named is right",
    "false alarm on healthy data": "a healthy ship is called wrong",
    EXPLAINED.format(
        "DP"
    ): "of the error at 60 s that the cause explains, the extended model removes",
    "another form: right": "the hidden cause of a ship of another form than the model is named, and nothing else",
    "another form: right when it names one": "what is named of her is right",
    "another form: false alarm on healthy data": "a healthy ship of another form is called wrong",
}
"""The rows that matter most, in plain words; the first row of a label counts."""


def leading(results):
    """The figures that matter, as Markdown; takes what `table` takes."""
    lines = ["| | " + " | ".join(KINDS) + " |", "|---|" + "---|" * len(KINDS)]
    for label, words in LEADING.items():
        row = next(row for row in ROWS if row.label == label)
        lines.append(
            f"| {words} | " + " | ".join(content(row, results, kind) for kind in KINDS) + " |"
        )
    return "\n".join(lines)


def table(results):
    """The whole table as Markdown.

    Parameters
    ----------
    results : list of dict
        As `runs.run` gives them.

    Returns
    -------
    str
    """
    heads = [f"{kind} (wanted)" for kind in KINDS]
    lines = ["| | " + " | ".join(heads) + " |", "|---|" + "---|" * len(KINDS)]
    for row in ROWS:
        cells = [content(row, results, kind) for kind in KINDS]
        if any(cells):
            wanted = [
                f" ({target})" if cell and target else ""
                for cell, target in zip(cells, row.targets, strict=True)
            ]
            lines.append(f"| {row.label} | " + " | ".join(map(str.__add__, cells, wanted)) + " |")
    parts = lines, calibration(results), _causes(results), _misses(results)
    return "\n".join([_heading(results), *(line for part in parts for line in ("", *part))])


def content(row, results, kind):
    """A cell of the table: of a `Row` and a kind of log; empty where no log counts."""
    if row.cell:
        return row.cell(_judged(results, row.name, kind))
    return _cell(*rates(results, row.name, kind, row.hit))


def _cell(successes, tries):
    if not tries:
        return ""
    low, high = interval(successes, tries)
    return f"{100 * successes / tries:.1f} % [{100 * low:.0f}, {100 * high:.0f}] of {tries}"


def _heading(results):
    seeds, versions = (
        [result["seed"] for result in results],
        sorted({result["version"] for result in results}),
    )
    errors = sum(result["error"] is not None for result in results)
    return (
        f"{len(results)} logs, seeds {min(seeds)} to {max(seeds)}, version {', '.join(versions)}; {errors} ended in an"
        " error (counted as misses). Rates with Wilson's 95 % interval and the number of logs that count."
    )


def calibration(results):
    """How often what was named with some probability was hidden in the log, as lines of a table in Markdown.

    Parameters
    ----------
    results : list of dict
        As `runs.run` gives them, of all sets.

    Returns
    -------
    list of str
    """
    edges = [f"{low:g} to {high:g}" for low, high in zip(SURE[:-1], SURE[1:], strict=True)]
    bins = {name: [] for name in (*edges, "faults of the data")}
    for result in results:
        for finding, right in named_rightly(result["answer"], result["diagnosis"] or UNJUDGED):
            sure, data = finding["probability"], finding["kind"] == "data"
            place = -1 if data else min(np.searchsorted(SURE, sure, side="right"), len(edges)) - 1
            [*bins.values()][place].append((sure, right))
    lines = [
        "| causes named with probability | named | mean probability | right |",
        "|---|---|---|---|",
    ]
    for name, found in bins.items():
        if found:
            sure, right = np.transpose(found)
            lines.append(
                f"| {name} | {len(found)} | {sure.mean():.2f} | {_cell(int(right.sum()), right.size)} |"
            )
    return lines


def _causes(results):
    """Rate of each cause in the set of single causes."""
    counts = defaultdict(Counter)
    for kind in KINDS:
        for result, judged in _judged(results, "one", kind):
            cause = result["answer"][0]["cause"]
            counts[cause].update({f"{kind} all": 1, kind: int(judged.right)})
    lines = [
        "| right, of single causes | " + " | ".join(KINDS) + " |",
        "|---|" + "---|" * len(KINDS),
    ]
    for cause in sorted(counts):
        cells = [
            f"{counts[cause][k]} of {counts[cause][f'{k} all']}"
            if counts[cause][f"{k} all"]
            else ""
            for k in KINDS
        ]
        lines.append(f"| `{cause}` | " + " | ".join(cells) + " |")
    return lines


def _misses(results):
    """What was answered instead, how often, with the seeds."""
    found = defaultdict(list)
    for result in results:
        judged = score(result["answer"], result["diagnosis"] or UNJUDGED, result["span"])
        if not judged.right:
            found[result["kind"], result["set"], hidden_name(result), answered_name(result)].append(
                result["seed"]
            )
    lines = ["| kind, set | hidden | answered | seeds |", "|---|---|---|---|"]
    for (kind, name, hidden, answered), seeds in sorted(found.items()):
        lines.append(
            f"| {kind}, {name} | {hidden} | {answered} | {', '.join(map(str, sorted(seeds)))} |"
        )
    return lines


def hidden_name(result):
    """What is hidden in a log, in words."""
    return " + ".join(_words(answer) for answer in result["answer"]) or "nothing"


def answered_name(result):
    """What was answered, in words."""
    diagnosis = result["diagnosis"]
    if diagnosis is None:
        return f"error: {result['error'][:80]}"
    named = " + ".join(_words(finding) for finding in diagnosis["findings"])
    beside = ", ".join(
        _words(candidate) for candidate in diagnosis.get("indistinguishable", [])[:4]
    )
    return " ".join(
        part for part in (diagnosis["verdict"], named, f"({beside})" if beside else "") if part
    )


def _words(entry):
    parts = [entry["cause"], entry["component"] or ""]
    if entry["cause"] in ("frame", "sign", "channel_swap"):
        parts.append("/".join(entry.get("channels", ())))
    if entry["cause"] in ("unknown", "gap", "frame"):
        parts.append(entry.get("note", "")[:30])
    return " ".join(filter(None, parts)).replace("|", "/")
