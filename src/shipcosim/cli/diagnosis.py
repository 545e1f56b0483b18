"""The command `diagnose`: from a measured log to its findings, the extended system, the gain and the page."""

import hashlib
import json
import tempfile
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

from shipcosim.cli.project import build_stale, check_is_system, find_project
from shipcosim.errors import Problem, ShipcosimError, suggestion

DEFAULT_SYSTEM = "gunnerus_open"
FILES = ("diagnosis.json", "report.html", "extended.ssp", "extended.ssv")
LINKS = (
    "1 of 5",
    "2 of 5: what does the simulation get wrong",
    "3 of 5: extending the system",
    "4 of 5: the gain, by co-simulation",
    "5 of 5: writing the page",
)


def find_system(given=None):
    """Path of the system that a log is held against.

    Parameters
    ----------
    given : str, optional
        A path, or the name of a system in the project's ssp/; the open Gunnerus without.

    Raises
    ------
    ShipcosimError
        If there is none.
    """
    if given is not None and Path(given.partition("#")[0]).exists():
        check_is_system(given)
        return given
    project = find_project(Path.cwd())
    folder = (project or Path.cwd()) / "ssp"
    name = given or DEFAULT_SYSTEM
    if (folder / name / "SystemStructure.ssd").is_file():
        return str(folder / name)
    known = [path.parent.name for path in sorted(folder.glob("*/SystemStructure.ssd"))]
    remedy = f"In {folder} there{suggestion(name, known).removeprefix('There')}" if known else "Give one with --system."
    raise ShipcosimError(Problem(name, "There is no such system.", remedy))


def default_folder(data):
    """Where results go without --out.

    Examples
    --------
    >>> default_folder("logs/monday.csv.gz").as_posix()
    'results/monday'
    """
    return Path("results") / Path(Path(data).name.removesuffix(".gz")).stem


def diagnose_log(data, folder, *, system=None, channels=None, effects=None):
    """Diagnose a log and write all that there is to say of it.

    Parameters
    ----------
    data : path
    folder : Path
        Gets diagnosis.json and report.html, and where a cause in the model was named extended.ssp and extended.ssv.
    system : str, optional
        As for `find_system`.
    channels, effects : path, optional
        As for `shipcosim.diagnose.pipeline.find_causes`.

    Returns
    -------
    Story
        With the findings, and everything on the page.

    Raises
    ------
    ShipcosimError
        Input that cannot be used; nothing is written then.
    """
    from shipcosim.cli.results import staged
    from shipcosim.diagnose.pipeline import find_causes
    from shipcosim.report.diagnosis.page import write_diagnosis
    from shipcosim.report.diagnosis.story import Story
    from shipcosim.ssp import read_system

    _check_inputs(data, channels, effects)
    given = find_system(system)
    project = find_project(Path(given.partition("#")[0]))
    fmus = [build_stale(project)] if project else []
    ship = read_system(given, fmus=fmus)
    with _progress() as link:
        link(LINKS[0])
        with _named_by(data):
            say = lambda doing: link(f"{LINKS[0]}: {doing}")  # noqa: E731
            diagnosis = find_causes(data, ship, channels, effects, say)
        link(LINKS[1])
        story = _with_errors(Story(diagnosis, diagnosis.basis, Path(data).name, ship))
        with staged(folder) as stage:
            link(LINKS[2])
            story = _extended(story, given, stage, _about(data, story.details), effects, fmus)
            link(LINKS[3])
            story = _simulated(story, given, effects, fmus, link)
            link(LINKS[4])
            text = json.dumps(story.diagnosis.as_json(), indent=2, ensure_ascii=False, allow_nan=False)
            (stage / "diagnosis.json").write_text(text + "\n", encoding="utf-8")
            write_diagnosis(story, stage / "report.html")
            written = {path.name for path in stage.iterdir()}
    for name in set(FILES) - written:  # of an earlier diagnosis
        (folder / name).unlink(missing_ok=True)
    if story.extension is not None:
        at_home = {kind: folder / f"extended.{kind}" for kind in ("ssp", "ssv")}
        story = replace(story, extension=replace(story.extension, **at_home))
    return story


