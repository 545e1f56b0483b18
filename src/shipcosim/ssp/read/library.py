"""What a tree reads: each file, set and description once, however often a system uses it; its faults are noted once."""

from shipcosim.ssp.fmu.description import describe_fmu
from shipcosim.ssp.read.package import open_package, read_in_component
from shipcosim.ssp.read.parameters import read_dictionary, read_mapping, read_parameter_set
from shipcosim.ssp.read.structure import read_structure


class Library:
    """Reads and keeps.

    Parameters
    ----------
    findings : Findings
        Takes what is wrong.
    described : dict, optional
        Keeps descriptions of FMUs without fault for other trees.

    Attributes
    ----------
    packages : list of Package
        Opened on the way.
    """

    def __init__(self, findings, described=None):
        self.findings, self.packages = findings, []
        self._described = {} if described is None else described
        self._kept = {}

    def _once(self, key, make):
        if key not in self._kept:
            self._kept[key] = make()
        return self._kept[key]

    def file(self, owner, uri, place):
        """File that an element's address means, or None; `owner`, which has a place, stays as long as the tree."""
        at = "at", place.package.folder, place.folder, uri
        if self._kept.get(at) is None:  # what is missing is said of each owner, once
            self._kept[at] = self._once((id(owner), uri), lambda: self._located(owner, uri, place))
        return self._kept[at]

    def _located(self, owner, uri, place):
        return place.package.locate(uri, place.folder, owner.place, self.findings)

    def package(self, address, fmus, shown):
        """Package at an address, or None."""
        return self._once(("package", address), lambda: self._opened(address, fmus, shown))

    def _opened(self, address, fmus, shown):
        package = open_package(address, self.findings, fmus, shown)
        self.packages += [] if package is None else [package]
        return package

    def structure(self, package, file):
        """Structure of an SSD, or None."""
        return self._once(("structure", file), lambda: self._structure(package, file))

    def _structure(self, package, file):
        document = package.read(file, self.findings)
        return None if document is None else read_structure(document, self.findings)

    def content(self, source, place, fmu=None):
        """Document that a source means, inline or in a file, or None."""
        if source.inline is not None or source.uri is None:
            return source.inline
        if source.in_component:
            return None if fmu is None else self._once((fmu.path, source.uri), lambda: self._inside(fmu, source))
        file = self.file(source, source.uri, place)
        return None if file is None else self._once(("file", file), lambda: place.package.read(file, self.findings))

    def _inside(self, fmu, source):
        return read_in_component(fmu, source.uri, source.place, self.findings)

    def parameter_set(self, document):
        """Parameter set of a document."""
        return self._once(("set", id(document.root)), lambda: read_parameter_set(document, self.findings))

    def mapping(self, document):
        """Entries of a parameter mapping."""
        return self._once(("mapping", id(document.root)), lambda: read_mapping(document, self.findings))

    def dictionary(self, document):
        """Entries of a signal dictionary by name."""
        return self._once(("dictionary", id(document.root)), lambda: read_dictionary(document, self.findings))

    def fmu(self, file, package):
        """Description of an FMU, or None."""
        return self._once(("fmu", file), lambda: self._description(file, package))

    def _description(self, file, package):
        key = file, file.stat().st_mtime_ns
        if key not in self._described:
            before = len(self.findings.problems)
            fmu = describe_fmu(file, self.findings, package.show(file))
            if len(self.findings.problems) > before:
                return fmu  # not kept: the next tree has to hear of its faults too
            self._described[key] = fmu
        return self._described[key]
