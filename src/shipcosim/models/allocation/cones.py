"""Choice of the cones of angles that azimuths keep to: ahead or astern, one each.

The forbidden sectors leave an azimuth two cones, half a turn apart. For each pair of cones a plan runs beside the
commands: the law of `sqp` on the same request, as if these were the only cones. What each plan costs, power and missed
load, is averaged. The commands change to the cheapest pair if it has been cheaper by a margin for a while. One azimuth
changes at a time: its thrust goes to zero, it turns through the sector, and its thrust comes back, all within the
limits of their rates. The other units take its load over. No thrust is reversed.
"""

from itertools import product
from typing import Any, NamedTuple

from shipcosim.models.allocation.consequences import Averaged, averaged, held_share
from shipcosim.models.allocation.detours import FAR, detour_step, detours_at_rest, on_its_way
from shipcosim.models.allocation.sqp import (
    OptimalProblem,
    Turned,
    is_whole,
    is_within,
    power_step,
    resting,
)
from shipcosim.models.core.maths import (
    Arithmetic,
    atan2,
    clip,
    floor,
    maximum,
    minimum,
    pi,
    sincos,
    sqrt,
    where,
    where_all,
)
from shipcosim.models.core.motion import Load

_LOSS = 10.0  # price of a missed newton over the largest price of a newton of thrust
_DEAR = 2.0  # cost over that of the cheapest plan, beyond which no plan counts
_ROUNDS = 12  # of the balance: none of 80 000 random loads came on the wrong side of 1.25


class ConeChoice(NamedTuple):
    """How cones are chosen.

    Parameters
    ----------
    cones : tuple of tuples of float
        Every admissible choice: of each unit 0 for the interval of its parameters, 1 for the opposite one. [1]
    margin : float
        Share of the present cost by which another choice must be cheaper. [1]
    wait, wait_missed : float
        Time for which it must be cheaper; the same where the present one misses load. [s]
    average : float
        Time constant of averaging the costs. [s]
    missed_most : float
        Most force that the present one may miss and another not, a moment counted by the yaw lever. [N]
    thrust_most : float
        Most thrust of a unit that may change its cone. [N]
    sectors_always : float
        1: a unit keeps to its cones also where it is the only one that turns; 0: there it turns all round. [1]
    """

    cones: tuple
    margin: float
    wait: float
    wait_missed: float
    average: float
    missed_most: float
    thrust_most: float
    sectors_always: float


class ConeMemory(NamedTuple):
    """State of the choice between cones.

    Parameters
    ----------
    half_turns : tuple of floats or (...) arrays or tensors
        Half turns of each unit's present interval from that of its parameters. [1]
    shifting : tuple, as many
        1 while a unit turns idle to where the plan has it, else 0. [1]
    wanted : tuple, as many
        Cone that each unit is to have, as of `ConeChoice.cones`. [1]
    waited, missed, strayed : like a half turn
        How long another choice has been cheaper, how long the wanted one has missed load that another gives, and how
        long the wanted plan has been cheaper than the commands. [s]
    cones : tuple of tuples, as `ConeChoice.cones`
        The choices, that of the plan which is next first. [1]
    plans : tuple of Turned
        State of the plan of each choice, in this order. [as its fields]
    latest, costs : tuple of floats or (...) arrays or tensors
        Cost of each plan, at its last step and averaged, in this order. [price of power]
    """

    half_turns: tuple
    shifting: tuple
    wanted: tuple
    waited: Arithmetic
    missed: Arithmetic
    strayed: Arithmetic
    cones: tuple
    plans: tuple
    latest: tuple
    costs: tuple


def cone_choices(two_cones: tuple) -> tuple:
    """Every choice of one cone a unit, those of the parameters first.

    Parameters
    ----------
    two_cones : tuple of bool
        Units that have the opposite cone too. [1]

    Returns
    -------
    tuple of tuples of float
        As of `ConeChoice.cones`. [1]

    References
    ----------
    Definition.

    Examples
    --------
    >>> cone_choices((True, False))
    ((0.0, 0.0), (1.0, 0.0))
    """
    return tuple(product(*((0.0, 1.0) if two else (0.0,) for two in two_cones)))


