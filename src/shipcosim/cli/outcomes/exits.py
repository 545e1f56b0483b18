"""How commands end: what they found in every form that is asked for, their exit codes, errors as a readable block."""

from __future__ import annotations

import functools
import inspect
import io
import os
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from shipcosim.cli.options import Debug
from shipcosim.cli.terminal import say, say_json
from shipcosim.errors import Problem, ShipcosimError, error_at

if TYPE_CHECKING:
    from shipcosim.results.shown import Check, Result

FAILED = 1
UNUSABLE = 2
INTERRUPTED = 130
EXIT_CODES = (
    "Exit codes: 0 done; 1 the work ran and what it checked does not hold; 2 unusable input or arguments; "
    "130 interrupted. --debug with any command shows the traceback of an error."
)
SUMMARY_OF_STEP = "GITHUB_STEP_SUMMARY"
"""Variable with the file that GitHub shows on the page of a job."""


@dataclass(frozen=True)
class Conclusion:
    """Result of a command.

    Attributes
    ----------
    name : str
        Of the scenario, the study, the log: the test suite of JUnit.
    result : Result
        With its outcome, its checks and its JSON.
    show : callable
        Prints it for people.
    folder : Path, optional
        Of the results.
    """

    name: str
    result: Result
    show: Callable[[], object]
    folder: Path | None = None


@dataclass(frozen=True)
class Output:
    """Forms of a command's output, as its options ask for."""

    as_json: bool = False
    quiet: bool = False
    junit: Path | None = None

    @contextmanager
    def working(self) -> Iterator[None]:
        """While the command works: stdout belongs to the JSON, and --quiet wants no progress and no remarks."""
        if self.junit is not None:
            if self.junit.is_dir():
                raise error_at("--junit", f"{self.junit} is a folder.", "Name a file.")
            self.junit.parent.mkdir(parents=True, exist_ok=True)
        with redirect_stderr(io.StringIO()) if self.quiet else nullcontext():
            with redirect_stdout(sys.stderr) if self.as_json or self.quiet else nullcontext():
                yield

    def conclude(self, conclusion: Conclusion) -> None:
        """Print the result; exit code 1 unless it passed, 2 if a part of the input could not be used."""
        from shipcosim.cli.console import print_problems, say_outcome
        from shipcosim.cli.terminal import make_console

        if self.as_json or self.quiet:
            print_problems(conclusion.result.failures)
        if self.as_json:
            say_json(conclusion.result.as_json())  # pyright: ignore[reportAttributeAccessIssue]
        elif self.quiet:
            say_outcome(make_console(soft_wrap=True), conclusion.result.outcome)
        else:
            conclusion.show()
        if self.is_published:
            outcome = conclusion.result.outcome
            self.publish(
                conclusion.name,
                f"{outcome.word} {outcome.sentence}",
                conclusion.result.checks,
                conclusion.folder,
            )
        if not conclusion.result.passed:
            raise typer.Exit(FAILED if conclusion.result.is_usable else UNUSABLE)

    @property
    def is_published(self) -> bool:
        """Whether CI asks for what was checked: a study has many runs."""
        return self.junit is not None or bool(os.environ.get(SUMMARY_OF_STEP))

    def publish(
        self, name: str, sentence: str, checks: Sequence[Check], folder: Path | None = None
    ) -> None:
        """Write the file of --junit, and the summary of the step where GitHub asks for one."""
        from shipcosim.cli.console import shown_path
        from shipcosim.cli.outcomes.junit import junit_xml
        from shipcosim.series import write_file

        where = None if folder is None else shown_path(folder)
        if self.junit is not None:
            write_file(self.junit, junit_xml(name, checks, where))
        page = "" if where is None else (where / "report.html").as_posix()
        add_to_summary(f"{name}: {sentence}", checks, page)


def add_to_summary(heading: str, checks: Sequence[Check], page: str = "") -> None:
    """Add a table to the summary of a step, where GitHub asks for one."""
    from shipcosim.cli.outcomes.junit import markdown

    if summary := os.environ.get(SUMMARY_OF_STEP):
        with open(summary, "a", encoding="utf-8") as file:
            file.write(markdown(heading, checks, page))


def guarded(function: Callable[..., Conclusion | None]) -> Callable[..., None]:
    """A command that says what it found, and whose errors become a readable block on stderr and an exit code.

    It has the option --debug after its own.
    """

    @functools.wraps(function)
    def wrapper(*args: Any, debug: bool = False, **kwargs: Any) -> None:
        flags = {name: kwargs[name] for name in Output.__annotations__ if kwargs.get(name)}
        output = Output(**flags)
        # NumPy's warnings name lines of ours; what overflows is shown as inf, or is an error of its own.
        warnings.simplefilter("ignore", RuntimeWarning)
        try:
            with output.working():
                conclusion = function(*args, **kwargs)
            if conclusion is not None:
                output.conclude(conclusion)
            return
        except typer.Exit:
            raise
        except ShipcosimError as error:
            problems = error.problems
            code = FAILED if error.is_finding else UNUSABLE
            explain(problems, debug)
        except KeyboardInterrupt:
            say("Interrupted.", err=True)
            raise typer.Exit(INTERRUPTED) from None
        except OSError as error:
            # The disk or the rights, not shipcosim: a name that is too long, a folder that nobody may write.
            problems = [Problem(str(error.filename or "system"), f"{error.strerror or error}.")]
            code = UNUSABLE
            explain(problems, debug)
        except Exception as error:
            remedy = "This is a fault of shipcosim. Run the command again with --debug for the traceback."
            problems = [Problem("shipcosim", f"{type(error).__name__}: {error}", remedy)]
            code = UNUSABLE
            explain(problems, debug)
        _publish_errors(function.__name__, problems, output)
        raise typer.Exit(code)

    # typer reads the options of a command from its signature.
    signature = inspect.signature(function, eval_str=True)
    debug = inspect.Parameter(
        "debug", inspect.Parameter.KEYWORD_ONLY, default=False, annotation=Debug
    )
    parameters = [*signature.parameters.values(), debug]
    wrapper.__signature__ = signature.replace(parameters=parameters)  # pyright: ignore[reportAttributeAccessIssue]
    return wrapper


def _publish_errors(command: str, problems: Sequence[Problem], output: Output) -> None:
    """Errors as a test suite: without a file CI would take a run that could not begin for one without tests."""
    if not output.is_published:
        return
    from contextlib import suppress

    from shipcosim.results.shown import Check

    checks = [
        Check(problem.where or command, "error", f"{problem.found} {problem.remedy}".rstrip())
        for problem in problems
    ]
    with suppress(ShipcosimError, OSError):  # the reported error may be that of this file
        output.publish(command, "error", checks)


def explain(problems: Iterable[Problem], debug: bool = False) -> None:
    """Print problems on stderr, with the traceback of the error being handled where asked for."""
    from shipcosim.cli.console import print_problems

    print_problems(problems)
    if debug:
        import traceback

        traceback.print_exc()
