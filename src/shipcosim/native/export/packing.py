"""Pack FMUs without Python, as `shipcosim build --native` does."""

from __future__ import annotations

import hashlib
import itertools
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from shipcosim.errors import error_at
from shipcosim.fmi.export.builder import documentation, fmu_class, write_archive
from shipcosim.fmi.export.description import model_description
from shipcosim.native.export.checking import refuse_other_results
from shipcosim.native.export.functions import understood
from shipcosim.native.export.targets import TARGETS, compiled, own_target
from shipcosim.native.export.text import source_of_model
from shipcosim.native.export.variants import Variant, variant_of
from shipcosim.native.symbols import Untraceable

MOST_FLAGS = 2
"""Flags that belong to the code up to which every combination of them gets a variant."""


def build_native_fmu(
    source: Path | str,
    out: Path | str,
    examples: Sequence[Mapping[str, Any]] = (),
    targets: Sequence[str] = (),
) -> Path:
    """Build an FMU with its model in C, and compare it with the one in Python.

    Parameters
    ----------
    source : Path or str
        Folder of the FMU, or its script.
    out : Path or str
        Folder for ``<name>.fmu``, made if needed.
    examples : sequence of mapping of str to value
        Sets of parameters, as systems have them: texts, and flags and counts that shape the code, can have the values
        that occur in them, or the FMU's own start values.
    targets : sequence of str
        Keys of `TARGETS`; the own platform without.

    Returns
    -------
    Path
        The FMU.

    Raises
    ------
    Untraceable
        It cannot be written in C, or does not give what Python gives; the text says why, and where.
    ShipcosimError
        There is no such FMU, it is wrong by itself, the compiler fails, or the file cannot be written.
    """
    with fmu_class(source) as (cls, script, bundled):
        # Record all variants and write the C text while the FMU's modules accept symbols.
        words = sys.modules[f"{bundled.package}.shipcosim.fmi.failures"].text_of
        with understood(bundled.package):
            recorded = list(_variants(cls, examples))
            variants = [variant for variant, _ in recorded]
            values = [given for _, given in recorded]
            text = source_of_model(cls, script.stem, variants, words)
        try:
            # The GUID is the hash of description and text without a GUID: the same model gives the
            # same GUID. It then goes into both.
            blank = _description(cls, script.stem, "")
            guid = f"{{{hashlib.sha256(blank + text.encode()).hexdigest()[:32]}}}"
            files = {"modelDescription.xml": _description(cls, script.stem, guid)} | documentation(
                script
            )
        except ValueError as error:
            raise error_at(f"{script}, class {cls.__name__}", str(error)) from None
        text = text.replace('#define GUID ""', f'#define GUID "{guid}"')
        # Compare on this machine before anything is written. Other targets have the same source.
        own_binary = compiled(text, own_target())
        refuse_other_results(cls, own_binary, guid, values)
    files["sources/all.c"] = text.encode()
    for name in targets or [own_target()]:
        path = f"binaries/{TARGETS[name].folder}/{script.stem}{TARGETS[name].suffix}"
        files[path] = own_binary if name == own_target() else compiled(text, name)
    return write_archive(Path(out) / f"{script.stem}.fmu", files)


def _variants(
    cls: Any, examples: Sequence[Mapping[str, Any]]
) -> Iterator[tuple[Variant, dict[str, Any]]]:
    """Variants for the examples and the FMU's own start values, each with its parameters.

    The first one that cannot be recorded ends it; of the flags' other values those that can be recorded are taken.
    """
    seen: list[dict[str, Any]] = []
    given = [dict(example) for example in examples] or [{}]
    # The start values are one more example, unless a parameter has none and must be set.
    if examples and not any(v.required for v in cls.variables):
        given.append({})
    for number, values in enumerate(given):
        if values in given[:number]:
            # Systems often repeat a set of parameters.
            continue
        variant = variant_of(cls, values, cls.default_step_size)
        yield variant, values
        seen.append(variant.fixed)
        flags = [v.name for v in cls.variables if v.type == "Boolean" and v.name in variant.fixed]
        # A user may toggle a flag that no example does. Few flags: every combination gets a
        # variant. Many would multiply the code.
        for chosen in (
            itertools.product([False, True], repeat=len(flags)) if len(flags) <= MOST_FLAGS else ()
        ):
            flagged = dict(zip(flags, chosen, strict=True))
            if variant.fixed | flagged in seen:
                continue
            # Note it before recording: a combination that fails is not tried again.
            seen.append(variant.fixed | flagged)
            try:
                yield variant_of(cls, values | flagged, cls.default_step_size), values | flagged
            except Untraceable:
                continue


def _description(cls, identifier, guid) -> bytes:
    """The description of the Python FMU, with the entries that differ for a C binary."""
    root = ElementTree.fromstring(model_description(cls, identifier, guid))
    binary = root.find("CoSimulation")
    assert binary is not None
    binary.set("needsExecutionTool", "false")
    files = ElementTree.SubElement(binary, "SourceFiles")
    ElementTree.SubElement(files, "File", name="all.c")
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"
