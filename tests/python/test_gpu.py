"""Fleets of device="cuda" against the libcuda of tests/gpu, which runs the kernels' bodies on this processor."""

import ctypes
import os

import numpy as np
import pytest

import rlslab


@pytest.mark.parametrize(
    ("variant", "size", "dtype"), [("ud", 4, "float64"), ("qr", 8, "float32"), ("ud", 12, "float32")]
)
def test_the_bits_are_those_of_the_processor(variant, size, dtype):
    if "RLSLAB_LIBCUDA" not in os.environ:
        pytest.skip("no RLSLAB_LIBCUDA")
    ctypes.CDLL(os.environ["RLSLAB_LIBCUDA"])  # whoever asks for libcuda.so.1 has it from now on
    fleets = [rlslab.Fleet(variant, 70, size, forgetting=0.99, dtype=dtype, device=d) for d in ("cpu", "cuda")]
    rng = np.random.default_rng(1)
    for k in range(20):
        Psi, y = rng.normal(size=(70, size)).astype(dtype), rng.normal(size=70).astype(dtype)
        y[3] = np.nan if k == 10 else y[3]
        for fleet in fleets:
            fleet.update(Psi, y)
    assert np.array_equal(fleets[0].theta, fleets[1].theta)
    assert np.array_equal(fleets[0].health, fleets[1].health)
    assert (repr(fleets[1])[-14:], fleets[1].missing) == ("device='cuda')", 1)
    other = rlslab.Fleet(variant, 70, size, forgetting=0.99, dtype=dtype, device="cuda")
    other.restore(fleets[1].state)
    assert np.array_equal(other.theta, fleets[0].theta)
