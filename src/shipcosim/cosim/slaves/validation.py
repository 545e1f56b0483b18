"""Check of an FMU's description by FMPy's validator: XML schema, start values, variabilities, units, structure."""

from pathlib import Path

from shipcosim.errors import Problem


def validation_problems(path: Path) -> list[Problem]:
    """What FMPy's validator finds in an FMU, as errors; its binaries are not loaded.

    Parameters
    ----------
    path : Path
        Of the FMU.
    """
    from fmpy.validation import validate_fmu

    found = (" ".join(str(one).split()) for one in validate_fmu(str(path)))
    remedy = "FMI does not allow it; export the FMU anew."
    return [Problem(str(path), text, remedy) for text in dict.fromkeys(found) if text]