def cone_step(
    state: Turned,
    tau: Load,
    available: tuple,
    h: float,
    *,
    design: OptimalProblem,
    shares: tuple | None = None,
    parameters: Any = None,
) -> Turned:
    """Commands at the least power, in the cones that have been the cheapest.

    Parameters
    ----------
    state, tau, available, h, shares, parameters
        As of `sqp.power_step`. [as there]
    design : OptimalProblem
        The units and how their cones are chosen; without a choice units keep their intervals. [as its fields]

    Returns
    -------
    Turned
        Commands and the load they give.

    References
    ----------
    As `sqp.power_step`; the choice of cones is this project's.
    """
    shares = shares or (1.0,) * len(design.units)
    average, design = _ranked(state.average, tau, available, h, design, shares)
    if design.choice is None:
        memory, now = detour_step(state, tau, h, design=design)
        new = power_step(state, tau, available, h, design=now, shares=shares)
        return new._replace(memory=memory, average=average)
    memory = _planned(state.memory, tau, available, h, design, shares)
    memory = _decided(memory, state, available, h, design)
    # Angles of the plan of the wanted cones, and how far each unit is from them.
    aimed = _aimed(memory)
    gaps = tuple(_gap(aim, now) for aim, now in zip(aimed.azimuths, state.azimuths, strict=True))
    memory = _strayed(memory, state, aimed, h, design)
    memory = _sent(memory, state, gaps, design)
    memory, now = _shifted(memory, state, gaps, available, design)
    usable = _clear(memory, state, available, design)
    new = power_step(state, tau, usable, h, design=now, shares=shares)
    return new._replace(memory=memory, average=average)


def cones_at_rest(state: Turned, tau: Load, *, design: OptimalProblem) -> Turned:
    """State at the start with what the choice of cones remembers, and no request yet.

    Units keep to the intervals of their parameters; the plans are at rest.

    Parameters
    ----------
    state : Turned
        Commands at the start. [as its fields]
    tau : tuple of three floats or (...) arrays or tensors
        Any load: it gives shape and type only. [N, N, N.m]
    design : OptimalProblem
        As of `cone_step`. [as its fields]

    Returns
    -------
    Turned
        The same commands.

    References
    ----------
    Definition.
    """
    zero = 0.0 * tau[0]
    state = state._replace(average=Averaged((zero,) * 3, zero))
    if design.choice is None:
        return state._replace(memory=detours_at_rest(tau, design=design))
    none = (zero,) * len(design.units)
    cones = tuple(tuple(zero + cone for cone in pair) for pair in design.choice.cones)
    plans = []
    for combination in design.choice.cones:
        units = zip(_within(design, combination).units, state.azimuths, strict=True)
        angles = tuple(clip(zero + angle, unit.first, unit.last) for unit, angle in units)
        plans.append(resting(tau, angles))
    costs = (zero,) * len(plans)
    # The start counts for nothing: thrusts come from zero, and angles from anywhere.
    waited = zero - design.choice.average
    memory = ConeMemory(none, none, none, waited, zero, zero, cones, tuple(plans), costs, costs)
    return state._replace(memory=memory)


def _ranked(average, tau, available, h, design, shares):
    """The request averaged, and the problem that puts position before heading only where the units cannot hold both."""
    balance = design.balance
    average = averaged(average, tau, h, parameters=balance)
    load = tuple(part / (average.weight + 1e-12) for part in average.load)
    usable = tuple(where(on, share, 0.0) for on, share in zip(available, shares, strict=True))
    # It is asked only where a unit is missing.
    rounds = where(is_whole(available, design), 0, _ROUNDS)
    held = held_share(load, usable, units=balance.units, rounds=rounds)
    first = held < balance.dynamic_factor
    # The balance knows no sectors: an azimuth that keeps to them can miss load that it says is held.
    if design.choice is not None:
        first = first | (design.choice.sectors_always > 0.5)
    lever = where(first, design.yaw_lever_degraded, design.yaw_lever)
    return average, design._replace(yaw_lever_degraded=lever)


def _within(design, half_turns):
    """The problem with its intervals turned by half turns."""
    units = tuple(
        unit._replace(first=unit.first + pi * turns, last=unit.last + pi * turns)
        for unit, turns in zip(design.units, half_turns, strict=True)
    )
    return design._replace(units=units)