def _check_inputs(data, channels, effects):
    problems = []
    for path, what in ((data, "file of measured data"), (channels, "channel file")):
        if path is not None and not Path(path).is_file():
            problems.append(Problem(str(path), f"There is no such {what}.", "Give the path of one."))
    if effects is not None and not Path(effects).is_dir():
        problems.append(Problem(str(effects), "There is no such folder of causes.", "Give the path of one."))
    if problems:
        raise ShipcosimError(problems)


@contextmanager
def _named_by(data):
    """Errors of the log carry the name of its file."""
    try:
        yield
    except ShipcosimError as error:
        problems = [replace(p, where=str(data)) if p.where == "log" else p for p in error.problems]
        raise ShipcosimError(problems) from error


def _about(data, details):
    """What the extension says of the log: its name and fingerprint, first and last time."""
    time = details.explained.identification.repaired["time"].values
    fingerprint = hashlib.sha256(Path(data).read_bytes()).hexdigest()
    return {"source": Path(data).name, "sha256": fingerprint, "span": (float(time[0]), float(time[-1]))}


def _is_named(diagnosis):
    return diagnosis.verdict == "named" and any(finding.kind == "physics" for finding in diagnosis.findings)


def _with_errors(story):
    """Errors of predictions, and the force that the model lacks."""
    from shipcosim.diagnose.validation.conditions import compare_unseen
    from shipcosim.diagnose.validation.gain import baseline, compare, gain
    from shipcosim.diagnose.validation.missing_force import missing_force

    details, named = story.details, _is_named(story.diagnosis)
    problem, fit = details.problem, details.fit
    if not named:
        fit = next(one for one in details.fits if not one.hypotheses)
    comparison = compare(problem, fit)
    diagnosis = story.diagnosis
    if comparison is not None:
        errors = comparison.errors
        diagnosis = replace(diagnosis, baseline=baseline(errors), gain=gain(errors) if named else None)
    force = missing_force(problem, problem.model, problem.motion)
    left = missing_force(problem, fit.model, fit.motion) if named else None
    unseen = compare_unseen(problem, fit) if named and comparison is not None else {}
    story = replace(story, diagnosis=diagnosis, comparison=comparison, force=force, force_left=left)
    return replace(story, unseen=unseen, unseen_errors={name: one.errors for name, one in unseen.items()})


def _extended(story, given, stage, about, effects, fmus):
    """The system with the named causes in it, where there are any."""
    from shipcosim.diagnose.extension.extend import extend
    from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
    from shipcosim.ssp import read_system

    findings = [finding for finding in story.diagnosis.findings if finding.kind == "physics"]
    if not findings:
        return story
    try:
        extension = extend(given, findings, stage, log_attributes=about, catalogue=read_catalogue(effects))
        return replace(story, extension=extension, extended=read_system(str(extension.ssp), fmus=fmus))
    except ShipcosimError as error:
        return replace(story, remarks=(*story.remarks, *(_said("not extended", p) for p in error.problems)))


