"""At night: every feature of the standard in the forms that CI leaves out."""

import pytest
from conformance.test_features import FORMED, IN_CI, check_feature


@pytest.mark.parametrize(("name", "form"), [formed for formed in FORMED if formed not in IN_CI])
def test_a_feature_gives_its_closed_form(name, form, tmp_path):
    check_feature(name, form, tmp_path)
