"""Records of a scenario: what happens in a run, and what must hold."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    PlainValidator,
    PrivateAttr,
    ValidationError,
    model_validator,
)
from pydantic_core import PydanticCustomError

from shipcosim import library
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.units import UnitError, amount, as_python, find_unit, is_amount, is_finite, number_in


def _plain(value: Any) -> bool | int | float | str:
    value = as_python(value)
    # NaN and infinity would spread through the simulation.
    if isinstance(value, (int, float)) and not is_finite(value):
        raise ValueError(f"{value} is not a finite number. Give one, in the variable's unit.")
    if isinstance(value, (bool, int, float, str)):
        return value
    raise ValueError(f"{value!r:.60} is no value. A value is a number, true or false, or a text.")


def _amount(value: Any) -> float | str:
    # Numbers, or texts with a number and a unit.
    plain = _plain(value)
    if isinstance(plain, bool) or (isinstance(plain, str) and not is_amount(plain)):
        raise PydanticCustomError(
            "float_type", "Input should be a number, or a text such as '2.5 deg'"
        )
    return plain if isinstance(plain, str) else float(plain)


def _seconds(value: Any) -> Any:
    """Convert texts such as "10 min" to seconds; pydantic checks the rest."""
    if not is_amount(value):
        return value
    try:
        return number_in(value, find_unit("s"))
    except UnitError as error:
        raise ValueError(str(error)) from None


def as_list(value: Any) -> Any:
    """A value as a list of one; lists and None stay as they are."""
    return value if isinstance(value, list) or value is None else [value]


def _positive(value: float | str | None) -> float | str | None:
    number = amount(value) if isinstance(value, str) else (value, "")
    if number is not None and number[0] is not None and not number[0] > 0.0:
        raise PydanticCustomError("greater_than", "Input should be greater than 0")
    return value


Amount = Annotated[float, PlainValidator(_amount), PlainSerializer(lambda value: value)]
"""A number in the signal's unit. One with another unit stays a text until `with_numbers` or `judge` converts it."""
Seconds = Annotated[float, BeforeValidator(_seconds)]
Value = Annotated[bool | int | float | str, PlainValidator(_plain)]
ListOfNames = Annotated[
    list[str], BeforeValidator(lambda names: [names] if isinstance(names, str) else names)
]


POSITION = ["x", "y"]  # names of signals that make a position: north, east


def problems_in(error: ValidationError, where: str) -> list[Problem]:
    """Findings of pydantic in our words, for records from scripts; files have lines in addition."""
    # Missing keys, unknown keys, and everything else with its value.
    problems = []
    for finding in error.errors():
        name = ".".join(map(str, finding["loc"]))
        if finding["type"] == "missing":
            problems.append(Problem(where, f"{name} is missing.", "Give it; times are in s."))
        elif finding["type"] == "extra_forbidden":
            problems.append(
                Problem(
                    where,
                    f"{name}: There is no such key.",
                    f"It was given {finding['input']!r:.60}.",
                )
            )
        else:
            message = f"{name} = {finding['input']!r:.60}." if name else ""
            text = finding["msg"].removeprefix("Value error, ").removesuffix(".")
            problems.append(Problem(where, message or f"{text}.", f"{text}." if message else ""))
    return problems


class _Made(type(BaseModel)):  # pyright: ignore[reportGeneralTypeIssues]  pydantic's metaclass has no public name
    """Makes records for scripts: all problems raise one ShipcosimError."""

    def __call__(cls, *arguments: Any, **keywords: Any) -> Any:
        try:
            return super().__call__(*arguments, **keywords)
        except ValidationError as error:
            raise ShipcosimError(problems_in(error, f"{cls.__name__}()")) from None


