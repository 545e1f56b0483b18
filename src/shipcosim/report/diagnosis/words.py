"""Results of a diagnosis in sentences for those who sail and maintain the ship."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from shipcosim.diagnose.craft.learned import LearnedCraft
from shipcosim.diagnose.experiment.design import ExperimentDesign
from shipcosim.diagnose.explanation.summary import CauseGain, LoadForm
from shipcosim.diagnose.finding import Candidate, Finding, ParameterEstimate
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue, read_faults
from shipcosim.diagnose.hypotheses.cause import Cause
from shipcosim.diagnose.reference.joint_result import JointDiagnosis
from shipcosim.diagnose.result import Diagnosis
from shipcosim.diagnose.validation.split import HORIZONS
from shipcosim.errors import capitalised
from shipcosim.report.diagnosis.clauses import filled
from shipcosim.report.diagnosis.estimates import amount, plus_minus
from shipcosim.report.theme.numbers import metres, percent, plain, span
from shipcosim.report.theme.views import Fact, Outcome, known_facts

LIKELY = 0.25
"""Probability of a candidate beside an unknown error, half of what it were alone, above which it is mentioned."""


def title(cause: str, component: str | None = None) -> str:
    """Name of a cause for readers.

    Examples
    --------
    >>> title("thrust_loss", "port")
    'Thrust loss of port'
    """
    text = cause.replace("_", " ")
    return capitalised(text) + (f" of {component}" if component else "")


def title_of(cause: Finding | Candidate | CauseGain) -> str:
    """Name of a cause at its place for readers."""
    return title(cause.cause, cause.component)


def finding_text(finding: Finding, causes: Mapping[str, Cause] | None = None) -> str:
    """Describe a finding as a clause with its numbers.

    Parameters
    ----------
    finding : Finding
    causes : dict of str to Cause, optional
        The causes by name; our own if not given.

    Returns
    -------
    str
    """
    # Faults of the log have texts of their own.
    if finding.cause in read_faults():
        return _fault(finding)
    if finding.logs == (finding.component,):
        weather = finding_text(replace(finding, component=None, logs=()), causes)
        return f"{weather} (on the day of {finding.component})"
    cause = (read_catalogue() if causes is None else causes).get(finding.cause)
    # Since when, and what it was at the reference.
    since = f", {course_of(finding)}" if finding.onset is not None else ""
    if finding.at_reference:
        before = (f"{n.replace('_', ' ')} {plus_minus(e)}" for n, e in finding.at_reference.items())
        since += f" (at the reference: {', '.join(before)})"
    try:
        if cause and cause.statement:
            return filled(cause.statement, finding.parameters, finding.component) + since
    except KeyError:  # of another version of the cause's file, with other parameters
        pass
    # Without a statement: the cause's sentence and plain numbers.
    sentence = cause.sentence if cause else title(finding.cause)
    numbers = ", ".join(f"{name} {plus_minus(e)}" for name, e in finding.parameters.items())
    place = f" ({finding.component})" if finding.component else ""
    return (
        f"{sentence[:1].lower()}{sentence[1:]}{place}" + (f": {numbers}" if numbers else "") + since
    )


def course_of(finding: Finding) -> str:
    """When a cause is there, as a clause.

    Examples
    --------
    >>> course_of(Finding("drag", segments=((60.0, 300.0), (500.0, 620.0)), onset=60.0, course="switching"))
    'coming and going, from 60 to 300 s and from 500 to 620 s'
    """
    spells = [f"from {start:.0f} to {end:.0f} s" for start, end in finding.segments]
    if finding.course in ("", "step"):
        return f"from {finding.onset or 0.0:.0f} s on"
    before = {"ramp": "growing ", "switching": "coming and going, "}
    return before.get(finding.course, "") + listed(spells)


def _fault(finding: Finding) -> str:
    """Describe a fault of the log or the connections as a clause."""
    fault = read_faults()[finding.cause]
    if finding.logs and finding.note:
        return finding.note
    text = fault.statement.format(component=finding.component)
    # Duration and number of stretches, or the channels, as the fault's file asks.
    if fault.adds == "duration" and finding.segments:
        seconds = sum(b - a for a, b in finding.segments)
        count = len(finding.segments)
        text += f" for {seconds:.0f} s in {count} stretch{'es' * (count > 1)}"
    elif fault.adds != "nothing" and 0 < len(finding.channels) <= 4:
        text += f" ({', '.join(finding.channels)})"
    return text


def outcome(diagnosis: Diagnosis) -> Outcome:
    """Verdict as a word and a sentence."""
    errors = diagnosis.craft.errors if diagnosis.craft else None
    word = "LEARNED" if diagnosis.is_assumed and errors else diagnosis.verdict.upper()
    return Outcome(diagnosis.verdict, word, _sentence(diagnosis))


def facts_of(diagnosis: Diagnosis) -> Sequence[Fact]:
    """System, and length of the log; of several logs their names and what they have in all."""
    if isinstance(diagnosis, JointDiagnosis):
        bases = [log.basis for log in diagnosis.logs.values()]
        logs = [basis.explained.identification.log for basis in bases if basis]
        names = f"{', '.join(diagnosis.logs)}; "
    else:
        logs = [diagnosis.log.measured] if diagnosis.log else []
        names = ""
    times = [log["time"].values for log in logs]
    minutes = sum(time[-1] - time[0] for time in times) / 60.0
    length = f"{names}{minutes:.0f} min, {sum(map(len, times))} rows" if times else ""
    system = diagnosis.system.name if diagnosis.system else ""
    return known_facts({"System": system, "Logs" if names else "Log": length})


def _sentence(diagnosis: Diagnosis) -> str:
    """The verdict, with what it rests on."""
    # Faults of the log and causes in the physics are kept apart.
    data = [finding_text(f) for f in diagnosis.findings if f.kind == "data" and not f.alternatives]
    physics = [finding_text(f, diagnosis.causes or None) for f in diagnosis.physics]
    several = isinstance(diagnosis, JointDiagnosis)
    faulty = "logs are faulty alike" if several else "log itself is faulty"
    log = f" The {faulty}: {listed(data)}." if data else ""
    if diagnosis.is_assumed:
        return _learned(diagnosis, log)
    # An unknown cause comes first: it puts everything else in doubt.
    if diagnosis.verdict == "unknown":
        return _unknown(diagnosis, physics) + craft_sentence(diagnosis.craft) + log
    # Next, channels that can be read in several ways.
    if misread := [f.sentence for f in diagnosis.findings if f.alternatives]:
        return (
            f"The log is misread, and its own channels cannot tell where: {listed(misread)}.{log}"
        )
    # Next, causes that cannot be told apart.
    if diagnosis.verdict == "ambiguous":
        if several and not diagnosis.indistinguishable:
            return "These logs say nothing of the ship: their channels may be misread. Each log's own line says how."
        which = "these logs" if several else "this log"
        names = [title_of(c).lower() for c in diagnosis.indistinguishable]
        besides = f" Certain is: {listed(physics)}." if physics else ""
        return f"Something is wrong, and {which} cannot tell which: {listed(names, 'or')}.{besides}{log}"
    # Named causes, then faults of the log alone.
    if physics:
        many = f"{len(physics)} things are" if len(physics) > 1 else "one thing is"
        better = _better_predictor(diagnosis) + craft_sentence(diagnosis.craft)
        return f"At least {many} not as modelled: {listed(physics)}.{better}{log}"
    if data:
        faulty = "logs are faulty alike" if several else "log is faulty"
        return f"The {faulty}: {listed(data)}. Apart from that, simulation and log agree."
    if several and any(diagnosis.own_faults(name) for name in diagnosis.logs):
        return "Apart from faults of single logs, simulation and logs agree."
    # No cause, and the log is explained by loads of another form alone; or perhaps so.
    if diagnosis.verdict == "form" and diagnosis.form:
        return _form(diagnosis.form)
    if diagnosis.craft:
        learned = craft_sentence(diagnosis.craft)
        return f"No cause is found, but numbers of the ship are not the file's.{learned}"
    if diagnosis.form:
        return "Simulation and log agree, where the loads may have another form than the model's."
    text = "Simulation and log agree, within noise and the tolerances of the model"
    if healthy := diagnosis.healthy:
        text += (
            f": healthy ships are off by up to {metres(healthy.largest['position'])} and "
            f"{healthy.largest['heading']:.1f}° after {HORIZONS[-1]:g} s, and she is by less"
        )
    return f"{text}."


def _learned(diagnosis: Diagnosis, log: str) -> str:
    """What a log teaches of a craft of whom only the length was known."""
    errors = diagnosis.craft.errors if diagnosis.craft else None
    if errors is None:
        return f"{diagnosis.obstacles[0]}{log}"
    return (
        f"The log teaches the craft: after {errors.horizon:.3g} s, on parts that were held out, she is predicted "
        f"{metres(errors.after)} and {errors.after_deg:.2g}° off. If she kept her velocity, it would be "
        f"{metres(errors.steady)} and {errors.steady_deg:.2g}°.{log}"
    )


def _form(form: LoadForm) -> str:
    """What another form of the loads does, how much of the error it explains, and which causes may hide in it."""
    if form.differs:
        name, share = max(form.differs.items(), key=lambda pair: pair[1])
        text = (
            "No cause is found, but the loads on the ship have another form than the model's, beyond its tolerances: "
            f"most of all {name}, by {percent(share)}."
        )
    else:
        number = form.numbers[0]
        size = plus_minus(ParameterEstimate(number.estimate, number.std, number.unit))
        text = (
            f"No cause is found, but numbers of the ship are beyond their tolerances: {number.number} is "
            f"{plain(number.model)} {number.unit} in the system, and {size} by the log."
        )
    if form.before_m is not None and form.after_m is not None:
        text += (
            f" After {form.horizon_s:g} s the simulation is {metres(form.before_m)} off the log, with that form "
            f"{metres(form.after_m)}"
        )
        if form.system_m is not None and form.system_m < form.before_m:
            text += f", and with those of its numbers that the FMUs have {metres(form.system_m)} (extended.ssp)"
        text += "."
    if form.hides:
        hidden = listed([title(name).lower() for name in form.hides])
        text += f" It can hide {hidden}."
    return text


def _better_predictor(diagnosis: Diagnosis) -> str:
    """Sentence if something else predicts this log better than the extended model."""
    gain = diagnosis.gain
    if not gain:
        return ""
    others = {
        "The model as it was": gain["before_m"],
        "The model as it was with a bias observer": gain["bias_observer_m"],
    }
    errors = {name: error for name, error in others.items() if error is not None}
    best = min(errors, key=lambda name: errors[name])
    if errors[best] >= gain["after_m"]:
        return ""
    return (
        f" {best} predicts better than with the cause in it: {metres(errors[best])} against "
        f"{metres(gain['after_m'])} after {gain['horizon_s']:g} s."
    )


def _unknown(diagnosis: Diagnosis, physics: Sequence[str]) -> str:
    """What is certain without a named cause: why none was tried, the largest discrepancy and sure findings."""
    message = f" Certain is: {listed(physics)}." if physics else ""
    largest = [d.what for d in diagnosis.discrepancies[:1]]
    if diagnosis.obstacles:
        # What differs may be what the log lacks: nothing is known to be wrong.
        differs = "".join(f" Simulation and log differ most in this: {what}." for what in largest)
        return f"No cause was tried. {diagnosis.obstacles[0]}{differs}{message}"
    wrong = [f" The simulation is wrong, first of all: {what}." for what in largest]
    likely = [candidate for candidate in diagnosis.candidates if candidate.probability >= LIKELY]
    if likely:
        names = [title_of(candidate).lower() for candidate in likely]
        message += f" Of the known ones {listed(names)} explain{'s' * (len(names) == 1)} most."
    if not wrong:
        return f"The simulation is wrong by more than noise, and none of the known causes explains it.{message}"
    return f"{wrong[0].strip()} None of the known causes explains all of it.{message}"


def craft_sentence(craft: LearnedCraft | None) -> str:
    """What the learned craft gains, as a sentence after others; empty without one."""
    if craft is None or craft.errors is None:
        return ""
    errors = craft.errors
    taught = "the log teaches her" if craft.logs == 1 else f"{craft.logs} logs teach her"
    return (
        f" The craft as {taught} predicts better. After {errors.horizon:.3g} s, on parts that were held "
        f"out, it is {metres(errors.after)} and {errors.after_deg:.2g}° off instead of {metres(errors.before)} and "
        f"{errors.before_deg:.2g}°. If she kept her velocity, it would be {metres(errors.steady)} and "
        f"{errors.steady_deg:.2g}°."
    )


def discrepancy_rows(diagnosis: Diagnosis) -> list[tuple[str, ...]]:
    """Discrepancies, largest first: in words, size, share of the error, and of several logs those that show it."""
    rows = []
    for discrepancy in diagnosis.discrepancies:
        size = (
            plus_minus(ParameterEstimate(discrepancy.estimate, discrepancy.std, discrepancy.unit))
            if discrepancy.std
            else ""
        )
        logs = (", ".join(discrepancy.logs),) if discrepancy.logs else ()
        rows.append(
            (discrepancy.what, size, percent(discrepancy.share) if discrepancy.share else "", *logs)
        )
    return rows


def listed(texts: Sequence[str], last: str = "and") -> str:
    """Join several texts into one.

    Examples
    --------
    >>> listed(["a current", "a tow", "waves"])
    'a current, a tow and waves'
    """
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} {last} {texts[-1]}"


def next_steps(diagnosis: Diagnosis, extended: str | None = None) -> list[str]:
    """Next steps for the user.

    Parameters
    ----------
    diagnosis : Diagnosis
    extended : str, optional
        Path of the extended system, where something in it is other than it was.

    Returns
    -------
    list of str
    """
    steps = []
    # Wrong readings and faulty logging first: they affect everything else.
    misread = any(f.alternatives for f in diagnosis.findings)
    if misread:
        steps.append(
            "Find out which it is, correct units, signs or columns in the channel file, and diagnose again."
        )
    if data := [f for f in diagnosis.findings if f.kind == "data" and not f.alternatives]:
        where = ", ".join(dict.fromkeys(title(f.cause).lower() for f in data))
        steps.append(
            f"Correct the logging where it is wrong ({where}); this diagnosis used a repaired copy."
        )
    several = isinstance(diagnosis, JointDiagnosis)
    faulty = [name for name in diagnosis.logs if diagnosis.own_faults(name)] if several else []
    if faulty:
        steps.append(f"Look at the faults of single logs: {', '.join(faulty)}.")
    # Steps that the causes' files recommend.
    causes = diagnosis.causes or read_catalogue()
    wanted = [
        (causes[f.cause].next_step, f.component) for f in diagnosis.physics if f.cause in causes
    ]
    steps += dict.fromkeys(step.format(component=component) for step, component in wanted if step)
    # A manoeuvre that separates causes, better logs, or a look at the missing force.
    if diagnosis.verdict == "ambiguous" and not misread:
        steps.append(_manoeuvre_step(diagnosis.prescription))
    if diagnosis.is_assumed:
        steps.append(
            "Write her known numbers into craft.toml and make her systems: shipcosim new ship NAME --from craft.toml. "
            "Diagnose this and other logs with them."
        )
    elif diagnosis.obstacles:
        steps.append(
            "Confirm columns or log more, as the remarks ask, and diagnose again: without it no cause can be named."
        )
    elif diagnosis.verdict == "unknown":
        where = "Diagnose a log by itself and look on its page" if several else "Look on the page"
        steps.append(f"{where} how the missing force goes with time, heading and wind.")
        steps.append(
            "If you know a cause that is not in the catalogue, add it as one file (docs/add-a-cause.md)."
        )
    elif diagnosis.verdict == "form":
        steps.append(
            "If the ship was well, make these logs her reference: shipcosim calibrate. A later diagnosis then says what "
            "has changed since."
        )
    # What is possible now, and what this log cannot say.
    better, judged = predicted_better(diagnosis)
    if extended and 2 * better < judged:
        steps.append(
            f"Do not use {extended} yet: with it {judged - better} of {judged} logs are predicted no better. There are "
            "other errors: correct the listed differences first, the largest first."
        )
    elif extended:
        steps.append(f"Simulate with it in the system: shipcosim simulate {extended}")
    if diagnosis.not_testable and not diagnosis.obstacles:
        names = listed([title(name).lower() for name in diagnosis.not_testable], "or")
        subject = "These logs say" if several else "This log says"
        steps.append(f"{subject} nothing about {names}, present or not.")
    return steps or ["Nothing needs to be done."]


def predicted_better(diagnosis: Diagnosis) -> tuple[int, int]:
    """How many logs are predicted better with the causes that others sized, after the longest horizon; of how many."""
    errors = diagnosis.errors.values() if isinstance(diagnosis, JointDiagnosis) else ()
    judged = [error.position for error in errors if "after" in error.position]
    return sum(errors["after"][-1] < errors["before"][-1] for errors in judged), len(judged)


def _manoeuvre_step(prescription: ExperimentDesign | None) -> str:
    """Manoeuvre to sail if causes cannot be told apart."""
    if prescription is None:
        return "Log more, with larger moves, turns and thrust ahead and astern: these causes differ there."
    name = prescription.manoeuvre.replace("_", " ")
    pairs = listed(
        [f"{a} from {b}".replace("_", " ") for a, b in prescription.separates] or ["them"]
    )
    return (
        f"Sail this and log it: {name}, {prescription.minutes:.0f} minutes. It tells {pairs} apart."
    )


def estimate_rows(finding: Finding) -> list[tuple[str, str, str, str]]:
    """Name, value, standard deviation and unit of each parameter as texts."""
    # Parameters of one unit are shown in one scale.
    largest: dict[str, float] = {}
    for estimate in finding.parameters.values():
        largest[estimate.unit] = max(abs(estimate.estimate), largest.get(estimate.unit, 0.0))
    return [
        (n.replace("_", " "), *amount(e, largest=largest[e.unit]))
        for n, e in finding.parameters.items()
    ]


def size_rows(finding: Finding) -> list[tuple[str, str]]:
    """Name and size of each parameter as texts; with a reference: before, an arrow, now.

    Examples
    --------
    >>> from shipcosim.diagnose.finding import ParameterEstimate
    >>> lost, before = ParameterEstimate(0.152, 0.012, "1"), ParameterEstimate(0.03, 0.02, "1")
    >>> size_rows(Finding("thrust_loss", "port", parameters={"loss": lost}, at_reference={"loss": before}))
    [('loss', '0.03 ± 0.02 → 0.152 ± 0.012')]
    """
    before = {
        name.replace("_", " "): f"{plus_minus(size)} → "
        for name, size in finding.at_reference.items()
    }
    return [
        (name, before.get(name, "") + f"{value} ± {std} {unit}".rstrip())
        for name, value, std, unit in estimate_rows(finding)
    ]


def finding_rows(findings: Iterable[Finding]) -> Iterator[tuple[str, ...]]:
    """Rows of texts: cause, certainty, and each parameter's size; for a fault, its place."""
    for finding in findings:
        name = title_of(finding)
        sure = percent(finding.probability)
        # Cause and certainty only in the first row of a finding.
        rows = size_rows(finding) if finding.kind == "physics" else []
        for parameter, size in rows:
            yield name, sure, parameter, size
            name = sure = ""
        for log, alone in by_log(finding):
            yield from ((f"{log} alone", "", *row) for row in size_rows(alone))
        if not rows:
            yield name, sure, where(finding), finding.sentence or ", ".join(finding.channels)


def by_log(finding: Finding) -> list[tuple[str, Finding]]:
    """A cause that several logs have in common, with its sizes by each of them alone."""
    return [
        (log, replace(finding, parameters=parameters, at_reference={}))
        for log, parameters in finding.by_log.items()
    ]


def where(finding: Finding) -> str:
    """Stretches of the log in which a fault acts, or the logs that show it, as text."""
    if finding.logs:
        return ", ".join(finding.logs)
    if not finding.segments:
        return "the whole log"
    return ", ".join(span(*segment) for segment in finding.segments)