def _planned(memory, tau, available, h, design, shares):
    """Advance one plan: they take turns to save time, and each then steps over the time of all turns."""
    far = len(memory.plans) * h
    within = _within(design, memory.cones[0])
    plan = power_step(memory.plans[0], tau, available, far, design=within, shares=shares)
    # Missed load counts far more than any unit asks for it.
    missed = abs(tau[0] - plan.tau_X) + abs(tau[1] - plan.tau_Y)
    missed = missed + abs(tau[2] - plan.tau_N) / design.yaw_lever
    # What only the rates keep from it is missed by every plan, and counts for none.
    cost = _power(plan, design) + where(
        plan.saturated, _LOSS * design.dearest * missed, 0.0 * missed
    )
    # The plan goes to the end of the row, so that the next one is first.
    latest = (*memory.latest[1:], cost)
    before = (*memory.costs[1:], memory.costs[0])
    # First-order average. A plan that misses much counts as one of twice the cost of the cheapest:
    # so it is soon believed when the request has changed.
    most = latest[0]
    for cost in latest[1:]:
        most = minimum(most, cost)
    share = h / (design.choice.average + h)
    costs = tuple(
        old + (minimum(new, _DEAR * most) - old) * share
        for old, new in zip(before, latest, strict=True)
    )
    cones = (*memory.cones[1:], memory.cones[0])
    plans = (*memory.plans[1:], plan)
    return memory._replace(cones=cones, plans=plans, latest=latest, costs=costs)


def _decided(memory, state, available, h, design):
    """Change what is wanted: where other cones have long been cheaper, or soon where the present ones miss load."""
    choice = design.choice
    zero = 0.0 * memory.waited
    # Where a unit is missing the others reverse instead, and where one pushes much it keeps its cone.
    busy = zero
    for unit, f, on in zip(design.units, state.thrusts, available, strict=True):
        if unit.kind == "turning":
            much = f > choice.thrust_most
            busy = busy + where(on, where(much, zero + 1.0, zero), zero + 1.0)
        elif unit.kind == "fixed":
            busy = busy + where(on, zero, zero + 1.0)
    free = busy < 0.5
    # To save power: by averaged costs, slowly.
    cheaper, least, present = _cheapest(memory, memory.costs)
    better = (least < (1.0 - choice.margin) * present) & free
    waited = where(better | (memory.waited < 0.0), memory.waited + h, zero)
    saves = better & (waited > choice.wait)
    # To give the load: by costs of this moment, soon. Missed load costs far more than power.
    giving, least, present = _cheapest(memory, memory.latest)
    misses = (present - least > _LOSS * design.dearest * choice.missed_most) & free
    missed = where(misses, memory.missed + h, zero)
    gives = misses & (missed > choice.wait_missed)
    wanted = where_all(gives, giving, where_all(saves, cheaper, memory.wanted))
    # A change that was needed is not soon undone to save power.
    waited = where(gives, zero - choice.average, where(saves, zero, waited))
    return memory._replace(wanted=wanted, waited=waited, missed=where(gives, zero, missed))


def _cheapest(memory, costs):
    """Cones of the least cost, that cost, and the cost of those that are wanted now."""
    zero = 0.0 * memory.waited
    present = zero
    least = costs[0]
    best = memory.cones[0]
    for cones, cost in zip(memory.cones, costs, strict=True):
        present = where(_differ(cones, memory.wanted), present, cost)
        less = cost < least
        least = where(less, cost, least)
        best = where_all(less, cones, best)
    return best, least, present


def _differ(cones, others):
    """Whether two choices of cones differ."""
    return sum(abs(cone - other) for cone, other in zip(cones, others, strict=True)) > 0.5


def _aimed(memory):
    """Plan of the wanted cones."""
    aimed = memory.plans[0]
    azimuths = aimed.azimuths
    thrusts = aimed.thrusts
    for cones, plan in zip(memory.cones, memory.plans, strict=True):
        other = _differ(cones, memory.wanted)
        azimuths = where_all(other, azimuths, plan.azimuths)
        thrusts = where_all(other, thrusts, plan.thrusts)
    return aimed._replace(thrusts=thrusts, azimuths=azimuths)


def _strayed(memory, state, aimed, h, design):
    """Count how long the wanted plan has been cheaper: units can be at the wrong end of a cone."""
    dear = (1.0 - design.choice.margin) * _power(state, design) > _power(aimed, design)
    return memory._replace(strayed=where(dear, memory.strayed + h, 0.0 * memory.strayed))


