"""What is put into a system structure where it lacks a cause: currents, forces, instruments, slipstreams."""

from dataclasses import dataclass, field, fields
from math import atan2, hypot
from pathlib import Path
from typing import Any, NamedTuple

import shipcosim
from shipcosim.diagnose.ship.environment import drift_arm_of, stern_of
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.models.core.motion import Motion
from shipcosim.models.ship.instruments import InstrumentParameters
from shipcosim.series import conversion
from shipcosim.ssp import parameter
from shipcosim.ssp.edit.opening import built_fmus

RAMP = 30.0
"""Time over which something grows after its onset, assumed. [s]"""

_BY_LENGTH = {
    "earth_force": ("x", stern_of, "point of attack: the stern, assumed"),
    "drift_force": ("yaw_arm", drift_arm_of, "as of the lengthened Gunnerus, by length"),
}
_AXES = ("X", "Y", "N")


class Estimated(NamedTuple):
    """A value with its standard deviation, None where there is none."""

    value: float
    std: float | None


@dataclass
class StructureEdits:
    """A system structure that is being extended, and what went into it so far.

    Attributes
    ----------
    structure : SystemStructure
        Changed in place.
    ship : str
        Full name of the vessel.
    log : mapping
        Attributes of the log.
    values : dict of str to ParameterValue
        By signal.
    inserted, remarks : list of str
    moved : bool
        Whether a current is in it.
    shows, suffix : str
        Component whose outputs are what the log shows, and what their names end in.
    errors : dict of str to float
    lag : float
        Of the instruments.
    """

    structure: Any
    ship: str
    log: Any
    values: dict = field(default_factory=dict)
    inserted: list = field(default_factory=list)
    remarks: list = field(default_factory=list)
    moved: bool = False
    shows: str = ""
    suffix: str = ""
    errors: dict = field(default_factory=dict)
    lag: float = 0.0

    def __post_init__(self):
        self.shows = self.ship

    @property
    def around(self):
        """What the full names of components beside the ship begin with."""
        return self.ship[: self.ship.rfind(".") + 1]

    def remark(self, finding, what):
        """Say what is not as a finding has it."""
        self.remarks.append(f"{finding.label}: {what}.")

    def thrusters(self, variable="rpm_in"):
        """Components that load the ship and have a variable."""
        sources = [source for source, target in self.structure.connections if target.startswith(f"{self.ship}.tau_")]
        names = dict.fromkeys(source.rpartition(".")[0] for source in sources)
        parts = self.structure.components
        return [name for name in names if name in parts and variable in parts[name].fmu.variables]

    def put(self, finding, signal, given, unit, *, note=""):
        """Give a signal a value in the set."""
        text = "; ".join(filter(None, (note, _origin(finding, self.log))))
        unit = None if unit in (None, "", "1") else unit
        self.values[signal] = parameter(signal, float(given.value), unit, text, tolerance=given.std or None)

    def put_parameter(self, finding, place, name, estimate):
        """Give a parameter of a component its estimate, in the FMU's unit; a remark where there is none such."""
        parts = self.structure.components
        variable = parts[place].fmu.variables.get(name) if place in parts else None
        if variable is None:
            what = f"'{place}' has no parameter '{name}'" if place in parts else f"there is no component '{place}'"
            self.remark(finding, f"{what}, so it is not carried")
            return
        factor, offset = conversion(estimate.unit, variable.unit or "1")
        given = Estimated(factor * estimate.estimate + offset, abs(factor) * estimate.std)
        self.put(finding, f"{place}.{name}", given, variable.unit, note=variable.description)

    def insert(self, fmu, name):
        """Add a component of one of our FMUs beside the ship; its full name."""
        path, taken = self._fmu(fmu), set(self.structure.elements)
        names = (f"{self.around}{name}{number}" for number in ("", *(f"_{k}" for k in range(2, 100))))
        full = next(one for one in names if one not in taken)
        self.structure.add_component(full, path)
        self.inserted.append(full)
        return full

    def _fmu(self, name):
        """File of one of our FMUs: beside those of the system, or built."""
        beside = [part.fmu.path.parent for part in self.structure.components.values()]
        starts = (Path.cwd(), Path(shipcosim.__file__))
        for folder in (*beside, *(folder for start in starts for folder in built_fmus(start))):
            if (folder / f"{name}.fmu").is_file():
                return folder / f"{name}.fmu"
        found = f"{name}.fmu is neither beside the system's FMUs nor in build/fmus."
        raise ShipcosimError(Problem(self.structure.name, found, f"`shipcosim build {name}` makes it."))

    def load(self, component):
        """Connect a component's loads to a free input of the ship; whether there is one."""
        used = {target for _, target in self.structure.connections} | {
            source for source, _ in self.structure.connections
        }
        variables = self.structure.components[self.ship].fmu.variables
        for number in range(1, 100):
            inputs = [f"tau_{axis}_{number}" for axis in _AXES]
            if not all(name in variables for name in inputs):
                return False
            if not any(f"{self.ship}.{name}" in used for name in inputs):
                for axis, name in zip(_AXES, inputs, strict=True):
                    self.structure.connect(f"{component}.tau_{axis}", f"{self.ship}.{name}")
                return True
        return False

    def drop(self, component):
        """Take an inserted component out again."""
        self.structure.remove(component)
        self.inserted.remove(component)

    @staticmethod
    def unit_of_error(name):
        """Unit of an error of the instruments."""
        known = {item.name: item.metadata["unit"] for item in fields(InstrumentParameters)}
        return known.get(name, "s" if name.endswith("lag") else "1")


