"""Quadratic program of an allocator: many commands within bounds, three loads to meet.

    minimise over x:  Σ (x_i - wanted_i)² / (2 ease_i) + Σ s_j² / (2 slack_j),   s = request - Σ effect_i x_i,
    low_i ≤ x_i ≤ high_i

Commands that are not at a bound are x_i = wanted_i + ease_i effect_i·λ with three multipliers λ:
every step of the active-set method solves three equations, for any number of commands.

Plain floats have an implementation of their own, some ten times as fast; a test compares both.
"""

from typing import NamedTuple

from shipcosim.models.core.maths import Arithmetic, clip, maximum, minimum, repeat, where, where_all

ROUNDS = 30
"""Most steps of the active-set method; each adds a bound or drops one. Of twelve commands few need more than ten."""
_EDGE = 1e-9  # share of a multiplier below which its sign is not trusted


class Command(NamedTuple):
    """One unknown of the program.

    Parameters
    ----------
    X, Y, N : float or (...) array or tensor
        Effect of a unit of the command. [N, N, N.m over the unit of the command]
    ease : like X
        Inverse of the price of its square, positive. [unit of the command squared over that of the price]
    wanted : like X
        Its value where nothing is requested. [unit of the command]
    low, high : like X
        Bounds; low is not above high. [unit of the command]
    """

    X: Arithmetic
    Y: Arithmetic
    N: Arithmetic
    ease: Arithmetic
    wanted: Arithmetic
    low: Arithmetic
    high: Arithmetic


def solve(
    request: tuple, commands: list[Command], slack: tuple, start: list | None = None
) -> tuple[list, tuple]:
    """Commands that meet a request at the least price, and the multipliers of the request.

    Parameters
    ----------
    request : tuple of three floats or (...) arrays or tensors
        Load to be met. [N, N, N.m]
    commands : list of Command
        The unknowns; with `request` all floats, or some of them arrays or tensors.
    slack : tuple of three floats or (...) arrays or tensors
        Load that is missed for a multiplier of one: small, so that a request is met where it can be. [N, N, N.m]
    start : list of floats or (...) arrays or tensors, optional
        Commands near the solution, which is then found in fewer steps; it does not depend on them. [unit of each]

    Returns
    -------
    list of floats or (...) arrays or tensors
        The commands, within their bounds whatever is requested. [unit of each]
    tuple of three, like request
        Multipliers: what one unit more of each load would cost. [price over N, N, N.m]

    Notes
    -----
    From a command within its bounds the step to the optimum of those that are free is taken as far as the first bound,
    which is then kept; at the optimum the bound that costs most is dropped. The price falls with each step, so the end
    is reached in finitely many.

    References
    ----------
    Härkegård, Efficient active set algorithms for solving constrained least squares problems in aircraft control
    allocation, Proc. 41st IEEE Conf. on Decision and Control, 2002.

    Examples
    --------
    Two of one effect share a request until one is at its bound:

    >>> pair = [Command(1.0, 0.0, 0.0, 1.0, 0.0, 0.0, high) for high in (2.0, 9.0)]
    >>> [round(x, 6) for x in solve((3.0, 0.0, 0.0), pair, (1e-9, 1e-9, 1e-9))[0]]
    [1.5, 1.5]
    >>> [round(x, 6) for x in solve((6.0, 0.0, 0.0), pair, (1e-9, 1e-9, 1e-9))[0]]
    [2.0, 4.0]
    """
    # One number each: the plain implementation is some ten times as fast.
    if isinstance(sum(map(sum, commands), request[0]), float):
        return _solve_floats(request, commands, slack, start or [0.0] * len(commands))
    return _solve_many(request, commands, slack, start or [0.0] * len(commands))


