"""Records of a study: factors, quantities of each run, and summaries of the runs."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainValidator,
    PrivateAttr,
    model_validator,
)
from pydantic_core import PydanticCustomError

from shipcosim import library
from shipcosim.scenario import Event, Expectation
from shipcosim.scenario.model import Amount, ListOfNames, Part, Seconds, Value, as_list
from shipcosim.sweep import weather

RESERVED = ("run", "error", "input", "sample")
"""Columns that every table of runs has."""


def _column(name: str) -> str:
    if name in RESERVED:
        raise ValueError(f"'{name}' is a column of every table of runs. Take another name.")
    if not re.fullmatch(r"[A-Za-z_][\w.-]*", name):
        raise ValueError(f"'{name}' cannot name a column. Use letters, digits, '_', '-' and '.'.")
    return name


def _label(value: Any) -> str | int | float:
    if isinstance(value, bool) or not isinstance(value, (str, int, float)):
        raise PydanticCustomError("label_type", "It should be a number or a text in quotes")
    return value


Label = Annotated[str | int | float, PlainValidator(_label)]
Column = Annotated[str, AfterValidator(_column)]
MOST_LEVELS = 10_000
"""Largest number of levels of a factor, which are all made before the first run."""
Count = Annotated[int, Field(ge=1)]
Several = Annotated[int, Field(ge=2, le=MOST_LEVELS)]
KINDS = "values", "from (with to and count or step)", "case", "directions", "conditions", "seeds"


class Case(Part):
    """Several things that change together.

    Values of `set` act from the start; events act at their times.
    """

    label: Label
    set: dict[str, Value] = {}
    events: list[Event] = []
    parameters: ListOfNames = []
    components: dict[str, str] = {}
    stop_time: Seconds | None = Field(default=None, gt=0.0)


class Factor(Part):
    """A factor and its values: listed, evenly spaced, cases, weather, or seeds."""

    name: Column
    signal: ListOfNames = Field(default=[], description="signals that get the value")
    values: list[Value] | None = Field(default=None, min_length=1)
    start: Amount | None = Field(default=None, alias="from")
    to: Amount | None = None
    count: Several | None = None
    step: Amount | None = None
    case: list[Case] | None = Field(default=None, min_length=1)
    directions: Several | None = Field(
        default=None, description="how many, that wind, waves and current come from"
    )
    conditions: list[Literal[weather.NUMBERS]] | None = Field(  # pyright: ignore[reportInvalidTypeForm]
        default=None,
        min_length=1,
        description="DP capability numbers whose wind, waves and current are set",
    )
    seeds: Annotated[int, Field(ge=1, le=MOST_LEVELS)] | None = None
    at_fork: bool = Field(default=False, description="acts at fork_at, as an event that overrides")

    @model_validator(mode="after")
    def _has_values(self) -> Factor:
        # Exactly one kind of values, and its keys complete.
        kinds = {
            "values": self.values,
            "from": self.start,
            "case": self.case,
            "directions": self.directions,
        }
        kinds |= {"conditions": self.conditions, "seeds": self.seeds}
        given = [name for name, value in kinds.items() if value is not None]
        if len(given) != 1:
            message = f"It has {' and '.join(given)}." if given else "It has no values."
            raise ValueError(f"{message} A factor has one of {', '.join(KINDS)}.")
        if self.start is None and (self.to, self.count, self.step) != (None, None, None):
            raise ValueError("to, count and step belong to from. Give from, too.")
        if self.start is not None and (
            self.to is None or (self.count is None) == (self.step is None)
        ):
            raise ValueError("from needs to, and either count or step.")
        if given[0] in ("values", "from") and not self.signal:
            raise ValueError("signal is missing. Name the signal that gets the values.")
        if self.cases and (self.signal or self.at_fork):
            which = "Cases" if self.case else given[0].capitalize()
            raise ValueError(
                f"{which} say themselves what they set: signal and at_fork are not used with them."
            )
        return self

    @property
    def cases(self) -> list[Case]:
        """Cases as listed, or made from directions and conditions; empty if there are none."""
        made = (
            weather.directions(self.directions)
            if self.directions
            else weather.conditions(self.conditions or ())
        )
        return self.case or [Case(label=label, set=dict(values)) for label, values in made.items()]


class Distribution(Part):
    """Distribution of a sampled signal: one of scipy.stats, with its parameters."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, float] = Field(init=False)

    distribution: str | None = None
    tolerance: bool = Field(
        default=False, description="normal, with the tolerance that the parameter set states"
    )
    unit: str | None = Field(
        default=None, description="of the samples; that of the variable where it is not given"
    )
    name: Column | None = Field(
        default=None, description="column; the name of the signal where it is not given"
    )
    also: ListOfNames = Field(default=[], description="further signals that get the same value")
    at_fork: bool = False

    @model_validator(mode="after")
    def _is_one(self) -> Distribution:
        if (self.distribution is None) == (not self.tolerance):
            raise ValueError("It needs either distribution or tolerance = true.")
        if self.tolerance and (self.shape or self.unit):
            raise ValueError(
                "tolerance = true takes its numbers from the parameter set: no others are given."
            )
        return self

    @property
    def shape(self) -> dict[str, float]:
        """Parameters of the distribution, loc and scale among them."""
        return dict(self.__pydantic_extra__ or {})


