"""What the file of a cause holds, and that of a fault of the log: the only place where either is described.

`docs/add-a-cause.md` explains the main keys with examples; the reference of file formats lists all, from here.
"""

from string import Formatter
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from shipcosim.units import spelled_conversion

FACTS = ("astern_share", "speed", "surge", "surge_acceleration", "sway", "wind_speed", "yaw_rate")
"""What `why_not_testable` can say of a log: root mean squares of the motion, the mean wind, the share astern."""


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


Number = Annotated[float, Field(strict=True)]
"""A finite one; true and "0.5" are none."""
Size = Annotated[Number, Field(gt=0.0)]
NotNegative = Annotated[Number, Field(ge=0.0)]


class OnConnections(_Strict):
    """How the connections of a thruster carry a parameter that the thruster's FMU does not have.

    Attributes
    ----------
    of : "loads", "rpm" or "azimuth"
        ``"loads"``: the connections of its loads to the ship get the factor 1 + `sign` times the value. Else those
        of its speed or direction get an offset of `sign` times the value.
    sign : float
    """

    of: Literal["loads", "rpm", "azimuth"]
    sign: Number


class CauseParameter(_Strict):
    """A parameter of a cause.

    Attributes
    ----------
    of : list of str
        Numbers of the ship that take its value: ``vessel.mass_scale``; ``{thruster}`` stands for the component,
        ``{azimuths}`` for each azimuth thruster at once, whether it turns or not, ``{thrusters}`` for each thruster.
    unit : str
        Unit in which it is reported; that of the number is converted.
    typical : float
        Size that matters, as distance from neutral.
    tolerance : float, optional
        Standard deviation that is no cause yet, where the ship's parameter sets do not say.
    bounds : tuple of two floats
        Values beyond are implausible.
    complement : bool
        Whether the number is 1 minus what is reported.
    factor : bool
        Whether the numbers are the model's own times what is reported.
    relative_to : str, optional
        Number of the ship whose value typical, tolerance and bounds are multiplied by.
    on_connections : OnConnections, optional
        How the extended system has it where the FMU of a thruster has no such parameter.
    """

    of: Annotated[list[str], Field(min_length=1)]
    unit: str = "1"
    typical: Size
    tolerance: NotNegative = 0.0
    bounds: tuple[Number, Number]
    complement: bool = False
    factor: bool = False
    relative_to: str | None = None
    on_connections: OnConnections | None = None

    @model_validator(mode="after")
    def _checked(self) -> Self:
        """Refuse bounds that no value is between, and an unknown unit."""
        spelled_conversion(self.unit, self.unit)
        low, high = self.bounds
        if not low < high:
            raise ValueError(f"bounds = [{low:g}, {high:g}]: the first should be below the second")
        return self


class ExtensionRule(_Strict):
    """How an extended system has a cause whose numbers are not parameters of its components.

    Attributes
    ----------
    by : "parameters", "force", "steady current", "varying current", "instruments" or "log"
        ``"parameters"``: of the components that the numbers name. ``"force"``: the FMU `insert`, whose loads are
        added to those on the ship. ``"steady current"``, ``"varying current"``: the velocity of the water, as one
        value or by those at the log's first and last row. ``"instruments"``: errors of instruments between the ship
        and the log. ``"log"``: not at all, since the log is to be corrected.
    parameters : dict of str to str
        By number of the ship: the parameter that takes it, of the inserted FMU or of the instruments, or the
        component of the current (``north``, ``east``, ``north_start``, ...).
    insert : str
        Name of the FMU.
    inputs : dict of str to str
        By input of the FMU: the ship's output that feeds it.
    zero : list of str
        Parameters of the FMU that are 0 where the cause has no such number.
    assumed : dict of str to str
        Parameters of the FMU that keep the ship model's value where the cause has no such number, and why.
    onset : tuple of two str, optional
        Parameters of the FMU for the time from which it acts and for how long it grows.
    neighbour_inputs : dict of str to str
        By input of a thruster: the output of its neighbour that feeds it.
    neighbour_place : tuple of two str, optional
        Parameters of a thruster that say where its neighbour is, forward and to starboard.
    """

    by: Literal[
        "parameters", "force", "steady current", "varying current", "instruments", "log"
    ] = "parameters"
    parameters: dict[str, str] = {}
    insert: str = ""
    inputs: dict[str, str] = {}
    zero: list[str] = []
    assumed: dict[str, str] = {}
    onset: tuple[str, str] | None = None
    neighbour_inputs: dict[str, str] = {}
    neighbour_place: tuple[str, str] | None = None