def _solve_floats(request, commands, slack, start):
    """`solve` for plain floats."""
    # Start within the bounds; side is 1 at the upper bound, -1 at the lower, 0 for a free command.
    x = [
        clip(value, command[5], command[6]) for value, command in zip(start, commands, strict=True)
    ]
    ends = zip(x, commands, strict=True)
    side = [1.0 if at == c[6] else -1.0 if at == c[5] else 0.0 for at, c in ends]
    best = list(x)
    multipliers = (0.0, 0.0, 0.0)
    freed = -1
    # Each round moves to the optimum of the free commands, or to the first bound on the way there.
    for _ in range(ROUNDS):
        multipliers = p, q, r = _multipliers_floats(request, commands, slack, x, side)
        # share is the part of the way that the bounds allow; hit is the command that stops it.
        share = 1.0
        hit = -1
        worst = 0.0
        dropped = -1
        for i, (X, Y, N, ease, wanted, low, high) in enumerate(commands):
            # Pull of the multipliers along this command, effect_i . lambda.
            pull = X * p + Y * q + N * r
            # A command at its bound: a positive loss means that the price falls if it is freed.
            if side[i]:
                loss = side[i] * ((x[i] - wanted) / ease - pull) if low < high else 0.0
                if loss > worst and loss > _EDGE * abs(pull):
                    worst = loss
                    dropped = i
                continue
            # A free command: its optimum, and the bound that it would cross first.
            best[i] = new = wanted + ease * pull
            bound = high if new > high else low
            if (new > high or new < low) and (bound - x[i]) / (new - x[i]) < share:
                share = (bound - x[i]) / (new - x[i])
                hit = i
        # Move the free commands by the common share; commands at a bound stay.
        x = [
            old if at else old + share * (new - old)
            for old, new, at in zip(x, best, side, strict=True)
        ]
        if (
            hit >= 0 and hit == freed and share <= 0.0
        ):  # by rounding alone: the bound it was freed from is kept
            break
        # Add the bound that was hit; at the optimum free the command with the largest loss.
        if hit >= 0:
            side[hit] = 1.0 if best[hit] > commands[hit][6] else -1.0
            x[hit] = commands[hit][6] if side[hit] > 0.0 else commands[hit][5]
        elif dropped >= 0:
            side[dropped] = 0.0
        else:
            break
        freed = dropped if hit < 0 else -1
    return x, multipliers


def _multipliers_floats(request, commands, slack, x, side):
    """Multipliers at the optimum of the free commands."""
    # Free commands count with their wanted value and their ease; those at a bound give a fixed load.
    rows = [
        (c[0], c[1], c[2], value, 0.0) if at else (c[0], c[1], c[2], c[4], c[3])
        for c, at, value in zip(commands, side, x, strict=True)
    ]
    return multipliers_of(request, slack, rows)


def multipliers_of(request: tuple, slack: tuple, rows: list[tuple]) -> tuple:
    """Multipliers λ of (Σ ease effect effectᵀ + diag(slack)) λ = request - Σ effect value.

    Parameters
    ----------
    request : tuple of three floats or (...) arrays or tensors
        Load to be met. [N, N, N.m]
    slack : tuple of three, like request
        As of `solve`. [N, N, N.m]
    rows : list of tuples of five, like request
        Of each command its effect X, Y, N, its value, and its ease, 0 for one at a bound. [units of `Command`]

    Returns
    -------
    tuple of three, like request
        Multipliers. [price over N, N, N.m]

    References
    ----------
    Lagrangian of a quadratic program with equality constraints.
    """
    # Remaining load, and the symmetric matrix of rows (a b c), (b d e), (c e f).
    X0, Y0, N0 = request
    a, d, f = slack
    b = c = e = 0.0
    for X, Y, N, value, ease in rows:
        X0 = X0 - X * value
        Y0 = Y0 - Y * value
        N0 = N0 - N * value
        p = ease * X
        q = ease * Y
        a = a + p * X
        b = b + p * Y
        c = c + p * N
        d = d + q * Y
        e = e + q * N
        f = f + ease * N * N
    return _three_equations(a, b, c, d, e, f, X0, Y0, N0)


def _solve_many(request, commands, slack, start):
    """`solve` for arrays or tensors, each element separately; recorded as one loop."""
    # A zero of the common shape and type: bounds and flags broadcast with it.
    zero = sum(0.0 * value for command in commands for value in command) + 0.0 * request[0]
    x = tuple(
        clip(zero + at, zero + c.low, zero + c.high) for at, c in zip(start, commands, strict=True)
    )
    ends = zip(x, commands, strict=True)
    side = tuple(
        where(at == c.high, zero + 1.0, where(at == c.low, zero - 1.0, zero)) for at, c in ends
    )
    never = zero > 1.0
    begin = 0.0, x, side, (never,) * len(x), never, (zero, zero, zero)
    _, x, _, _, _, multipliers = repeat(
        lambda now: _goes_on(now[0] < ROUNDS, now[4]),
        lambda now: _round(request, commands, slack, zero, *now),
        begin,
    )
    return list(x), multipliers