def _simulated(story, given, effects, fmus, link):
    """The errors again as co-simulations, with what was fitted on the training rows."""
    from shipcosim.diagnose.validation.cosimulation import MOST
    from shipcosim.diagnose.validation.gain import baseline, gain

    if story.comparison is None or (story.comparison.fit.hypotheses and story.extension is None):
        return story
    run = partial(_co_simulated, story, given, effects, fmus, lambda n, of: link(LINKS[3], n, of))
    try:
        errors = run(story.comparison, MOST)
        unseen = {name: run(one, MOST // 2) for name, one in story.unseen.items()}
    except ShipcosimError as error:
        return replace(story, remarks=(*story.remarks, *(_said("not co-simulated", p) for p in error.problems)))
    named = story.diagnosis.gain is not None
    diagnosis = replace(story.diagnosis, baseline=baseline(errors), gain=gain(errors) if named else None)
    return replace(story, diagnosis=diagnosis, simulated=errors, unseen_errors=unseen)


def _co_simulated(story, given, effects, fmus, progress, comparison, most):
    """Errors of one comparison, by the system and by the one extended by what it was fitted with."""
    from shipcosim.diagnose.extension.extend import extend
    from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
    from shipcosim.diagnose.validation.cosimulation import Replayed, simulated
    from shipcosim.ssp import read_system

    extended = None
    with tempfile.TemporaryDirectory(prefix="shipcosim-") as folder:
        if comparison.fit.hypotheses:
            about = {"span": comparison.fit.model.span}
            catalogue = read_catalogue(effects)
            made = extend(given, _findings(comparison.fit), folder, log_attributes=about, catalogue=catalogue)
            extended = Replayed(read_system(str(made.ssp), fmus=fmus), made.signals)
        return simulated(comparison, Replayed(story.system), extended, most=most, progress=progress)


def _findings(fit):
    from shipcosim.diagnose.result import Estimate, Finding

    return [
        Finding(
            hypothesis.cause,
            hypothesis.component,
            parameters={
                of.name: Estimate(fit.values[of.paths[0]] * of.factor, abs(fit.std[of.paths[0]] * of.factor), of.unit)
                for of in hypothesis.parameters
            },
        )
        for hypothesis in fit.hypotheses
    ]


def _said(what, problem):
    return f"The system was {what}: {problem.where}: {problem.found} {problem.remedy}".rstrip()


@contextmanager
def _progress():
    """Which link of the chain is being worked on, on stderr; yields a function of (link, done, in all)."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    columns = [SpinnerColumn(), TextColumn("{task.description}"), BarColumn(bar_width=24), TimeElapsedColumn()]
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("", total=None)

        def link(text, done=None, total=None):
            bar.update(task, description=text, completed=done or 0, total=total)

        yield link


def print_diagnosis(story, folder, as_json):
    """What was found, on stdout."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    from shipcosim.cli.console import shown_path
    from shipcosim.report.diagnosis.key_figures import key_figures
    from shipcosim.report.diagnosis.words import estimate_rows, next_steps, outcome, title, where

    diagnosis = story.diagnosis
    if as_json:
        print(json.dumps(diagnosis.as_json(), indent=2, ensure_ascii=False))
        return
    console = Console(highlight=False, soft_wrap=True)
    verdict = outcome(diagnosis, story.causes)
    style = {"consistent": "bold green", "named": "bold blue"}.get(diagnosis.verdict, "bold red")
    console.print(Text(verdict.word, style=style), Text(verdict.sentence))
    listed = Table(box=None, pad_edge=False, show_header=False)
    for finding in diagnosis.findings:
        name, sure = title(finding.cause, finding.component), f"{100 * finding.probability:.0f} %"
        rows = estimate_rows(finding) if finding.kind == "physics" else []
        for parameter, value, std, unit in rows:
            listed.add_row(name, sure, parameter, f"{value} ± {std} {unit}".rstrip())
            name = sure = ""
        if not rows:
            listed.add_row(name, sure, where(finding), finding.note or ", ".join(finding.channels))
    sections = [("Found", listed if diagnosis.findings else None)]
    sections += [("This log cannot tell apart", _chances(diagnosis.indistinguishable, title))]
    figures = Table(box=None, pad_edge=False, show_header=False)
    for number, text in key_figures(diagnosis):
        figures.add_row(number, text)
    sections += [("Errors", figures if figures.rows else None)]
    silent = ", ".join(title(name).lower() for name in diagnosis.not_testable)
    sections += [("This log could not have shown", Text(silent) if silent else None)]
    sections += [("Remarks", Text("\n".join(story.notes), style="yellow") if story.notes else None)]
    extension = story.extension
    extended = str(shown_path(extension.ssp)) if extension is not None and extension.values else None
    sections += [("What to do next", Text("\n".join(f"- {s}" for s in next_steps(diagnosis, extended, story.causes))))]
    for heading, content in sections:
        if content is not None:
            console.print()
            console.print(Text(heading, style="bold"))
            console.print(content)
    console.print()
    console.print(f"Page: {shown_path(folder / 'report.html')}", markup=False)


def _chances(candidates, title):
    from rich.table import Table

    listed = Table(box=None, pad_edge=False, show_header=False)
    for candidate in candidates:
        listed.add_row(title(candidate.cause, candidate.component), f"{100 * candidate.probability:.0f} %")
    return listed if candidates else None
