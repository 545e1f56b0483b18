/* Numeric primitives that models ask for: what NumPy does for them in Python. */
