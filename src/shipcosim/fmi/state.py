"""State of an FMU as bytes, which another process can restore without trusting the sender."""

import io
import pickle
from collections.abc import Set
from typing import Any

NUMPY = {
    "numpy": {"ndarray", "dtype"},
    "numpy.core.multiarray": {"_reconstruct", "scalar"},
    "numpy._core.multiarray": {"_reconstruct", "scalar"},
    "numpy.core.numeric": {"_frombuffer"},
    "numpy._core.numeric": {"_frombuffer"},
    "numpy.random._pickle": {"__generator_ctor", "__bit_generator_ctor"},
    "numpy.random._pcg64": {"PCG64", "PCG64DXSM"},
    "numpy.random._philox": {"Philox"},
    "numpy.random._sfc64": {"SFC64"},
    "numpy.random._mt19937": {"MT19937"},
    "numpy.random.bit_generator": {"SeedSequence", "__pyx_unpickle_SeedSequence"},
}
PLAIN = {
    "builtins": {
        "complex",
        "range",
        "slice",
        "bytearray",
        "set",
        "frozenset",
        "list",
        "dict",
        "int",
        "float",
    },
    "collections": {"deque", "OrderedDict", "defaultdict", "Counter"},
}


class _Unpickler(pickle.Unpickler):
    """Unpickles plain data, NumPy arrays and generators, and classes of the FMU; nothing else."""

    def __init__(self, data: bytes, packages: Set[str]):
        super().__init__(io.BytesIO(data))
        self.packages = packages

    def find_class(self, module: str, name: str) -> Any:
        # NumPy and plain containers are harmless.
        if name in NUMPY.get(module, ()) or name in PLAIN.get(module, ()):
            return super().find_class(module, name)
        # Classes of the FMU, but nothing that these modules only import.
        if module.partition(".")[0] in self.packages:
            loaded = super().find_class(module, name)
            if isinstance(loaded, type) and loaded.__module__.partition(".")[0] in self.packages:
                return loaded
        raise pickle.UnpicklingError(
            f"{module}.{name} is refused: a state holds plain data, NumPy arrays and generators, and the FMU's classes"
        )


def to_bytes(state: Any, label: str, packages: Set[str]) -> bytes:
    """Bytes of a state; `from_bytes` can read them.

    Parameters
    ----------
    state : object
        Plain data, NumPy arrays and generators, instances of classes of `packages`.
    label : str
        Names the code that the state belongs to; has no line break.
    packages : set of str
        Top-level names of packages whose classes may occur.

    Returns
    -------
    bytes

    Raises
    ------
    pickle.PicklingError, pickle.UnpicklingError, TypeError, AttributeError
        The state holds something that cannot be stored or would be refused.
    """
    # The label says which code the state belongs to; the test reading finds refused content early.
    data = label.encode() + b"\n" + pickle.dumps(state, protocol=4)
    from_bytes(data, label, packages)
    return data


def from_bytes(data: bytes, label: str, packages: Set[str]) -> Any:
    """State that `to_bytes` stored.

    Raises
    ------
    pickle.UnpicklingError
        The bytes belong to other code, or ask for something that is not data.
    """
    # Another version of the FMU may have another state.
    stored_label, _, content = data.partition(b"\n")
    if stored_label != label.encode():
        raise pickle.UnpicklingError(
            f"this is a state of {stored_label[:100].decode(errors='replace')!r}, wanted is one of {label!r}"
        )
    return _Unpickler(content, packages).load()
