"""Errors and remarks in one form: where, what was found, what would be right."""

import os
import re
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from difflib import get_close_matches

AnyPath = str | os.PathLike[str]
"""A path as users give it."""
LONGEST_TEXT = 4000  # characters of each part of a problem: a name can be as long as a file
MOST_SHOWN = 100  # problems that anybody reads at once
MOST_NAMES = 20  # that a remedy lists in full
MOST_COMPARED = 1000  # names that a misspelt one is compared with, characters of one that is
LONGEST_NAME = 200


def printable(text: str) -> str:
    r"""A text without characters that control a terminal; they are written as escapes, line ends and tabs stay.

    Texts of files and of FMUs go through here before anybody sees them: they must not colour, clear or retitle a
    terminal, nor turn the direction of writing.

    Examples
    --------
    >>> printable("a\x1b[31mred")
    'a\\x1b[31mred'
    """
    return CONTROLS.sub(lambda match: ascii(match[0])[1:-1], text)


def capitalised(text: str) -> str:
    """A text as it begins a sentence.

    Examples
    --------
    >>> capitalised("too many arguments")
    'Too many arguments'
    """
    return text[:1].upper() + text[1:]


CONTROLS = re.compile(
    r"[\ud800-\udfff\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ufffe\uffff]"
)
"""Characters that control a terminal or that XML cannot hold."""


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
    flaw : bool
        Whether a remark is about something that breaks its standard and can mean one thing only. `--strict` makes it
        an error.
    """

    where: str
    found: str
    remedy: str = ""
    severity: str = "error"
    flaw: bool = False

    def __post_init__(self) -> None:
        for part in ("where", "found", "remedy"):
            text = printable(getattr(self, part))
            if len(text) > LONGEST_TEXT:
                text = f"{text[: LONGEST_TEXT // 2]} ... {text[-LONGEST_TEXT // 4 :]}"
            object.__setattr__(self, part, text)

    @property
    def is_error(self) -> bool:
        """Whether it stops a run."""
        return self.severity == "error"

    def __str__(self) -> str:
        text = f"{self.where}: {self.found}" if self.where else self.found
        return f"{text} {self.remedy}".rstrip()


class ShipcosimError(Exception):
    """Unusable input. Carries all problems that were found, not only the first.

    Parameters
    ----------
    problems : Problem or str or iterable of them
        What is wrong.
    """

    def __init__(self, problems: Problem | str | Iterable[Problem | str]):
        if isinstance(problems, (Problem, str)):
            problems = [problems]
        self.problems = [p if isinstance(p, Problem) else Problem("", p) for p in problems]
        super().__init__("\n".join(map(str, worth_showing(self.problems))))

    @property
    def is_finding(self) -> bool:
        """Whether the work ran and this is what it found, as opposed to input that cannot be used."""
        return False

    def _render_traceback_(self) -> list[str]:
        """What IPython and Jupyter show in place of a traceback: the problems, each on lines of its own."""
        shown = worth_showing(self.problems)
        head = (
            f"{type(self).__name__}: {len(self.problems)} problems"
            if len(shown) > 1
            else type(self).__name__
        )
        return [
            f"\x1b[1;31m{head}\x1b[0m",
            *(f"  {line}" for problem in shown for line in str(problem).splitlines()),
        ]


@contextmanager
def reading(path: AnyPath, remedy: str = "Write or copy it again.") -> Iterator[None]:
    """Turn whatever a library raises while it reads a file into one error that names the file.

    Libraries for zip, HDF5, Parquet, XML and workbooks raise errors of many kinds for damaged files.

    Parameters
    ----------
    path : path
        Of the file, for the message.
    remedy : str
        What helps where the file is damaged.

    Raises
    ------
    ShipcosimError
        Those from inside go through; all others become "cannot be read: ...".
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of libraries, in words and places of theirs
            yield
    except ShipcosimError:
        raise
    except MemoryError as error:
        raise error_at(str(path), "is larger than the memory.", "Read a part of it.") from error
    except Exception as error:
        # The system says what is wrong with the disk or the rights; a library, with the content.
        reason = error.strerror if isinstance(error, OSError) else None
        reason_text = reason or reason_of(error)
        raise error_at(
            str(path), f"cannot be read: {reason_text}.", "" if reason else remedy
        ) from error


def reason_of(error: Exception) -> str:
    """What an error of a library says, in one line.

    Examples
    --------
    >>> reason_of(ValueError("no  number.")), reason_of(KeyError("time"))
    ('no number', "it has no 'time'")
    >>> reason_of(TypeError("'int' object is not iterable"))
    'its parts are of other types than they should be'
    """
    if isinstance(error, (AttributeError, TypeError)):
        return "its parts are of other types than they should be"
    text = " ".join(str(error).split())[:200].rstrip(".") or type(error).__name__
    return f"it has no {text}" if isinstance(error, KeyError) else text


