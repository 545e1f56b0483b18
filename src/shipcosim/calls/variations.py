"""Many variations of one run, on all cores."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from shipcosim.calls.arguments import (
    AnyScenario,
    AnySystem,
    AnyTime,
    Components,
    Settings,
    listed,
    mapping,
    read_scenario,
    scenario_of,
    values_of_sets,
    without_none,
)
from shipcosim.calls.runs import system_for
from shipcosim.cosim import Variation
from shipcosim.cosim import simulate_many as run_variations
from shipcosim.errors import error_at
from shipcosim.keywords import with_known_keywords
from shipcosim.options import RunOptions
from shipcosim.scenario import Scenario
from shipcosim.scenario.signals import chosen
from shipcosim.ssp import System, with_values
from shipcosim.units import as_python

if TYPE_CHECKING:
    import pandas
    import xarray

    from shipcosim.options import CountProgress


@with_known_keywords
def simulate_many(
    system: AnySystem | None = None,
    scenario: AnyScenario | None = None,
    variations: Sequence[Mapping[str, Any]] | pandas.DataFrame | xarray.Dataset = (),
    *,
    record: str | Sequence[str] | None = None,
    reduce: Callable[[xarray.Dataset], Any] | None = None,
    workers: int | None = None,
    stop_time: AnyTime = None,
    step_size: AnyTime = None,
    output_interval: AnyTime = None,
    set: Settings = None,
    components: Components = None,
    events: Iterable[Mapping[str, object]] = (),
    engine: str = "native",
    progress: CountProgress | None = None,
) -> xarray.Dataset:
    """Run many variations of one run, on all cores.

    Each is the run that `simulate` makes of its values, whatever runs beside it. Models are compiled once; without a
    compiler Python steps, and the remarks say so.

    Parameters
    ----------
    system, scenario, stop_time, step_size, output_interval, set, components, events
        As of `simulate`: what all variations have in common.
    variations : list of mappings, DataFrame or Dataset
        What each has of its own: start values by full name, ``{"environment.seed": 3, "vessel.mass": "550 t"}``.
        ``"parameters"`` among the names is a list of parameter sets (.ssv), ``"events"`` a list of events beside those
        of all, ``"stop_time"`` its own end. A missing value (NaN) leaves what all have.
    record : str or sequence of str, optional
        Signals, components, connectors or patterns such as ``"*.thrust"``; everything if not given.
    reduce : callable, optional
        Gets the table of each run and gives a number, or a mapping of names to numbers and arrays, which is all that
        is kept of the run.
    workers : int, optional
        Runs at a time; one a core if not given.
    engine : str
        ``"native"`` or ``"fmpy"``, as in `shipcosim.options.RunOptions`.
    progress : callable, optional
        Called with (runs done, runs in all).

    Returns
    -------
    Dataset
        Signals over ``variation`` and ``time``. Coordinates are the start values of each variation, and ``error``: why
        it failed, empty where it did not. Rows that a run does not reach are NaN.

    Raises
    ------
    ShipcosimError
        If a name does not exist, or no variation runs.

    Examples
    --------
    >>> import shipcosim
    >>> speeds = [{"port_rpm": 60.0}, {"port_rpm": 80.0}]
    >>> runs = shipcosim.simulate_many("gunnerus_open", variations=speeds, record="vessel.u", stop_time=1.0)
    >>> dict(runs.sizes), bool(runs["vessel.u"][1, -1] > runs["vessel.u"][0, -1])
    ({'variation': 2, 'time': 21}, True)
    """
    if engine not in ("native", "fmpy"):
        raise error_at(
            "simulate_many()", f"engine = {engine!r}.", "Variations are run by 'native' or 'fmpy'."
        )
    if scenario is not None:
        scenario = read_scenario(scenario)
    ship = system_for(system, scenario, components=components)
    start_time = ship.experiment.start_time if scenario is None else 0.0
    times = without_none(
        {"stop_time": stop_time, "step_size": step_size, "output_interval": output_interval}
    )
    happening = scenario_of(
        scenario, ship, times | {"set": mapping("set", set), "events": list(events)}
    )
    varied = [_variation(ship, happening, dict(entries)) for entries in _records(variations)]
    wanted = [os.fspath(name) for name in listed(record, "record")]
    return run_variations(
        with_values(ship, happening.set, str(happening.path or "scenario")),
        happening,
        varied,
        RunOptions(engine=engine, start_time=start_time, progress=progress),
        choose=tuple if record is None else lambda names: chosen(names, wanted),
        reduce=reduce,
        workers=workers,
    )


def _records(variations: Any) -> list[Mapping[str, Any]]:
    """Variations as mappings; what is missing in a table is left out."""
    if hasattr(variations, "to_dataframe"):
        variations = variations.to_dataframe()
    if not hasattr(variations, "to_dict"):
        return [mapping("variations", entries) for entries in variations]
    rows = variations.to_dict("records")
    return [{str(name): value for name, value in row.items() if value == value} for row in rows]


def _variation(system: System, scenario: Scenario, given: dict[str, Any]) -> Variation:
    """A variation as the engine takes it: parameter sets as values, its own events and end in its scenario."""
    fitting, _ = values_of_sets(given.pop("parameters", ()), system)
    changes = without_none({"stop_time": given.pop("stop_time", None)}) | {
        "events": list(given.pop("events", ()))
    }
    values = {name: as_python(value) for name, value in given.items()}
    is_plain = not changes["events"] and "stop_time" not in changes
    return Variation(
        fitting | values, scenario if is_plain else scenario_of(scenario, system, changes)
    )
