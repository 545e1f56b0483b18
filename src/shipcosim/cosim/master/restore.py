"""Taking a snapshot of a running system, and putting one back."""

from shipcosim.cosim.master.algorithm import Failure
from shipcosim.cosim.master.events import in_force_after, target_of
from shipcosim.cosim.master.plan import label
from shipcosim.cosim.master.result import hashes, start_values
from shipcosim.cosim.master.snapshot import Snapshot
from shipcosim.cosim.slaves.interface_type import interface_type_of
from shipcosim.cosim.slaves.slave import SlaveError
from shipcosim.errors import Problem, ShipcosimError

ABILITIES = ("canGetAndSetFMUstate", "canSerializeFMUstate"), ("canGetAndSetFMUState", "canSerializeFMUState")
"""What an FMU has to declare so that its state can be stored, in FMI 2.0 and 3.0."""


def check_storable(system):
    """Raise ShipcosimError with the components whose FMUs cannot store their state."""
    problems = []
    for component in system.components.values():
        fmu = component.fmu
        if interface_type_of(component) == "ModelExchange":
            found = "it runs as model exchange, and the solver's state cannot be stored."
            problems.append(Problem(component.name, found, "Run the system without storing it."))
            continue
        needed = ABILITIES[fmu.fmi_version.startswith("3")]
        lacking = [name for name in needed if fmu.interfaces["CoSimulation"].get(name) not in ("true", "1")]
        if lacking:
            found = f"{fmu.path.name} cannot store its state: it does not declare {' and '.join(lacking)}."
            problems.append(Problem(component.name, found, "Run the system without storing it."))
    if problems:
        raise ShipcosimError(problems)


def check_fit(snapshot, system, scenario):
    """Raise ShipcosimError where a system or a scenario cannot go on from a snapshot."""
    where, problems = f"snapshot at {snapshot.time:g} s", []
    if scenario.step_size != snapshot.step_size:
        found = f"it was stored in a run with steps of {snapshot.step_size:g} s, this one has {scenario.step_size:g} s."
        problems.append(Problem(where, found, "The step size cannot change on the way."))
    if set(snapshot.fmus) != set(system.components):
        found = f"it holds {', '.join(snapshot.fmus)}; the system has {', '.join(system.components)}."
        problems.append(Problem(where, found, "Continue with the system that was stored."))
    else:
        problems += _changed_fmus(snapshot, system, where) or _changed_values(snapshot, system, where)
    if problems:
        raise ShipcosimError(problems)


def _changed_fmus(snapshot, system, where):
    present = hashes(system)
    remedy = "A state belongs to the code that it comes from. Continue with the FMU that was stored."
    return [
        Problem(where, f"{name}: {component.fmu.path.name} is another FMU than the one that was stored.", remedy)
        for name, component in system.components.items()
        if present[name] != snapshot.fmus[name]
    ]


def _changed_values(snapshot, system, where):
    present, stored = start_values(system), snapshot.start_values
    remedy = "It is part of the stored state. An event can change inputs, outputs and tunable parameters."
    return [
        Problem(where, f"{name} was {stored.get(name)!r} and would now be {present.get(name)!r}.", remedy)
        for name in sorted(present | stored)
        if present.get(name) != stored.get(name)
    ]


def take(plan, exchanges, parts, span, scenario, in_force):
    """Snapshot at the end of a span; `in_force` are the changes that were in force at its beginning."""
    outputs, inputs, changes = {}, {}, in_force_after(scenario, plan, span, in_force)
    for kind, exchange in exchanges.items():
        ends = plan.layouts[kind].outputs, plan.layouts[kind].inputs
        outputs |= zip(map(label, ends[0]), exchange.outputs.tolist(), strict=True)
        inputs |= zip(plan.layouts[kind].carried, exchange.plain.tolist(), strict=True)
        for rows, changed in zip(ends, (exchange.output_changes, exchange.input_changes), strict=True):
            changes |= {label(rows[row]): change for row, change in changed.in_force.items()}
    return Snapshot(
        system=plan.system.name,
        start_time=span.start_time,
        step_size=scenario.step_size,
        step=span.last,
        fmus=hashes(plan.system),
        start_values=start_values(plan.system),
        outputs=outputs,
        inputs=inputs,
        changes=changes,
        states={name: _blamed(part, part.slave.state) for name, part in parts.items()},
    )


def put_back(snapshot, plan, exchanges, texts, parts):
    """Bring the values and the FMUs of a system that has been initialised into the state that they had."""
    for name, part in parts.items():
        _blamed(part, part.restore, snapshot.states[name])
    for name, change in snapshot.changes.items():
        end = plan.system.split(name)
        if end[0] is not None:
            target, row = target_of(end, plan, exchanges)
            target.put(row, *change)
    for kind, exchange in exchanges.items():
        _fill(exchange.outputs, map(label, plan.layouts[kind].outputs), snapshot.outputs)
        exchange.transfer(0)
        _fill(exchange.plain, plan.layouts[kind].carried, snapshot.inputs)
    for text in texts:
        text.last = None


def _fill(values, names, known):
    """Set values by name, where they are known."""
    values[:] = [known.get(name, value) for name, value in zip(names, values, strict=True)]


def _blamed(part, call, *arguments):
    """What a call to a component returns; what goes wrong is a failure of this component."""
    try:
        return call(*arguments)
    except SlaveError as error:
        raise Failure(Problem(part.name, f"its state cannot be stored or restored. {error}")) from error
