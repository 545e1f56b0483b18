"""Sails what the diagnosis prescribed: the ship of an ambiguous log sails on, and the longer log is diagnosed again."""

import time
from functools import cache
from pathlib import Path

from shipcosim.diagnose.experiment.manoeuvres import library
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from trial.runs import TOOL, add, answered, drawn, key, pool_of, read_results
from trial.tools import system

AFTER = "{} sailed"
"""Name of a set after the manoeuvre."""


@cache
def orders():
    """By the name of each manoeuvre of the library, what the truth is told."""
    return {one.name: orders_of(one) for one in library(ship_model_of(system()))}


def orders_of(manoeuvre):
    """A manoeuvre as the fields of `truth.orders.Orders`."""
    return {
        "legs": [[float(value) for value in leg] for leg in manoeuvre.legs],
        "pushes": [
            [p.thruster, *(float(v) for v in (p.start, p.end, p.force, *p.azimuth))]
            for p in manoeuvre.pushes
        ],
        "free": [[float(value) for value in span] for span in manoeuvre.free],
    }


def unsailed(results, kinds, sets):
    """Ambiguous results with a manoeuvre that nobody has sailed yet.

    Parameters
    ----------
    results : list of dict
        As `runs.run` gives them.
    kinds, sets : sequence of str

    Returns
    -------
    list of dict
    """
    done = {key(result) for result in results}
    return [
        result
        for result in results
        if result["kind"] in kinds
        and result["set"] in sets
        and (result["kind"], AFTER.format(result["set"]), result["seed"]) not in done
        and prescribed(result)
    ]


def prescribed(result):
    """Name of the manoeuvre that an ambiguous answer prescribes, or None."""
    diagnosis = result["diagnosis"]
    if not diagnosis or diagnosis["verdict"] != "ambiguous" or not diagnosis["prescription"]:
        return None
    return diagnosis["prescription"]["manoeuvre"]


def sail(kinds, sets, into, *, tool=TOOL, jobs=1, minutes=None, progress=print):
    """Have every prescribed manoeuvre sailed once, and the longer logs diagnosed.

    Parameters
    ----------
    kinds, sets : sequence of str
    into : path
        Results as of `runs.run`; new lines, of the sets `AFTER`, are appended.
    tool, jobs, minutes, progress
        As of `runs.run`.
    """
    into, until = Path(into), time.monotonic() + 60.0 * (minutes or 1e9)
    wanted = unsailed(read_results(into), kinds, sets)
    with pool_of(jobs) as pool:
        for some in (wanted[i : i + jobs] for i in range(0, len(wanted), jobs)):
            if time.monotonic() > until:
                return
            for result in answered([longer(before) for before in some], tool=tool, pool=pool):
                add(result, into)
                progress(result, len(wanted))


def longer(result):
    """The ship of a result after the manoeuvre that it prescribes: her log, its set and its options."""
    options = result["options"] | {"after": orders()[prescribed(result)]}
    return drawn(result["kind"], [result["seed"]], options)[0], AFTER.format(result["set"]), options
