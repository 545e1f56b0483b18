"""What a log could not have shown, by the inner products of what each cause would have done to it."""

import numpy as np
from diagnose import twin

from shipcosim.diagnose.experiment.testability import Excitation, not_testable
from shipcosim.diagnose.hypotheses.catalogue import hypotheses_of, read_catalogue
from shipcosim.diagnose.inference.fitting import Regressor
from shipcosim.diagnose.inference.thresholds import TESTABLE

EVERYONE = {
    hypothesis.label: hypothesis for hypothesis in hypotheses_of(read_catalogue(), twin.model())
}


def test_a_cause_is_testable_if_its_typical_size_would_have_gained_enough():
    """One column of information g: a size of one typical size gains g/2 less Occam's share."""
    places = {"mass": 1, "drag": 2}
    columns = [Regressor({f"vessel.{path}": 1.0}) for path in ("lift", "mass_scale", "drag_scale")]
    products = np.diag([1.0, 5.0, 40.0, 4.0])
    groups = [(EVERYONE[label], [at]) for label, at in places.items()]
    assert 0.5 * 40.0 - 0.5 * np.log(41.0) > TESTABLE > 2.0
    assert not_testable(Excitation(products, columns, groups)) == ("drag",)


def test_a_cause_that_looks_like_a_known_number_is_not_testable():
    columns = [Regressor({"vessel.lift": 1.0}), Regressor({"vessel.mass_scale": 1.0})]
    products = np.diag([1.0, 40.0, 40.0])
    assert not_testable(Excitation(products, columns, [(EVERYONE["mass"], [1])])) == ()
    products[1, 2] = products[2, 1] = 39.9
    assert not_testable(Excitation(products, columns, [(EVERYONE["mass"], [1])])) == ("mass",)