def _sent(memory, state, gaps, design):
    """Send one unit to where the plan has it, if all run: the one with the least thrust first."""
    units = _within(design, memory.half_turns).units
    zero = 0.0 * memory.waited
    idle = zero
    first = zero + 1e300
    due = []
    rows = zip(
        units, state.thrusts, state.azimuths, memory.half_turns, memory.wanted, gaps, strict=True
    )
    for unit, f, angle, turns, want, gap in rows:
        # Due: in the wrong cone, or far from the plan although that has long been cheaper.
        wrong = abs(_cone(turns) - want) > 0.5
        strays = (memory.strayed > design.choice.wait) & (abs(gap) > FAR)
        sends = (wrong | strays) & (f <= design.choice.thrust_most)
        if unit.kind != "turning":
            sends = zero > 0.0
        due.append(sends)
        first = where(sends & (f < first), f, first)
        # A unit runs if it is within its interval and gives its least thrust.
        if unit.kind == "turning":
            runs = is_within(angle, unit.first, unit.last) & (f > 0.99 * unit.least)
            idle = idle + where(runs, zero, zero + 1.0)
    ready = idle < 0.5
    half_turns = []
    shifting = []
    rows = zip(
        state.thrusts, memory.half_turns, memory.shifting, memory.wanted, gaps, due, strict=True
    )
    for f, turns, shifts, want, gap, sends in rows:
        goes = sends & ready & (f <= first)
        ready = ready & (goes == False)  # noqa: E712
        # The shorter way, through the sector on that side.
        side = where(gap > 0.0, zero + 1.0, zero - 1.0)
        half_turns.append(turns + where(goes & (abs(_cone(turns) - want) > 0.5), side, zero))
        shifting.append(where(goes, zero + 1.0, shifts))
    return memory._replace(half_turns=tuple(half_turns), shifting=tuple(shifting))


def _shifted(memory, state, gaps, available, design):
    """The problem with the present intervals; a unit that changes its interval has that of the plan."""
    memory, opens = _opened(memory, state, available, design)
    within = _within(design, memory.half_turns)
    units = []
    shifting = []
    rows = zip(within.units, state.azimuths, memory.shifting, gaps, strict=True)
    for unit, angle, shifts, gap in rows:
        if unit.kind == "turning":
            unit, shifts = on_its_way(unit, angle, angle + gap, shifts)
            # Without sectors no end is within reach of a step.
            unit = unit._replace(
                first=where(opens, angle - pi, unit.first), last=where(opens, angle + pi, unit.last)
            )
        units.append(unit)
        shifting.append(shifts)
    return memory._replace(shifting=tuple(shifting)), within._replace(units=tuple(units))


def _opened(memory, state, available, design):
    """Whether the sectors are open; then the cone of each unit is the one nearest to its angle, for when they are back."""
    running = 0.0 * memory.waited
    for unit, on in zip(design.units, available, strict=True):
        if unit.kind == "turning":
            running = running + where(on, 1.0, 0.0)
    opens = (running < 1.5) & (design.choice.sectors_always < 0.5)
    half_turns = []
    rows = zip(
        design.units,
        zip(*design.choice.cones, strict=True),
        state.azimuths,
        memory.half_turns,
        strict=True,
    )
    for unit, cones, angle, turns in rows:
        if unit.kind == "turning":
            # A unit without the opposite cone comes back to its own after whole turns.
            apart = where(sum(cones) > 0.5, pi, 2.0 * pi)
            nearest = floor((angle - 0.5 * (unit.first + unit.last)) / apart + 0.5)
            turns = where(opens, nearest * (apart / pi), turns)
        half_turns.append(turns)
    return memory._replace(half_turns=tuple(half_turns)), opens


def _clear(memory, state, available, design):
    """Units that can be used: one that comes back waits until no other azimuth pushes in a sector."""
    units = _within(design, memory.half_turns).units
    zero = 0.0 * memory.waited
    pushing = zero
    for unit, f, angle in zip(units, state.thrusts, state.azimuths, strict=True):
        if unit.kind == "turning":
            clear = is_within(angle, unit.first, unit.last) | (f == 0.0)
            pushing = pushing + where(clear, zero, zero + 1.0)
    waits = (pushing > 0.5) & (design.choice.sectors_always < 0.5)
    rows = zip(units, state.thrusts, available, strict=True)
    return tuple(
        on & ((f != 0.0) | (waits == False)) if unit.kind == "turning" else on  # noqa: E712
        for unit, f, on in rows
    )


def _cone(half_turns):
    """Cone after half turns: 0 or 1."""
    return half_turns - 2.0 * floor(0.5 * half_turns)


def _gap(aim, angle):
    """Angle to an aim, the short way."""
    s, c = sincos(aim - angle)
    return atan2(s, c)


def _power(state, design):
    """Power of commands, in the unit of the prices."""
    # Sizes above nothing keep the derivative of the root finite.
    sizes = [maximum(abs(f), 1e-9) for f in state.thrusts]
    rows = zip(design.units, sizes, strict=True)
    return sum(unit.price * (size * sqrt(size)) for unit, size in rows)
