"""Fleets of device="cuda" against the libcuda of tests/gpu, which runs the kernels' bodies on this processor."""

import copy
import ctypes
import os
import threading

import numpy as np
import pytest

import rlslab


class There:
    """An array as torch or cupy shows one of the GPU's."""

    def __init__(self, array, **about):
        self.array, self.about = array, about

    @property
    def __cuda_array_interface__(self):
        known = {name: self.array.__array_interface__[name] for name in ("shape", "typestr", "data", "strides")}
        return {**known, "version": 3, "stream": None, **self.about}


def fleet(*arguments, **options):
    if "RLSLAB_LIBCUDA" not in os.environ:
        pytest.skip("no RLSLAB_LIBCUDA")
    ctypes.CDLL(os.environ["RLSLAB_LIBCUDA"])    # whoever asks for libcuda.so.1 has it from now on
    return rlslab.Fleet(*arguments, device="cuda", **options)


@pytest.mark.parametrize(
    ("variant", "size", "dtype"), [("ud", 4, "float64"), ("qr", 8, "float32"), ("ud", 12, "float32")]
)
def test_the_bits_are_those_of_the_processor(variant, size, dtype):
    options = {"forgetting": 0.99, "dtype": dtype}
    fleets = [rlslab.Fleet(variant, 70, size, **options), fleet(variant, 70, size, **options)]
    there = fleet(variant, 70, size, **options)
    rng = np.random.default_rng(1)
    for k in range(20):
        Psi, y = rng.normal(size=(70, size)).astype(dtype), rng.normal(size=70).astype(dtype)
        y[3] = np.nan if k == 10 else y[3]
        for one in fleets:
            one.update(Psi, y)
        turned = [Psi, np.asfortranarray(Psi), Psi[::-1].copy()[::-1], np.repeat(Psi, 2, axis=1)[:, ::2]][k % 4]
        there.update(There(turned), There(y[::-1].copy()[::-1]))
    assert np.array_equal(there.theta, fleets[1].theta)
    assert np.array_equal(fleets[0].theta, fleets[1].theta)
    assert np.array_equal(fleets[0].health, fleets[1].health)
    assert (repr(fleets[1])[-14:], fleets[1].missing) == ("device='cuda')", 1)
    other = fleet(variant, 70, size, **options)
    other.restore(fleets[1].state)
    assert np.array_equal(other.theta, fleets[0].theta)


def test_what_a_gpu_refuses():
    one = fleet("ud", 10, 4)
    Psi, y = np.ones((10, 4)), np.ones(10)
    with pytest.raises(TypeError, match="y is not on the GPU"):
        one.update(There(Psi), y)
    with pytest.raises(TypeError, match="masked"):
        one.update(There(Psi, mask=There(np.zeros((10, 4), bool))), There(y))
    with pytest.raises(ValueError, match="aligned"):
        one.update(There(np.zeros(324, np.uint8)[4:].view()[:320].reshape(10, 32), shape=(10, 4), typestr="<f8",
                         strides=(32, 8)), There(y))
    with pytest.raises(ValueError, match="prior theta"):
        fleet("ud", 3, 2, prior_variance=None, prior_theta=[1, 2])
    with pytest.raises(ValueError, match="forgetting"):
        fleet("ud", 3, 2, forgetting=-1)
    for copied in (copy.copy, copy.deepcopy):
        with pytest.raises(TypeError, match="restore"):
            copied(one)


def test_threads_take_turns():
    one = fleet("ud", 1000, 4)
    refused = []

    def feed(value):
        for _ in range(30):
            try:
                one.update(np.full((1000, 4), float(value)), np.full(1000, float(value)))
            except RuntimeError as error:
                refused.append(str(error))

    threads = [threading.Thread(target=feed, args=(value,)) for value in range(1, 5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(np.unique(one.theta, axis=0)) == 1
    assert all("another thread" in words for words in refused)
