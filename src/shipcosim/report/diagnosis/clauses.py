"""Texts of cause files, filled with the estimates of a finding."""

from collections.abc import Mapping

from shipcosim.diagnose.finding import ParameterEstimate
from shipcosim.report.diagnosis.estimates import plus_minus, shown_unit, vector


def filled(
    text: str, parameters: Mapping[str, ParameterEstimate], component: str | None = None
) -> str:
    """Fill the placeholders of a text with estimates of a cause's parameters.

    Parameters
    ----------
    text : str
        ``{lag}`` is a value with its standard deviation and unit, ``{loss:percent}`` a share in percent, and
        ``{loss:percent less|more}`` its size with the first word where it is positive, else with the second.
        ``{offset:signed too much|too little}`` is the size, then the first words if it is positive, else the second;
        ``{x:given}`` is followed by what the system says, ``(the file says 14.5 m)``;
        ``{scale:excess larger|smaller}`` in percent, how far a factor is above or below 1, with such words.
        ``{north+east}`` is size and direction of a vector, ``{component}`` the thruster.
    parameters : dict of str to Estimate
    component : str, optional

    Returns
    -------
    str

    Raises
    ------
    KeyError
        A parameter that is not there.

    Examples
    --------
    >>> filled("the {component} thruster loses {loss:percent}", {"loss": ParameterEstimate(0.337, 0.012, "1")}, "port")
    'the port thruster loses 34 ± 1 %'
    >>> filled("the ship is {scale:excess heavier|lighter}", {"scale": ParameterEstimate(0.9, 0.02, "1")})
    'the ship is 10 ± 2 % lighter'
    """
    return text.format_map(_Values(parameters, component))


class _Values(dict):
    """Values of the placeholders in a text."""

    def __init__(self, parameters: Mapping[str, ParameterEstimate], component: str | None) -> None:
        super().__init__(
            {name: _Value(estimate) for name, estimate in parameters.items()}, component=component
        )

    def __missing__(self, key: str) -> str:
        # north+east means the vector of two parameters.
        first, plus, second = key.partition("+")
        if not plus:
            raise KeyError(key)
        return vector(self[first].estimate, self[second].estimate)


class _Value:
    """An estimate in a text, in the format of the placeholder."""

    def __init__(self, estimate: ParameterEstimate) -> None:
        self.estimate = estimate

    def __format__(self, wanted: str) -> str:
        # Form and words of the placeholder; the sign chooses between the words.
        form, _, words = wanted.partition(" ")
        above, _, below = words.partition("|")
        value = self.estimate.estimate
        std = self.estimate.std
        if form == "percent":
            return (
                f"{_percent(abs(value), std)} {above if value > 0 else below}"
                if words
                else _percent(value, std)
            )
        if form == "excess":
            return f"{_percent(abs(value - 1), std)} {above if value > 1 else below}"
        if form == "given" and self.estimate.given is not None:
            unit, factor = shown_unit(self.estimate.unit, abs(value))
            return f"{plus_minus(self.estimate)} (the file says {factor * self.estimate.given:.6g} {unit})"
        if form == "signed":
            return f"{plus_minus(self.estimate, absolute=True)} {above if value > 0 else below}"
        return plus_minus(self.estimate)


def _percent(value: float, std: float) -> str:
    return f"{100 * value:.0f} ± {max(100 * std, 0.5):.0f} %"
