"""The diagnosis from end to end. Each stage is a function from one value to the next.

From a log to an identification problem, `problem_of`:

    read_measurements  ReadLog         the log by the roles of its columns, the ship, the catalogue of causes
    checked            CheckedLog      faults of the log that its own channels show, repaired
    compared           ComparedLog     commanded against measured force: what is grossly wrong, corrected
    identified         Identification  the identification problem: noise, linearisation about the ship without a cause

From there to its verdict, `verdict_on`:

    corrected          Identification  faults of the log and of connections that only the ship's response shows
    with_learnt_form   Identification  how far the form of the ship's loads differs from the model's
    with_causes        ExplainedLog    sets of causes fitted to the log
    with_settled_form  ExplainedLog    the model's form after all, where the causes found do without another
    with_right_inputs  ExplainedLog    mislabelled channels of thrusters and wind, which look like causes
    with_course        ExplainedLog    causes that begin, grow, or come and go
    judged             JudgedLog       the verdict, against unmodelled errors and what healthy ships gain
    with_craft         JudgedLog       the craft as the log teaches her, where no cause explains it

From the verdict to the gain, `diagnose`:

    stated             Diagnosis       findings, what this log could not have shown, what to sail next
    with_predictions   PredictedLog    predictions on rows that nothing was fitted on, the force that the model lacks
    named_if_better    Diagnosis       no name for a cause with which these rows are predicted no better
    verified           Diagnosis       "consistent" only where the system predicts these rows as it would a healthy ship
    with_findings      ExtendedSystem  the system with the named causes in it
    with_form          ExtendedSystem  the system with the numbers of another form, where that is the answer
    with_cosimulation  SimulatedLog    the predictions as co-simulations of the given and the extended system
    completed          Diagnosis       errors, gain, and all that the page shows
"""

from collections.abc import Callable
from dataclasses import replace

from threadpoolctl import threadpool_limits

from shipcosim.diagnose.checked_log import ReadLog, checked
from shipcosim.diagnose.compared_log import compared
from shipcosim.diagnose.explanation.course_search import with_course
from shipcosim.diagnose.explanation.form import with_learnt_form, with_settled_form
from shipcosim.diagnose.explanation.identification import Identification, identified
from shipcosim.diagnose.explanation.search import ExplainedLog, with_causes
from shipcosim.diagnose.explanation.verdict import JudgedLog, judged, with_craft
from shipcosim.diagnose.extension.extended_system import ExtendedSystem, with_findings
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.log.runs import LogSource, run_as_log
from shipcosim.diagnose.log_faults.corrections import corrected, with_right_inputs
from shipcosim.diagnose.reference.change_since_reference import with_sizes_at_reference
from shipcosim.diagnose.reference.parameter_set import with_calibrated_numbers
from shipcosim.diagnose.reference.reference import Reference, read_reference, with_reference
from shipcosim.diagnose.result import Diagnosis
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.diagnose.statement import completed, named_if_better, stated, verified, with_form
from shipcosim.diagnose.validation.conditions import with_predictions
from shipcosim.diagnose.validation.replays import with_cosimulation
from shipcosim.ssp import AnyPath, AnySystem, System, SystemStructure, read
from shipcosim.temporary import temporary_folder

Progress = Callable[..., None]
"""Called with what is being done, in words; and where known with how many parts of it are done, and of how many."""

STEPS = {
    "is the log right?": 2.5,
    "how does the ship answer?": 1.5,
    "which causes explain it?": 3.0,
    "what do healthy ships look like?": 1.0,
    "what does the simulation get wrong": 1.5,
    "extending the system": 0.5,
    "the gain, by co-simulation": 4.5,
}
"""What `diagnose` tells its progress function, in order, with the time that it typically takes: that of simulated logs
of half an hour, on one core. [s]"""


def diagnose(
    log: LogSource,
    system: AnySystem,
    channels: AnyPath | None = None,
    causes: AnyPath | None = None,
    progress: Progress | None = None,
    *,
    out: AnyPath | None = None,
    reference: AnyPath | Reference | None = None,
    is_assumed: bool = False,
) -> Diagnosis:
    """Diagnose a log: what the simulation gets wrong, by which causes, the system with them, and what that gains.

    Parameters
    ----------
    log : path or xarray.Dataset
        Measured data, see docs/measured-data.md.
    system : path, SystemStructure or System
        The ship that the log is compared with.
    channels : path, optional
        Channel file: which column is what, in which unit.
    causes : path, optional
        Folder with further causes.
    progress : callable, optional
        Called with what is being done, in words; for the co-simulations also with how many are done and of how many.
    out : path, optional
        Folder that gets extended.ssp and extended.ssv, where a cause of the physics is named; a temporary one that is
        there as long as the diagnosis if not given.
    reference : path or Reference, optional
        What logs in which the ship was well say of her, as a calibration leaves it: what has changed since is told.
    is_assumed : bool
        Whether all numbers of the ship are guesses: they are learned, and no cause in her is sought.

    Returns
    -------
    Diagnosis

    Raises
    ------
    ShipcosimError
        Data, system or causes that cannot be used.
    """
    say = progress or (lambda *_: None)
    given, reference, out, folder = prepared_system(system, reference, out)
    diagnosis = find_causes(log, given.given, channels, causes, say, reference, is_assumed)
    say("what does the simulation get wrong")
    basis = diagnosis.basis
    if basis is None:
        raise ValueError("a diagnosis that does not know its log")
    diagnosis, predicted = named_if_better(diagnosis, with_predictions(basis, diagnosis.is_named))
    diagnosis = verified(diagnosis, predicted)
    say("extending the system")
    identification = basis.explained.identification
    extended = with_findings(given, diagnosis.findings, identification, out)
    diagnosis, extended = with_form(diagnosis, predicted, extended, out)
    say("the gain, by co-simulation")
    simulated = with_cosimulation(
        predicted, extended, lambda *done: say("the gain, by co-simulation", *done)
    )
    return replace(completed(diagnosis, predicted, extended, simulated), folder=folder)


