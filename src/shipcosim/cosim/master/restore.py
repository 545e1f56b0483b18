"""Take a snapshot of a running system, and continue from one."""

from collections.abc import Mapping, Sequence
from itertools import pairwise

from shipcosim.cosim.master.algorithm import Failure
from shipcosim.cosim.master.component import ComponentInstance
from shipcosim.cosim.master.connections import StringConnection
from shipcosim.cosim.master.events import modifiers_after, modifiers_of
from shipcosim.cosim.master.plan import Plan, label
from shipcosim.cosim.master.result import hashes, start_values
from shipcosim.cosim.master.signals import Exchange, Modifier
from shipcosim.cosim.master.time_grid import TimeGrid
from shipcosim.cosim.slaves.interface_type import interface_type_of
from shipcosim.cosim.slaves.pythonfmu_code import stores_registered_alone
from shipcosim.cosim.slaves.slave import SlaveError
from shipcosim.errors import Problem, raise_errors, shortened
from shipcosim.scenario import Scenario
from shipcosim.snapshot import Snapshot
from shipcosim.ssp import System

ABILITIES = (
    ("canGetAndSetFMUstate", "canSerializeFMUstate"),
    ("canGetAndSetFMUState", "canSerializeFMUState"),
)
"""Capability flags that an FMU needs so that its state can be stored, in FMI 2.0 and 3.0."""


TRIED = 10
"""Steps by which a state is tried. Assumed: what an FMU forgets shows in its outputs by then, or seldom does."""


def check_storable(system: System) -> None:
    """Raise ShipcosimError with the components whose FMUs cannot store their state."""
    problems = []
    for component in system.components.values():
        fmu = component.fmu
        # The solver of a model-exchange component lies outside the FMU; its state would be lost.
        if interface_type_of(component) == "ModelExchange":
            message = "it runs as model exchange, and the solver's state cannot be stored."
            problems.append(Problem(component.name, message, "Run the system without storing it."))
            continue
        needed = ABILITIES[fmu.fmi_version.startswith("3")]
        lacking = [
            name for name in needed if fmu.interfaces["CoSimulation"].get(name) not in ("true", "1")
        ]
        if lacking:
            message = f"{fmu.path.name} cannot store its state: it does not declare {' and '.join(lacking)}."
            problems.append(Problem(component.name, message, "Run the system without storing it."))
        elif stores_registered_alone(fmu.path):
            message = f"{fmu.path.name} stores its registered variables alone: PythonFMU loses what else it keeps."
            remedy = "Give its class _get_fmu_state and _set_fmu_state, or run the system without storing it."
            problems.append(Problem(component.name, message, remedy))
    raise_errors(problems)


def check_fit(snapshot: Snapshot, system: System, scenario: Scenario) -> None:
    """Raise ShipcosimError if a system or scenario cannot continue from a snapshot."""
    where = f"snapshot at {snapshot.time:g} s"
    problems = []
    # The step is counted in steps since the start, so its size must stay.
    if scenario.step_size != snapshot.step_size:
        message = f"it was stored in a run with steps of {snapshot.step_size:g} s, this one has {scenario.step_size:g} s."
        problems.append(Problem(where, message, "The step size cannot change on the way."))
    # Other components, another FMU or other parameters make the states meaningless.
    if set(snapshot.fmus) != set(system.components):
        message = (
            f"it holds {', '.join(snapshot.fmus)}; the system has {', '.join(system.components)}."
        )
        problems.append(Problem(where, message, "Continue with the system that was stored."))
    else:
        problems += _changed_fmus(snapshot, system, where) or _changed_values(
            snapshot, system, where
        )
    raise_errors(problems)


def _changed_fmus(snapshot, system, where):
    present = hashes(system)
    remedy = (
        "A state belongs to the code that it comes from. Continue with the FMU that was stored."
    )
    return [
        Problem(
            where,
            f"{name}: {component.fmu.path.name} is another FMU than the one that was stored.",
            remedy,
        )
        for name, component in system.components.items()
        if present[name] != snapshot.fmus[name]
    ]


def _changed_values(snapshot, system, where):
    present = start_values(system)
    stored = snapshot.start_values
    remedy = "It is part of the stored state. An event can change inputs, outputs and tunable parameters."
    return [
        Problem(
            where,
            f"{name} was {stored.get(name)!r} and would now be {present.get(name)!r}.",
            remedy,
        )
        for name in sorted(present | stored)
        if present.get(name) != stored.get(name)
    ]