def error_at(where: str, found: str, remedy: str = "") -> ShipcosimError:
    """An error of one problem, to be raised; parameters as of `Problem`.

    Examples
    --------
    >>> print(error_at("gust.toml, line 3", "stop_time = -1.", "Give a time above 0."))
    gust.toml, line 3: stop_time = -1. Give a time above 0.
    """
    return ShipcosimError(Problem(where, found, remedy))


def raise_errors(problems: Iterable[Problem]) -> None:
    """Raise ShipcosimError with the errors among problems, if there are any; remarks pass.

    Examples
    --------
    >>> raise_errors([Problem("dp.ssd", "has no step size.", severity="remark")])
    """
    if errors := [problem for problem in problems if problem.is_error]:
        raise ShipcosimError(errors)


def held_strictly(problems: Iterable[Problem]) -> list[Problem]:
    """The problems, with flaws that have only one meaning as errors.

    Examples
    --------
    >>> [problem.severity for problem in held_strictly([Problem("", "", severity="remark", flaw=True)])]
    ['error']
    """
    return [replace(problem, severity="error") if problem.flaw else problem for problem in problems]


def worth_showing(problems: Iterable[Problem]) -> list[Problem]:
    """As many of the problems as anybody reads, errors before remarks if there are more, and how many others there are.

    Examples
    --------
    >>> [str(problem) for problem in worth_showing([Problem("", str(i)) for i in range(103)])][-2:]
    ['99', 'And 3 more.']
    """
    listed = list(problems)
    if len(listed) <= MOST_SHOWN:
        return listed
    listed.sort(key=lambda problem: not problem.is_error)
    more = Problem(
        "", f"And {len(listed) - MOST_SHOWN} more.", severity=listed[MOST_SHOWN].severity
    )
    return [*listed[:MOST_SHOWN], more]


def suggestion(name: object, choices: Iterable[str]) -> str:
    """Remedy for an unknown name: what there is, and the nearest of it.

    Parameters
    ----------
    name : str
        That was not found. Python callers may give anything, such as a number: it is taken as its text.
    choices : iterable of str
        Names that there are.

    Examples
    --------
    >>> suggestion("thrust_comand", ["thrust_cmd"])
    "There is: thrust_cmd. Did you mean 'thrust_cmd'?"
    """
    name, names = str(name), sorted(filter(None, choices))
    if not names:
        return "There is none."
    # A name that has a comma in it is quoted; a few names more than are usually shown are better than some left out.
    count = len(names) if len(names) <= MOST_NAMES else 12
    shown = ", ".join(f"'{choice}'" if "," in choice else choice for choice in names[:count])
    shown += f", ... ({len(names)} in all)" if len(names) > count else ""
    same = [choice for choice in names[:MOST_COMPARED] if choice.lower() == name.lower()]
    close = (
        same or get_close_matches(name, names[:MOST_COMPARED], n=1)
        if len(name) < LONGEST_NAME
        else ()
    )
    return f"There is: {shown}." + (f" Did you mean '{close[0]}'?" if close else "")


def it_has(name: str, choices: Iterable[str]) -> str:
    """Remedy for an unknown name: the known names, and the nearest one.

    Parameters
    ----------
    name : str
        That was not found.
    choices : iterable of str
        Names that it has.

    Examples
    --------
    >>> it_has("thrust_comand", ["thrust_cmd"])
    "It has: thrust_cmd. Did you mean 'thrust_cmd'?"
    """
    return "It has" + suggestion(name, choices).removeprefix("There is")


def counted(number: int, what: str) -> str:
    """A number of things, for a sentence.

    Examples
    --------
    >>> counted(1, "row"), counted(2, "row")
    ('1 row', '2 rows')
    """
    return f"{int(number)} {what}{'s' if number > 1 else ''}"


def shortened(names: Iterable[object], most: int = 5, between: str = ", ") -> str:
    """Names for a sentence, and how many there are beyond the first ones.

    Examples
    --------
    >>> shortened(["x", "y"]), shortened("abcdefg", 4)
    ('x, y', 'a, b, c, d and 3 more')
    """
    texts = [str(name) for name in names]
    more = f" and {len(texts) - most} more" if len(texts) > most else ""
    return between.join(texts[:most]) + more


@contextmanager
def imported(where: str, found: str, extra: str = "sweep") -> Iterator[None]:
    """For an import of a library that an extra of the package brings.

    Parameters
    ----------
    where, found : str
        As of the problem, where the library is missing.
    extra : str
        That brings it.

    Raises
    ------
    ShipcosimError
        If it is missing, with what to install.
    """
    try:
        yield
    except ImportError:
        raise error_at(where, found, f"Install it: pip install 'shipcosim[{extra}]'.") from None
