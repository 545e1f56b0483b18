"""Writer of OspSystemStructure.xml, exact to the last digit that libcosim reads."""

from collections import defaultdict
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from xml.sax.saxutils import quoteattr

from shipcosim.ssp.flatten.connections import Connection
from shipcosim.ssp.osp.schema import NAMESPACE
from shipcosim.ssp.read.structure import End
from shipcosim.ssp.xml.markup import free_name
from shipcosim.ssp.xml.values import Value, text_of


@dataclass(frozen=True)
class Simulator:
    """A simulator as it is written.

    Parameters
    ----------
    name, source : str
        Its name and the address of its FMU.
    step_size : float
        A multiple of the base step. [s]
    values : mapping of str to (kind, value)
        Initial values by variable; kinds Real, Integer, Boolean, String.
    """

    name: str
    source: str
    step_size: float
    values: Mapping[str, tuple[str, Value]] = field(default_factory=dict)


def structure_text(
    simulators: Sequence[Simulator],
    connections: Iterable[Connection],
    step_size: float,
    end_time: float | None = None,
) -> str:
    """Text of an OspSystemStructure.xml.

    Parameters
    ----------
    simulators : sequence of Simulator
        In their order.
    connections : iterable of Connection
        Between their variables: Real ones with factor and offset, several into one target as a sum.
    step_size : float
        Base step. [s]
    end_time : float, optional
        [s]

    Returns
    -------
    str
    """
    functions, joined = _connections(connections, [simulator.name for simulator in simulators])
    end = "" if end_time is None else f"\n  <EndTime>{end_time!r}</EndTime>"
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<OspSystemStructure xmlns="{NAMESPACE}" version="0.1">\n  <StartTime>0.0</StartTime>{end}\n'
        f"  <BaseStepSize>{seconds_text(step_size)}</BaseStepSize>\n  <Algorithm>fixedStep</Algorithm>"
        + _group("Simulators", [line for simulator in simulators for line in _lines(simulator)])
        + _group("Functions", functions)
        + _group("Connections", joined)
        + "\n</OspSystemStructure>\n"
    )


def seconds_text(seconds: float) -> str:
    """Seconds as text that libcosim, which truncates to nanoseconds, reads exactly.

    Examples
    --------
    >>> seconds_text(0.29)
    '0.29000000025'
    """
    # A quarter nanosecond more: truncation then gives the right nanosecond.
    nanoseconds = round(seconds * 1e9)
    return f"{nanoseconds // 10**9}.{nanoseconds % 10**9:09d}25"


def _lines(simulator: Simulator) -> list[str]:
    step = seconds_text(simulator.step_size)
    head = f'<Simulator name={quoteattr(simulator.name)} source={quoteattr(simulator.source)} stepSize="{step}"'
    if not simulator.values:
        return [f"{head}/>"]
    values = (
        f"    <InitialValue variable={quoteattr(name)}><{kind} value={quoteattr(text_of(value))}/></InitialValue>"
        for name, (kind, value) in simulator.values.items()
    )
    return [f"{head}>", "  <InitialValues>", *values, "  </InitialValues>", "</Simulator>"]


def _connections(
    connections: Iterable[Connection], taken: Container[str]
) -> tuple[list[str], list[str]]:
    """Function elements, in the order that libcosim requires, and connection elements."""
    into = defaultdict(list)
    linear = []
    sums = []
    joined = []
    # Group by target: several connections into one input are a sum.
    for connection in connections:
        into[connection.target].append(connection)
    for target, feeding in into.items():
        first = feeding[0]
        # A Sum function for several sources, a linear one for a
        # factor or offset, else a plain connection.
        if len(feeding) > 1:
            name = free_name(f"sum_{len(sums)}", taken)
            sums.append(f'<Sum name="{name}" inputCount="{len(feeding)}"/>')
            joined += [_signal(c.source, name, f"in[{i}]") for i, c in enumerate(feeding)]
            joined.append(_signal(target, name, "out"))
        elif first.is_linear:
            name = free_name(f"linear_{len(linear)}", taken)
            how = f'factor="{first.factor!r}" offset="{first.offset!r}"'
            linear.append(f'<LinearTransformation name="{name}" {how}/>')
            joined += [_signal(first.source, name, "in"), _signal(target, name, "out")]
        else:
            joined.append(
                f"<VariableConnection>{_variable(first.source)}{_variable(target)}</VariableConnection>"
            )
    return linear + sums, joined


def _signal(end: End, function: str, name: str) -> str:
    signal = f'<Signal function="{function}" name="{name}"/>'
    return f"<SignalConnection>{_variable(end)}{signal}</SignalConnection>"


def _variable(end: End) -> str:
    return f"<Variable simulator={quoteattr(end[0] or '')} name={quoteattr(end[1])}/>"


def _group(name: str, lines: list[str]) -> str:
    return (
        f"\n  <{name}>" + "".join(f"\n    {line}" for line in lines) + f"\n  </{name}>"
        if lines
        else ""
    )
