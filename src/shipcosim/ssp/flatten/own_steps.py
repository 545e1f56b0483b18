"""Make steps of components multiples of the base step, if the file differs only by rounding."""

from collections.abc import Mapping
from dataclasses import replace
from math import floor

from shipcosim.ssp.flatten.system import Component
from shipcosim.ssp.xml.document import Findings
from shipcosim.units import steps_in

ROUNDED = 1e-3
"""Share of a step by which written numbers may differ from what they stand for: 0.033 stands for a thirtieth."""
EXACT = 1e-9


def with_whole_steps(
    components: Mapping[str, Component],
    base: float | None,
    findings: Findings,
    as_libcosim: bool = False,
) -> dict[str, Component]:
    """Components with own steps as multiples of the base step, where the file is clear.

    Parameters
    ----------
    components : mapping of str to Component
        By name.
    base : float or None
        Step of the system; None if it is unknown. [s]
    findings : Findings
        Takes what is changed.
    as_libcosim : bool
        Whether a step that is no multiple becomes the next smaller one, as in libcosim, instead of staying as it is.
    """
    fitted = {}
    for name, component in components.items():
        step = component.step_size
        # A difference within rounding means the multiple; anything else is left to the check of the
        # plan.
        n = None if step is None or not base else _multiple(steps_in(step, base), as_libcosim)
        if n is not None and step is not None and base and abs(n * base - step) > EXACT * step:
            message = f"Its step of {step:.9g} s is no multiple of the base step of {base:.9g} s"
            findings.flaw(
                name, f"{message}; it takes {n} of them, {n * base:.9g} s.", "Write a multiple."
            )
            component = replace(component, step_size=n * base)
        fitted[name] = component
    return fitted


def _multiple(ratio: float, as_libcosim: bool) -> int | None:
    """Number of base steps that a ratio of steps stands for, or None."""
    nearest = round(ratio)
    if nearest and abs(ratio - nearest) <= ROUNDED * nearest:
        return nearest
    return max(1, floor(ratio)) if as_libcosim else None
