"""Draw a log with a hidden effect, and its healthy twin.

A log is drawn by a kind and a seed. Everything but the effect has random streams of its own, so that the twin has the
same ship, weather, plan and noise.
"""

import os
from dataclasses import dataclass, field, replace
from datetime import date
from itertools import combinations

import numpy as np
import pandas as pd

from truth import autopilot, effects, faults, sensors, unknowns
from truth.effects import Answer, Effect
from truth.form import draw_form
from truth.loop import AFTER, BEFORE, HALF_SECOND, Setup, run
from truth.orders import Orders, carried_out
from truth.ship import draw_coefficients
from truth.streams import Lengthened, stream
from truth.weather import draw_weather, elevation, wind_series, windier

KINDS = ("trial", "work", "hold")
BATCH = 64
FIXED_SEED = 202648
"""Seed of the benches in CI, which says the same of the same tree on any day."""
CAUSES = tuple(effects.SIZES)
ALL_MODES = (autopilot.FIXED, autopilot.TURNING, autopilot.OPPOSED)


@dataclass(frozen=True)
class Case:
    """A log, and what is hidden in it.

    Attributes
    ----------
    log : pandas.DataFrame
        Measured data as the contract says, columns ``role [unit]``.
    answer : list of Answer
        (cause, component, parameters, ...) of everything hidden; empty for a healthy log.
    truth : pandas.DataFrame
        The ship's real low-frequency motion at the log's rows, were all clocks right. SI and radians.
    off_track : (rows,) array
        Distance from the setpoint. [m]
    off_heading : (rows,) array
        [rad]
    """

    kind: str
    seed: int
    log: pd.DataFrame
    answer: list
    truth: pd.DataFrame
    off_track: np.ndarray
    off_heading: np.ndarray
    healthy: "Case | None" = field(default=None, repr=False)

    def twin(self):
        """The healthy log of the same ship, weather, plan and noise."""
        return self.healthy or self

    def save(self, path):
        """Write the log as CSV."""
        self.log.to_csv(path, index=False)


def draw(kind, seed, **options):
    """Draw one log; see `draw_many`."""
    return draw_many(kind, [seed], **options)[0]


def draw_many(kind, seeds, **options):
    """Draw logs, many at a time.

    Parameters
    ----------
    kind : str
        "trial" (moves and heading steps designed to excite), "work" (ordinary DP) or "hold" (stationkeeping).
    seeds : iterable of int
        One log each; the same seed and options give the same bytes.
    causes : 0, 1, 2 or "unknown"
        How many causes are hidden (default 1), or one effect that is in no catalogue. Of two, at most one is in
        the log only, and none is a frame, a sign or swapped channels.
    size : float
        Factor on how far the effects are from neutral (default 1).
    minutes : int
        Of log, at least 10 (default 40).
    mismatch : float
        Factor on the tolerances from which the ship's coefficients are drawn (default 1).
    rough : bool
        A ship of other forms: roll, other wind and cross-flow tables (default no).
    form : float
        A ship of a drawn form, see `form.draw_form`, that differs from the model's by this factor times the usual
        (default 0: the model's).
    among : sequence of str, optional
        Causes (or names of unknown effects) to draw from; all if not given.
    onset : bool or str
        Effects on the ship or its sensors begin within the log (default no): and stay; or with "ramp" grow until its
        end, with "spell" end again, with "switching" come and go.
    always : str, optional
        A cause that is hidden in every log, alone or beside what is drawn.
    after : dict, optional
        A manoeuvre or a loss of power that the ship sails when the log is over, as the fields of `orders.Orders`; its
        rows are added at the end, the others are the same bytes as without it. The weather and the effect go on.
    day : int
        Another day in the life of the same ship: weather, plan and noise are others, the ship, her DP and the hidden
        effect are the same (default 0).
    ship : str, optional
        The kind whose ship it is, where another kind's sails: ``draw("trial", 3, ship="work")`` has the ship of
        ``draw("work", 3)``.

    Returns
    -------
    list of Case
    """
    if options.get("minutes", 40) < 10:
        raise ValueError("minutes is less than 10, too short for what is hidden in time")
    if kind not in KINDS:
        raise ValueError(f"kind is {kind!r}; it is one of {', '.join(KINDS)}")
    seeds = list(seeds)
    return [
        case
        for first in range(0, len(seeds), BATCH)
        for case in draw_batch(
            [set_up(kind, seed, **options) for seed in seeds[first : first + BATCH]]
        )
    ]


