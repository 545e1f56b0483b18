"""Measured logs: read, diagnosed, replayed, calibrated on, studied as sea trials."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, overload

from shipcosim import library
from shipcosim.calls.arguments import (
    SYSTEM_OF_LOGS,
    AnyPath,
    AnySystem,
    AnyTime,
    Reading,
    check_inputs,
    in_seconds,
    name_of_log,
    named,
    source_of,
    sources_of,
    values_of_sets,
)
from shipcosim.calls.learning import assumed_craft, check_learning
from shipcosim.errors import Problem, error_at
from shipcosim.keywords import with_known_keywords
from shipcosim.results.diagnosis import DiagnosisOfLog, DiagnosisOfLogs
from shipcosim.results.log import Log
from shipcosim.results.shown import parts_of
from shipcosim.results.studies import Calibration, Replay, SeaTrials
from shipcosim.ships import make_systems
from shipcosim.ssp import System, SystemStructure, read, with_values
from shipcosim.staging import WRITING, check_targets, staged
from shipcosim.temporary import temporary_folder

if TYPE_CHECKING:
    import xarray

    from shipcosim.diagnose.experiment.isolability import Isolability
    from shipcosim.diagnose.pipeline import Progress
    from shipcosim.diagnose.reference.reference import Reference
    from shipcosim.options import CountProgress
    from shipcosim.results.run import Run

    AnyLog = AnyPath | xarray.Dataset | Log | Run


EXTENDED = ("extended.ssp", "extended.ssv", "craft.toml", "craft_open.ssp")
CALIBRATED = ("calibrated.ssv", "reference.json", "craft.toml", "craft_open.ssp")
"""Files that an earlier diagnosis or calibration may have left, and a later one does not always write."""
Saved = TypeVar("Saved", bound=DiagnosisOfLog | DiagnosisOfLogs | SeaTrials | Calibration)


@with_known_keywords
def read_log(log: AnyLog, channels: AnyPath | None = None) -> Log:
    """Read a measured log, every row of it, to look at it before it is diagnosed.

    Parameters
    ----------
    log : path, name of an example, or xarray.Dataset
        Measured data, see docs/measured-data.md.
    channels : path, optional
        Channel file: which column is what, in which unit.

    Returns
    -------
    Log

    Raises
    ------
    ShipcosimError
        With all that is wrong: a column that is missing, not numeric or in a unit of something else, no time.

    Examples
    --------
    >>> import shipcosim
    >>> shipcosim.read_log("gunnerus_log")["heading"].attrs["units"]
    'deg'
    """
    from shipcosim.diagnose.log.reader import read_log

    source, channels = source_of(log, channels)
    check_inputs([source], channels)
    return Log(name_of_log(source), read_log(source, channels), source, channels)


@with_known_keywords
def isolability(
    log: AnyLog,
    system: AnySystem | None = None,
    channels: AnyPath | None = None,
    progress: Progress | None = None,
) -> tuple[Isolability, ...]:
    """Which causes a log could tell apart, by its channels and its motion, whatever is wrong in it.

    Parameters
    ----------
    log, system, channels, progress
        As of `diagnose`.

    Returns
    -------
    tuple of Isolability
        By cause and component; empty where something keeps the log from telling any.

    Raises
    ------
    ShipcosimError
        Data or system that cannot be used.
    """
    from shipcosim.diagnose.experiment.isolability import isolability as by_excitation
    from shipcosim.diagnose.experiment.testability import excitation_of
    from shipcosim.diagnose.pipeline import find_causes, given_system

    source, channels = source_of(log, channels)
    check_inputs([source], channels)
    ship = given_system(Reading().system(system or SYSTEM_OF_LOGS, "system"))
    basis = find_causes(source, ship.given, channels, None, progress).basis
    if basis is None or basis.explained.identification.comparison.obstacles:
        return ()
    return by_excitation(excitation_of(basis))


@overload
def diagnose(
    log: AnyLog,
    system: AnySystem | None = None,
    channels: AnyPath | None = None,
    causes: AnyPath | None = None,
    progress: Progress | None = None,
    *,
    out: AnyPath | None = None,
    force: bool = False,
    reference: AnyPath | Reference | None = None,
    learn: bool = False,
    length: float | str | None = None,
) -> DiagnosisOfLog: ...
@overload
def diagnose(
    log: Sequence[AnyLog],
    system: AnySystem | None = None,
    channels: AnyPath | None = None,
    causes: AnyPath | None = None,
    progress: Progress | None = None,
    *,
    out: AnyPath | None = None,
    force: bool = False,
    reference: AnyPath | Reference | None = None,
) -> DiagnosisOfLogs: ...
@with_known_keywords
def diagnose(
    log: AnyLog | Sequence[AnyLog],
    system: AnySystem | None = None,
    channels: AnyPath | None = None,
    causes: AnyPath | None = None,
    progress: Progress | None = None,
    *,
    out: AnyPath | None = None,
    force: bool = False,
    reference: AnyPath | Reference | None = None,
    learn: bool = False,
    length: float | str | None = None,
) -> DiagnosisOfLog | DiagnosisOfLogs:
    """Say what the simulation gets wrong of a log, and why: causes by name, the system with them, what that gains.

    Parameters
    ----------
    log : path, name of an example, Log, Run, xarray.Dataset, or a list of them
        Measured data, see docs/measured-data.md; several logs of one ship are weighed together.
    system : path, name, SystemStructure or System, optional
        The ship that the log is compared with; gunnerus_open if not given.
    channels : path, optional
        Channel file: which column is what, in which unit.
    causes : path, optional
        Folder with further causes.
    progress : callable, optional
        Called with what is being done, in words; for the co-simulations also with how many are done and of how many.
    out : path, optional
        Folder that gets diagnosis.json, report.html, and extended.ssp and extended.ssv where a cause of the physics
        is named; nothing is left on the disk without.
    force : bool
        Replace files of these names there, instead of keeping them in a numbered folder beside it.
    reference : path or Reference, optional
        What `calibrate` left of logs in which the ship was well: the diagnosis then says what has changed since.
    learn : bool
        Learn a craft that no file describes from the log, with `length` and without `system`. `out` gets craft.toml
        and craft_open.ssp too, her file and system with assumed numbers; extended.ssp has the learned ones.
    length : float or str, optional
        Her length, such as ``"1.2 m"``. [m]

    Returns
    -------
    DiagnosisOfLog
        Or DiagnosisOfLogs of a list.

    Raises
    ------
    ShipcosimError
        Data, system or causes that cannot be used; nothing is written then.
    """
    from shipcosim.diagnose.joint_pipeline import diagnose_jointly
    from shipcosim.diagnose.pipeline import diagnose

    several = isinstance(log, Sequence) and not isinstance(log, (str, bytes))
    sources, channels = sources_of(log if several else [log], channels)
    check_inputs(sources, channels, causes)
    if learn or length is not None:
        given = {"system": system, "reference": reference, "causes": causes}
        check_learning(learn, length, several=several, **given)
        return _written(
            lambda stage: _learned(sources[0], channels, length, progress, stage),
            *(out, force, progress),
        )
    ship = ship_of(system)

    def result_in(stage: Path | None) -> DiagnosisOfLog | DiagnosisOfLogs:
        options: dict[str, Any] = {"out": stage, "reference": reference}
        if several:
            joint = diagnose_jointly(sources, ship, channels, causes, progress, **options)
            return DiagnosisOfLogs(**parts_of(joint))
        return DiagnosisOfLog(
            **parts_of(diagnose(sources[0], ship, channels, causes, progress, **options))
        )

    return _written(result_in, out, force, progress)


def _learned(
    source: Any,
    channels: AnyPath | None,
    length: float | str | None,
    progress: Progress | None,
    stage: Path | None,
) -> DiagnosisOfLog:
    """A craft that no file describes, by her length and her log."""
    from shipcosim.diagnose.pipeline import diagnose

    folder = temporary_folder()
    ship = _assumed_system([source], channels, length, Path(folder.name), stage)
    diagnosis = diagnose(source, ship, channels, None, progress, out=stage, is_assumed=True)
    # The folder of her system stays as long as what was found.
    return replace(DiagnosisOfLog(**parts_of(diagnosis)), folder=(folder, diagnosis.folder))


def _assumed_system(
    sources: Sequence[Any],
    channels: AnyPath | None,
    length: float | str | None,
    folder: Path,
    stage: Path | None,
) -> SystemStructure:
    """System of a craft that no file describes, made in a folder; its files are left in another one too."""
    text = assumed_craft(sources, channels, length)
    (folder / "craft.toml").write_text(text, encoding="utf-8")
    fmus = library.fmus()
    ship = read(make_systems(folder / "craft.toml", str(folder), fmus)[0], fmus=fmus)
    if stage is not None:
        (stage / "craft.toml").write_text(text, encoding="utf-8")
        ship.write(stage / "craft_open.ssp")
    return ship


@with_known_keywords
def replay(
    log: AnyLog,
    system: AnySystem | None = None,
    before: AnySystem | None = None,
    channels: AnyPath | None = None,
    *,
    parameters: Sequence[AnyPath] = (),
    horizon: AnyTime = None,
    progress: CountProgress | None = None,
    out: AnyPath | None = None,
    force: bool = False,
) -> Replay:
    """Predict a log piece by piece, each from the measured state, with one system or with two.

    Parameters
    ----------
    log
        As for `diagnose`, one log.
    system : path, name, SystemStructure or System, optional
        The ship, or the ``extended`` system of a diagnosis; gunnerus_open if not given.
    before : like `system`, optional
        The system to compare with. By default that without `parameters`, and of an extended.ssp the one that was
        extended.
    channels : path, optional
        Channel file.
    parameters : sequence of path
        Parameter sets over those of `system`; what does not fit is left out and listed in `Replay.remarks`.
    horizon : float, optional
        Length of each prediction; one that fits the craft and the log if not given. [s]
    progress : callable, optional
        Called with (predictions done, predictions in all).
    out : path, optional
        Folder that gets report.html, errors.csv and replay.nc; nothing is written without.
    force : bool
        Replace files of these names there, instead of keeping them in a numbered folder beside it.

    Returns
    -------
    Replay

    Raises
    ------
    ShipcosimError
        Data or systems that cannot be used.
    """
    from shipcosim.diagnose.replays import replay_log

    source, channels = source_of(log, channels)
    check_inputs([source], channels)
    if out is not None:
        check_targets(Path(out))
    systems, remarks = _replayed_systems(
        SYSTEM_OF_LOGS if system is None else system, before, parameters
    )
    times = in_seconds({"horizon": horizon}, ["horizon"])
    replayed = replay_log(source, systems, channels, horizon=times["horizon"], progress=progress)
    parts = parts_of(replayed)
    parts["remarks"] = (*map(str, remarks), *replayed.remarks)
    names = tuple(each.name for each in systems.values())
    result = Replay(**parts, name=name_of_log(source), systems=names)
    if out is not None:
        result.save(out, force=force)
    return result


def _replayed_systems(
    given: AnySystem, before: AnySystem | None, parameters: Sequence[AnyPath]
) -> tuple[dict[str, System], list[Problem]]:
    """The systems of a replay, ``before`` and ``after`` or a single one, with remarks on the parameter sets."""
    reading = Reading()
    system = reading.system(given, "system")
    if parameters:
        values, remarks = values_of_sets(parameters, system)
        after = with_values(system, values, named("parameters"))
        return {
            "before": system if before is None else reading.system(before, "before"),
            "after": after,
        }, remarks
    if (
        before is None
        and not isinstance(given, (System, SystemStructure))
        and Path(given).name == EXTENDED[0]
    ):
        before = _extended_from(system, str(given))
    if before is None:
        return {"simulated": system}, []
    return {"before": reading.system(before, "before"), "after": system}, []


def _extended_from(system: System, given: str) -> str:
    """The system that was extended: it lies beside the extended one, or has a name in the project."""
    neighbour = Path(given).with_name(f"{system.name}.ssp")
    if neighbour.exists():
        return str(neighbour)
    if library.named("system", system.name) is None:
        raise error_at(
            given,
            f"it extends a system '{system.name}', which has no name here.",
            f"Say which one it was: {named('before')}.",
        )
    return system.name


@with_known_keywords
def calibrate(
    logs: AnyLog | Sequence[AnyLog],
    system: AnySystem | None = None,
    channels: AnyPath | None = None,
    causes: AnyPath | None = None,
    progress: Progress | None = None,
    *,
    out: AnyPath | None = None,
    force: bool = False,
    learn: bool = False,
    length: float | str | None = None,
) -> Calibration:
    """Fit a ship's numbers to logs in which she is known to be well: her own parameter set, and a reference.

    Parameters
    ----------
    logs, system, channels, causes, progress
        As for `diagnose`.
    out : path, optional
        Folder that gets calibrated.ssv, reference.json and report.html, the page alone where the logs are refused;
        nothing is written without.
    force : bool
        Replace files of these names there, instead of keeping them in a numbered folder beside it.
    learn, length
        As for `diagnose`: a craft that no file describes. `out` gets craft.toml and craft_open.ssp, the system of
        calibrated.ssv, and no reference.

    Returns
    -------
    Calibration
        Its ``reference`` is what `diagnose` takes.

    Raises
    ------
    ShipcosimError
        Data, system or causes that cannot be used; nothing is written then.
    """
    from shipcosim.diagnose.calibration_pipeline import calibrate

    several = logs if isinstance(logs, Sequence) and not isinstance(logs, (str, bytes)) else [logs]
    sources, channels = sources_of(several, channels)
    check_inputs(sources, channels, causes)
    if learn or length is not None:
        given = {"system": system, "reference": None, "causes": causes}
        check_learning(learn, length, several=False, **given)

    def result_in(stage: Path | None) -> Calibration:
        with temporary_folder() as folder:
            ship = (
                _assumed_system(sources, channels, length, Path(folder), stage)
                if learn
                else ship_of(system)
            )
            calibration = calibrate(
                sources, ship, channels, causes, progress, out=stage, is_assumed=learn
            )
        return Calibration(**parts_of(calibration))

    return _written(result_in, out, force, progress, CALIBRATED)


@with_known_keywords
def sea_trials(
    log: AnyLog,
    system: AnySystem | None = None,
    channels: AnyPath | None = None,
    causes: AnyPath | None = None,
    progress: Progress | None = None,
    *,
    orders: bool = False,
    out: AnyPath | None = None,
    force: bool = False,
) -> SeaTrials:
    """Say what a simulation gets wrong of a ship's trials: straight runs, turning circles, zig-zags.

    Parameters
    ----------
    log, system, channels, causes, progress
        As for `diagnose`, one log.
    orders : bool
        Whether the thrusters' channels are orders, which the units follow, instead of feedback.
    out : path, optional
        Folder that gets sea_trials.json, report.html, and where causes were found extended.ssp and extended.ssv;
        nothing is written without.
    force : bool
        Replace files of these names there, instead of keeping them in a numbered folder beside it.

    Returns
    -------
    SeaTrials

    Raises
    ------
    ShipcosimError
        Data that cannot be used; no turning circle. Nothing is written then.
    """
    from shipcosim.diagnose.extension.extend import extend
    from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
    from shipcosim.diagnose.sea_trials.study import study

    source, channels = source_of(log, channels)
    check_inputs([source], channels, causes)
    given = ship_of(system)
    ship = given if isinstance(given, System) else given.checked()

    def result_in(stage: Path | None) -> SeaTrials:
        trials = study(source, ship, channels, causes, progress, orders=orders)
        if stage is not None and trials.findings:
            structure = given if isinstance(given, SystemStructure) else read(ship.file)
            extend(structure, trials.findings, stage, catalogue=read_catalogue(causes))
        return SeaTrials(
            **parts_of(trials), name=name_of_log(source), system=ship.name, orders=orders
        )

    return _written(result_in, out, force, progress)


def ship_of(system: AnySystem | None) -> System | SystemStructure:
    """The ship of a diagnosis: a structure stays one, so that changes made to it are in the extended system, too."""
    if isinstance(system, SystemStructure):
        return system
    return Reading().system(SYSTEM_OF_LOGS if system is None else system, "system")


def _written(
    result_in: Callable[[Path | None], Saved],
    out: AnyPath | None,
    force: bool,
    progress: Progress | None,
    left: Sequence[str] = EXTENDED,
) -> Saved:
    """A result and, if a folder is given, its files: all of them or none.

    Parameters
    ----------
    result_in : callable
        Makes the result, and writes an extended system into the folder that it gets.
    left : sequence of str
        Files that an earlier result may have left.
    """
    if out is None:
        return result_in(None)
    check_targets(Path(out))
    with staged(Path(out), left, force=force) as stage:
        result = result_in(stage)
        if progress is not None:
            progress(WRITING)
        result.write(stage)
    extension = getattr(result, "extension", None)
    if extension is None:
        return result
    # The extended system was made in the stage, and has moved.
    at_home = {kind: Path(out) / f"extended.{kind}" for kind in ("ssp", "ssv")}
    return replace(result, extension=replace(extension, **at_home))  # pyright: ignore[reportCallIssue]