def prepared_system(
    system: AnySystem, reference: AnyPath | Reference | None, out: AnyPath | None
) -> tuple[ExtendedSystem, Reference | None, AnyPath, object]:
    """A system with the numbers of a reference, that reference, and a folder for what is written.

    The last entry keeps a temporary folder alive; None where `out` is given.
    """
    folder = None
    if out is None:
        folder = temporary_folder()
        out = folder.name
    given = given_system(system)
    if reference is not None:
        reference = read_reference(reference)
        given = with_calibrated_numbers(given, reference, out)
    return given, reference, out, folder


def given_system(system: AnySystem) -> ExtendedSystem:
    """A system in whichever form, to be extended."""
    if isinstance(system, System):
        return ExtendedSystem(system, system.file)
    structure = system if isinstance(system, SystemStructure) else read(system)
    return ExtendedSystem(structure.checked(), structure)


def find_causes(
    log: LogSource,
    system: System,
    channels: AnyPath | None = None,
    causes: AnyPath | None = None,
    progress: Progress | None = None,
    reference: Reference | None = None,
    is_assumed: bool = False,
) -> Diagnosis:
    """Diagnose a log: its faults, and the causes for which the ship does not behave as modelled.

    Parameters
    ----------
    log : path or xarray.Dataset
        Measured data, see docs/measured-data.md.
    system : System
        The ship that the log is compared with, as `read_system` gives it.
    channels : path, optional
        Channel file.
    causes : path, optional
        Folder with further causes.
    progress : callable, optional
        Called with what is being done, in words.
    reference : Reference, optional
        As for `diagnose`, read by `read_reference`.
    is_assumed : bool
        As for `diagnose`.

    Returns
    -------
    Diagnosis
        Without the errors of predictions, the extended system, the gain and what the page shows besides, which
        `diagnose` adds.

    Raises
    ------
    ShipcosimError
        Data, system or causes that cannot be used.
    """
    say = progress or (lambda *_: None)
    say("is the log right?")
    with threadpool_limits(1):  # many small matrices: threads would only wait for each other
        read = read_measurements(log, system, channels, causes, reference)
        return causes_in(problem_of(read, is_assumed), read.ship, say, reference)


def causes_in(
    problem: Identification, ship: ShipModel, progress: Progress, reference: Reference | None = None
) -> Diagnosis:
    """Diagnose a log as an identification problem of a ship, as `find_causes` does."""
    diagnosis = stated(verdict_on(problem, progress))
    if reference is None:
        return diagnosis
    return replace(
        diagnosis,
        findings=with_sizes_at_reference(diagnosis.findings, ship, reference, problem.causes),
    )


def read_measurements(
    log: LogSource,
    system: System,
    channels: AnyPath | None = None,
    causes: AnyPath | None = None,
    reference: Reference | None = None,
) -> ReadLog:
    """A log by the roles of its columns, with the ship of a system or of a reference, and the causes of a catalogue."""
    ship = ship_by(system, reference)
    if channels is None:
        # Where a thruster's neighbour is, the ship knows by itself.
        paths = [path for path in ship.numbers if ".neighbour_" not in path]
        numbers = {path: ship.get(path) for path in paths}
        log = run_as_log(log, ship.vessel, ship.thrusters, numbers, ship.thrust_signals)
    drives = {name: ship.drives(name) for name in ship.thrusters}
    return ReadLog(read_log(log, channels, drives), ship, read_catalogue(causes))


def ship_by(system: System, reference: Reference | None) -> ShipModel:
    """The ship of a system, with the numbers of a reference if there is one."""
    ship = ship_model_of(system)
    return ship if reference is None else with_reference(ship, reference)


def problem_of(read: ReadLog, is_assumed: bool = False) -> Identification:
    """A log as an identification problem; what cannot be used is reported here, later stages refuse nothing."""
    return identified(compared(checked(read), is_assumed))


def verdict_on(problem: Identification, progress: Progress) -> JudgedLog:
    """The way of a log to its verdict, stage by stage."""
    progress("how does the ship answer?")
    if problem.comparison.obstacles:
        return judged(with_causes(problem))
    plain = corrected(problem)
    identification = with_learnt_form(plain)
    progress("which causes explain it?")
    explained = with_settled_form(with_causes(identification))
    explained = _with_labels_or_course(explained, plain)
    progress("what do healthy ships look like?")
    return with_craft(judged(explained))


def _with_labels_or_course(explained: ExplainedLog, plain: Identification) -> ExplainedLog:
    """The log with mislabelled inputs corrected, then with a cause that has a course; or with that cause alone."""
    relabelled = with_right_inputs(explained, plain)
    before = len(explained.identification.faults)
    if any(fault.segments for fault in relabelled.identification.faults[before:]):
        # A cause that begins within the log looks like a label that is wrong in a part of it. The likelier one counts.
        as_labelled = with_course(explained, plain)
        gain_of_labels = relabelled.fits[0].score - explained.fits[0].score
        if as_labelled.course is not None and as_labelled.course.gain > gain_of_labels:
            return as_labelled
    return with_course(relabelled, plain)
