"""The table of what must hold: each row says what is to be reached and what was measured, and whether it is met."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from allocation.laws import LAWS
from allocation.measures import Spread, spread

KINDS = ("force", "angle", "rate", "sector")  # of violations
BASE = "allocator"  # what others' power is compared with: the generalised inverse at -45 and 45 deg


@dataclass(frozen=True)
class Row:
    """A row: what is measured, and of which laws how much is to be reached.

    Attributes
    ----------
    what : str
    measure : callable
        From a law's measures and those of all laws to values, one a seed or one at all, or None where it was not
        measured.
    to_reach : dict of str to float
        By law, the largest value that meets it. Laws that are not in it are shown, not judged.
    shown : str
        Format of a number.
    worst : bool
        Whether the largest value of a seed is judged, not the mean.
    """

    what: str
    measure: Callable[[dict, dict], list[float] | None]
    to_reach: dict[str, float] = field(default_factory=dict)
    shown: str = ".3g"
    worst: bool = False

    def met(self, law: str, values: Sequence[float]) -> bool | None:
        """Whether a law reaches what it should; None where nothing is asked of it."""
        if law not in self.to_reach:
            return None
        found = spread(values)
        return (found.largest if self.worst else found.mean) <= self.to_reach[law]


def over_requests(key: str, scale: float = 1.0):
    """Mean over both scenarios' recorded requests, one value a seed; None of a law without such a measure."""

    def measure(one, laws):
        if any(key not in run for run in one["replayed"].values()):
            return None
        return [scale * sum(pair) / len(pair) for pair in _by_seed(one["replayed"], key)]

    return measure


def broken(one, laws):
    """Steps with any violation, on recorded requests and in closed loops: the sum of kinds, one value a seed."""
    runs = [*one["replayed"].values(), *([one["loop"]] if one["loop"] else [])]
    return [sum(run[kind][k] for run in runs for kind in KINDS) for k in _seeds(one)]


def broken_share(*kinds: str):
    """Share of the recorded requests at which a limit of these kinds is broken, in per cent, one value a seed."""

    def measure(one, laws):
        steps = one["steps"] / len(one["seeds"])
        runs = one["replayed"].values()
        return [
            100.0 * sum(run[kind][k] for run in runs for kind in kinds) / steps for k in _seeds(one)
        ]

    return measure


def broken_random(one, laws):
    """Violations on random and adversarial requests, all kinds."""
    return [sum(one["random"][kind][0] for kind in KINDS)] if "random" in one else None


def against_optimum(one, laws):
    """Power over that of the exact static optimum, ratio of means over both scenarios, one value a seed."""
    own, best = (_by_seed(one["replayed"], key) for key in ("power", "optimum"))
    return [sum(a) / sum(b) for a, b in zip(own, best, strict=True)]


def against_base(part: str):
    """Power against the generalised inverse at fixed angles, in per cent, one value a seed; on the same requests or in
    the loop, as the part says."""

    def measure(one, laws):
        if not one[part] or BASE not in laws:
            return None
        powers = [law[part] if part == "replayed" else {"": law[part]} for law in (one, laws[BASE])]
        pairs = zip(*(_by_seed(runs, "power") for runs in powers), strict=True)
        return [100.0 * (sum(own) / sum(base) - 1.0) for own, base in pairs]

    return measure


def of_scenario(scenario: str, key: str = "power"):
    """Power, or with "optimum" the least possible one, against the generalised inverse on one scenario's requests."""

    def measure(one, laws):
        if BASE not in laws:
            return None
        own, base = one["replayed"][scenario][key], laws[BASE]["replayed"][scenario]["power"]
        return [100.0 * (a / b - 1.0) for a, b in zip(own, base, strict=True)]

    return measure


def in_stationkeeping(key: str):
    """A measure of ten minutes of stationkeeping, one value a seed."""
    return lambda one, laws: one["loop"][key] if one["loop"] else None


def after_loss(unit: str, key: str):
    """Largest distance [m] or turn [deg] after the loss of a unit, one value a seed."""
    return lambda one, laws: one["lost"][unit][key] if one["lost"] else None


def microseconds(which: int):
    """Median or 99th percentile of the time of an allocation, None where it was not measured. [us]"""
    return lambda one, laws: [1e6 * one["seconds"][which]] if one["seconds"] else None


OPTIMAL, PAPER_V = "optimal_allocator", "paper_v_allocator"
TURNING = (OPTIMAL, PAPER_V)
KEEPING = (OPTIMAL,)  # laws that shall keep all limits


def beside(value: float, *laws: str) -> dict[str, float]:
    """What some laws, by default those that keep all limits, are to reach."""
    return dict.fromkeys(laws or KEEPING, value)


