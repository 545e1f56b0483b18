"""The five links of the chain as sections of the page: log, error, cause, extension, gain."""

import numpy as np

from shipcosim.diagnose.experiment.manoeuvres import cannot_turn, library
from shipcosim.diagnose.hypotheses.catalogue import read_faults
from shipcosim.diagnose.inference.search import without_causes
from shipcosim.diagnose.inference.verdict import gained
from shipcosim.diagnose.validation.gain import rms
from shipcosim.report.diagnosis import causes, error, parts
from shipcosim.report.diagnosis.data import log_panels, track_panel
from shipcosim.report.diagnosis.numbers import plain
from shipcosim.report.diagnosis.words import estimate_rows, title, told, where


def data_section(story, figures):
    """Is the log right?"""
    details = story.details
    faults = [f for f in story.diagnosis.findings if f.kind == "data"]
    rows = [
        (title(f.cause), ", ".join(f.channels) or "all", where(f), f.note or told(f), read_faults()[f.cause].repair)
        for f in faults
    ]
    text = (
        "Each channel as logged (faint) and as used. Faulty stretches are shaded."
        if faults
        else "Position, velocity, heading and rate of turn agree with each other, and so do the clocks."
    )
    panels = [
        track_panel(details.explained.identification.repaired),
        *log_panels(
            details.explained.identification.log, details.explained.identification.repaired, story.diagnosis.findings
        ),
    ]
    head = ["Fault", "Channels", "Where", "What", "Done about it"]
    return parts.section(
        "log",
        "1 Is the log right?",
        parts.lead(text),
        parts.table(head, rows),
        parts.listed(story.notes),
        figures.grid(panels),
        parts.folded("Ordinary, and handled", story.handled),
    )


def error_section(story, figures):
    """What does the simulation get wrong?"""
    content = []
    if story.errors is None:
        content.append(
            parts.lead("The log is too short, or has too many gaps, to measure predictions on rows not fitted.")
        )
    else:
        models = _judged(story, ("plain", "floor"))
        head, rows = error.error_table(story.errors, models)
        content.append(
            parts.lead(
                "The simulation starts from the logged state, runs on with the logged thrusters and wind, and is "
                "compared with the log: root mean square errors, on rows that nothing was fitted on. The noise floor "
                "is what a perfect model would miss."
            )
        )
        content.append(figures.grid(error.error_panels(story.errors, models)))
        content.append(parts.subheading("Errors after 60 s" + ": simulation / noise floor" * (len(models) > 1)))
        content.append(parts.table(head, rows, tight=range(2, 9)))
    if story.force is not None:
        thrusters = story.details.problem.model.azimuths
        content.append(parts.lead("What else must have pushed the ship for her to move as she did:"))
        content.append(figures.grid(error.force_panels(story.force, story.force_left, thrusters)))
    return parts.section("error", "2 What does the simulation get wrong?", *content)


def _judged(story, models):
    """Models to show; what a perfect model would miss is not known while something is wrong that has no name."""
    return [m for m in models if m != "floor" or story.diagnosis.verdict in ("named", "consistent")]


def causes_section(story, figures):
    """Which cause?"""
    diagnosis, details = story.diagnosis, story.details
    fit, problem = details.fit, details.problem
    nothing = without_causes(details.fits)
    text = (
        "Every cause of the catalogue, alone and with others, was fitted to the whole log, while every coefficient of "
        "the ship stayed free within its tolerance."
    )
    began = sorted({f.onset for f in diagnosis.findings if f.onset is not None})
    if began:
        text += f" What is wrong began at {began[0]:.0f} s: rows before are healthy, what follows is of those after."
    content = [parts.lead(text), _estimates(story), _stands_out(story)]
    panels = [causes.evidence_panel(details.fits, fit)] if len(details.fits) > 1 else []
    panels += [causes.estimate_panel(fit)] if fit.hypotheses else []
    content.append(figures.grid(panels))
    if details.unmodelled:
        content.append(figures.grid([causes.strange_panel(details.unmodelled)]))
    shown = {"Before: the plain model": causes.whiteness(problem, nothing, as_it_is=True)}
    if fit.hypotheses:
        shown["After: with the causes"] = causes.whiteness(problem, fit)
    low, high = (pick(list(shown.values())) for pick in (np.nanmin, np.nanmax))
    between = [min(-0.2, 1.05 * float(low)), max(0.2, 1.05 * float(high))]
    step, rows = problem.record.step, problem.record.time.size
    panels = [causes.whiteness_panel(name, found, step, rows, between) for name, found in shown.items()]
    content.append(figures.grid(panels))
    content.append(_alike(diagnosis))
    content.append(_to_sail(diagnosis.prescription, problem))
    if diagnosis.not_testable:
        content.append(parts.subheading("What this log could not have shown"))
        rows = causes.not_testable_rows(problem, diagnosis.not_testable, story.causes)
        content.append(parts.table(["Cause", "What it would be", "Why not"], rows))
    return parts.section("causes", "3 Which cause?", *content)


