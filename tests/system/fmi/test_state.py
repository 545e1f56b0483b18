import pickle
from collections import deque
from typing import NamedTuple

import numpy as np
import pytest

from shipcosim.fmi import state

PACKAGES = {__name__.partition(".")[0]}


class Own(NamedTuple):
    value: float


class Call:
    """Unpickled, this would call a function."""

    def __init__(self, function, *arguments):
        self.function, self.arguments = function, arguments

    def __reduce__(self):
        return self.function, self.arguments


def there_and_back(content):
    return state.from_bytes(state.to_bytes(content, "label", PACKAGES), "label", PACKAGES)


def test_plain_data_arrays_and_own_classes_come_back():
    content = {
        "a": (1, 2.5, True, None, b"x", 1j),
        "b": {1, 2},
        "c": deque([1], maxlen=3),
        "d": Own(1.5),
    }
    assert there_and_back(content) == content
    array = there_and_back(np.arange(6.0).reshape(2, 3)[:, ::2])
    assert np.array_equal(array, [[0, 2], [3, 5]]) and array.dtype == float
    assert there_and_back(np.float32(0.5)) == np.float32(0.5)


@pytest.mark.parametrize("kind", ["PCG64", "PCG64DXSM", "Philox", "SFC64", "MT19937"])
def test_generators_go_on_with_the_same_numbers(kind):
    generator = np.random.Generator(getattr(np.random, kind)(7))
    generator.normal(size=3)
    copy = there_and_back(generator)
    assert np.array_equal(copy.normal(size=5), generator.normal(size=5))


@pytest.mark.parametrize("function", [print, eval, np.load, pickle.loads, np.testing.assert_equal])
def test_bytes_that_would_call_a_function_are_refused(function):
    with pytest.raises(pickle.UnpicklingError, match="refused"):
        state.from_bytes(b"label\n" + pickle.dumps(Call(function, "1")), "label", PACKAGES)


def test_a_function_of_the_own_package_is_refused_too():
    with pytest.raises(pickle.UnpicklingError, match="refused"):
        state.from_bytes(b"label\n" + pickle.dumps(Call(there_and_back, 1)), "label", PACKAGES)


def test_what_could_not_be_restored_is_not_stored():
    with pytest.raises(pickle.UnpicklingError, match="refused"):
        state.to_bytes(print, "label", PACKAGES)


def test_the_state_of_other_code_is_refused():
    with pytest.raises(pickle.UnpicklingError, match="'label'"):
        state.from_bytes(state.to_bytes(1, "label", PACKAGES), "other", PACKAGES)
