"""The interface type in which a component runs: co-simulation or model exchange."""

from shipcosim.ssp import Component


def interface_type_of(component: Component) -> str | None:
    """``"CoSimulation"`` or ``"ModelExchange"``; None if the FMU does not offer what is asked for.

    Where the system asks for none it is co-simulation wherever an FMU offers that.
    """
    # Without a wish co-simulation comes first: it needs no solver from us.
    wanted = component.implementation
    types = ("CoSimulation", "ModelExchange") if wanted == "any" else (wanted,)
    return next((name for name in types if name in component.fmu.interfaces), None)


def missing_interface_type(component: Component) -> tuple[str, str]:
    """Problem and remedy where `interface_type_of` finds nothing."""
    wanted = (
        "co-simulation or model exchange"
        if component.implementation == "any"
        else component.implementation
    )
    offered = ", ".join(component.fmu.interfaces) or "nothing"
    message = f"{component.fmu.path.name} offers no {wanted}. It offers {offered}."
    return message, "Export the FMU again in this form, or ask for the one that it has."
