"""What every room says when it cannot go on: where, what was found, what would be right."""

from dataclasses import dataclass
from difflib import get_close_matches


@dataclass(frozen=True)
class Problem:
    """One finding of a check.

    Parameters
    ----------
    where : str
        File, line and element, as a reader would look it up: ``"dp.ssd, line 84: a.b -> c.d"``.
    found : str
        What is there.
    remedy : str
        What would be right; empty where nothing better than `found` can be said.
    severity : str
        ``"error"``, or ``"remark"`` for what does not stop a run.
    """

    where: str
    found: str
    remedy: str = ""
    severity: str = "error"

    def __str__(self):
        text = f"{self.where}: {self.found}" if self.where else self.found
        return f"{text} {self.remedy}".rstrip()


class ShipcosimError(Exception):
    """Unusable input. Carries all problems that were found, not only the first.

    Parameters
    ----------
    problems : Problem or str or iterable of them
        What is wrong.
    """

    def __init__(self, problems):
        if isinstance(problems, (Problem, str)):
            problems = [problems]
        self.problems = [p if isinstance(p, Problem) else Problem("", p) for p in problems]
        super().__init__("\n".join(str(p) for p in self.problems))


def suggestion(name, known):
    """Remedy for an unknown name: what there is, and the nearest of it.

    Examples
    --------
    >>> suggestion("thrust_comand", ["thrust_cmd"])
    "There is: thrust_cmd. Did you mean 'thrust_cmd'?"
    """
    known = sorted(known)
    if not known:
        return "There is none."
    shown = ", ".join(known[:12]) + (f", ... ({len(known)} in all)" if len(known) > 12 else "")
    close = get_close_matches(name, known, n=1)
    return f"There is: {shown}." + (f" Did you mean '{close[0]}'?" if close else "")