def _estimates(story):
    rows = []
    for finding in story.diagnosis.findings:
        if finding.kind == "physics":
            for name, value, std, unit in estimate_rows(finding):
                chance = f"{100 * finding.probability:.0f} %"
                rows.append((title(finding.cause, finding.component), name, value, f"± {std}", unit, chance))
    return parts.table(["Cause", "Parameter", "Estimate", "Std", "Unit", "Probability"], rows, tight=range(1, 6))


def _stands_out(story):
    """What each cause gains, beside what it gains by chance on healthy ships."""
    details = story.details
    rows = []
    for hypothesis in details.fit.hypotheses:
        chance = details.null_gains.get(hypothesis.label)
        by_chance = "far above what healthy ships show" if chance is None else f"up to {plain(chance, 2)} nats"
        rows.append(
            (
                title(hypothesis.cause, hypothesis.component),
                plain(gained(hypothesis, details.fit, details.fits)),
                by_chance,
            )
        )
    head = ["Cause", "Makes the log likelier by [nats]", "The same on healthy ships on this track"]
    return parts.table(head, rows, tight=(1,))


def _to_sail(prescription, problem):
    """The prescribed manoeuvre step by step."""
    known = library(problem.model, cannot_turn(problem.record, problem.model)) if prescription else ()
    manoeuvre = next((one for one in known if one.name == prescription.manoeuvre), None)
    if manoeuvre is None:
        return ""
    heading = f"To sail and log: {manoeuvre.name}, {prescription.minutes:g} minutes"
    pairs = [f"It tells {a} from {b}.".replace("_", " ") for a, b in prescription.separates]
    rows = causes.manoeuvre_rows(manoeuvre)
    seen = "Seen from where the ship was and how she lay at the start. The DP leaves a thruster alone that pushes."
    return (
        parts.subheading(heading)
        + parts.lead(seen)
        + parts.listed(pairs)
        + parts.table(["When", "What"], rows, tight=(0,))
    )


def _alike(diagnosis):
    alike = diagnosis.indistinguishable
    named = {(f.cause, f.component) for f in diagnosis.findings}
    others = [c for c in diagnosis.candidates if (c.cause, c.component) not in named and c not in alike]
    besides = "Found beside what has no name" if diagnosis.verdict == "unknown" else "Other candidates"
    text = ""
    for heading, entries in (("What this log cannot tell apart", alike), (besides, others)):
        rows = [(title(c.cause, c.component), f"{100 * c.probability:.1f} %") for c in entries]
        text += parts.subheading(heading) + parts.table(["Cause", "Probability"], rows) if rows else ""
    return text


def extension_section(story, figures):
    """What was changed in the system?"""
    extension = story.extension
    if extension is None:
        found = any(f.kind == "physics" for f in story.diagnosis.findings)
        text = (
            "The system could not be extended."
            if found
            else "No cause in the model was named; the system stays as it is."
        )
        return parts.section("extension", "4 The extended system", parts.lead(text))
    rows = [
        (name, *_before_after(name, value, story.system, story.extended or story.system))
        for name, value in extension.values.items()
    ]
    inserted = ", ".join(extension.components)
    if not extension.values:
        text = "The cause is one of the log: its channels are to be corrected, the system stays as it is."
        return parts.section("extension", "4 The extended system", parts.lead(text), parts.listed(extension.remarks))
    content = [
        parts.lead(
            f"The named causes, and nothing else, are in {extension.ssv.name}, which {extension.ssp.name} has bound."
        ),
        parts.table(["Number", "Was", "Is", "Unit"], rows, tight=(1, 2, 3)),
        parts.lead(f"Inserted into the system: {inserted}." if inserted else "No component was inserted."),
        parts.listed(extension.remarks),
        f"<p>Run it: <code>shipcosim simulate {parts.escape(extension.ssp.name)}</code></p>",
    ]
    return parts.section("extension", "4 The extended system", *content)