class Part(BaseModel, metaclass=_Made):
    """A record of a file: no unknown keys, no later changes."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class Event(Part):
    """A change at a time, in OSP's terms. An event at time t acts on the step that starts at t."""

    time: Seconds = Field(ge=0.0, description="s")
    override: dict[str, Value] = Field(
        default={}, description="signals held at a value instead of what they would be"
    )
    bias: dict[str, Amount] = Field(default={}, description="values added to signals")
    reset: ListOfNames = Field(
        default=[], description="signals that follow their source, or their start value, again"
    )

    @model_validator(mode="after")
    def _does_something(self) -> Event:
        if not (self.override or self.bias or self.reset):
            raise ValueError("The event does nothing. It needs override, bias or reset.")
        return self

    @property
    def changes(self) -> list[tuple[str, str, Value | None]]:
        """(override, bias or reset; signal; value) of each change."""
        changes: list[tuple[str, str, Value | None]] = [
            ("override", *item) for item in self.override.items()
        ]
        return (
            changes
            + [("bias", *item) for item in self.bias.items()]
            + [("reset", s, None) for s in self.reset]
        )


class Expectation(Part):
    """What must hold of one signal, or of the distance that several span.

    Differences of signals in rad are taken the short way round.
    """

    signal: ListOfNames = Field(min_length=1)
    near: Annotated[list[float | str] | None, BeforeValidator(as_list)] = Field(
        default=None, description="amounts, or names of signals"
    )
    within: Annotated[Amount | None, AfterValidator(_positive)] = Field(
        default=None, description="largest distance from `near`, greater than 0"
    )
    at_least: Amount | None = None
    at_most: Amount | None = None
    during: Annotated[list[Seconds], Field(min_length=2, max_length=2)] | None = Field(
        default=None, description="from, to in s"
    )
    statistic: Literal["mean", "max", "min", "final"] | None = Field(
        default=None, description="instead of every row"
    )

    @model_validator(mode="after")
    def _is_one_claim(self) -> Expectation:
        # Either near with within, or limits.
        limits = self.at_least is not None or self.at_most is not None
        if (self.near is None) != (self.within is None):
            raise ValueError("`near` and `within` come together.")
        if (self.near is not None) == limits:
            raise ValueError(
                "An expectation states either near and within, or at_least and/or at_most."
            )
        # One target for each signal.
        if self.near is not None and len(self.near) != len(self.signal):
            raise ValueError(
                f"{len(self.signal)} signals need {len(self.signal)} values in `near`."
            )
        if limits and len(self.signal) > 1:
            raise ValueError("at_least and at_most take one signal.")
        # A window must not end before it starts.
        if self.during and not self.during[0] <= self.during[1]:
            raise ValueError(f"during = {self.during} ends before it starts.")
        return self

    def __str__(self) -> str:
        limits = {"≥": self.at_least, "≤": self.at_most}
        # The claim in words, as messages show it.
        claims = [f"{word} {_text(limit)}" for word, limit in limits.items() if limit is not None]
        if self.near is not None and self.within is not None:
            target = ", ".join(map(_text, self.near))
            claims = [
                f"within {_text(self.within)} of {target if len(self.near) == 1 else f'({target})'}"
            ]
        window = f" during {self.during[0]:g} to {self.during[1]:g} s" if self.during else ""
        return f"{self.subject} {' and '.join(claims)}{window}"

    @property
    def subject(self) -> str:
        """Subject in words: 'position of vessel', 'mean of port.power'."""
        # x and y of one component are a position, psi is a heading.
        owners = {signal.rpartition(".")[0] for signal in self.signal}
        names = [signal.rpartition(".")[2] for signal in self.signal]
        if names == POSITION and len(owners) == 1:
            what = "position"
        elif self.is_heading:
            what = "heading"
        else:
            owners = {""}
            what = ", ".join(self.signal)
            what = what if len(names) == 1 else f"({what})"
        of = f" of {owner}" if (owner := next(iter(owners))) else ""
        return (f"{self.statistic} of " if self.statistic else "") + what + of

    @property
    def is_heading(self) -> bool:
        """True for a heading, by its usual name."""
        return [signal.rpartition(".")[2] for signal in self.signal] == ["psi"]

    @property
    def signals(self) -> list[str]:
        """Every signal of the expectation."""
        return [
            *self.signal,
            *(v for v in self.near or () if isinstance(v, str) and not is_amount(v)),
        ]


