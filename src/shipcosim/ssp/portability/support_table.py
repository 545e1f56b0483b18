"""Table of features that tools which read system files themselves do not support as standardised.

Every entry is what the tool did when tried (libcosimpy 0.0.6, ecospy 0.7.2); tests run them again
and compare. `shipcosim simulate --engine` differs: each engine gets the system as we read it.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from shipcosim.ssp.portability import (
    connection_features,
    osp_features,
    parameter_features,
    structure_features,
)
from shipcosim.ssp.portability.subject import Found, Subject

IGNORED = "goes on without it, and says nothing"
MISREAD = "takes it for something else, and says nothing"
REFUSED = "refuses the system"
CRASHES = "crashes"
TOLD = "has to be told it in the call"
HOSTS = ("libcosim", "ecos")


@dataclass(frozen=True)
class Feature:
    """A feature of a system that a tool does not take as the standard means it.

    Parameters
    ----------
    name, about : str
        Its key, and what it is.
    becomes : mapping of str to str
        By tool: what that does with it. A tool that is not in it does it right.
    remedy : str
        How the system can be written so that it means the same there.
    find : callable
        Places where a Subject has it, each with what is there: (place, what).
    """

    name: str
    about: str
    becomes: Mapping[str, str]
    remedy: str
    find: Callable[[Subject], Found]


def _both(verdict: str) -> dict[str, str]:
    return dict.fromkeys(HOSTS, verdict)


def _libcosim(verdict: str) -> dict[str, str]:
    return {"libcosim": verdict}


def _ecos(verdict: str) -> dict[str, str]:
    return {"ecos": verdict}


BIND = "Bind it to the component: `system.bind_to_components()` does it for all."
FLAT = "`shipcosim export osp` writes the system flat; or leave out the system around."
FEATURES = (
    Feature(
        "prefixes",
        "other namespace prefixes than the standard's own",
        _both(REFUSED),
        "Read and write it with shipcosim, which writes ssd:, ssc:, ssv:.",
        structure_features.prefixes,
    ),
    Feature(
        "version_2", "SSP 2.0", _ecos(REFUSED), 'Write version="1.0".', structure_features.version_2
    ),
    Feature(
        "nested_system",
        "a system in a system",
        _both(REFUSED),
        FLAT,
        structure_features.nested_systems,
    ),
    Feature(
        "other_file",
        "a component that is a system of its own",
        _both(REFUSED),
        FLAT,
        structure_features.other_files,
    ),
    Feature(
        "dictionary",
        "a signal dictionary",
        _both(REFUSED),
        "Connect the components directly.",
        structure_features.dictionaries,
    ),
    Feature(
        "system_connection",
        "a connection with a connector of the outermost system",
        _both(REFUSED),
        "Leave it out; set what it feeds, look at what it shows.",
        structure_features.system_connections,
    ),
    Feature(
        "reversed",
        "a connection written from input to output",
        {"libcosim": REFUSED, "ecos": IGNORED},
        "Exchange its start and its end.",
        connection_features.reversed_links,
    ),
    Feature(
        "undeclared",
        "a connector that only the FMU declares",
        _both(REFUSED),
        "Declare it.",
        connection_features.undeclared_connectors,
    ),
    Feature(
        "typeless",
        "a connector without a type",
        _libcosim(REFUSED),
        "Give it the type of the FMU's variable.",
        connection_features.typeless_connectors,
    ),
    Feature(
        "types_differ",
        "a connection between different types",
        _both(REFUSED),
        "Connect equal types.",
        connection_features.different_types,
    ),
    Feature(
        "connector_2",
        "a connector of a type of SSP 2.0",
        _libcosim(REFUSED),
        "Write Real, Integer, Boolean or String.",
        connection_features.connectors_of_2,
    ),
    Feature(
        "enumeration_connector",
        "a connector that is an enumeration",
        _libcosim(CRASHES),
        "Leave the connector out, or make the variable an Integer.",
        connection_features.enumeration_connectors,
    ),
    Feature(
        "enumeration_connection",
        "a connection of enumerations",
        _both(REFUSED),
        "Make the variables Integers.",
        connection_features.enumeration_connections,
    ),
    Feature(
        "parameter_connection",
        "a connection into a parameter",
        {"libcosim": REFUSED, "ecos": IGNORED},
        "Set the parameter's value in a set.",
        connection_features.parameter_connections,
    ),
    Feature(
        "mapping",
        "a Boolean, integer or enumeration mapping",
        _both(IGNORED),
        "Do it in a component between the two.",
        connection_features.mappings,
    ),
    Feature(
        "linear_without_factor",
        "a linear transformation without a factor",
        _ecos(MISREAD),
        'Write factor="1".',
        connection_features.linear_without_factor,
    ),
    Feature(
        "unit_conversion",
        "a connection that converts units",
        _both(IGNORED),
        "Write the conversion as a LinearTransformation and suppressUnitConversion.",
        connection_features.unit_conversions,
    ),
    Feature(
        "set_on_system",
        "a parameter set bound to a system",
        _both(IGNORED),
        BIND,
        parameter_features.sets_on_systems,
    ),
    Feature(
        "several_sets",
        "a second parameter set on a component",
        _both(IGNORED),
        "Make one set of them: `system.bind_to_components()`.",
        parameter_features.several_sets,
    ),
    Feature(
        "set_names",
        "parameter sets of different names",
        _ecos(IGNORED),
        "Give all sets one name: ecos applies those of the name that it is told.",
        parameter_features.sets_of_other_names,
    ),
    Feature(
        "set_name",
        "a parameter set",
        _ecos(TOLD),
        "Give its name: `init(parameter_set=...)`; without one ecos applies none.",
        parameter_features.set_names,
    ),
    Feature(
        "set_prefix", "a prefix of a binding", _both(IGNORED), BIND, parameter_features.set_prefixes
    ),
    Feature(
        "set_mapping",
        "a parameter mapping (SSM)",
        _both(IGNORED),
        BIND,
        parameter_features.set_mappings,
    ),
    Feature(
        "set_in_fmu",
        "a parameter set inside an FMU",
        _both(REFUSED),
        "Put the file beside the SSD.",
        parameter_features.sets_in_fmus,
    ),
    Feature(
        "set_unit",
        "a value in another unit than the FMU's",
        _both(IGNORED),
        "Give it in the FMU's unit.",
        parameter_features.set_units,
    ),
    Feature(
        "set_enumeration",
        "a value of type Enumeration",
        {"libcosim": CRASHES, "ecos": REFUSED},
        "Leave it to the FMU's start value.",
        parameter_features.set_enumerations,
    ),
    Feature(
        "set_2",
        "a value of a type of SSP 2.0",
        _libcosim(CRASHES),
        "Write Real, Integer, Boolean or String.",
        parameter_features.values_of_2,
    ),
    Feature(
        "set_fmi_1",
        "a value for a parameter of an FMU of FMI 1.0",
        _libcosim(IGNORED),
        "Set it from the program that runs libcosim, or take an FMU of FMI 2.0.",
        parameter_features.values_for_fmi_1,
    ),
    Feature(
        "set_integer",
        "an Integer value for a Real",
        _libcosim(IGNORED),
        "Write it as <ssv:Real>.",
        parameter_features.integers_for_reals,
    ),
    Feature(
        "set_other",
        "a value for a variable that is no parameter or input",
        _libcosim(IGNORED),
        "Make the variable a parameter.",
        parameter_features.values_of_others,
    ),
    Feature(
        "no_osp_step",
        "a step size that only another tool's annotation states",
        _libcosim(CRASHES),
        "State it as osp:FixedStepAlgorithm (`system.step_size = ...`), or give it in the call.",
        structure_features.steps_of_others,
    ),
    Feature(
        "no_step",
        "no step size",
        _libcosim(TOLD),
        "State it (`system.step_size = ...`), or give it in the call: without one libcosim crashes.",
        structure_features.no_steps,
    ),
    Feature(
        "step",
        "a step size",
        _ecos(TOLD),
        "Give it in the call: ecos reads none from the file.",
        structure_features.steps,
    ),
    Feature(
        "osp_annotation",
        "OSP's algorithm with another prefix than osp:, or with the prefix declared on itself",
        _libcosim(REFUSED),
        "Read and write it with shipcosim, which declares osp: on the root.",
        structure_features.osp_annotations,
    ),
    Feature(
        "step_hint",
        "a component's step size in another tool's annotation",
        _both(IGNORED),
        "Write it as osp:StepSizeHint in an annotation of type com.opensimulationplatform.",
        structure_features.hints_of_others,
    ),
    Feature(
        "start_time",
        "a start time other than 0",
        _ecos(IGNORED),
        "Let the system start at 0.",
        structure_features.start_times,
    ),
    Feature(
        "escaped_address",
        "an address with escaped characters",
        _ecos(REFUSED),
        "Rename the file so that nothing has to be escaped.",
        structure_features.escaped_addresses,
    ),
    Feature(
        "fmi_3",
        "an FMU of FMI 3.0",
        _libcosim(REFUSED),
        "Export the FMU as FMI 2.0.",
        structure_features.fmi_3,
    ),
    Feature(
        "model_exchange_1",
        "an FMU of FMI 1.0 that offers no co-simulation",
        _both(REFUSED),
        "Export the FMU for co-simulation.",
        structure_features.without_co_simulation_1,
    ),
    Feature(
        "model_exchange",
        "an FMU that offers no co-simulation",
        {"libcosim": REFUSED, "ecos": CRASHES},
        "Export the FMU for co-simulation.",
        structure_features.without_co_simulation,
    ),
    Feature(
        "form_asked",
        "model exchange asked for of an FMU that offers co-simulation too",
        _both(IGNORED),
        "Take an FMU that offers model exchange alone, or ask for co-simulation: they run that.",
        structure_features.model_exchange_asked,
    ),
    Feature(
        "osp_algorithm",
        "an OspSystemStructure.xml without an algorithm",
        _libcosim(REFUSED),
        "Add <Algorithm>fixedStep</Algorithm>.",
        osp_features.osp_without_algorithm,
    ),
    Feature(
        "osp_second_target",
        "a second connection from the output of a function",
        _libcosim(IGNORED),
        "Give each target a function of its own.",
        osp_features.osp_second_targets,
    ),
    Feature(
        "osp_group_file",
        "variable groups in a file that has not the model's name",
        _libcosim(REFUSED),
        "Call the file MODELNAME_OspModelDescription.xml.",
        osp_features.osp_group_files,
    ),
    Feature(
        "same_guid",
        "two FMUs of one GUID",
        _libcosim(MISREAD),
        "Build one of them anew: libcosim takes the variables of the first for both.",
        structure_features.same_guids,
    ),
)
"""In the order in which a check reports them."""
