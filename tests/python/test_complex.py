"""Filters of complex numbers: what they estimate, what is refused, states and pickles."""

import copy
import pickle

import numpy as np
import pytest

import rlslab


def drawn(rng, *shape):
    return rng.standard_normal(shape) + 1j * rng.standard_normal(shape)


@pytest.mark.parametrize("variant", [v for v in rlslab.variants() if v != "qr_block"])
def test_theta_is_that_of_least_squares(variant):
    rng = np.random.default_rng(3)
    Psi, y = drawn(rng, 40, 3), drawn(rng, 40)
    f = rlslab.filter(variant, 3, dtype="complex128")
    steps = f.update_many(Psi, y)
    A = np.vstack([Psi.conj(), np.eye(3) / 128])    # c^2 = 16384
    assert np.allclose(f.theta, np.linalg.lstsq(A, np.r_[y, np.zeros(3)], rcond=None)[0], rtol=1e-9)
    inverse = f.covariance if hasattr(f, "covariance") else np.linalg.inv(f.information)
    assert np.allclose(inverse, np.linalg.inv(A.conj().T @ A), rtol=1e-8, atol=1e-12)
    assert np.allclose(steps.residual[-1], y[-1] - Psi[-1].conj() @ f.theta)
    assert np.allclose(steps.residual, steps.gamma * steps.innovation)
    assert f.health == 0 and (steps.health == 0).all()


def test_a_fleet_is_its_filters_and_a_missing_row_none():
    rng = np.random.default_rng(4)
    Psi, Y = drawn(rng, 30, 11, 3), drawn(rng, 30, 11, 2)
    Psi[7, 4, 1] = np.nan + 1j
    Y[9, 10, 1] = np.inf
    fleet = rlslab.Fleet("ud", 11, 3, outputs=2, dtype="complex64", forgetting=0.98)
    steps = fleet.update_many(Psi, Y)
    assert steps.innovation.shape == (30, 11, 2) and steps.gamma.shape == (30, 11)
    assert fleet.theta.shape == (11, 3, 2) and fleet.covariance.shape == (11, 3, 3) and fleet.dtype == np.complex64
    assert (np.argwhere(steps.health) == [[7, 4], [9, 10]]).all() and np.isnan(steps.residual[7, 4]).all()
    for i in range(11):
        alone = rlslab.Ud(3, outputs=2, dtype="complex64", forgetting=0.98)
        for k in range(30):
            if (k, i) not in ((7, 4), (9, 10)):
                step = alone.update(Psi[k, i], Y[k, i])
                assert (step.innovation == steps.innovation[k, i]).all()
        assert (alone.theta == fleet.theta[i]).all() and (alone.covariance == fleet.covariance[i]).all()


def test_weights_are_rows_of_their_roots():
    rng = np.random.default_rng(7)
    Psi, Y, w = drawn(rng, 30, 3, 2), drawn(rng, 30, 3), rng.integers(0, 4, (30, 3)) ** 2 / 1.0
    w[9, 1], w[10, 2] = -1, np.nan
    f, ones, none, roots = (rlslab.Fleet("ud", 3, 2, dtype="complex128", forgetting=0.98) for _ in range(4))
    steps = f.update_many(Psi, Y, weights=w)
    with np.errstate(invalid="ignore"):
        r = np.sqrt(w)
        expected = roots.update_many(r[..., None] * Psi, r * Y)
        parts = expected.innovation.view(float).reshape(30, 3, 2) / r[..., None]    # each rounded once
    assert np.array_equal(steps.innovation.view(float).reshape(30, 3, 2), parts, equal_nan=True)
    assert f.state == roots.state and (np.argwhere(steps.health) == [[9, 1], [10, 2]]).all()
    assert np.array_equal(np.isnan(steps.residual), np.isnan(w) | (w <= 0)) and (w == 0).any()
    ones.update_many(Psi, Y, weights=np.ones((30, 3), np.float32))
    none.update_many(Psi, Y)
    assert ones.state == none.state


def test_states_copies_and_pickles_go_on():
    rng = np.random.default_rng(5)
    f = rlslab.Gentleman(2, dtype="complex64", forgetting=0.9, prior_variance=None)
    assert np.isnan(f.theta).all() and rlslab.HEALTHS[f.health] == "undetermined"
    f.update_many(drawn(rng, 9, 2), drawn(rng, 9))
    others = [copy.copy(f), copy.deepcopy(f), pickle.loads(pickle.dumps(f)), type(f)(**f._made)]
    others[-1].restore(f.state)
    psi, y = drawn(rng, 2), 1j
    f.update(psi, y)
    for other in others:
        other.update(psi, y)
        assert (other.theta == f.theta).all() and other.state == f.state and repr(other) == repr(f)
    f.reset()
    assert np.isnan(f.theta).all()