class Sample(Part):
    """Values drawn at random or spread evenly over distributions."""

    method: Literal["sobol", "latin_hypercube", "random", "saltelli"] = "sobol"
    runs: Count
    of: dict[str, Distribution] = Field(min_length=1)


REDUCTIONS = (
    "maximum",
    "minimum",
    "mean",
    "rms",
    "final",
    "at",
    "percentile",
    "time_beyond",
    "share_beyond",
)
_NEEDS = {"at": "time", "percentile": "percentile", "time_beyond": "limit", "share_beyond": "limit"}


def _check_argument(part: Part, key: str, needs: dict[str, str]) -> None:
    """Raise ValueError unless a part has the argument that the value of its key needs, and no other."""
    value = getattr(part, key)
    for name in dict.fromkeys(needs.values()):
        is_needed = needs.get(value) == name
        if is_needed != (getattr(part, name) is not None):
            verb = "needs" if is_needed else "does not use"
            raise ValueError(f'{key} = "{value}" {verb} {name}.')


class Quantity(Part):
    """A number or a verdict that is kept of a run."""

    name: Column
    description: str = ""
    signal: ListOfNames = []
    near: Annotated[list[Label] | None, BeforeValidator(as_list)] = Field(
        default=None, description="amounts, or names of signals"
    )
    reduce: Literal[REDUCTIONS] | None = None  # pyright: ignore[reportInvalidTypeForm]
    during: Annotated[list[Seconds], Field(min_length=2, max_length=2)] | None = None
    time: Seconds | None = Field(default=None, ge=0.0)
    percentile: Annotated[float, Field(gt=0.0, lt=100.0)] | None = None
    limit: Amount | None = None
    since: Seconds | None = Field(
        default=None, ge=0.0, description="from which the time beyond a limit is counted"
    )
    expect: list[Expectation] = []
    scenario_expectations: bool = False
    margin: Literal["phase", "gain", "delay"] | None = Field(
        default=None, description="of the DP loop, the least axis"
    )
    component: str = Field(default="controller", description="whose margin it is")
    peak_period: Seconds | None = Field(
        default=None, gt=0.0, description="of the waves that its filter has adapted to"
    )

    @model_validator(mode="after")
    def _is_one(self) -> Quantity:
        # A margin follows from the start values alone, so no key of a signal fits to it.
        if self.margin is not None:
            if self.model_fields_set - {
                "name",
                "description",
                "margin",
                "component",
                "peak_period",
            }:
                raise ValueError(
                    "margin follows from start values: beside it there are component and peak_period."
                )
            if self.peak_period is None:
                raise ValueError(
                    'peak_period is missing. Give that of the waves: peak_period = "6 s".'
                )
            return self
        if self.peak_period is not None or "component" in self.model_fields_set:
            raise ValueError("component and peak_period belong to margin. Give margin, too.")
        # Either a reduced signal, or a verdict by expectations.
        if self.judges == bool(self.signal):
            raise ValueError(
                "A quantity has either signal and reduce, or expect or scenario_expectations = true."
            )
        others = ("near", "reduce", "during", "time", "percentile", "limit", "since")
        if self.judges and (
            others_given := [name for name in others if getattr(self, name) is not None]
        ):
            raise ValueError(
                f"{', '.join(others_given)}: not used beside expect; an expectation has its own keys."
            )
        if self.judges:
            return self
        if self.reduce is None:
            raise ValueError(f"reduce is missing. It is one of {', '.join(REDUCTIONS)}.")
        _check_argument(self, "reduce", _NEEDS)
        if self.since is not None and (self.reduce != "time_beyond" or self.during):
            raise ValueError('since belongs to reduce = "time_beyond", without during.')
        if len(self.signal) > 1 and self.near is None:
            raise ValueError(
                "Several signals span a distance: near is missing. Give a value for each signal."
            )
        self.claim  # noqa: B018  says what is wrong with near and during
        return self

    @property
    def judges(self) -> bool:
        """True if the quantity is a verdict."""
        return bool(self.expect or self.scenario_expectations)

    @property
    def claim(self) -> Expectation:
        """An expectation with the signals, distance or value, and window of this quantity."""
        # The limit is a dummy where the reduction has none; only signals and window are used then.
        limit: dict[str, Any] = {"at_most": self.limit if self.limit is not None else 0.0}
        if self.near is not None:
            limit = {"near": self.near, "within": self.limit if self.limit is not None else 1.0}
        return Expectation.model_validate({"signal": self.signal, "during": self.during, **limit})