def _goes_on(more, done):
    """Whether there is another round: not if all elements are done."""
    return more & ~done if hasattr(done, "maths") else more and not bool(done.all())


def _round(request, commands, slack, zero, count, x, side, freed, done, multipliers):
    """The state of `_solve_many` after one more round, to the digit as a round of `_solve_floats`."""
    at_active = _multipliers(request, commands, slack, x, side)
    # Optimum of the free commands, loss of each bound, and how far each command may go.
    best, loss, steps = _towards(commands, at_active, x, side)
    # Smallest allowed step and largest loss, over all commands.
    share = zero + 1.0
    worst = zero
    for step, lost in zip(steps, loss, strict=True):
        share = minimum(share, step)
        worst = maximum(worst, lost)
    whole = share >= 1.0
    hits = _first([step <= share for step in steps], ~whole)
    drops = _first([lost >= worst for lost in loss], whole & (worst > 0.0))
    # A command that was freed hits its bound again by rounding alone: it stays, and the element is done.
    again = zero > 1.0
    for hit, was in zip(hits, freed, strict=True):
        again = again | (hit & was & (share <= 0.0))
    # Add the bound that was hit, or free the command with the largest loss. Elements that are done stay.
    after = []
    rows = zip(commands, best, x, side, hits, drops, strict=True)
    for command, new, old, at, hit, drop in rows:
        over = new > command.high
        bound = where(over, zero + command.high, zero + command.low)
        kept = where(hit, where(over, zero + 1.0, zero - 1.0), where(drop, zero, at))
        moved = where(hit & ~again, bound, old + share * (new - old))
        after.append((where(done, old, moved), where(done | again, at, kept), drop))
    x, side, freed = zip(*after, strict=True)
    multipliers = where_all(done, multipliers, at_active)
    # A whole step without a loss is the optimum.
    done = done | again | (whole & (worst <= 0.0))
    return count + 1.0, x, side, freed, done, multipliers


def _first(flags, wanted):
    """The first flag that is set of each element, where one is asked for."""
    first = []
    for flag in flags:
        first.append(flag & wanted)
        wanted = wanted & ~flag
    return first


def _multipliers(request, commands, slack, x, side):
    """`_multipliers_floats` for arrays or tensors."""
    rows = []
    for (X, Y, N, ease, wanted, _, _), at, value in zip(commands, side, x, strict=True):
        free = at == 0.0
        none = 0.0 * value
        rows.append((X, Y, N, where(free, none + wanted, value), where(free, none + ease, none)))
    return multipliers_of(request, slack, rows)


def _towards(commands, multipliers, x, side):
    """Optimum of free commands, loss of each bound, and share of the way to each bound."""
    p, q, r = multipliers
    best = []
    loss = []
    steps = []
    for (X, Y, N, ease, wanted, low, high), at, old in zip(commands, side, x, strict=True):
        # Optimum of a free command; one at its bound stays.
        pull = X * p + Y * q + N * r
        free = at == 0.0
        new = where(free, wanted + ease * pull, old)
        # Loss of keeping a bound, as in `_solve_floats`.
        lost = where(0.0 * old + low < high, at * ((old - wanted) / ease - pull), 0.0 * old)
        # Share of the way up to the bound, 1 where none is crossed.
        way = new - old
        outside = (new > high) | (new < low)
        room = where(new > high, high - old, low - old)
        best.append(new)
        loss.append(where(lost > _EDGE * abs(pull), lost, 0.0 * old))
        steps.append(where(outside, room / where(outside, way, 0.0 * old + 1.0), 0.0 * old + 1.0))
    return best, loss, steps


def _three_equations(a, b, c, d, e, f, X, Y, N):
    """Solve three equations with the symmetric positive matrix of rows (a b c), (b d e), (c e f).

    With few free commands the matrix is nearly singular: its condition is that of the slack, some 1e6. By factors
    L D Lᵀ rounding grows by this; by cofactors it would grow by its square.
    """
    # Factors: L has ones on its diagonal and (p), (q r) below it; D has a, u, v.
    p = b / a
    q = c / a
    u = d - p * b
    w = e - p * c
    r = w / u
    v = f - q * c - r * w
    # Forward through L, over D, and back through its transpose.
    Y = Y - p * X
    N = (N - q * X - r * Y) / v
    Y = Y / u - r * N
    return X / a - p * Y - q * N, Y, N