def add_force(edits, finding, fmu, north, east, others):
    """Insert a force of the earth's direction that acts on the ship.

    Parameters
    ----------
    edits : StructureEdits
        Changed.
    finding : Finding
    fmu : str
        ``"earth_force"`` or ``"drift_force"``.
    north, east : Estimated
        [N]
    others : dict of str to Estimate
        Further parameters of the FMU: where it attacks, which is the stern otherwise.
    """
    name = edits.insert(fmu, finding.cause)
    if not edits.load(name):
        edits.drop(name)
        edits.remark(finding, f"'{edits.ship}' has no free load input, so it is not carried")
        return
    edits.structure.connect(f"{edits.ship}.psi", f"{name}.psi")
    edits.put(finding, f"{name}.north", north, "N")
    edits.put(finding, f"{name}.east", east, "N")
    for number, estimate in others.items():
        edits.put_parameter(finding, name, number, estimate)
    number, of_length, note = _BY_LENGTH[fmu]
    if number not in others:
        given = Estimated(of_length(edits.structure.parameters[f"{edits.ship}.length"]), None)
        edits.put(finding, f"{name}.{number}", given, "m", note=note)
    if finding.onset is not None:
        edits.put(finding, f"{name}.onset_time", Estimated(finding.onset, None), "s")
        edits.put(finding, f"{name}.ramp_time", Estimated(RAMP, None), "s", note="assumed")


def add_current(edits, finding, start, end=None):
    """Make the water move.

    Parameters
    ----------
    edits : StructureEdits
        Changed.
    finding : Finding
        One with an onset gets a current that grows from then on.
    start : tuple of two Estimated
        North and east, steady without an `end`, else at the log's first row; of None at an onset: none. [m/s]
    end : tuple of two Estimated, optional
        At the log's last row, or after the onset. [m/s]
    """
    source = _water(edits)
    if edits.moved:
        edits.remark(finding, "the water moves already by another finding, so it is not carried")
        return
    edits.moved = True
    if end is None:
        _steady(edits, finding, source, *start)
        return
    if source is None:
        source = _environment(edits)
    onset = start == (None, None)
    span = (finding.onset, finding.onset + RAMP) if onset else edits.log.get("span")
    if span is None:
        span = edits.structure.start_time, edits.structure.stop_time or 600.0
        edits.remark(finding, f"the log's span is not known; it varies from {span[0]:g} to {span[1]:g} s")
    name = edits.insert("varying_current", "varying_current")
    for output in ("current_speed", "current_to"):
        _release(edits, f"{source}.{output}")
        edits.structure.connect(f"{name}.{output}", f"{source}.{output}")
    for label, ends in (("start", start), ("end", end)):
        for axis, given in zip(("north", "east"), ends, strict=True):
            if given is not None:
                edits.put(finding, f"{name}.{axis}_{label}", given, "m/s")
    for label, time in zip(("start", "end"), span, strict=True):
        edits.put(finding, f"{name}.time_{label}", Estimated(time, None), "s", note="of the log")


def add_instruments(edits, finding, errors):
    """Put instruments with these errors between the ship and her log.

    Parameters
    ----------
    edits : StructureEdits
        Changed.
    finding : Finding
    errors : dict of str to Estimated
        Fields of `InstrumentParameters`; the lag as ``navigation_lag``.
    """
    for name in [name for name in errors if name not in _ERRORS]:
        del errors[name]
        edits.remark(finding, "it is one of the log, not of the ship: shift the channels")
    if errors and not edits.suffix:
        edits.shows, edits.suffix = edits.insert("instruments", "instruments"), "_meas"
        for name in Motion._fields:
            edits.structure.connect(f"{edits.ship}.{name}", f"{edits.shows}.{name}")
    for name, given in errors.items():
        field_name = _ERRORS[name]
        edits.put(finding, f"{edits.shows}.{field_name}", given, edits.unit_of_error(field_name))
        if field_name == "lag":
            edits.lag = given.value
        else:
            edits.errors[field_name] = given.value


_ERRORS = {name: name for name in ("heading_bias", "lever_x", "lever_y", "velocity_scale")} | {"navigation_lag": "lag"}


