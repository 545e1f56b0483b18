"""Which of the forms that an FMU offers a component runs in."""

from shipcosim.ssp import Component


def form_of(component: Component) -> str | None:
    """``"CoSimulation"`` or ``"ModelExchange"``; None where the FMU offers neither or not the one that is asked for.

    Without a wish it is co-simulation wherever an FMU offers that.
    """
    wanted = component.implementation
    forms = ("CoSimulation", "ModelExchange") if wanted == "any" else (wanted,)
    return next((form for form in forms if form in component.fmu.interfaces), None)


def lacks_form(component: Component) -> tuple[str, str]:
    """What is found and what would be right where `form_of` finds nothing."""
    wanted = "co-simulation or model exchange" if component.implementation == "any" else component.implementation
    offered = ", ".join(component.fmu.interfaces) or "nothing"
    found = f"{component.fmu.path.name} offers no {wanted}. It offers {offered}."
    return found, "Export the FMU again in this form, or ask for the one that it has."
