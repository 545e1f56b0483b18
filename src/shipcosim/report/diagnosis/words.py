"""What a diagnosis says, in sentences for those who sail and maintain the ship."""

from shipcosim.report.diagnosis.numbers import amount, plus_minus, span, vector

DATA_FAULTS = {
    "gap": "data was lost or filled in",
    "clock": "the clock of the log runs wrong",
    "frame": "channels are in another frame or unit than stated",
    "channel_swap": "channels are exchanged",
    "sign": "a channel has the wrong sign",
    "heading_wrap": "the heading is interpolated across north",
}
REPAIRS = {
    "gap": "cut out",
    "heading_wrap": "cut out",
    "clock": "times put right",
    "frame": "converted",
    "channel_swap": "exchanged back",
    "sign": "sign changed",
}
ADVICE = {
    "current": "Give the simulation this current, or measure it: a ship's model cannot know the water's motion.",
    "current_varying": "Give the simulation this current over time; a tide table says whether it fits.",
    "wave_drift": "Compare with the sea state of the day. If it fits, give the simulation these waves.",
    "tow": "Ask what was made fast: a tether, a tow, a hose, an anchor.",
    "wind_scale": "Look for what changes the windage (deck cargo, superstructure) and how the wind sensor is exposed.",
    "wind_direction": "Check how the wind sensor is aligned with the bow.",
    "thrust_loss": "Inspect the {component} thruster for fouling, damage, ventilation; check its speed feedback.",
    "azimuth_offset": "Calibrate the zero of the azimuth feedback of the {component} thruster.",
    "rpm_offset": "Calibrate the speed feedback of the {component} thruster.",
    "reverse_loss": "Replace the curve of thrust astern in the model by a measured one.",
    "thruster_interaction": "Set a forbidden sector, or allow for the loss in the allocation.",
    "mass": "Check the loading condition against the model's mass.",
    "drag": "Check hull and propellers for fouling, and whether something was in the water.",
    "crossflow": "Measure the resistance in sway and yaw, or take the value found here into the model.",
    "heading_bias": "Align the compass.",
    "lever_arm": "Enter the antenna's position in the navigation system, or in the channel file.",
    "velocity_scale": "Check the unit and the calibration of the velocity.",
    "navigation_lag": "Check time stamps of the navigation's messages.",
    "thruster_lag": "Check time stamps of the thrusters' messages.",
}


def title(cause, component=None):
    """A cause's name as people write it.

    Examples
    --------
    >>> title("thrust_loss", "port")
    'Thrust loss of port'
    """
    text = cause.replace("_", " ")
    return text[:1].upper() + text[1:] + (f" of {component}" if component else "")


def told(finding, effects=None):
    """A finding as a clause with its numbers.

    Parameters
    ----------
    finding : Finding
    effects : dict of str to Cause, optional
        The causes by name: a cause of the user's own speaks by its own sentence.

    Returns
    -------
    str
    """
    if finding.kind == "data":
        return _data(finding)
    if finding.cause in _CLAUSES:
        try:
            return _CLAUSES[finding.cause](finding.parameters, finding.component) + _since(finding)
        except KeyError:  # own file of a known cause, with other parameters
            pass
    sentence = effects[finding.cause].sentence if effects and finding.cause in effects else title(finding.cause)
    numbers = ", ".join(f"{name} {plus_minus(e)}" for name, e in finding.parameters.items())
    place = f" ({finding.component})" if finding.component else ""
    return f"{sentence[:1].lower()}{sentence[1:]}{place}" + (f": {numbers}" if numbers else "") + _since(finding)


def _since(finding):
    return f", from {finding.onset:.0f} s on" if finding.onset is not None else ""


def _data(finding):
    text = DATA_FAULTS.get(finding.cause, title(finding.cause).lower())
    if finding.cause == "gap" and finding.segments:
        seconds, count = sum(b - a for a, b in finding.segments), len(finding.segments)
        text += f" for {seconds:.0f} s in {count} stretch{'es' * (count > 1)}"
    elif finding.cause != "clock" and 0 < len(finding.channels) <= 4:
        text += f" ({', '.join(finding.channels)})"
    return text


def _percent(estimate):
    return f"{100 * estimate.estimate:.0f} ± {max(100 * estimate.std, 0.5):.0f} %"


def _off(parameters, more, less):
    scale = parameters["scale"]
    size = f"{100 * abs(scale.estimate - 1):.0f} ± {max(100 * scale.std, 0.5):.0f} %"
    return f"{size} {more if scale.estimate > 1 else less}"


def _vector(parameters, what):
    return f"{what} of {vector(parameters['north'], parameters['east'])}"


def _varying(parameters, _):
    ends = [vector(parameters[f"north_{end}"], parameters[f"east_{end}"]) for end in ("start", "end")]
    return f"a current of {ends[0]} at the start and {ends[1]} at the end"


def _signed(estimate, more, less):
    return f"{plus_minus(estimate, absolute=True)} {more if estimate.estimate > 0 else less}"


def _lever(parameters, _):
    forward = _signed(parameters["x"], "forward", "aft")
    across = _signed(parameters["y"], "to starboard", "to port")
    return f"position and velocity are those of a point {forward} and {across} of the ship's origin"


