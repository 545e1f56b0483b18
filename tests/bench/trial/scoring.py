"""How an answer of the diagnosis is judged by what was hidden in the log.

Definitions
-----------
same name
    The same cause and the same component; port and starboard are two names. Swapped channels and a wrong sign must
    be of the same channels, a wrong frame must share a channel with the hidden one (a pair may be named by one of it).
right
    Healthy log: the verdict is `consistent`. Effect outside the catalogue: `unknown`. Otherwise the verdict is `named`,
    every hidden cause is named, and nothing else is.
named, precise
    The findings hold at least one cause; all of them are hidden in the log.
alarm
    The verdict is not `consistent`. (On healthy logs; `unknown` and `ambiguous` are alarms too.)
contained
    Every hidden cause is among the findings, or among the causes that are said to be indistinguishable.
excused
    Every hidden cause that is missed is listed as not testable.
located
    Each fault of the data is named and its segments overlap with the hidden ones: duration of the intersection over
    that of the union, both widened by 2 s at either end (edges of a log at 1 Hz), is at least one half. No segments
    are the whole log.
error
    Distance of the estimate from the truth over the distance of the truth from neutral, both over all parameters of
    the cause together (a vector is not judged by its components).
within
    For each parameter, whether it is off by less than two of its standard deviations.
"""

from dataclasses import dataclass

import numpy as np

ENOUGH_OVERLAP = 0.5
EDGE = 2.0  # [s]
DATA_FAULTS = ("clock", "gap", "frame", "channel_swap", "sign", "heading_wrap")
NEUTRAL = {"scale": 1.0, "rate": 1.0}
UNITS = {
    "current": "m/s",
    "current_varying": "m/s",
    "wave_drift": "N",
    "tow": "N",
    "wind_direction": "deg",
    "azimuth_offset": "deg",
    "heading_bias": "deg",
    "rpm_offset": "rpm",
    "lever_arm": "m",
    "navigation_lag": "s",
    "thruster_lag": "s",
}


@dataclass(frozen=True)
class Score:
    """What one answer is worth; the module says what each word means.

    Attributes
    ----------
    verdict : str
    right, named, precise, alarm, contained, excused : bool
    overlap : float or None
        Least overlap over the hidden faults of the data; None without such a fault.
    errors : dict of str to float
        By name of each rightly named cause that has parameters.
    within : dict of str to bool
        By name and parameter.
    onset_errors : dict of str to float
        Found minus hidden onset, for hidden onsets. [s]
    """

    verdict: str
    right: bool
    named: bool
    precise: bool
    alarm: bool
    contained: bool
    excused: bool
    overlap: float | None
    errors: dict
    within: dict
    onset_errors: dict

    @property
    def located(self):
        return self.overlap is not None and self.overlap >= ENOUGH_OVERLAP


def score(answers, diagnosis, span):
    """Judge an answer.

    Parameters
    ----------
    answers : sequence of dict
        What is hidden, each as ``dataclasses.asdict`` gives it; empty for a healthy log.
    diagnosis : dict
        Content of diagnosis.json.
    span : (float, float)
        First and last time of the log. [s]

    Returns
    -------
    Score

    Examples
    --------
    >>> hidden = {"cause": "thrust_loss", "component": "port", "parameters": {"loss": 0.2}, "onset": 0.0}
    >>> estimate = {"loss": {"estimate": 0.22, "std": 0.02, "unit": "1"}}
    >>> found = {"cause": "thrust_loss", "component": "port", "parameters": estimate}
    >>> judged = score([hidden], {"verdict": "named", "findings": [found]}, (0.0, 2400.0))
    >>> judged.right, round(judged.errors["thrust_loss port"], 3)
    (True, 0.1)
    >>> score([hidden], {"verdict": "named", "findings": [found | {"component": "starboard"}]}, (0.0, 2400.0)).right
    False
    """
    findings, verdict = diagnosis.get("findings", []), diagnosis["verdict"]
    pairs = _paired(answers, findings)
    nameless = any(answer["cause"] == "unknown" for answer in answers)
    expected = "consistent" if not answers else "unknown" if nameless else "named"
    complete = nameless or (len(pairs) == len(answers) == len(findings))
    missed = [answer for answer in answers if all(answer is not hidden for hidden, _ in pairs)]
    return Score(
        verdict=verdict,
        right=(verdict == expected or not answers and verdict == "form") and complete,
        named=bool(findings),
        precise=bool(findings) and len(pairs) == len(findings),
        alarm=verdict not in ("consistent", "form"),
        contained=all(_listed(answer, diagnosis.get("indistinguishable", [])) for answer in missed),
        excused=all(answer["cause"] in diagnosis.get("not_testable", []) for answer in missed),
        overlap=_least_overlap(answers, pairs, span),
        errors={_name(a): _error(a, f) for a, f in pairs if a["parameters"]},
        within={f"{_name(a)} {k}": _is_within(a, f, k) for a, f in pairs for k in a["parameters"]},
        onset_errors={
            _name(a): (f.get("onset") or 0.0) - a["onset"] for a, f in pairs if a.get("onset")
        },
    )


