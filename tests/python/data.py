"""Rows for the tests."""

import numpy as np


def rows(n=200, d=4, seed=1, dtype=np.float64):
    """Psi (n, d) and y of a model with a little noise."""
    generator = np.random.default_rng(seed)
    Psi = generator.standard_normal((n, d)).astype(dtype)
    return Psi, (Psi @ np.arange(1, d + 1) + 0.1 * generator.standard_normal(n)).astype(dtype)


def same(a, b):
    """The same bits, NaN included."""
    return np.asarray(a).tobytes() == np.asarray(b).tobytes()
