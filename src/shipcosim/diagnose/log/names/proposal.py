"""All columns of a log together: which one has which role, what is sure, what a guess, and what is not used and why."""

from dataclasses import dataclass, replace

import numpy as np

from shipcosim.diagnose.log.channels import Channel
from shipcosim.diagnose.log.files.file_layout import FileLayout
from shipcosim.diagnose.log.files.positions import are_codes, hemisphere_signs, sides_of
from shipcosim.diagnose.log.files.table import LogColumns
from shipcosim.diagnose.log.names.clock import time_of
from shipcosim.diagnose.log.names.guesses import (
    EXACT,
    GUESS,
    SURE,
    UNUSED,
    Guess,
    Thrusters,
    guesses_of,
)
from shipcosim.diagnose.log.names.units import unit_for
from shipcosim.diagnose.log.names.unstated_units import are_axes_open, exchange_axes, settled
from shipcosim.diagnose.log.names.vocabulary import (
    meaning_of,
    simple_words,
    vocabulary,
    words_of,
)
from shipcosim.diagnose.log.values import LARGEST
from shipcosim.diagnose.numerics import finite

_DIRECTIONS = set("direction rotation sign ahead forward sense reverse rev astern backward".split())
"""Words of a column that holds the direction of a shaft."""
_HEMISPHERES = {"hemisphere", "hemi", "ns", "ew", "hem"}
_OF_A_SHAFT = set("rpm thrust speed shaft propeller thruster feedback".split())
_POSITIONS = (("north", "east"), ("latitude", "longitude"))
_PAIRS = (
    *_POSITIONS,
    ("speed_over_ground", "course_over_ground"),
    ("north_velocity", "east_velocity"),
)


@dataclass(frozen=True)
class Proposal:
    """What the columns of a log are.

    Attributes
    ----------
    used : tuple of Guess
        One for each role, in the order of the file.
    unused : tuple of Guess
        The other columns, each with why.
    form : FileLayout
        What the file states of itself.
    """

    used: tuple[Guess, ...]
    unused: tuple[Guess, ...]
    form: FileLayout

    def channels(self, guessed: bool = False) -> dict[str, Channel]:
        """Channels by role: those that are sure, or the guesses as well.

        A column named by its role is in the role's unit where none is stated, unless the proposal is confirmed.
        """
        if guessed:
            return {g.role: g.channel for g in self.used}
        plain = {
            g.role: g.channel.model_copy(update={"unit": None})
            for g in self.used
            if g.rank == EXACT and g.role == "yaw_rate"
        }
        return {g.role: g.channel for g in self.used if g.rank < GUESS} | plain


def propose(
    log: LogColumns, thrusters: Thrusters | None = None, form: FileLayout | None = None
) -> Proposal:
    """Roles of the columns of a log, by their names, units and values.

    Parameters
    ----------
    log : LogColumns
        As from `read_file`.
    thrusters : mapping of str to tuple of str, optional
        Of the system, and what drives each; any without.
    form : FileLayout, optional
        What the file states of itself.
    """
    form = form or FileLayout()
    # Guesses for each column alone, then the best for each role.
    site = _site(log)
    every = [guess for column in log.values for guess in guesses_of(column, log, thrusters, site)]
    every = _known_together(every)
    chosen, left = _chosen([g for g in every if g.role and g.role != "time"])
    left += [g for g in every if not g.role]
    # Time, quaternions and hemispheres need several columns.
    clock, others = time_of([g for g in every if g.role == "time"], log, form)
    chosen |= {"time": clock} if clock else {}
    left += others
    _with_quaternion(chosen, log)
    _with_hemispheres(chosen, log)
    _with_directions(chosen, log)
    _with_its_pair(chosen, left)
    _beside_others(chosen, log)
    # Conventions and values settle what names leave open.
    _by_convention_of_ros(chosen, log)
    settled(chosen, log, form)
    left += _of_one_kind(chosen, log)
    # Columns that no channel uses keep the reason of their first guess.
    taken = {name for guess in chosen.values() for name in guess.channel.columns}
    unused = {guess.column: guess for guess in reversed(left) if guess.column not in taken}
    order = list(log.values)
    used = sorted(chosen.values(), key=lambda g: (g.role != "time", order.index(g.column)))
    return Proposal(tuple(used), tuple(unused[name] for name in order if name in unused), form)