class Cause(_Strict):
    """A cause as its file has it.

    Attributes
    ----------
    cause, sentence, reference : str
    statement : str
        The finding with its numbers, as a clause: ``"the ship is {scale:excess heavier|lighter} than modelled"``.
        Without it the sentence and the numbers.
    next_step : str
        What to do about it; ``{component}`` is the thruster.
    why_not_testable : str
        What this log lacks to show it, with facts of the log such as ``{speed}``.
    for_each : "ship", "thruster" or "azimuth"
        Where it can sit.
    sought_in : "every log", "sea trials" or "comparison"
        ``"sea trials"``: only by features of circles, zig-zags and straight runs at speed. ``"comparison"``: before
        any noise is tuned, as a factor on the thrust that all thrusters have in common, or on the damping of `axis`.
    axis : "", "surge", "sway" or "yaw"
        Of a cause that is sought in the comparison: whose damping its one parameter is; empty of the thrust.
    law : "linear", "vector" or "turning"
        Whether small effects add up; or act by a vector's size and direction, and the cause is sought by directions
        first; or by two vectors, at the first and the last row, and it is sought by `sought_by` first.
    sought_by : list of four str
        For the law ``"turning"``: numbers of a vector at the first row, and of what it grows by to the last, which
        act linearly.
    least : float
        An effect below this share of its typical size is not named.
    cost : float
        Log-evidence that it must gain beyond what every cause must: a rare cause needs more. [nats]
    companions : list of str
        Numbers that are only known within their tolerance and only matter where this cause acts.
    shape : list of str
        Companions that, taken together, must lie within their tolerances: with another shape it is another cause.
    replaces : list of str
        Numbers that this cause is evidence for: their tolerance is left out where it acts.
    special : str, optional
        A simpler cause that this one contains, its parameters several times in the same order.
    without_wind : "sought", "left out" or "allowed for"
        In a log without wind: whether it can be told; or acts like the unknown wind and is not sought; or is not
        sought, and acts with an unknown size beside every other cause.
    unit_of : list of str
        Channels in a wrong unit that look like this cause; the wrong unit is preferred.
    extension : ExtensionRule, optional
        Without it the cause is in the extended system as a cause of ours on the same numbers, else by parameters.
    parameters : dict of str to CauseParameter
    """

    cause: str
    sentence: str
    reference: str
    statement: str = ""
    next_step: str = ""
    why_not_testable: str = ""
    for_each: Literal["ship", "thruster", "azimuth"] = "ship"
    sought_in: Literal["every log", "sea trials", "comparison"] = "every log"
    axis: Literal["", "surge", "sway", "yaw"] = ""
    law: Literal["linear", "vector", "turning"] = "linear"
    sought_by: list[str] = []
    least: NotNegative = 0.2
    cost: Number = 0.0
    companions: list[str] = []
    shape: list[str] = []
    replaces: list[str] = []
    special: str | None = None
    without_wind: Literal["sought", "left out", "allowed for"] = "sought"
    unit_of: list[str] = []
    extension: ExtensionRule | None = None
    parameters: Annotated[dict[str, CauseParameter], Field(min_length=1)]

    @model_validator(mode="after")
    def _checked(self) -> Self:
        """Refuse a text with a placeholder that nothing fills, and a law without what it needs."""
        fills = {
            "statement": {*self.parameters, "component"},
            "next_step": {"component"},
            "why_not_testable": set(FACTS),
        }
        for key, allowed in fills.items():
            wanted = {
                name for field in placeholders(getattr(self, key)) for name in field.split("+")
            }
            if wanted - allowed:
                raise ValueError(
                    f"{key}: there is no {sorted(wanted - allowed)} to fill in, but {sorted(allowed)}"
                )
        if self.law == "turning" and (len(self.sought_by), len(self.parameters)) != (4, 4):
            raise ValueError("law 'turning' takes four parameters, and four numbers in sought_by")
        if self.law == "vector" and len(self.parameters) != 2:
            raise ValueError("law 'vector' takes two parameters")
        return self


def placeholders(text: str) -> list[str]:
    """Names in braces of a text with placeholders."""
    return [name for _, name, _, _ in Formatter().parse(text) if name is not None]


class Fault(_Strict):
    """A kind of fault of the log, or of the system's connections, in words.

    Attributes
    ----------
    fault : str
        Its name in findings.
    statement : str
        What is wrong, as a clause.
    adds : "channels", "duration" or "nothing"
        What of the finding follows the statement.
    repair : str
        What the diagnosis did about it.
    in_every_channel : bool
        Whether it concerns all channels, whichever the finding names.
    rewires : bool
        Whether the extended system has the connections of the component as their names say.
    why_not_testable : str
        What keeps a log from showing it, as a clause.
    """

    fault: str
    statement: str
    adds: Literal["channels", "duration", "nothing"] = "channels"
    repair: str
    in_every_channel: bool = False
    rewires: bool = False
    why_not_testable: str = ""