OPEN_LOOP = (
    Row("steps that break the sector [%]", broken_share("sector")),
    Row("steps that break a rate [%]", broken_share("rate")),
    Row("steps that break a limit of force [%]", broken_share("force")),
    Row("power over the exact static optimum", against_optimum, beside(1.06), ".3f"),
    Row(
        "power against the generalised inverse [%]", against_base("replayed"), beside(-16.0), ".1f"
    ),
    Row("in four corners [%]", of_scenario("four_corner"), {}, ".1f"),
    Row(
        "in four corners, what the exact optimum gives [%]",
        of_scenario("four_corner", "optimum"),
        {},
        ".1f",
    ),
    Row("in stationkeeping [%]", of_scenario("stationkeeping"), {}, ".1f"),
    Row(
        "in stationkeeping, what the exact optimum gives [%]",
        of_scenario("stationkeeping", "optimum"),
        {},
        ".1f",
    ),
    Row(
        "force missed where limits and rates allow [N]",
        over_requests("force_error_within_rates"),
        beside(5.0),
    ),
    Row("moment missed there [N m]", over_requests("moment_error_within_rates"), beside(10.0)),
    Row("share of requests that they allow [%]", over_requests("attainable_within_rates", 100.0)),
    Row("force missed where limits allow [N]", over_requests("force_error")),
    Row("moment missed there [N m]", over_requests("moment_error")),
    Row("time, median [us]", microseconds(0), {OPTIMAL: 60.0, PAPER_V: 100.0}),
    Row("time, 99th percentile [us]", microseconds(1), {OPTIMAL: 150.0, PAPER_V: 200.0}),
)
CLOSED_LOOP = (
    Row("steps with a violation, recorded requests and loops", broken, beside(0.0), ".0f", True),
    Row("the same, random and adversarial requests", broken_random, beside(0.0), ".0f", True),
    Row(
        "power against the generalised inverse, each in its loop [%]",
        against_base("loop"),
        {},
        ".1f",
    ),
    Row(
        "reversals of an azimuth's propeller in 10 min",
        in_stationkeeping("azimuth_reversals"),
        beside(0.0, *TURNING),
        ".1f",
        True,
    ),
    Row("reversals of the tunnel in 10 min", in_stationkeeping("tunnel_reversals"), {}, ".1f"),
    Row(
        "distance from the reference, stationkeeping, rms [m]",
        in_stationkeeping("distance"),
        {},
        ".2f",
    ),
)
ROWS = CLOSED_LOOP[:2] + OPEN_LOOP + CLOSED_LOOP[2:]


def losses(unit: str, held: bool, laws: dict[str, dict]) -> tuple[Row, Row]:
    """The rows of a lost unit; 3 m are to reach where the ship can be held without it. The turn is not judged."""
    to_reach = dict.fromkeys(laws, 3.0) if held else {}
    what = f"without {unit}{'' if held else ', cannot be held'}"
    return (
        Row(f"{what}: distance [m]", after_loss(unit, "distance"), to_reach, ".1f", True),
        Row(f"{what}: turn [deg]", after_loss(unit, "turn"), {}, ".0f", True),
    )


def lines(laws: dict[str, dict], rows: Sequence[Row]) -> list[str]:
    """The table in Markdown, a column a law; **not met** stands where a law misses what it should reach.

    Parameters
    ----------
    laws : dict of str to dict
        Measures by law, as `measuring.measured` gives them.
    rows : sequence of Row

    Returns
    -------
    list of str
    """
    found = [f"| | to reach | {' | '.join(laws)} |", f"|---|---|{'---|' * len(laws)}"]
    for row in rows:
        cells = [_cell(row, law, row.measure(one, laws)) for law, one in laws.items()]
        found.append(f"| {row.what} | {_asked(row)} | {' | '.join(cells)} |")
    return found


def not_met(laws: dict[str, dict], rows: Sequence[Row]) -> list[str]:
    """What is not reached, in words: row, law, what was found, what was to reach."""
    said = []
    for row in rows:
        for law, one in laws.items():
            values = row.measure(one, laws)
            if values is not None and row.met(law, values) is False:
                said.append(
                    f"{row.what}, {law}: {_number(row, values)}, to reach {row.to_reach[law]:g}"
                )
    return said


def _cell(row, law, values):
    if values is None:
        return "-"
    return _number(row, values) + (" **not met**" if row.met(law, values) is False else "")


def _number(row, values):
    found: Spread = spread(values)
    if row.worst and len(values) > 1:
        return f"{found.mean:{row.shown}}, at most {found.largest:{row.shown}}"
    return f"{found.mean:{row.shown}}" + (f" ± {found.half:.2g}" if len(values) > 1 else "")


def _asked(row):
    return ", ".join(dict.fromkeys(f"{value:g}" for value in row.to_reach.values()))


def _seeds(one):
    return range(len(one["seeds"]))


def _by_seed(runs, key):
    """Values of all runs, seed by seed."""
    return list(zip(*(run[key] for run in runs.values()), strict=True))