def _site(log):
    """Words that all names of several words share and that no name in names.toml has: historians write the ship's."""
    names = [set(words_of(column)) for column in log.values if len(words_of(column)) > 1]
    return frozenset(set.intersection(*names) - simple_words() if len(names) > 2 else ())


def _known_together(every):
    """Letters with one meaning if all of a group occur: N and E; u, v and r."""
    fillers = set(vocabulary()["words"]["filler"])
    letters = [" ".join(w for w in words_of(g.column) if w not in fillers) for g in every]
    single = {letter for letter in letters if " " not in letter}
    sure = set().union(*(group for group in ({"n", "e"}, {"u", "v", "r"}) if group <= single))
    # With all three of vx, vy and vz, or with x and y, these are mostly velocities over the earth.
    is_earth = "vz" in single or {"x", "y"} <= single
    over_earth = {"vx": "north_velocity", "vy": "east_velocity"} if is_earth else {}
    together = []
    for guess, letter in zip(every, letters, strict=True):
        if letter in over_earth:
            guess = replace(guess, role=over_earth[letter], why="it may be along the ship")
        role = {"n": "north", "e": "east"}.get(letter, guess.role)
        if letter in sure and role and guess.role != role:
            guess = Guess(guess.column, role, Channel(column=guess.column), unit=guess.unit)
        is_sure = letter in sure and role
        together.append(replace(guess, rank=min(guess.rank, SURE), why="") if is_sure else guess)
    return together


def _chosen(guesses):
    """The best guess for each role, and the others with why they are not used."""
    kinds = {"feedback": 0, "": 1, "command": 2}
    chosen = {}
    left = []
    # Rank by certainty, then measured before commanded values.
    for role in dict.fromkeys(guess.role for guess in guesses):
        ranked = sorted(
            (g for g in guesses if g.role == role), key=lambda g: (g.rank, kinds[g.kind])
        )
        best = ranked[0]
        rest = ranked[1:]
        commands = [g for g in rest if g.kind == "command" and best.kind != "command"]
        if commands and best.rank != EXACT:
            best = replace(
                best,
                notes=(f"measured; the command beside it, '{commands[0].column}', is not used",),
            )
        elif best.kind == "command" and rest:
            best = replace(best, notes=())
        # Two equal candidates make a guess of either.
        same = [g for g in rest if g.rank == best.rank == SURE and g.kind == best.kind]
        if same:
            best = replace(best, rank=GUESS, why=f"'{same[0].column}' says the same")
        chosen[role] = best
        for guess in rest:
            why = (
                "a command, and there is what was measured"
                if guess in commands
                else f"'{best.column}' is the {role}"
            )
            left.append(guess.refused(why))
    return chosen, left


def _with_quaternion(chosen, log):
    """A heading from the four columns of an attitude, where there is no other."""
    if "heading" in chosen and chosen["heading"].rank < GUESS:
        return
    # Columns that share a prefix and end in the components of a quaternion.
    ends = dict(zip("wxyz0123", "wxyzwxyz", strict=True))
    named = {"q", "quaternion", "quat", "orientation", "attitude", "qw", "qx"}
    groups: dict[tuple, dict[str, str]] = {}
    for column, cells in log.values.items():
        *before, last = words_of(column) or ("",)
        if not before and len(last) == 2 and last[0] == "q":
            before = ["q"]
            last = last[1]
        if last in ends and named & set(before) and cells.dtype.kind == "f":
            groups.setdefault(tuple(before), {})[ends[last]] = column
    whole = [parts for parts in groups.values() if len(parts) == 4]
    if whole:
        parts = whole[0]
        channel = Channel(quaternion=(parts["w"], parts["x"], parts["y"], parts["z"]))
        why = "of a quaternion; it may be of another frame (ENU)"
        chosen["heading"] = Guess(parts["w"], "heading", channel, GUESS, why)


