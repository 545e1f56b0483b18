"""Difference in form between the ship's loads and the model's, in words."""

from dataclasses import dataclass

from shipcosim.diagnose.explanation.summary import FormNumber, LoadForm
from shipcosim.errors import capitalised
from shipcosim.report.theme.numbers import percent, plain
from shipcosim.report.theme.views import Table

SCALES = {0.5: "half as much as", 1.0: "about as much as", 2.0: "about twice as much as"}


@dataclass(frozen=True)
class FormSection:
    """How far the loads differ in form: in a sentence, by function, and by the numbers that clearly differ."""

    sentence: str
    functions: Table
    numbers: Table


def form_section(form: LoadForm) -> FormSection:
    """The part on the form of loads for the template."""
    head = ("Number", "In the model", "As logged", "Std", "Unit")
    numbers = Table([_row(number) for number in form.numbers], head)
    if not form.differs:
        return FormSection("Numbers of the ship lie beyond their tolerances.", Table(()), numbers)
    # How unusual the difference is, compared with other ships.
    scale = SCALES.get(form.scale, f"{form.scale:g} times")
    functions = tuple((capitalised(name), percent(size)) for name, size in form.differs.items())
    return FormSection(
        f"Over place, angle and speed the loads on this ship have another shape than the model's. They differ {scale} "
        "ships usually do from their models. Causes were sought beside that.",
        Table(functions, head=("Load", "Differs from the model's by about")),
        numbers,
    )


def _row(number: FormNumber) -> tuple[str, str, str, str, str]:
    # A thruster's number has the thruster's name in front.
    thruster, of_form, _ = number.number.rpartition(".form.")
    what = f"{thruster}: {number.what}" if of_form else number.what or number.number
    unit = "" if number.unit == "1" else number.unit
    return (
        capitalised(what),
        plain(number.model),
        plain(number.estimate),
        f"± {plain(number.std, 2)}",
        unit,
    )