class Record(Part):
    """What the table of a run keeps; without it all signals."""

    signals: ListOfNames = Field(
        default=[], description="signals, components, connectors or patterns such as 'vessel.*'"
    )
    every: Seconds | None = Field(
        default=None, gt=0.0, description="s; another name of output_interval"
    )


def _text(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"


class Scenario(Part):
    """What happens: a system, its start values, events, and what must hold.

    A change is a copy: ``scenario.model_copy(update={"step_size": 0.025})``.
    """

    description: str = ""
    system: str = Field(default="", description="name of a system, or a path")
    parameters: ListOfNames = Field(
        default=[], description="names of parameter sets in the system's resources, or paths"
    )
    components: dict[str, str] = Field(
        default={},
        description="FMUs that components run in place of their own: names of FMUs, or paths",
    )
    stop_time: Seconds = Field(gt=0.0, description="s")
    step_size: Seconds = Field(gt=0.0, description="s")
    output_interval: Seconds | None = Field(
        default=None, gt=0.0, description="s; every step where it is not given"
    )
    order: Literal["jacobi", "gauss-seidel"] = Field(
        default="jacobi",
        description="jacobi: every component steps with what the others had put out before the step; gauss-seidel: "
        "with what those before it have just put out",
    )
    set: dict[str, Value] = Field(default={}, description="start values")
    events: list[Event] = []
    expect: list[Expectation] = []
    record: Record = Record()
    _path: Path | None = PrivateAttr(None)

    @model_validator(mode="before")
    @classmethod
    def _with_interval_of_rows(cls, content: Any) -> Any:
        # `every` of [record] becomes the output interval, so that all that runs a scenario knows one name of it.
        record = content.get("record") if isinstance(content, dict) else None
        every = record.get("every") if isinstance(record, dict) else None
        if record is None or every is None:
            return content
        if content.get("output_interval", every) != every:
            raise ValueError("`output_interval` and `every` of [record] are two intervals of rows.")
        rest = {key: value for key, value in record.items() if key != "every"}
        return content | {"output_interval": every, "record": rest}

    @property
    def path(self) -> Path | None:
        """File the scenario was read from."""
        return self._path

    @property
    def name(self) -> str:
        """Name of the file, without its suffix."""
        return self._path.stem if self._path else ""

    @property
    def folder(self) -> Path:
        """Folder in which files that it names are looked for first."""
        return self._path.resolve().parent if self._path else Path.cwd()

    @property
    def project(self) -> Path:
        """Folder of the project that the scenario lies in, else the one above the scenario's own folder."""
        if self._path is None:
            return self.folder
        return library.project_of(self.folder) or self.folder.parent

    @property
    def system_path(self) -> Path:
        """Path of the system: next to the scenario or in the project, else found by name."""
        candidates = [self.folder / self.system, self.project / self.system]
        if path := next((c for c in candidates if self.system and c.exists()), None):
            return path
        return (
            library.named("system", self.system, self.project) or self.project / "ssp" / self.system
        )

    @property
    def parameter_paths(self) -> list[Path]:
        """Paths of the parameter sets: by name in the system's resources, else beside the file."""
        named = {name: self.system_path / "resources" / f"{name}.ssv" for name in self.parameters}
        return [path if path.exists() else self.folder / name for name, path in named.items()]

    def component_paths(self, build: bool = True) -> dict[str, Path]:
        """FMUs that replace those of components: a path next to the scenario, else found by name.

        Parameters
        ----------
        build : bool
            Build an FMU that has a name and is missing or out of date.

        Raises
        ------
        ShipcosimError
            If there is no such FMU.
        """
        paths = {}
        for name, fmu in self.components.items():
            path = self.folder / fmu
            paths[name] = (
                path if path.is_file() else library.find("fmu", fmu, near=self.project, build=build)
            )
        return paths
