"""A system structure that can be changed and written.

The XML itself is edited, so that everything unchanged stays as it was: annotations of other tools,
geometry, descriptions, files of any kind in the package.
"""

from collections.abc import Iterable

from shipcosim import library
from shipcosim.errors import suggestion
from shipcosim.ssp.edit import bindings, connections, elements
from shipcosim.ssp.edit.connectors import declare
from shipcosim.ssp.edit.system_contents import SystemContents
from shipcosim.ssp.fmu.reader import read_fmu
from shipcosim.ssp.read.structure import KIND_NAMES
from shipcosim.ssp.xml.definitions import read_units
from shipcosim.ssp.xml.document import AnyPath, children
from shipcosim.ssp.xml.values import Value
from shipcosim.units import find_unit


class SystemStructure(SystemContents):
    """A system structure that can be changed; made by `shipcosim.read` and `shipcosim.new`.

    Elements are named with the systems around them (``"ship.vessel"``), connectors and parameters with their element
    (``"ship.vessel.mass"``); what belongs to the outermost system has its name alone. A change that would make the
    system wrong raises a ShipcosimError and leaves it as it was.

    Attributes
    ----------
    parameters : MutableMapping of str to value
        Start values in the FMUs' units, to be read, set and deleted.
    """

    def __repr__(self) -> str:
        counts = f"{len(self.components)} components, {len(self.connections)} connections"
        return f"<SystemStructure {self.name!r}: {counts}>"

    def add_component(
        self,
        name: str,
        fmu: AnyPath,
        *,
        kinds: Iterable[str] = ("input", "output"),
        implementation: str | None = None,
        step_size: float | None = None,
    ) -> None:
        """Add a component with the connectors that its FMU's model description gives, and their units.

        Parameters
        ----------
        name : str
            ``"tow"``, or ``"ship.tow"`` for one in a nested system.
        fmu : path or name
            The FMU. It comes along when the system is written; a run says where the copy is no longer that of its
            source.
        kinds : iterable of str
            Kinds of the variables that get a connector. Parameters need none to be set.
        implementation : str, optional
            ``"CoSimulation"`` or ``"ModelExchange"``, where the FMU offers both.
        step_size : float, optional
            The component's own step, as an OSP annotation. [s]

        Raises
        ------
        ShipcosimError
            If the FMU cannot be read, or the name is taken.
        """
        with self.changes():
            file = library.find("fmu", fmu, "fmu")
            description = read_fmu(file)
            elements.add_component(
                self._draft, name, file, description, tuple(kinds), implementation, step_size
            )

    def add_system(self, name: str) -> None:
        """Add a nested system without content."""
        with self.changes():
            elements.add_element(self._draft, name, "System")

    def add_connector(
        self,
        name: str,
        kind: str,
        *,
        type: str = "Real",
        unit: str | None = None,
        description: str = "",
    ) -> None:
        """Add a connector to the outermost system, or to a nested one (``"ship.speed"``).

        Parameters
        ----------
        name : str
            Of the connector.
        kind : str
            ``"input"``, ``"output"`` or ``"parameter"``.
        type : str
            Real, Integer, Boolean or String.
        unit : str, optional
            Of a Real, in FMI's spelling.
        description : str
            One line.

        Raises
        ------
        ShipcosimError
            If there is no such system or kind, or it has a connector of this name.
        """
        draft = self._draft
        if kind not in KIND_NAMES:
            raise draft.error(name, f"There is no kind '{kind}'.", suggestion(kind, KIND_NAMES))
        with self.changes():
            owner, short = elements.system_for(draft, name)
            defined = find_unit(unit, read_units(children(draft.root, "ssd:Units", "ssc:Unit")))
            declare(owner, short, kind, type, defined, ("", {}), description, draft.root)

    def connect(
        self,
        source: str,
        target: str,
        *,
        factor: float | None = None,
        offset: float | None = None,
        suppress_unit_conversion: bool = False,
    ) -> None:
        """Connect two connectors of one system; undeclared variables of FMUs are declared.

        Parameters
        ----------
        source, target : str
            ``"tow.force_X"``; a connector of the outermost system by its name alone.
        factor, offset : float, optional
            target = factor * source + offset, after the conversion of units.
        suppress_unit_conversion : bool
            Leave the value as it is even if units differ.

        Raises
        ------
        ShipcosimError
            If there is no such connector, the target is connected already, or types or units do not fit.
        """
        linear = {"factor": factor, "offset": offset}
        with self.changes():
            connections.connect(self._draft, source, target, linear, suppress_unit_conversion)

    def disconnect(self, source: str, target: str | None = None) -> None:
        """Remove the connection of two connectors, in either order; without `target` all of one.

        Parameters
        ----------
        source, target : str
            Full names of the connectors.

        Raises
        ------
        ShipcosimError
            If there is none.
        """
        with self.changes():
            connections.disconnect(self._draft, source, target)

    def remove(self, name: str) -> None:
        """Remove an element with its connections and values, or a connector with its connections.

        Raises
        ------
        ShipcosimError
            If there is no such element or connector.
        """
        with self.changes():
            elements.remove(self._draft, name)

    def rename(self, old: str, new: str) -> None:
        """Rename an element or a system's connector; connections and parameter sets follow.

        Parameters
        ----------
        old : str
            Its full name: ``"ship.vessel"``.
        new : str
            Its own new name, without the systems around it: ``"hull"``.

        Raises
        ------
        ShipcosimError
            If there is no such element or connector, or the new name is taken.
        """
        with self.changes():
            elements.rename(self._draft, old, new)

    def set(
        self,
        name: str,
        value: Value,
        unit: str | None = None,
        description: str = "",
        tolerance: float | None = None,
    ) -> None:
        """Give a parameter or input a start value.

        A value that the system sets is changed where it stands; a new one goes to a parameter set of its component.

        Parameters
        ----------
        name : str
            ``"vessel.mass"``.
        value : float, int, bool, str
            In the FMU's unit if `unit` is not given. An enumeration's item by its name or number.
        unit : str, optional
            Unit of `value`, which is converted to the FMU's.
        description : str
            What it is and where the number comes from.
        tolerance : float, optional
            Standard deviation within which it counts as known, in the FMU's unit.

        Raises
        ------
        ShipcosimError
            If there is no such parameter, or the value does not fit.
        """
        with self.changes():
            self.parameters.put(name, value, unit, description, tolerance)

    def bind(self, source: AnyPath, element: str = "", *, prefix: str | None = None) -> None:
        """Bind a parameter set in a file to an element or, without one, to the outermost system; the last one wins.

        Parameters
        ----------
        source : path
            An .ssv: a file of the package (``"resources/thesis.ssv"``) or any other, which comes along.
        element : str
            Full name.
        prefix : str, optional
            Before the names in the set.

        Raises
        ------
        ShipcosimError
            If there is no such file or element, or what is in the set does not fit.
        """
        with self.changes():
            bindings.bind(self._draft, source, element, prefix)

    def unbind(self, source: AnyPath, element: str = "") -> None:
        """Remove the binding of a parameter set in a file from an element.

        Parameters
        ----------
        source : path
            The .ssv, as `bind` was given it.
        element : str
            Full name; empty for the outermost system.

        Raises
        ------
        ShipcosimError
            If it is not bound there.
        """
        with self.changes():
            bindings.unbind(self._draft, source, element)

    def bind_to_components(self) -> None:
        """Give each component one set of all its values, in its FMU's units, for system sets.

        The system stays the same. libcosim takes the first set of each component and no others, and converts no units.
        Values for elements that the system does not have are lost.

        Raises
        ------
        ShipcosimError
            If the system has errors.
        """
        self.checked()
        with self.changes():
            self.parameters.bind_to_components()