class Summary(Part):
    """A number over all runs that differ in the given factors only."""

    name: Column
    quantity: str
    over: ListOfNames = Field(min_length=1)
    statistic: Literal["percentile", "mean", "std", "maximum", "minimum", "share", "last_held"]
    description: str = ""
    percentile: Annotated[float, Field(gt=0.0, lt=100.0)] | None = None
    along: str | None = Field(
        default=None, description="factor whose cases come in the order of their weight"
    )
    share: Annotated[float, Field(gt=0.0, le=1.0)] | None = None
    none: Label | None = Field(default=None, description="where not even the first case is held")

    @model_validator(mode="after")
    def _is_one(self) -> Summary:
        _check_argument(self, "statistic", {"percentile": "percentile", "last_held": "along"})
        if self.statistic != "last_held" and (self.share, self.none) != (None, None):
            raise ValueError('share and none belong to statistic = "last_held".')
        return self


class Range(Part):
    """Range of a parameter in a search."""

    low: Amount
    high: Amount
    log: bool = Field(default=False, description="evenly spread in the logarithm")
    name: Column | None = Field(
        default=None, description="column; the name of the signal where it is not given"
    )
    also: ListOfNames = Field(default=[], description="further signals that get the same value")


class Objective(Part):
    """An objective of a search: a quantity over the runs of a trial."""

    quantity: str
    direction: Literal["minimise", "maximise"]
    statistic: Literal["mean", "maximum", "minimum"] = "mean"


class Tune(Part):
    """A search for Pareto-optimal parameter values by NSGA-II, generation by generation."""

    trials: Count
    population: Annotated[int, Field(ge=2)]
    of: dict[str, Range] = Field(min_length=1)
    objective: list[Objective] = Field(min_length=2)


def _names_or_false(value: Any) -> Any:
    return [] if value is False else [value] if isinstance(value, str) else value


