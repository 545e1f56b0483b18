"""The answers counted."""

import numpy as np

OUTCOMES = ("right", "wrong", "open", "part", "silent")


def table(answers):
    """Outcomes by source and by number of mistakes, and how often what was said at a probability is right."""
    lines = [f"{'':34}" + "".join(f"{name:>8}" for name in OUTCOMES) + "   of"]
    for source in dict.fromkeys(answer.source for answer in answers):
        for count in (0, 1, 2):
            group = [a for a in answers if a.source == source and len(a.mistakes) == count]
            lines += [_line(f"{source}, {count} mistakes", group)] if group else []
    names = dict.fromkeys(a.mistakes[0] for a in answers if len(a.mistakes) == 1)
    lines += [_line(name, [a for a in answers if a.mistakes == (name,)]) for name in sorted(names)]
    return "\n".join([*lines, *_calibration(answers)])


def _line(name, group):
    return f"{name:34}" + "".join(f"{sum(a.outcome == o for a in group):8}" for o in OUTCOMES) + f"{len(group):5}"


def _calibration(answers):
    said = [(probability, right) for answer in answers for _, probability, right in answer.said]
    for low, high in ((0.0, 0.9), (0.9, 0.99), (0.99, 0.999), (0.999, 1.01)):
        group = [(p, right) for p, right in said if low <= p < high]
        if group:
            mean, right = np.mean(group, axis=0)
            yield f"said at {low:g} to {min(high, 1.0):g}: {len(group)} times, mean {mean:.4f}, right {right:.4f}"