def named_rightly(answers, diagnosis):
    """Each finding of an answer with whether it is hidden in the log, a hidden cause once.

    Returns
    -------
    list of tuple of dict and bool
    """
    pairs = _paired(answers, diagnosis.get("findings", []))
    return [
        (found, any(found is one for _, one in pairs)) for found in diagnosis.get("findings", [])
    ]


def _paired(answers, findings):
    """Each hidden cause with the finding of the same name, a finding once."""
    left, pairs = list(findings), []
    for answer in answers:
        hits = [finding for finding in left if _same(answer, finding)]
        if hits:
            best = max(hits, key=lambda finding: _overlap(answer, finding, (0.0, 1e6)))
            left.remove(best)
            pairs.append((answer, best))
    return pairs


def _same(answer, finding):
    if (answer["cause"], answer["component"]) != (finding["cause"], finding["component"]):
        return False
    hidden, found = set(answer.get("channels", ())), set(finding.get("channels", ()))
    if answer["cause"] == "frame":
        return bool(hidden & found)
    return answer["cause"] not in ("channel_swap", "sign") or hidden == found


def _listed(answer, candidates):
    name = answer["cause"], answer["component"]
    return any((candidate["cause"], candidate["component"]) == name for candidate in candidates)


def _name(answer):
    return " ".join(part for part in (answer["cause"], answer["component"]) if part)


def _least_overlap(answers, pairs, span):
    faults = [answer for answer in answers if answer["cause"] in DATA_FAULTS]
    if not faults:
        return None
    found = [
        _overlap(answer, finding, span)
        for answer, finding in pairs
        if answer["cause"] in DATA_FAULTS
    ]
    return min(found) if len(found) == len(faults) else 0.0


def _overlap(answer, finding, span):
    hidden, found = _ticks(answer.get("segments"), span), _ticks(finding.get("segments"), span)
    return float((hidden & found).sum() / max((hidden | found).sum(), 1))


def _ticks(segments, span):
    """Which half seconds of a log are in segments."""
    times = np.arange(span[0], min(span[1], span[0] + 1e5) + 0.5, 0.5)
    inside = np.zeros(len(times), bool)
    for start, end in segments or [span]:
        inside |= (times >= start - EDGE) & (times <= end + EDGE)
    return inside


def _error(answer, finding):
    hidden = answer["parameters"]
    off = [_estimate(answer, finding, key)[0] - hidden[key] for key in hidden]
    size = [hidden[key] - NEUTRAL.get(key, 0.0) for key in hidden]
    return float(np.linalg.norm(off) / np.linalg.norm(size))


def _is_within(answer, finding, key):
    estimate, std = _estimate(answer, finding, key)
    return bool(abs(estimate - answer["parameters"][key]) <= 2.0 * std)


def _estimate(answer, finding, key):
    """Estimate and standard deviation of a parameter; not a number where it is missing or in another unit."""
    found, unit = finding["parameters"].get(key), UNITS.get(answer["cause"])
    if found is None or (unit and found["unit"] != unit):
        return np.nan, 0.0
    return found["estimate"], found["std"]