def _by_convention_of_ros(chosen, log):
    """Guesses about messages of ROS: x east, y north, angles anticlockwise, y to port (REP 103)."""
    if not any({"pose", "twist", "odom", "odometry"} & set(words_of(name)) for name in log.values):
        return

    def turned(role, why, **update):
        chosen[role] = chosen[role].read_as(update, why=f"{why} (REP 103)")

    # Only guesses follow the convention; what is sure stays as it is.
    is_open = {role for role, guess in chosen.items() if guess.rank == GUESS}
    if {"north", "east"} <= is_open and are_axes_open(chosen):
        exchange_axes(chosen)
        turned("north", "y is assumed to be north")
        turned("east", "x is assumed to be east")
    if "heading" in is_open and chosen["heading"].channel.quaternion:
        turned("heading", "of a quaternion, assumed from ENU", frame="ENU")
    elif "heading" in is_open and chosen["heading"].why.startswith("yaw"):
        stated = chosen["heading"].unit
        in_degrees = stated and unit_for(stated, "deg") == "deg"
        unit = {} if stated else {"unit": "rad"}
        offset = 90.0 if in_degrees else np.pi / 2.0
        turned("heading", "assumed anticlockwise from east", sign=-1, offset=offset, **unit)
    for role in is_open & {"sway", "yaw_rate"}:
        if "port" in chosen[role].why:
            unit = {"unit": "rad/s"} if role == "yaw_rate" and not chosen[role].unit else {}
            turned(role, "assumed positive to port", sign=-1, **unit)


def _with_hemispheres(chosen, log):
    """Numbers with the columns of N and S, E and W, or port and starboard that stand behind them."""
    order = list(log.values)
    for role in [role for role in chosen if sides_of(role)]:
        guess = chosen[role]
        # Whole degrees beside a column of minutes are only a part of a position.
        minutes = [
            n
            for n in order
            if role in words_of(n) and {"min", "minutes"} & {*words_of(n), log.units[n]}
        ]
        if minutes and guess.rank != EXACT and guess.column not in minutes:
            why = f"its minutes may stand in '{minutes[0]}'"
            guess = chosen[role] = replace(guess, rank=GUESS, why=why)
        # The side stands behind the number; of a position also in a column that is named so.
        named = [n for n in order if _HEMISPHERES & set(words_of(n))]
        after = order[order.index(guess.column) + 1 :][:1]
        is_position = role in LARGEST
        for name in [*after, *named] if is_position else [n for n in after if n not in named]:
            cells = log.values[name]
            if cells.dtype.kind == "f" or are_codes(cells):
                continue
            signs = hemisphere_signs(cells, role)
            # An A alone behind a number may mean that it is active.
            if signs is not None and (1.0 in signs or "F" not in sides_of(role)):
                notes = () if is_position else (f"its side stands in '{name}'",)
                chosen[role] = guess.read_as({"hemisphere": name}, notes=(*guess.notes, *notes))
                break


def _with_directions(chosen, log):
    """Speeds and thrusts without a sign are asked where another column may hold their direction."""
    for role, guess in chosen.items():
        values = log.values.get(guess.column)
        is_shaft = role.endswith(("_rpm", "_thrust")) and not guess.channel.hemisphere
        if not is_shaft or values.dtype.kind != "f" or (finite(values) < 0.0).any():
            continue
        thruster = _thruster_words(guess.column)
        for name, cells in log.values.items():
            if not _DIRECTIONS & set(words_of(name)) or _thruster_words(name) != thruster:
                continue
            if are_codes(cells):
                why = f"it has no sign, and '{name}' may hold it: which code is ahead is not stated"
                chosen[role] = guess.read_as({"hemisphere": name}, rank=GUESS, why=why)