def add_slipstreams(edits, finding, units):
    """Tell each unit where its neighbour is, and how that runs: the one that is wired to it, else the nearest."""
    values, wired = edits.structure.parameters, set(edits.structure.connections)
    feeds = {target for _, target in wired}
    place = {unit: (values[f"{unit}.x"], values[f"{unit}.y"]) for unit in units}
    for unit in units:
        here = place[unit]
        fed = {source.rpartition(".")[0] for source, target in wired if target == f"{unit}.neighbour_azimuth"}
        others = sorted((o for o in units if o != unit), key=lambda o: (o not in fed, _distance(place[o], here)))
        if not others:
            edits.remark(finding, f"'{unit}' has no neighbour")
            continue
        for name in ("azimuth", "rpm"):
            if f"{unit}.neighbour_{name}" not in feeds:
                edits.structure.connect(f"{others[0]}.{name}", f"{unit}.neighbour_{name}")
        for name, there in zip(("neighbour_x", "neighbour_y"), place[others[0]], strict=True):
            if values[f"{unit}.{name}"] != there:
                edits.put(finding, f"{unit}.{name}", Estimated(there, None), "m", note=f"where {others[0]} is")


def _distance(a, b):
    return hypot(a[0] - b[0], a[1] - b[1])


def _water(edits):
    """Component that moves the ship's water and takes its speed and direction; None where there is none such."""
    feeding = {connection.target: connection.source for connection in edits.structure.checked().connections}
    source, _ = feeding.get((edits.ship, "current_north"), (None, ""))
    variables = edits.structure.components[source].fmu.variables if source else {}
    return source if {"current_speed", "current_to"} <= set(variables) else None


def _environment(edits):
    """Insert an environment that only moves the water."""
    name = edits.insert("environment", "water")
    for axis in ("north", "east"):
        _release(edits, f"{edits.ship}.current_{axis}")
        edits.structure.connect(f"{name}.current_{axis}", f"{edits.ship}.current_{axis}")
    return name


def _steady(edits, finding, source, north, east):
    """Give the water one velocity, where the system takes it."""
    if source is None:
        for axis, given in (("north", north), ("east", east)):
            _start(edits, finding, edits.ship, f"current_{axis}", given, "m/s")
        return
    speed = hypot(north.value, east.value)
    along = hypot(north.value * north.std, east.value * east.std) / (speed or 1.0)
    across = hypot(east.value * north.std, north.value * east.std) / (speed * speed or 1.0)
    _start(edits, finding, source, "current_speed", Estimated(speed, along), "m/s")
    _start(edits, finding, source, "current_to", Estimated(atan2(east.value, north.value), across), "rad")


def _start(edits, finding, component, name, given, unit):
    """Start value of an input: at the system's own input where that feeds it, else at the component."""
    system, target = edits.structure.checked(), (component, name)
    feeding = next((c for c in system.connections if c.target == target), None)
    outer = feeding is not None and feeding.source[0] is None and feeding.mapping is None and feeding.factor != 0.0
    if not outer:
        _release(edits, f"{component}.{name}")
        edits.put(finding, f"{component}.{name}", given, unit)
        return
    signal = system.inputs[feeding.source[1]]
    value = (given.value - feeding.offset) / feeding.factor
    edits.put(finding, signal.name, Estimated(value, given.std / abs(feeding.factor)), signal.unit)
    edits.remark(finding, f"a table that feeds the input '{signal.name}' overrides it")


def _release(edits, input_name):
    """Disconnect an input from whatever feeds it."""
    if any(input_name in pair for pair in edits.structure.connections):
        edits.structure.disconnect(input_name)


def _origin(finding, log):
    """Where a value comes from, for the set."""
    sizes = ", ".join(f"{name} {e.estimate:.4g} ± {e.std:.2g} {e.unit}" for name, e in finding.parameters.items())
    source = Path(str(log["source"])).name if log.get("source") else "a log"
    digest = f", SHA-256 {log['sha256']}" if log.get("sha256") else ""
    return f"{finding.label}, named with probability {finding.probability:.2f}: {sizes}; from {source}{digest}"


def rewire(edits, name):
    """Connect a thruster's loads to the ship, and its inputs to the system's, as their names say."""
    structure, loads = edits.structure, {f"{name}.tau_{axis}" for axis in _AXES}
    wrong = [pair for pair in structure.connections if pair[0] in loads and pair[1].startswith(f"{edits.ship}.tau_")]
    slots = [target.rpartition("_")[2] for _, target in wrong]
    for pair in wrong:
        structure.disconnect(*pair)
    for axis in _AXES if wrong else ():
        structure.connect(f"{name}.tau_{axis}", f"{edits.ship}.tau_{axis}_{max(slots, key=slots.count)}")
    for source, target in structure.connections:
        kind = target.removeprefix(f"{name}.").removesuffix("_in")
        if target == f"{name}.{kind}_in" and source.endswith(f"_{kind}") and "." not in source:
            structure.disconnect(source, target)
            structure.connect(f"{name}_{kind}", target)