def test_layouts_and_kinds_are_taken_as_they_mean():
    rng = np.random.default_rng(6)
    Psi, y = drawn(rng, 12, 4), drawn(rng, 12)
    f, g = (rlslab.Carlson(4, dtype="complex128") for _ in range(2))
    f.update_many(Psi, y)
    g.update_many(np.asfortranarray(Psi)[:6], y[:6].tolist())
    g.update_many(np.repeat(Psi, 2, 1)[6:, ::2], np.r_[y, y][6:12].astype(">c16"))
    assert (f.theta == g.theta).all()
    assert rlslab.Ud(1, dtype=complex).update([2], 3).innovation == 3    # real and whole numbers are complex ones
    assert rlslab.Ud(2, dtype=complex).update_many(np.empty((0, 2)), []).innovation.shape == (0,)


@pytest.mark.parametrize(
    ("wrong", "error", "words"),
    [
        (lambda f: f.update([1, 2], 1), ValueError, "psi has shape (2,), expected (3,)"),
        (lambda f: f.update([1, 2, 3], [1]), ValueError, "y has shape (1,), expected ()"),
        (lambda f: f.update_many(np.ones((4, 3)), np.ones(3)), ValueError, "y has shape (3,), expected (n,)"),
        (lambda f: f.update_many(3, 4), ValueError, "Psi has shape ()"),
        (lambda f: f.update(["a", "b", "c"], 1), TypeError, "psi holds <U1, not complex numbers"),
        (lambda f: f.update(np.ma.masked_equal([1, 2, 3], 2), 1), TypeError, "psi is a masked array"),
        (lambda f: f.information, AttributeError, "ud reports covariance"),
        (lambda f: f.restore(b"x"), ValueError, "not a state"),
        (lambda f: f.restore(rlslab.Ud(3).state), ValueError, "ud in float64 with 3 parameters"),
        (lambda f: rlslab.Qr(3, dtype="complex64", outputs=2), ValueError, "one output"),
        (lambda f: rlslab.QrBlock(3, dtype="complex64"), ValueError, "qr_block"),
        (lambda f: rlslab.Ud(3, dtype="complex64", guard="reset"), ValueError, "plain variant"),
        (lambda f: rlslab.Ud(3, dtype="complex64", prior_theta=[1, 2, 3]), ValueError, "plain variant"),
        (lambda f: rlslab.Ud(3, dtype="complex64", prior_variance=None), ValueError, "expected a prior"),
        (lambda f: rlslab.Ud(3, dtype="complex256"), ValueError, "complex128, complex64"),
        (lambda f: rlslab.Fleet("ud", 0, 3, dtype="complex64"), ValueError, "filters >= 1"),
        (lambda f: rlslab.Fleet("ud", 2, 3, dtype="complex64", device="cuda"), ValueError, "on the CPU"),
        (lambda f: f.update([1, 2, 3], 1, weights=[1]), ValueError, "weights has shape (1,), expected ()"),
        (lambda f: f.update([1, 2, 3], 1, weights=1j), TypeError, "weights holds complex128, not real numbers"),
        (lambda f: rlslab.Fleet("ud", 10**9, 1000, dtype="complex64"), MemoryError, "GB"),
    ],
)
def test_what_is_none_is_refused_in_a_line(wrong, error, words):
    f = rlslab.Ud(3, dtype="complex128")
    f.update([1, 1j, 2], 1)
    before = f.state
    with pytest.raises(error) as caught:
        wrong(f)
    assert words in str(caught.value) and "\n" not in str(caught.value)
    assert f.state == before


def test_masked_and_ragged_lists_are_refused():
    row = np.ma.masked_array([1.0, 9.0], [0, 1])
    f = rlslab.Ud(2, dtype="complex128")
    for given in ([row, row], [[1.0, np.ma.masked], [1, 2]]):
        with pytest.raises(TypeError, match="masked"):
            f.update_many(given, [1, 2])
    with pytest.raises(ValueError, match="differ in length"):
        f.update_many([[1, 2], [3]], [1, 2])
    assert f.theta.tolist() == [0, 0]