def share_held(cases):
    """Share of healthy logs in which the ship stays near its setpoint."""
    held = [
        case.off_track.max() < 12.0 and np.degrees(np.abs(case.off_heading).max()) < 25.0
        for case in cases
    ]
    return np.mean(held)


def bench_seed(day=None):
    """Seed that a bench draws from: always the same, or that of the week where SHIPCOSIM_FRESH_SEEDS is set."""
    return weekly_seed(day) if os.environ.get("SHIPCOSIM_FRESH_SEEDS") else FIXED_SEED


def weekly_seed(day=None):
    """Seed of the week, e.g. 202647; printed, so that a failed run can be repeated."""
    year, week, _ = (day or date.today()).isocalendar()
    seed = 100 * year + week
    print(f"seed of the week: {seed}")
    return seed


def set_up(
    kind,
    seed,
    causes=1,
    size=1.0,
    minutes=40,
    mismatch=1.0,
    rough=False,
    form=0.0,
    among=None,
    onset=False,
    always=None,
    after=None,
    day=0,
    ship=None,
):
    """Everything about a log that is drawn before it is simulated; see `draw_many`."""

    def of_day(name):
        return stream(kind, seed, name_of(name, day))

    hidden = set_effects(kind, seed, causes, size, minutes, among, onset, always)
    names = {e.answer.cause for e in hidden} | {e.answer.note for e in hidden}
    weather = draw_weather(of_day("weather"))
    if names & {"wind_scale", "wind_direction", "wind_shadow"}:
        weather = windier(weather, 5.5)
    ticks, rows = 60 * minutes + AFTER, 60 * minutes + 1
    rng = of_day("plan")
    heading = rng.uniform(-np.pi, np.pi)
    if "heading_wrap" in names:
        heading = np.radians(rng.uniform(-0.3, 0.3))
    planner = autopilot.Planner((0.0, 0.0, heading), BEFORE, ticks)
    autopilot.PLANS[kind](planner, rng, modes_for(hidden))
    plan, longer = planner.plan(), 0
    if after:
        orders = Orders(**after)
        plan, longer = carried_out(plan, orders, of_day("captain"), AFTER), AFTER + orders.rows
        if "clock" not in names:  # with one, the last rows of the log may see what comes after them
            hidden = [effects.gone_on(e, 60 * minutes + longer) for e in hidden]
    ends = [(n, n + longer) for n in (BEFORE + ticks, rows)] + [
        (records(BEFORE + ticks), records(plan.mode.size))
    ]

    def lengthened(name):
        return Lengthened(
            of_day(name), of_day(f"{name} after"), {long: short for short, long in ends}
        )

    drawn = draw_form(stream(ship or kind, seed, "form"), form) if form else None
    air = lengthened("air")
    mast, over_ship = wind_series(weather, air, ends[2][1], HALF_SECOND)
    return Setup(
        kind=kind,
        seed=seed,
        rows=rows + longer,
        planned_rows=rows,
        coefficients=draw_coefficients(stream(ship or kind, seed, "ship"), mismatch, rough, drawn),
        weather=weather,
        mast_wind=mast,
        wind=over_ship,
        sea=elevation(weather, air, ends[2][1], HALF_SECOND),
        style=autopilot.draw_style(stream(ship or kind, seed, "style")),
        plan=plan,
        noise=sensors.draw_noise(lengthened("noise"), plan.mode.size, rows + longer),
        effects=tuple(hidden),
        day=day,
    )


def name_of(stream_name, day):
    """Name of a random stream on a day."""
    return f"{stream_name}, day {day}" if day else stream_name


def records(ticks):
    """Number of records of so many seconds."""
    return int(ticks / HALF_SECOND) + 1


def modes_for(hidden):
    """Ways to use the units in which the hidden effects can show at all."""
    causes = {e.answer.cause for e in hidden}
    if "reverse_loss" in causes:
        return (
            (autopilot.FIXED,)
            if "thruster_interaction" not in causes
            else (autopilot.FIXED, autopilot.TURNING)
        )
    if "thruster_interaction" in causes:
        return (autopilot.TURNING, autopilot.OPPOSED)
    if "channel_swap" in causes:
        return (autopilot.FIXED, autopilot.OPPOSED)
    return ALL_MODES


