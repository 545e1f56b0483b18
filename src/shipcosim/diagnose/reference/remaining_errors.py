"""What a calibrated ship still gets wrong, in each log: by numbers that this log did not give."""

from shipcosim.diagnose.reference.calibration import Calibration, numbers_of
from shipcosim.diagnose.reference.joint_fit import JointFit, fitted_jointly
from shipcosim.diagnose.reference.log_errors import LogErrors, errors_by_models
from shipcosim.diagnose.reference.several_logs import SeveralLogs
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.validation.gain import calibrated
from shipcosim.diagnose.validation.split import first_rows, trained


def remaining_errors(calibration: Calibration) -> dict[str, LogErrors | None]:
    """The error that remains in each log of a calibration.

    Each log is judged by the numbers that the other logs give; a single one by those of its first part. The weather is
    that which was fitted in the log itself.

    Parameters
    ----------
    calibration : Calibration

    Returns
    -------
    dict of str to LogErrors or None
        By name of the log; None where no stretch of it is whole.
    """
    problems = calibration.logs.problems
    if len(problems) == 1:
        return {name: _of_last_rows(calibration, name) for name in problems}
    return {name: _by_others(calibration, name) for name in problems}


def _by_others(calibration: Calibration, name: str) -> LogErrors | None:
    # Fit the ship's numbers to the other logs, with their weather.
    others = {
        other: problem for other, problem in calibration.logs.problems.items() if other != name
    }
    weather = [
        hypothesis for hypothesis in calibration.fit.hypotheses if hypothesis.component in others
    ]
    values = {
        path: v for path, v in calibration.fit.values.items() if path.partition("|")[0] in others
    }
    logs = SeveralLogs(others, is_well=True)
    fit = fitted_jointly(logs, weather, values, scale=calibration.scale, about_all=True)
    return _errors(
        calibration,
        name,
        calibration.logs.problems[name].record,
        _with_numbers(calibration, name, fit),
        tuple(others),
    )


def _of_last_rows(calibration: Calibration, name: str) -> LogErrors | None:
    problem = calibration.logs.problems[name]
    # Fit to the first part of the only log, and predict the rest.
    rows = first_rows(problem.record)
    early = SeveralLogs({name: trained(problem, rows)}, is_well=True)
    fit = fitted_jointly(
        early,
        calibration.fit.hypotheses,
        calibration.fit.values,
        scale=calibration.scale,
        about_all=True,
    )
    return _errors(
        calibration, name, problem.record.part(~rows), _with_numbers(calibration, name, fit), ()
    )


def _with_numbers(calibration: Calibration, name: str, fit: JointFit) -> ShipModel:
    """The ship of a log with the numbers of a fit to other rows, in the weather that was fitted in the log itself."""
    model = calibration.logs.problems[name].model
    part = calibration.fit.parts[name]
    # The ship's numbers moved as the fit wants, and the weather of this log's own fit.
    names, _, moved, _ = numbers_of(fit)
    of_ship = {
        path: model.get(path) + by for path, by in zip(names, moved, strict=True) if model.has(path)
    }
    of_day = {path: value for path, value in part.values.items() if ShipModel.is_of_day(path)}
    return model.with_values(of_ship | of_day)


def _errors(calibration, name, record, after, others) -> LogErrors | None:
    """Errors on a record by the system, by `after`, and by the ship as all logs have her."""
    # Open-loop predictions by the system, the calibrated ship, and the ship fitted to all logs.
    model = calibration.logs.problems[name].model
    part = calibration.fit.parts[name]
    models = {"before": model, "after": after, "floor": calibrated(part)}
    return errors_by_models(record, models, others)