def _with_its_pair(chosen, left):
    """A wind speed is of the wind that its direction is of; speed and course beside a heading are over ground."""
    speed = chosen.get("wind_speed")
    wind_from = chosen.get("wind_from")
    if speed and speed.rank != SURE and (wind_from is None or wind_from.rank == GUESS):
        role = "wind_speed"
        why = speed.why or "it may be over ground, as in CF"
        if wind_from is None and "true_wind_from" in chosen and "true_wind_speed" not in chosen:
            role = "true_wind_speed"
            why = "it may be the apparent wind's"
        del chosen["wind_speed"]
        chosen[role] = replace(speed, role=role, rank=GUESS, why=why)
    # AIS, GPX and trackers have both without more words.
    bare = {frozenset(words_of(g.column)) - {"true", "deg"}: g for g in left if "heading" in chosen}
    if (course := bare.get(frozenset({"course"}))) and "course_over_ground" not in chosen:
        why = "it may be another course"
        chosen["course_over_ground"] = replace(
            course, role="course_over_ground", rank=GUESS, why=why
        )
    surge = chosen.get("surge")
    is_bare = surge and surge.why == meaning_of(("speed",)).doubt and "sway" not in chosen
    if is_bare and "course_over_ground" in chosen and "speed_over_ground" not in chosen:
        chosen["speed_over_ground"] = replace(chosen.pop("surge"), role="speed_over_ground")


def _beside_others(chosen, log):
    """Names with two meanings, of which another column has one: a true course, and breadth and length in the north."""
    heading = chosen.get("heading")
    course = chosen.get("course_over_ground")
    if heading and "over ground" in heading.why and course and not course.is_guess:
        values = log.values[heading.column]
        # An order stands still mostly, and a copy of the other tells nothing.
        is_order = np.mean(values[1:] == values[:-1]) > 0.5
        if not is_order and not np.array_equal(values, log.values[course.column]):
            chosen["heading"] = replace(heading, rank=SURE, why="")
    # A ship's breadth and length do not change.
    pair = [chosen[role] for role in LARGEST if role in chosen]
    is_place = [guess.why in ("it may be a breadth", "it may be a length") for guess in pair]
    if len(pair) == 2 and all(is_place) and all(len({*log.values[g.column]}) > 2 for g in pair):
        chosen |= {guess.role: replace(guess, rank=SURE, why="") for guess in pair}


def _thruster_words(name):
    """Words of a name that say which thruster it is."""
    return set(words_of(name)) - _DIRECTIONS - _OF_A_SHAFT


def _of_one_kind(chosen, log):
    """Takes away what is there twice in another form, or without its other half; these guesses, with why."""
    left = []

    def drop(roles, why):
        for role in roles:
            if role in chosen:
                guess = chosen.pop(role).refused(why.replace("_", " "))
                left.append(replace(guess, channel=UNUSED))

    def how_poor(pair):
        columns = [log.values[chosen[role].column] for role in pair]
        is_dead = all(
            cells.dtype.kind == "f" and len(np.unique(finite(cells))) < 2 for cells in columns
        )
        return is_dead, any(chosen[role].is_guess for role in pair)

    # Pairs need both of their roles.
    for pair in _PAIRS:
        for role, other in (pair, pair[::-1]):
            if other not in chosen:
                drop([role], f"it is {role}, and no column is {other}")
    # Of two positions keep one that changes, then the surer one: x and y may count from a fixed latitude.
    whole = sorted((pair for pair in _POSITIONS if pair[0] in chosen), key=how_poor)
    if len(whole) == 2:
        best, worse = whole
        drop(worse, f"{' and '.join(best)} are used instead")
    # Of several velocities keep one that changes, then the surer one.
    ways = [
        pair for pair in (("surge", "sway"), *_PAIRS[:1:-1]) if all(role in chosen for role in pair)
    ]
    ways.sort(key=how_poor)
    for pair in [*ways[1:], ("surge", "sway")] if ways else ():
        if pair != ways[0]:
            drop(pair, f"{' and '.join(ways[0])} are used instead")
    return left
