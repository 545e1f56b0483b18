"""Functions of an OspSystemStructure.xml: their signals, and the connections that they make."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import lxml.etree as etree

from shipcosim.errors import it_has
from shipcosim.ssp.flatten.connections import Connection
from shipcosim.ssp.xml.document import Findings, local


@dataclass(frozen=True)
class Function:
    """A function of an OspSystemStructure.xml, between variables of type Real.

    Parameters
    ----------
    kind, name : str
        ``"LinearTransformation"``, ``"Sum"`` or ``"VectorSum"``.
    inputs, dimension : int
        How many it adds up, and how many numbers each of them has.
    factor, offset : float
        Of a linear transformation.
    place : str
        Where it stands, for messages.
    """

    kind: str
    name: str
    inputs: int = 1
    dimension: int = 1
    factor: float = 1.0
    offset: float = 0.0
    place: str = ""

    @property
    def rows(self) -> list[tuple[list[str], str]]:
        """For each output number: names of its input signals, and its own name."""
        if self.kind == "LinearTransformation":
            return [(["in"], "out")]
        inputs = [f"in[{i}]" for i in range(self.inputs)]
        if self.kind == "Sum":
            return [(inputs, "out")]
        return [([f"{name}[{j}]" for name in inputs], f"out[{j}]") for j in range(self.dimension)]

    @property
    def signals(self) -> list[str]:
        """Names allowed in a SignalConnection."""
        return [name for inputs, output in self.rows for name in (*inputs, output)]

    @property
    def groups(self) -> list[str]:
        """Names allowed in a SignalGroupConnection."""
        return (
            [f"in[{i}]" for i in range(self.inputs)] + ["out"] if self.kind == "VectorSum" else []
        )


MOST_SIGNALS = 10_000
"""Most signals of one function: a few digits in a file can ask for more than any memory holds."""


def read_function(element: etree._Element, place: str, findings: Findings) -> Function | None:
    """Function from its XML element; None, with an error, if it has too many signals.

    Parameters
    ----------
    element : lxml element
        Keeps the schema.
    place : str
        Where it stands, for messages.
    findings : Findings
        Takes what is wrong.

    Returns
    -------
    Function or None
    """
    inputs, dimension = (int(element.get(name, 1)) for name in ("inputCount", "dimension"))
    # A few digits in a file can ask for more signals than memory holds.
    if inputs * dimension > MOST_SIGNALS:
        findings.error(
            place, f"It has {inputs * dimension} inputs.", f"At most {MOST_SIGNALS} are taken."
        )
        return None
    factor = float(element.get("factor", 1.0))
    offset = float(element.get("offset", 0.0))
    return Function(local(element), element.get("name"), inputs, dimension, factor, offset, place)


class Wiring:
    """Connections of variables with function signals, as they are read.

    Parameters
    ----------
    functions : mapping of str to Function
        By name.
    findings : Findings
        Takes what is wrong.
    """

    def __init__(self, functions: Mapping[str, Function], findings: Findings):
        self.functions = functions
        self.findings = findings
        self._ends: dict[tuple[str, str], list[tuple[tuple[str, str], str]]] = {}
        self._given_up: set[str] = set()

    def give_up(self, function: str) -> None:
        """Mark a function as faulty, so that its missing connections are not reported too."""
        self._given_up.add(function)

    def take(self, function: str, signal: str, end: tuple[str, str] | None, place: str) -> None:
        """Record that a variable is connected with a signal of a function.

        Parameters
        ----------
        function, signal : str
            Their names.
        end : tuple of two str or None
            Simulator and variable; None: one with an error.
        place : str
            Where the connection stands, for messages.
        """
        if end is None:
            self.give_up(function)
            return
        # The signal must exist.
        declared = self.functions[function]
        if signal not in declared.signals:
            message = f"The {declared.kind} '{function}' has no signal '{signal}'."
            self.findings.error(place, message, it_has(signal, declared.signals))
            return
        # An input takes one connection; an output may have
        # several, of which libcosim makes the first.
        ends = self._ends.setdefault((function, signal), [])
        if ends and not signal.startswith("out"):
            self.findings.error(
                place, f"A second connection into {function}:{signal}.", "Remove one of them."
            )
        elif ends:
            message = (
                f"{function}:{signal} has more than one connection; libcosim makes the first alone."
            )
            self.findings.remark(place, message, "Give each target a function of its own.")
        ends.append((end, place))

    def connections(self) -> Iterator[tuple[tuple[str, str], Connection]]:
        """(output signal, connection) of all functions; a sum has several into one target."""
        for function in self.functions.values():
            for inputs, output in function.rows if function.name not in self._given_up else ():
                # A function needs all its signals.
                missing = [
                    name for name in (*inputs, output) if (function.name, name) not in self._ends
                ]
                if missing:
                    message = f"The {function.kind} '{function.name}' has nothing connected to {', '.join(missing[:5])}."
                    self.findings.error(
                        function.place, message, "Connect every signal of it, or remove it."
                    )
                    continue
                # Each source to each target, with the function's factor and offset.
                sources = [self._ends[function.name, name][0][0] for name in inputs]
                for target, place in self._ends[function.name, output]:
                    for source in sources:
                        connection = Connection(
                            source, target, function.factor, function.offset, place=place
                        )
                        yield (function.name, output), connection
