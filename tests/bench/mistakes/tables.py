"""The answers counted."""

import numpy as np

OUTCOMES = ("right", "wrong", "among", "beside", "part", "silent", "not visible")


def table(answers):
    """Outcomes by source and by number of mistakes, and how often what was said at a probability is right."""
    lines = [
        f"{'':34}" + "".join(f"{name:>{max(8, len(name) + 1)}}" for name in OUTCOMES) + "   of"
    ]
    counts = sorted({len(answer.mistakes) for answer in answers})
    for source in dict.fromkeys(answer.source for answer in answers):
        for count in counts:
            group = [a for a in answers if a.source == source and len(a.mistakes) == count]
            lines += [_line(f"{source}, {count} mistakes", group)] if group else []
    lines += [
        _line(f"all, {count} mistakes", [a for a in answers if len(a.mistakes) == count])
        for count in counts
    ]
    names = dict.fromkeys(a.mistakes[0] for a in answers if len(a.mistakes) == 1)
    lines += [_line(name, [a for a in answers if a.mistakes == (name,)]) for name in sorted(names)]
    return "\n".join([*lines, *_calibration(answers)])


def _line(name, group):
    counts = {outcome: sum(answer.outcome == outcome for answer in group) for outcome in OUTCOMES}
    return (
        f"{name:34}"
        + "".join(f"{n:{max(8, len(o) + 1)}}" for o, n in counts.items())
        + f"{len(group):5}"
    )


def _calibration(answers):
    said = [(probability, right) for answer in answers for _, probability, right in answer.said]
    for low, high in ((0.0, 0.9), (0.9, 0.96), (0.96, 0.98), (0.98, 0.995), (0.995, 1.01)):
        group = [(p, right) for p, right in said if low <= p < high]
        if group:
            mean, right = np.mean(group, axis=0)
            yield f"said at {low:g} to {min(high, 1.0):g}: {len(group)} times, mean {mean:.4f}, right {right:.4f}"
