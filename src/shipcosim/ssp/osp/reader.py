"""Reader of OspSystemStructure.xml, the configuration file of the Open Simulation Platform.

The result is a system ready to run. Elements mean what libcosim (tried: libcosimpy 0.0.6) takes
them for, where known.
"""

from collections.abc import Iterable
from math import isfinite
from pathlib import Path

from shipcosim.ssp.flatten.array_sizes import resized, sizes_wanted
from shipcosim.ssp.flatten.assemble import components_of, parameter_sets
from shipcosim.ssp.flatten.bindings import apply_set
from shipcosim.ssp.flatten.hierarchy import Hierarchy, Swapped
from shipcosim.ssp.flatten.own_steps import with_whole_steps
from shipcosim.ssp.flatten.start_values import Settings
from shipcosim.ssp.flatten.swapped import take_swapped
from shipcosim.ssp.flatten.system import System, alias_remarks
from shipcosim.ssp.osp.connections import ConnectionReader
from shipcosim.ssp.osp.functions import Function, read_function
from shipcosim.ssp.osp.mend import mend_osp
from shipcosim.ssp.osp.schema import NAMESPACE, validate_osp
from shipcosim.ssp.osp.simulators import Simulators
from shipcosim.ssp.osp.times import read_experiment
from shipcosim.ssp.read.package import OSP_STRUCTURE, SYSTEM_STRUCTURE
from shipcosim.ssp.read.parameters import ParameterSet, ParameterSets
from shipcosim.ssp.xml.document import AnyPath, Document, Findings, local, parts_of, read_document


def osp_file(path: AnyPath) -> Path | None:
    """OspSystemStructure.xml of a path: the file, or that in a folder without an SSD; or None."""
    path = Path(path)
    if path.is_dir() and not (path / SYSTEM_STRUCTURE).is_file():
        path = path / OSP_STRUCTURE
    return path if path.suffix.lower() == ".xml" and path.is_file() else None


def assemble_osp(
    path: Path,
    parameters: ParameterSets,
    fmus: Iterable[AnyPath],
    findings: Findings,
    swapped: Swapped = None,
) -> System | None:
    """System of an OspSystemStructure.xml.

    Parameters
    ----------
    path : Path
        The file.
    parameters : path or ParameterSet, or iterable of them
        Applied over its initial values.
    fmus : iterable of path
        Folders searched for FMUs that are not where it says.
    findings : Findings
        Takes what is wrong.
    swapped : mapping of str to Path, optional
        FMUs that simulators run in place of their own.

    Returns
    -------
    System, None or incomplete where there are errors
    """
    # Flaws and schema first: later steps rely on both.
    document = read_document(path, str(path), findings)
    if document is not None:
        mend_osp(document, findings)
    if document is None or not _is_osp(document, findings):
        return None
    before = len(findings.errors)
    validate_osp(document, findings)
    if len(findings.errors) > before:
        return None
    # Read the system once to learn which array sizes it sets.
    before = list(findings.problems)
    sets = list(parameter_sets(parameters, findings))
    folders = [Path(folder) for folder in fmus]
    system = _system(document, folders, sets, Hierarchy(findings, swapped=swapped))
    # If sizes differ from the FMU's, read again with the arrays in these sizes.
    if any(problem for component in system.components.values() for problem in resized(component)):
        findings.problems[:] = before
        tree = Hierarchy(findings, sizes=sizes_wanted(system.components), swapped=swapped)
        system = _system(document, folders, sets, tree)
    return system


def _is_osp(document: Document, findings: Findings) -> bool:
    if document.root.tag == f"{{{NAMESPACE}}}OspSystemStructure":
        return True
    message = f"Its outermost element is <{local(document.root)}> of '{document.root.tag.partition('}')[0].lstrip('{')}'."
    findings.error(
        document.place(document.root),
        message,
        f'Right would be <OspSystemStructure xmlns="{NAMESPACE}">.',
    )
    return False


def _system(
    document: Document, folders: list[Path], sets: Iterable[ParameterSet], tree: Hierarchy
) -> System:
    """System of a document that conforms to the schema."""
    # Simulators first: functions and connections refer to them.
    findings = tree.findings
    simulators = Simulators(document, folders, tree, findings)
    for element in parts_of(document.root, "Simulators"):
        simulators.take(element)
    functions = _functions(document, simulators.names, findings)
    connections = ConnectionReader(document, simulators, functions, findings).read(
        parts_of(document.root, "Connections")
    )
    # Exchanged FMUs, then parameter sets over the initial values.
    take_swapped(tree)
    for values in sets:
        apply_set(tree, values)
    settings = Settings(tree, findings)
    settings.apply()
    # Step sizes: each component's own step is a multiple of the base step in libcosim.
    experiment = read_experiment(document, findings)
    components = with_whole_steps(
        components_of(tree, settings), experiment.step_size, findings, as_libcosim=True
    )
    findings.problems += alias_remarks(components, connections)
    return System(
        name=Path(document.file).resolve().parent.name,
        file=document.file,
        components=components,
        connections=tuple(connections),
        experiment=experiment,
        swapped={name: str(file) for name, file in tree.swapped.items()},
        remarks=tuple(dict.fromkeys(findings.remarks)),
    )


def _functions(
    document: Document, simulators: Iterable[str], findings: Findings
) -> dict[str, Function]:
    """Functions by name; faulty ones are left out, with an error."""
    functions = {}
    for element in parts_of(document.root, "Functions"):
        name = element.get("name")
        place = document.place(element, name)
        # Names are shared by functions and simulators.
        if name in functions or name in simulators:
            findings.error(
                place, f"'{name}' is the name of something else already.", "Names must differ."
            )
        elif not all(isfinite(float(element.get(part, 0.0))) for part in ("factor", "offset")):
            findings.error(place, "Its factor or offset is no finite number.")
        elif (function := read_function(element, place, findings)) is not None:
            functions[name] = function
    return functions
