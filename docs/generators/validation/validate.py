"""Make docs/generated/validation.md and its pictures: every number in it comes from here.

    .venv/bin/python docs/generators/validation/validate.py

takes about three minutes. It needs the reference data in ../shared, which is not part of the project, and matplotlib.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
PAGE = HERE.parents[1] / "generated" / "validation.md"
SHARED = HERE.parents[3] / "shared"
QUICK = ("turn", "trials", "units", "loads")
"""Sections that take seconds."""
SLOW = ("thesis", "steps")
"""Sections that take minutes: co-simulations."""


def numbers(shared, names=QUICK + SLOW, progress=lambda name: None):
    """Numbers of sections.

    Parameters
    ----------
    shared : Path
        The reference data.
    names : iterable of str
        Sections, of `QUICK` and `SLOW`.
    progress : callable
        Called with the name of each section before it is computed.

    Returns
    -------
    dict of dict
        By section and name, as the template calls them.
    """
    import corners
    import loads
    import short_turn
    import thruster_units
    import trials

    sections = {
        "turn": lambda: short_turn.validate(shared),
        "trials": lambda: trials.validate(shared),
        "units": lambda: thruster_units.validate(shared),
        "loads": lambda: loads.validate(shared),
        "thesis": corners.validate_thesis,
        "steps": corners.validate_steps,
    }
    found = {}
    for name in names:
        progress(name)
        found[name] = sections[name]()
    return found


def template():
    """Text with the places of the numbers, in the form of `str.format`, as the page in docs/generated has it."""
    from common import from_generated

    return from_generated((HERE / "template.md").read_text(encoding="utf-8"))


def unmet():
    """What keeps the command from running: one readable line, or None."""
    if not SHARED.is_dir():
        return "There is no folder 'shared' beside the project. The validation needs its reference data and cannot run."
    try:
        import matplotlib  # noqa: F401 - only asked for
    except ImportError:
        return "matplotlib is missing, which draws the pictures. Install it: .venv/bin/pip install -e '.[docs]'"
    return None


def main():
    """Write the page; exit code 2 if something is missing."""
    if complaint := unmet():
        print(complaint, file=sys.stderr)
        return 2
    found = numbers(SHARED, progress=lambda name: print(f"{name} ...", flush=True))
    PAGE.write_text(template().format_map(found), encoding="utf-8")
    print("docs/generated/validation.md and docs/generated/pictures/ are written.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