def _before_after(name, value, system, extended):
    component, _, variable = name.rpartition(".")
    start = system.components[component].start_value(variable) if component in system.components else None
    known = extended.components[component].fmu.variables if component in extended.components else extended.inputs
    unit = known[variable].unit if variable in known else ""
    was = plain(float(start), 5) if isinstance(start, int | float) else "–"
    return was, plain(float(value), 5), "" if unit in (None, "1") else unit


def gain_section(story, figures):
    """What was gained?"""
    gain, models = story.diagnosis.gain, _judged(story, tuple(error.MODELS))
    if story.errors is None:
        return parts.section("gain", "5 The gain", parts.lead("There was too little data to measure it."))
    if story.extension is None or gain is None:
        models = [model for model in models if not model.startswith("extended")]
    how = (
        f"Each prediction is a co-simulation of the {'extended ' if 'extended' in models else ''}system"
        if story.simulated is not None
        else "Predictions by the ship's model in array form"
    )
    text = (
        f"{how}, on rows that the causes were not fitted on: position errors after 60 s, beside the honest rival, the "
        "plain model with a slowly estimated force as DP systems have. An observer helps the model with the cause "
        "too: with one on both sides, the difference is what the cause is worth to a DP."
    )
    content = [parts.lead(text), _gain_table(gain), figures.grid(error.gain_panels(story.errors, models))]
    if gain:
        content += [
            parts.subheading("By condition"),
            parts.table(*error.condition_table(story.errors, story.unseen_errors), tight=range(1, 8)),
            parts.lead(_not_there(story.unseen_errors)),
            parts.lead(_rest(story.comparison)),
        ]
    if story.simulated is not None and "difference" in story.simulated:
        apart = float(story.simulated["difference"].isel(horizon=-1).max())
        content.append(parts.lead(f"Co-simulation and array form differ by at most {plain(apart, 2)} m after 60 s."))
    return parts.section("gain", "5 The gain", *content)


def _rest(comparison):
    """What could be learned besides, without a name."""
    missed = [parts.metres(rms(comparison.errors, "position", model)) for model in ("extended", "calibrated")]
    return (
        f"Apart from the causes: with every known number of the ship moved within its tolerance too, as the rows that "
        f"were fitted on want it, {missed[1]} would be missed over the later part instead of {missed[0]} (in array "
        "form). No such number is named, and none is in the extended system."
    )


def _not_there(unseen):
    """How conditions were held out, and which this log does not have."""
    said = "Conditions not fitted on are held out of the fit wherever in the log they are. Intervals hold 95 %."
    lacks = {"other headings": "another quarter of headings", "free drift": "a drift without thrust"}
    missing = [text for name, text in lacks.items() if name not in unseen]
    return f"{said} The log has too little of {' and of '.join(missing)} for it." if missing else said


def _gain_table(gain):
    if not gain:
        return ""
    rows = [
        ("Simulation as it was", parts.metres(gain["before_m"])),
        ("with a bias observer", parts.metres(gain["bias_observer_m"])),
        ("with the named causes", parts.metres(gain["after_m"])),
        ("Noise floor", parts.metres(gain["noise_floor_m"])),
    ]
    if gain["share_of_explainable"] is not None:
        rows.append(("Explainable error removed", error.removed(gain)))
    return parts.table(["Position error after 60 s", "Root mean square"], rows)


def status(key, story):
    """What a link of the chain found, in a few words."""
    diagnosis = story.diagnosis
    if key == "log":
        faults = sum(f.kind == "data" for f in diagnosis.findings)
        return f"{faults} fault{'s' * (faults != 1)}" if faults else "no fault found"
    if key == "error":
        base = diagnosis.baseline
        return (
            f"{parts.metres(base['position_error_m'][-1])} after {base['horizon_s'][-1]:g} s"
            if base
            else "not measured"
        )
    if key == "causes":
        names = [title(f.cause, f.component) for f in diagnosis.findings if f.kind == "physics"]
        return ", ".join(names) or {"consistent": "none", "named": "none"}.get(diagnosis.verdict, diagnosis.verdict)
    if key == "extension":
        return "extended.ssp" if story.extension is not None else "none"
    gain = diagnosis.gain
    if gain and gain["share_of_explainable"] is not None:
        return f"{100 * gain['share_of_explainable']:.0f} % of the explainable error"
    return "nothing to gain" if diagnosis.verdict == "consistent" else "none"
