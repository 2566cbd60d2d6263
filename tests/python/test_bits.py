"""The bits of C++: theta, K and P after 1000 rows, by every variant in both arithmetics; weights, removals, variances
and draws; of several outputs, fleets and complex numbers theta and the state."""

import os
import struct
import subprocess

import numpy as np
import pytest

import rlslab


def numbers():
    """x = 1664525 x + 1013904223 mod 2^32; the number is (x >> 8) / 2^23 - 1."""
    x = 1
    while True:
        x = (1664525 * x + 1013904223) % 2**32
        yield (x >> 8) / 2**23 - 1


def hash_of(values, more=b""):
    first = second = 1
    for byte in struct.pack(f"<{len(values)}d", *values) + more:
        first, second = (257 * first + byte) % 4294967291, (65599 * second + byte) % 4294967291
    return f"{first:08x}{second:08x}"


def left_by(variant, dtype):
    f = rlslab.filter(variant, 5, forgetting=0.9921875, dtype=dtype)
    number = numbers()
    for _ in range(1000):
        psi = [next(number) for _ in range(5)]
        f.update(psi, next(number))
    matrix = f.covariance if hasattr(f, "covariance") else f.information
    return hash_of([*f.theta.tolist(), *f.gain.tolist(), *matrix.T.ravel().tolist()])


def printed_by_cpp(*verb):
    if "RLSLAB_BITS" not in os.environ:
        pytest.skip("RLSLAB_BITS names no program of tests/portability/digest.cpp: ctest does")
    return subprocess.run([os.environ["RLSLAB_BITS"], *verb], check=True, capture_output=True, text=True).stdout


def test_the_bits_are_those_of_cpp():
    printed = printed_by_cpp()
    ours = "".join(
        f"{variant} {name} {left_by(variant, dtype)}\n"
        for dtype, name in (("float32", "float"), ("float64", "double"))
        for variant in rlslab.variants()
    )
    assert ours == printed
    assert len(set(printed.split()[2::3])) >= 28    # kalman's and conventional's may agree


def asked_of(variant, dtype):
    f = rlslab.filter(variant, 5, forgetting=0.9921875, dtype=dtype)
    number = numbers()
    table = np.array([[next(number) for _ in range(6)] for _ in range(100)])
    f.update_many(table[:, :5], table[:, 5], weights=np.arange(100) % 5 / 2, steps=True)
    psi, y = table[-1, :5], table[-1, 5]
    out = [*f.theta.tolist(), *f.gain.tolist()]
    answers = (
        lambda: [f.variance(psi)],
        lambda: f.sample(1, 3, 0.5).ravel().tolist(),
        lambda: [*f.least_excited().direction.tolist(), *f.least_excited()[1:]],
        lambda: [*f.remove(psi, y, 2.0)],
    )
    for answer in answers:
        try:
            out += answer()
        except ValueError:
            pass
    return hash_of([*out, *f.theta.tolist()])


def test_weights_and_what_a_filter_is_asked_are_those_of_cpp():
    ours = "".join(
        f"{variant} {name} {asked_of(variant, dtype)}\n"
        for dtype, name in (("float32", "float"), ("float64", "double"))
        for variant in rlslab.variants()
    )
    assert ours == printed_by_cpp("asked")


def test_several_outputs_are_those_of_cpp():
    number = numbers()
    table = np.array([[next(number) for _ in range(8)] for _ in range(620)])
    X, Y = table[:, :5], table[:, 5:]    # in place: rows apart from one another
    ours = ""
    for dtype, name in (("float32", "float"), ("float64", "double")):
        for variant in rlslab.variants():
            if variant in ("kalman", "extended_qr"):
                continue
            f = rlslab.CLASSES[variant](5, outputs=3, forgetting=0.9921875, dtype=dtype)
            for k in range(20):
                f.update(X[k], Y[k])
            f.update_many(X[20:].astype(dtype), Y[20:].astype(dtype))
            ours += f"{variant} {name} {hash_of(f.theta.ravel().tolist(), f.state)}\n"
    assert ours == printed_by_cpp("outputs")
    assert len(set(ours.split()[2::3])) == 32


@pytest.mark.parametrize("verb", ["complex", "fleets"])
def test_fleets_are_those_of_cpp(verb):
    """Of complex numbers; of real ones of two outputs, with weights."""
    ours = ""
    is_complex = verb == "complex"
    for name, real, number_type in (("float", "f4", "c8"), ("double", "f8", "c16")):
        dtype = number_type if is_complex else real
        for variant in rlslab.variants():
            several = variant != "qr_block" and hasattr(rlslab.Fleet(variant, 1, 2, dtype=dtype), "covariance")
            if variant == "qr_block" or not (is_complex or several):
                continue
            m = 2 if several else 1
            f = rlslab.Fleet(variant, 11, 5, outputs=m, forgetting=0.9921875, dtype=dtype)
            number = numbers()
            table = np.array([[next(number) for _ in range((11 + 11 * is_complex) * (5 + m))] for _ in range(60)])
            table = table.view("c16" if is_complex else "f8")
            Psi, Y = table[:, :55].reshape(60, 11, 5), table[:, 55:].reshape(60, 11, m)
            w = np.ones((60, 11)) if is_complex else (np.arange(60)[:, None] + np.arange(11)) % 5 / 2
            f.update(Psi[0], Y[0], weights=w[0])
            f.update_many(Psi[1:].astype(dtype), Y[1:].astype(dtype), weights=w[1:].astype(real))
            theta = f.theta.ravel().view(real).tolist()
            ours += f"{variant} {verb.removesuffix('s')} {name} {hash_of(theta, f.state)}\n"
    assert ours == printed_by_cpp(verb)
    assert len(set(ours.split()[3::4])) >= (32 if is_complex else 22)    # kalman's and conventional's may agree