_CLAUSES = {
    "current": lambda p, c: _vector(p, "a current"),
    "current_varying": _varying,
    "wave_drift": lambda p, c: _vector(p, "a wave drift force (on the beam)"),
    "tow": lambda p, c: _vector(p, "a pull"),
    "wind_scale": lambda p, c: f"the wind pushes {_off(p, 'harder', 'less hard')} than modelled",
    "wind_direction": lambda p, c: f"the wind sensor shows {_signed(p['offset'], 'too much', 'too little')}",
    "thrust_loss": lambda p, c: (
        f"the {c} thruster delivers {_percent(p['loss'])} less thrust than its speed should give"
    ),
    "reverse_loss": lambda p, c: (
        f"astern the azimuth thrusters deliver {_percent(p['loss'])} less thrust than modelled"
    ),
    "azimuth_offset": lambda p, c: (
        f"the {c} thruster points {_signed(p['offset'], 'clockwise', 'anticlockwise')} of what its feedback says"
    ),
    "rpm_offset": lambda p, c: f"the speed of the {c} thruster is logged {_signed(p['offset'], 'too high', 'too low')}",
    "thruster_interaction": lambda p, c: (
        f"a thruster in its neighbour's slipstream loses {_percent(p['loss'])} of its thrust"
    ),
    "mass": lambda p, c: f"the ship is {_off(p, 'heavier', 'lighter')} than modelled",
    "drag": lambda p, c: f"her resistance ahead is {_off(p, 'larger', 'smaller')} than modelled",
    "crossflow": lambda p, c: f"her resistance in sway and yaw is {_off(p, 'larger', 'smaller')} than modelled",
    "heading_bias": lambda p, c: f"the compass shows {_signed(p['offset'], 'too much', 'too little')}",
    "lever_arm": _lever,
    "velocity_scale": lambda p, c: f"the velocity is logged {_off(p, 'too large', 'too small')}",
    "navigation_lag": lambda p, c: f"position, heading and velocity are logged {plus_minus(p['lag'])} late",
    "thruster_lag": lambda p, c: f"the thrusters' channels are logged {plus_minus(p['lag'])} late",
}


def outcome(diagnosis, effects=None):
    """The verdict as a word, and in one sentence.

    Parameters
    ----------
    diagnosis : Diagnosis
    effects : dict of str to Cause, optional

    Returns
    -------
    tuple of str, str
    """
    data = [told(f) for f in diagnosis.findings if f.kind == "data"]
    physics = [told(f, effects) for f in diagnosis.findings if f.kind == "physics"]
    log = f" The log itself is faulty: {_listed(data)}." if data else ""
    if diagnosis.verdict == "unknown":
        sentence = "The simulation is wrong by more than noise, and none of the known causes explains it."
        return "UNKNOWN", sentence + log
    if diagnosis.verdict == "ambiguous":
        names = [title(c.cause, c.component).lower() for c in diagnosis.indistinguishable]
        besides = f" Certain is: {_listed(physics)}." if physics else ""
        return "AMBIGUOUS", f"Something is wrong, and this log cannot tell which: {_listed(names, 'or')}.{besides}{log}"
    if physics:
        many = f"{len(physics)} things are" if len(physics) > 1 else "One thing is"
        return "NAMED", f"{many} not as modelled: {_listed(physics)}.{log}"
    if data:
        return "NAMED", f"The log is faulty: {_listed(data)}. Apart from that, simulation and log agree."
    return "CONSISTENT", "Simulation and log agree, within noise and the tolerances of the model."


def _listed(texts, last="and"):
    """Several texts as one.

    Examples
    --------
    >>> _listed(["a current", "a tow", "waves"])
    'a current, a tow and waves'
    """
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} {last} {texts[-1]}"


def next_steps(diagnosis, extended=None):
    """What to do now.

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
    if data := [f for f in diagnosis.findings if f.kind == "data"]:
        where = ", ".join(dict.fromkeys(title(f.cause).lower() for f in data))
        steps.append(f"Correct the logging where it is wrong ({where}); this diagnosis used a repaired copy.")
    physics = [f for f in diagnosis.findings if f.kind == "physics"]
    steps += [ADVICE[f.cause].format(component=f.component) for f in physics if f.cause in ADVICE]
    if diagnosis.verdict == "ambiguous":
        steps.append(_manoeuvre(diagnosis.prescription))
    if diagnosis.verdict == "unknown":
        steps.append("Look on the page how the missing force goes with time, heading and wind.")
        steps.append("If you know a cause that is not in the catalogue, add it as one file (docs/add-a-cause.md).")
    if extended:
        steps.append(f"Simulate with the cause in the system: shipcosim simulate {extended}")
    if diagnosis.not_testable:
        names = _listed([title(name).lower() for name in diagnosis.not_testable], "or")
        steps.append(f"This log says nothing about {names}, present or not.")
    return steps or ["Nothing needs to be done."]


def _manoeuvre(prescription):
    if prescription is None:
        return "Log more, with larger moves, turns and thrust ahead and astern: what is alike here differs there."
    name = prescription.manoeuvre.replace("_", " ")
    pairs = _listed([f"{a} from {b}".replace("_", " ") for a, b in prescription.separates] or ["them"])
    return f"Sail this and log it: {name}, {prescription.minutes:.0f} minutes. It tells {pairs} apart."


def estimate_rows(finding):
    """Name, value with standard deviation and unit of each parameter, as texts."""
    largest = {}
    for estimate in finding.parameters.values():
        largest[estimate.unit] = max(abs(estimate.estimate), largest.get(estimate.unit, 0.0))
    return [(n.replace("_", " "), *amount(e, largest=largest[e.unit])) for n, e in finding.parameters.items()]


def where(finding):
    """In which stretches of the log a fault is, as text."""
    if not finding.segments:
        return "the whole log"
    return ", ".join(span(*segment) for segment in finding.segments)