class View(Part):
    """A view on the results page; its keys depend on its kind."""

    kind: Literal["polar", "curves", "tracks", "bars", "pareto", "scatter"]
    title: str = ""
    note: str = ""
    series: Annotated[list[str] | None, BeforeValidator(_names_or_false)] = None
    only: dict[str, Value | list[Value]] = {}
    table: str | None = None
    angle: str | None = None
    radius: str | None = None
    static: Annotated[list[Literal["simulator", "level 1"]], BeforeValidator(as_list)] = []
    quantity: str | None = None
    circles: list[Annotated[float, Field(gt=0.0)]] = []
    category: str | None = None
    value: ListOfNames = []
    most: Count | None = None
    quantities: ListOfNames = Field(default=[], min_length=2, max_length=3)
    largest: ListOfNames = []
    marked: str | None = None
    x: str | None = None
    y: str | None = None

    @model_validator(mode="after")
    def _keys_of_its_kind(self) -> View:
        """Raise ValueError if a key is missing, or would be ignored."""
        needed, others = _KEYS_OF_VIEWS[self.kind]
        if missing := [key for key in needed if not getattr(self, key)]:
            raise ValueError(f"a view of kind '{self.kind}' needs {' and '.join(missing)}.")
        allowed = {"kind", "title", "note", "series", "only", "table", *needed, *others}
        if foreign := sorted(self.model_fields_set - allowed):
            raise ValueError(f"a view of kind '{self.kind}' has no {', '.join(foreign)}.")
        return self


_KEYS_OF_VIEWS = {
    "polar": (("angle", "radius"), ("static",)),
    "curves": (("quantity",), ()),
    "tracks": ((), ("circles",)),
    "bars": (("category", "value"), ("most",)),
    "pareto": (("quantities",), ("largest", "marked")),
    "scatter": (("x", "y"), ()),
}
"""Keys that a view needs, and others that it can have, by its kind."""


class Tracks(Part):
    """Signals over time that are kept of each run, thinned."""

    signals: ListOfNames = Field(min_length=1)
    interval: Seconds | None = Field(default=None, gt=0.0)


class Study(Part):
    """A study: a scenario, its variations, and what is kept of each run."""

    description: str = ""
    scenario: str = Field(min_length=1)
    seed: Annotated[int, Field(ge=0)] = 1
    stop_time: Seconds | None = Field(default=None, gt=0.0)
    step_size: Seconds | None = Field(default=None, gt=0.0)
    output_interval: Seconds | None = Field(default=None, gt=0.0)
    fork_at: Seconds | None = Field(default=None, gt=0.0)
    parameters: ListOfNames = []
    components: dict[str, str] = {}
    set: dict[str, Value] = {}
    events: list[Event] = []
    names: dict[str, Annotated[list[str], Field(min_length=1)]] = {}
    factor: list[Factor] = []
    sample: Sample | None = None
    tune: Tune | None = None
    quantity: list[Quantity] = Field(min_length=1)
    summary: list[Summary] = []
    view: list[View] = []
    tracks: Tracks | None = None
    _path: Path | None = PrivateAttr(None)
    _source: Any = PrivateAttr(None)

    @property
    def path(self) -> Path | None:
        """File from which it was read."""
        return self._path

    @property
    def name(self) -> str:
        """Name of the file, without its suffix."""
        return self._path.stem if self._path else "study"

    @property
    def folder(self) -> Path:
        """Folder in which files that it names are looked for first."""
        return self._path.resolve().parent if self._path else Path.cwd()

    @property
    def scenario_path(self) -> Path:
        """The scenario: a path beside the study, else what has this name.

        Raises
        ------
        ShipcosimError
            If there is none.
        """
        neighbour = self.folder / self.scenario
        return (
            neighbour
            if neighbour.is_file()
            else library.find("scenario", self.scenario, near=self.folder)
        )