def take_snapshot(
    plan: Plan,
    exchanges: Mapping[str, Exchange],
    components: Mapping[str, ComponentInstance],
    grid: TimeGrid,
    scenario: Scenario,
    active: Mapping[str, Modifier],
) -> Snapshot:
    """Snapshot at the end of a run.

    Parameters
    ----------
    plan, exchanges, components, grid, scenario
        Of the run.
    active : mapping of str to (scale, shift)
        Overrides and biases of signals that acted at its beginning.

    Raises
    ------
    Failure
        If an FMU does not give its state.
    """
    outputs = {}
    inputs = {}
    modifiers = modifiers_after(scenario, plan, grid, active)
    # Outputs, and inputs before overrides: connections with longer periods still hold old values.
    for kind, exchange in exchanges.items():
        layout = plan.layouts[kind]
        outputs |= zip(map(label, layout.outputs), exchange.outputs.tolist(), strict=True)
        inputs |= zip(layout.transferred_names, exchange.transferred.tolist(), strict=True)
        # Overrides that act at the end must act again after the restart.
        modifiers |= {
            label(layout.outputs[row]): modifier
            for row, modifier in exchange.output_modifiers.active.items()
        }
        modifiers |= {
            label(layout.inputs[row]): modifier
            for row, modifier in exchange.input_modifiers.active.items()
        }
    return Snapshot(
        system=plan.system.name,
        start_time=grid.start_time,
        step_size=scenario.step_size,
        step=grid.last,
        fmus=hashes(plan.system),
        start_values=start_values(plan.system),
        outputs=outputs,
        inputs=inputs,
        changes=modifiers,
        states={
            name: _stored(component, component.slave.state)
            for name, component in components.items()
        },
    )


def check_restored(
    snapshot: Snapshot,
    exchanges: Mapping[str, Exchange],
    components: Mapping[str, ComponentInstance],
    grid: TimeGrid,
) -> None:
    """Step FMUs that are not ours on from a snapshot, twice: both times have to give the same outputs.

    What an FMU keeps beside its state shows so, as far as its outputs follow from it within `TRIED` steps. Where the
    run has no steps left nothing is tried. The components are not those of the run afterwards.

    Raises
    ------
    Failure
        If an FMU gives other outputs after its state was restored.
    """
    for name, component in components.items():
        if getattr(component.slave, "python_object", None) is not None:
            continue
        ends = grid.times[grid.last :: component.multiple][: TRIED + 1]
        live = _stored(component, _stepped, component, exchanges, ends)
        _stored(component, component.restore, snapshot.states[name])
        again = _stored(component, _stepped, component, exchanges, ends)
        if live != again:
            message = "its state is not complete: restored, it goes on with other outputs than without that."
            raise Failure(Problem(name, message, "Run the system without storing it."))


def _stepped(component, exchanges, times):
    """Outputs of a component, as bytes, after each of some steps with the inputs as they are."""
    outputs = []
    for time, end in pairwise(times):
        component.write()
        component.step(float(time), float(end - time))
        component.read()
        for kind, (first, variables) in component.output_rows.items():
            outputs.append(exchanges[kind].sources[first : first + len(variables)].tobytes())
    return outputs


def restore_snapshot(
    snapshot: Snapshot,
    plan: Plan,
    exchanges: Mapping[str, Exchange],
    string_connections: Sequence[StringConnection],
    components: Mapping[str, ComponentInstance],
) -> None:
    """Restore the values and FMUs of an initialised system.

    Raises
    ------
    Failure
        If an FMU does not take its state.
    """
    # A row before the first step would else show values of the start.
    shown = [label(end) for layout in plan.layouts.values() for end in layout.outputs]
    if lost := sorted(set(shown) - set(snapshot.outputs)):
        message = f"it has no value of {shortened(lost)}."
        raise Failure(
            Problem(f"snapshot at {snapshot.time:g} s", message, "Store the state again.")
        )
    # FMU states first, then the overrides, then the values in the arrays.
    for name, component in components.items():
        _stored(component, component.restore, snapshot.states[name])
    for name, modifier in snapshot.changes.items():
        end = plan.system.split(name)
        if end[0] is not None:
            modifiers, row = modifiers_of(end, plan, exchanges)
            modifiers.put(row, *modifier)
    for kind, exchange in exchanges.items():
        layout = plan.layouts[kind]
        # Outputs first; the transfer then computes the inputs. Inputs that held an older value get
        # it back after it.
        _fill(exchange.outputs, map(label, layout.outputs), snapshot.outputs)
        exchange.transfer(0)
        _fill(exchange.transferred, layout.transferred_names, snapshot.inputs)
    # Strings are passed on again, since the FMU may have other values.
    for connection in string_connections:
        connection.last = None


def _fill(values, names, stored):
    """Set the values of known names; keep the others."""
    values[:] = [stored.get(name, value) for name, value in zip(names, values, strict=True)]


def _stored(component, call, *arguments):
    """Call a method of a component; an error is a failure of this component."""
    try:
        return call(*arguments)
    except SlaveError as error:
        raise Failure(
            Problem(component.name, f"its state cannot be stored or restored. {error}")
        ) from error
