"""Parameter sets that an SSD binds, changed in place: inline, or in files of the package."""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple
from urllib.parse import unquote, urlsplit

import lxml.etree as etree

from shipcosim.ssp.edit.names import walk
from shipcosim.ssp.read.package import Package
from shipcosim.ssp.read.parameters import TOLERANCE, ParameterValue
from shipcosim.ssp.xml.definitions import define_unit
from shipcosim.ssp.xml.document import (
    Document,
    Findings,
    child,
    children,
    parent_of,
    parts_in,
    read_document,
)
from shipcosim.ssp.xml.markup import add, drop, ensure, put
from shipcosim.ssp.xml.values import KINDS, text_of


@dataclass(frozen=True)
class Bound:
    """A parameter set where it is bound.

    Parameters
    ----------
    owner : str
        Full name of the element that it is bound to; empty for the outermost system.
    binding : lxml element
        The ParameterBinding.
    root : lxml element
        The ParameterSet.
    file : Path or None
        Its file in the package; None for an inline set.
    shared : bool
        Whether it is bound more than once, so that a change would reach further than it should.
    """

    owner: str
    binding: etree._Element
    root: etree._Element
    file: Path | None
    shared: bool

    @property
    def prefix(self) -> str:
        """Start of the full names of its parameters."""
        return (f"{self.owner}." if self.owner else "") + self.binding.get("prefix", "")

    @property
    def mapped(self) -> bool:
        """Whether a parameter mapping renames its parameters."""
        return child(self.binding, "ssd:ParameterMapping") is not None

    def parameter(self, name: str) -> etree._Element | None:
        """Parameter element by its full name, or None."""
        if self.mapped or not name.startswith(self.prefix):
            return None
        listed = children(self.root, "ssv:Parameters", "ssv:Parameter")
        return next((part for part in listed if part.get("name") == name[len(self.prefix) :]), None)


class Sets:
    """Parameter sets of an SSD, weakest first: of inner elements, then of systems around them.

    Parameters
    ----------
    package : Package
        Its `held` takes the files that are changed.
    document : Document
        The SSD.
    """

    def __init__(self, package: Package, document: Document):
        self.package = package
        self.document = document
        # Bindings of all elements; a file bound twice must not be changed for one element only.
        system = child(document.root, "ssd:System")
        self.elements = {} if system is None else dict(walk(system))
        bindings = [
            (name, part)
            for name, element in self.elements.items()
            for part in children(element, "ssd:ParameterBindings", "ssd:ParameterBinding")
        ]
        counts = Counter(self._file(part) for _, part in bindings)
        bound = [self._bound(name, part, counts) for name, part in bindings]
        # Outer systems override inner ones: sort by depth, innermost first.
        depths = {
            name: sum(1 for _ in element.iterancestors()) for name, element in self.elements.items()
        }
        self.bound = sorted(
            (bound_set for bound_set in bound if bound_set is not None),
            key=lambda bound_set: -depths[bound_set.owner],
        )

    def _file(self, binding: etree._Element) -> Path | None:
        """File in the package that a binding or mapping names, or None."""
        source = binding.get("source")
        if not source or binding.get("sourceBase") == "component":
            return None
        return (self.document.folder / unquote(urlsplit(source).path)).resolve()

    def _bound(
        self, owner: str, binding: etree._Element, counts: Mapping[Path | None, int]
    ) -> Bound | None:
        # The set is in a file, or inline in the binding.
        file = self._file(binding)
        inline = child(binding, "ssd:ParameterValues")
        root = (
            self._root(file)
            if file
            else None
            if inline is None
            else child(inline, "ssv:ParameterSet")
        )
        return (
            None
            if root is None
            else Bound(owner, binding, root, file, counts[file] > 1 and file is not None)
        )

    def _root(self, file: Path) -> etree._Element | None:
        held = self.package.held.get(file, file)
        if isinstance(held, Path):
            held = read_document(held, self.package.show(file), Findings())
        return None if held is None else held.root

    def keep(self, file: Path | None, root: etree._Element) -> None:
        """Keep a changed file for writing; nothing to do for an inline set."""
        held = self.package.held.get(file) if file is not None else None
        if file is not None and not (isinstance(held, Document) and held.root is root):
            self.package.held[file] = Document(self.package.show(file), root, file.parent)

    def put(self, name: str, value: ParameterValue) -> None:
        """Set a parameter's value in the set that has it, else in a set of its element.

        Parameters
        ----------
        name : str
            Full name.
        value : ParameterValue
            Its own name is not looked at.
        """
        # The strongest set with this parameter, unless it is shared.
        places = [bound for bound in self.bound if bound.parameter(name) is not None]
        if places and not places[-1].shared:
            write_value(places[-1].root, places[-1].parameter(name), value)
            self.keep(places[-1].file, places[-1].root)
            return
        # Else a set of the same element, where its names fit.
        owner = places[-1].owner if places else self._owner(name)
        of_owner = [bound for bound in self.bound if bound.owner == owner]
        fits = (
            of_owner
            and not places
            and not of_owner[0].shared
            and not of_owner[0].mapped
            and name.startswith(of_owner[0].prefix)
        )
        if fits:
            self._add(of_owner[0].root, name[len(of_owner[0].prefix) :], value)
            self.keep(of_owner[0].file, of_owner[0].root)
        else:
            # Else a new set, bound after all others.
            self.append(owner, name, value)

    def append(self, owner: str, name: str, value: ParameterValue) -> None:
        """Set a parameter's value in a new set, bound to an element after all others.

        Parameters
        ----------
        owner : str
            Full name of the element.
        name : str
            Full name of the parameter.
        value : ParameterValue
            Its own name is not looked at.
        """
        element = self.elements[owner]
        binding = add(ensure(element, "ssd:ParameterBindings"), "ssd:ParameterBinding")
        title = owner or self.document.root.get("name") or "values"
        root = add(
            ensure(binding, "ssd:ParameterValues"), "ssv:ParameterSet", version="1.0", name=title
        )
        ensure(root, "ssv:Parameters")
        self._add(root, name.removeprefix(f"{owner}.") if owner else name, value)

    def _add(self, root: etree._Element, name: str, value: ParameterValue) -> None:
        parameter = add(ensure(root, "ssv:Parameters"), "ssv:Parameter", name=name)
        write_value(root, parameter, value)

    def _owner(self, name: str) -> str:
        """Innermost element of this SSD with which a parameter's full name begins."""
        return max(
            (owner for owner in self.elements if not owner or name.startswith(f"{owner}.")), key=len
        )

    def clear(self, name: str) -> bool:
        """Remove a parameter from all sets; False if no set or only a shared one has it."""
        places = [bound for bound in self.bound if bound.parameter(name) is not None]
        for place in places:
            if place.shared:
                return False
            remove_parameter(place.parameter(name))
            self.keep(place.file, place.root)
        return bool(places)

    def rename(self, old: str, new: str | None, *, exact: bool = False) -> None:
        """Rename or remove (new name None) an element or connector in all surrounding sets.

        Parameters
        ----------
        old, new : str
            Of an element, whose parameters' names begin with it, or (`exact`) of a system's connector.
        """
        # Only sets around the element know its name, relative to their owner.
        for bound in self.bound:
            if bound.owner and not old.startswith(f"{bound.owner}."):
                continue
            owner = f"{bound.owner}."
            names = _Names(old.removeprefix(owner), new and new.removeprefix(owner), exact)
            # A mapping has the name in its targets, a prefix in
            # itself, all others in each parameter.
            mapping = child(bound.binding, "ssd:ParameterMapping")
            if mapping is not None:
                self._rename_targets(mapping, names)
            elif bound.binding.get("prefix"):
                names.follow(bound.binding, "prefix", drop)
            elif not bound.shared:
                listed = children(bound.root, "ssv:Parameters", "ssv:Parameter")
                # All names follow, also after one that has changed.
                changed = [names.follow(part, "name", remove_parameter) for part in listed]
                if any(changed):
                    self.keep(bound.file, bound.root)

    def _rename_targets(self, mapping: etree._Element, names: "_Names") -> None:
        file = self._file(mapping)
        root = self._root(file) if file else child(mapping, "ssm:ParameterMapping")
        if root is None:
            return
        entries = children(root, "ssm:MappingEntry")
        changed = [names.follow(part, "target", root.remove) for part in entries]
        if any(changed):
            self.keep(file, root)


