"""A job in libcosim's form: OspSystemStructure.xml, scenario, and what they cannot express."""

import json
from collections.abc import Callable, Iterator, Mapping

from shipcosim.cosim.engines.adapter import Job, sums, unsupported
from shipcosim.cosim.master.events import SignalChange
from shipcosim.errors import Problem
from shipcosim.ssp import Connection, Simulator, seconds_text, structure_text


def structure_of(
    job: Job,
    sources: Mapping[str, str] | None = None,
    values: Mapping[str, dict] | None = None,
    end_time: float | None = None,
) -> str:
    """OspSystemStructure.xml of a job, no events in it.

    Parameters
    ----------
    job : Job
        Without complaints.
    sources : mapping of str to str, optional
        Addresses of the FMUs by component; where they are if not given.
    values : mapping of str to dict, optional
        Initial values by component, as in Simulator; none if not given.
    end_time : float, optional
        [s]
    """
    step = job.scenario.step_size
    sources = sources or {}
    values = values or {}
    simulators = [
        Simulator(
            name,
            sources.get(name) or component.fmu.path.resolve().as_uri(),
            step * job.plan.multiples[name],
            values.get(name, {}),
        )
        for name, component in job.system.components.items()
    ]
    return structure_text(simulators, job.connections, step, end_time)


def event_of(job: Job, change: SignalChange) -> dict[str, object]:
    """Event of OSP that makes a change of a job."""
    component, variable = change.end
    # The event's time as text of the step size times the step: the same double as in our grid.
    time = float(seconds_text(job.scenario.step_size * change.step))
    event = {"time": time, "model": component, "variable": variable, "action": change.action}
    if change.action != "reset":
        event["value"] = {"Real": float, "Boolean": bool}.get(
            job.plan.variable(change.end).kind, int
        )(change.value)
    return event


def events_json(job: Job) -> str:
    """Scenario of OSP, in JSON, with the changes that a job makes to connections."""
    events = [event_of(job, change) for change in job.changes]
    after = 2.0 * job.times[-1]  # all changes are taken back at this time
    return json.dumps({"description": job.scenario.description, "events": events, "end": after})


def unsupported_by_libcosim(job: Job) -> list[Problem]:
    """Problems of libcosim with a job."""
    return unsupported("libcosim", job, _complaint_of(job), _problems(job))


def _problems(job: Job) -> Iterator[Problem]:
    """Problems other than connections, which libcosim would ignore or crash on."""
    # libcosim counts in nanoseconds; a step that is no whole number of them would drift.
    if abs(job.scenario.step_size * 1e9 - nanoseconds(job.scenario.step_size)) > 1e-6:
        message = f"The step size {job.scenario.step_size!r} s is no whole number of nanoseconds, in which libcosim counts."
        yield Problem("step_size", message)
    for component in job.system.components.values():
        if component.fmu.fmi_version != "2.0":
            yield Problem(
                component.name,
                f"is an FMU of FMI {component.fmu.fmi_version}; libcosim runs FMI 2.0.",
            )


def _complaint_of(job: Job) -> Callable[[Connection], str | None]:
    def complaint(connection):
        source, target = (
            job.plan.variable(end).causality for end in (connection.source, connection.target)
        )
        if (source, target) != ("output", "input"):
            return f"it goes from {source} to {target}"
        # OSP has functions for a linear transformation and for a sum, but not for both in one.
        return (
            "it is transformed and added to others"
            if connection in added and connection.is_linear
            else None
        )

    added = sums(job.connections)
    return complaint


def nanoseconds(seconds: float) -> int:
    """Seconds in libcosim's unit."""
    return round(seconds * 1e9)