def set_effects(kind, seed, causes=1, size=1.0, minutes=40, among=None, onset=False, always=None):
    """Effects of one log: none, one or two of the catalogue, or one outside it; see `draw_many`."""
    rng = stream(kind, seed, "effect")
    if causes == "unknown":
        name = None if among is None else str(rng.choice(among))
        return [unknowns.draw_unknown(rng, kind, size, (0.0, 0.0), name)]
    names = list(CAUSES if among is None else among)
    groups = [group for group in combinations(names, causes) if go_together(group)]
    groups = [group for group in groups if always is None or always in group]
    if not groups:
        raise ValueError(f"no {causes} of {names} go together")
    return [
        draw_effect(name, rng, size, minutes, onset) for name in groups[rng.integers(len(groups))]
    ]


def go_together(causes):
    """Whether each of these causes is still what it is beside the others."""
    if len(causes) < 2:
        return True
    if set(causes) & effects.NEVER_PAIRED:
        return False
    return all(len(group & set(causes)) < 2 for group in effects.EXCLUSIVE)


def draw_effect(cause, rng, size, minutes, onset):
    """One effect of the catalogue."""
    if cause in faults.DRAW:
        return faults.DRAW[cause](rng, size, minutes)
    component, parameters, shape = effects.DRAW[cause](rng, size, minutes)
    start = float(rng.uniform(0.25, 0.6) * 60 * minutes)
    when = start if onset and cause not in effects.WITHOUT_ONSET else 0.0
    parameters = {name: float(value) for name, value in parameters.items()}
    course = onset if when and isinstance(onset, str) else ""
    spells = draw_spells(course, rng, when, 60.0 * minutes)
    return Effect(
        Answer(cause, component, parameters, onset=when, course=course, spells=spells), shape
    )


def draw_spells(course, rng, start, end):
    """When an effect is there that begins at a time of a log of this length. [s]"""
    if course == "ramp":
        return ((start, end),)
    if course == "spell":
        return ((start, start + float(rng.uniform(0.15, 0.3)) * end),)
    spells = []
    while course == "switching" and start < end:
        on, off = (float(rng.uniform(0.05, 0.12)) * end for _ in range(2))
        spells.append((start, start + on))
        start += on + off
    return tuple(spells)


def draw_batch(setups):
    """Simulate logs together with their twins."""
    twins = [replace(setup, effects=()) for setup in setups if setup.effects]
    spare = (
        setups if len(setups) + len(twins) == 1 else []
    )  # NumPy adds up a lone column in another order
    records = run(setups + twins + spare)
    cases = [write(setup, record) for setup, record in zip(setups, records, strict=False)]
    healthy = (
        write(setup, record) for setup, record in zip(twins, records[len(setups) :], strict=False)
    )
    return [replace(case, healthy=next(healthy)) if case.answer else case for case in cases]


def write(setup, record):
    """The log of one simulated ship."""
    times = np.arange(setup.rows)
    grid = -BEFORE + HALF_SECOND * np.arange(record["x"].size)
    when = faults.true_times(times, [e.answer for e in setup.effects])
    channels = sensors.log_channels(
        record, grid, when, setup.weather, setup.mast_wind, setup.sea, setup.noise
    )
    parts = [spoiled(setup, channels, times, slice(0, setup.planned_rows), "dropouts")]
    if setup.rows > setup.planned_rows:
        parts.append(
            spoiled(setup, channels, times, slice(setup.planned_rows, setup.rows), "dropouts after")
        )
    log = pd.concat([part for part, _ in parts], ignore_index=True)
    answer = [faults.told_of(pieces) for pieces in zip(*(told for _, told in parts), strict=True)]
    truth = pd.DataFrame({name: np.interp(times, grid, record[name]) for name in sensors.RECORDED})
    target = setup.plan.eta[:, BEFORE : BEFORE + setup.rows]
    off_track = np.hypot(truth["x"] - target[0], truth["y"] - target[1]).to_numpy()
    off_heading = (truth["psi"] - target[2]).to_numpy()
    return Case(setup.kind, setup.seed, log, answer, truth, off_track, off_heading)


def spoiled(setup, channels, times, rows, name):
    """Some rows of the log with faults, resolution and dropouts, and what is hidden in them."""
    channels, times = {role: values[rows] for role, values in channels.items()}, times[rows]
    kept, answer = np.ones(times.size, bool), []
    for effect in setup.effects:
        channels, left, told = faults.spoil(channels, times, effect)
        kept &= left
        answer.append(told)
    channels = sensors.wrap_and_round(channels)
    channels, received = sensors.drop_out(
        channels, stream(setup.kind, setup.seed, name_of(name, setup.day))
    )
    columns = {"time [s]": times.astype(float)}
    columns |= {f"{role} [{sensors.ROLES[role][0]}]": values for role, values in channels.items()}
    return pd.DataFrame(columns)[kept & received], answer
