"""Requests that no controller sends: random ones, and those that are meant to break an allocator."""

import numpy as np

SPAN = np.array([80e3, 50e3, 900e3])  # N, N, N.m: beyond what the ship can give in every direction
HELD = 50  # steps for which a kind of request and an availability last


def requests(steps: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Requests and availability, (n, 1, 3) each, in stretches of `HELD` steps, each of one kind.

    Parameters
    ----------
    steps : int
        How many.
    seed : int
        Of the generator.

    Returns
    -------
    (n, 1, 3) array, (n, 1, 3) array of bool
        Requests [N, N, N.m], and whether port, starboard and tunnel can be used.

    Notes
    -----
    The kinds: independent uniform requests; corners of the span in turn, from one to the opposite one; a large force
    that turns right round; signs that change every step around zero; a small walk; a constant that nobody can give.
    """
    random = np.random.default_rng(seed)
    kinds = (_uniform, _corners, _round, _around_zero, _walk, _constant)
    parts, usable = [], []
    for _ in range(-(-steps // HELD)):
        parts.append(kinds[random.integers(len(kinds))](random))
        able = random.random(3) > (0.2 if random.random() < 0.3 else 0.0)
        usable.append(np.tile(able, (HELD, 1)))
    return np.concatenate(parts)[:steps, None], np.concatenate(usable)[:steps, None]


def _uniform(random):
    return random.uniform(-SPAN, SPAN, (HELD, 3)) * 10.0 ** random.uniform(-3.0, 0.0)


def _corners(random):
    corner = random.choice([-1.0, 1.0], 3) * SPAN
    return np.where(np.arange(HELD)[:, None] // random.integers(1, 10) % 2, corner, -corner)


def _round(random):
    angle = random.uniform(0.0, 2.0 * np.pi) + random.choice([-1, 1]) * np.linspace(
        0.0, 2.0 * np.pi, HELD
    )
    size = random.uniform(1e3, 60e3)
    return np.stack(
        [
            size * np.cos(angle),
            size * np.sin(angle),
            random.uniform(-SPAN[2], SPAN[2]) * np.sin(angle),
        ],
        -1,
    )


def _around_zero(random):
    return (
        10.0 ** random.uniform(-6.0, 3.0)
        * random.choice([-1.0, 0.0, 1.0], (HELD, 3))
        * [1.0, 1.0, 10.0]
    )


def _walk(random):
    steps = random.normal(0.0, 1.0, (HELD, 3)) * [300.0, 300.0, 3e3]
    return random.uniform(-0.3, 0.3, 3) * SPAN + steps.cumsum(0)


def _constant(random):
    return np.tile(random.choice([-1.0, 1.0], 3) * SPAN * 3.0, (HELD, 1))