class _Names(NamedTuple):
    """An old and a new name, as one parameter set sees them."""

    old: str
    new: str | None
    exact: bool

    def follow(
        self, element: etree._Element, attribute: str, remove: Callable[[etree._Element], None]
    ) -> bool:
        """Change an attribute that has the old name; return whether it did."""
        text = element.get(attribute, "")
        if text != self.old if self.exact else not text.startswith(f"{self.old}."):
            return False
        if self.new is None:
            remove(element)
        else:
            element.set(attribute, self.new + text.removeprefix(self.old))
        return True


def remove_parameter(parameter: etree._Element) -> None:
    """Remove a Parameter from its set, which may then be empty."""
    parent_of(parameter).remove(parameter)


def write_value(root: etree._Element, parameter: etree._Element, value: ParameterValue) -> None:
    """Write a value into a Parameter element; its description and tolerance replace the old ones.

    Parameters
    ----------
    root : lxml element
        The ParameterSet, which gets the unit's definition.
    parameter : lxml element
        In it.
    value : ParameterValue
        What to write.
    """
    # Replace the typed value, and define its unit in the set.
    for part in parts_in(parameter, *KINDS):
        parameter.remove(part)
    typed = add(parameter, f"ssv:{value.kind}", value=text_of(value.value))
    if value.unit is not None and define_unit(root, "ssv:Units", value.unit):
        typed.set("unit", value.unit.name)
    # Description and tolerance belong to the new value.
    parameter.attrib.pop("description", None)
    if value.description:
        parameter.set("description", value.description)
    for annotation in children(parameter, "ssv:Annotations", "ssc:Annotation"):
        if annotation.get("type") == TOLERANCE:
            drop(annotation)
    if value.tolerance is not None:
        annotation = add(ensure(parameter, "ssv:Annotations"), "ssc:Annotation", type=TOLERANCE)
        put(annotation, annotation.makeelement("tolerance", value=repr(float(value.tolerance))))
