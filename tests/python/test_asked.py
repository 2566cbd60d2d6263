"""Weights, removals, merging, variances, factors, draws and the least excited direction."""

import pickle

import numpy as np
import pytest

import rlslab

DTYPES = ("float32", "float64")
NO_ROOT = ("conventional", "conventional_two_sided", "symmetric", "joseph", "joseph_rank_two", "kalman", "information")
NO_FORM = ("kalman", "extended_qr", "qr_block")


def rows(n=200, d=4, seed=1):
    numbers = np.random.default_rng(seed)
    Psi = numbers.standard_normal((n, d))
    w = numbers.uniform(0, 2, n)
    w[[3, 50]], w[[7, 60]], w[[9, 70]] = 0, 1, (np.nan, -1)
    return Psi, Psi @ np.arange(1.0, d + 1) + 0.1 * numbers.standard_normal(n), w


def taken(f):
    f.update_many(*rows()[:2])
    return f


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("variant", rlslab.variants())
def test_a_weight_is_a_scaled_row(variant, dtype):
    Psi, y, w = rows()
    f = rlslab.filter(variant, 4, forgetting=0.98, dtype=dtype)
    scaled, many, blocks = f.copy(), f.copy(), f.copy()
    in_dtype, root = (array.astype(dtype) for array in (Psi, np.sqrt(w.astype(dtype), where=w > 0, out=w * 0)))
    for k in range(len(y)):
        step, before = f.update(Psi[k], y[k], w[k]), scaled.state
        if w[k] > 0:
            scaled.update(root[k] * in_dtype[k], root[k] * y.astype(dtype)[k])
            assert f.gain.tolist() == (root[k] * scaled.gain).tolist()
        elif w[k] == 0:
            scaled.pass_time()
            assert step.health == "sound" and np.isnan(step.innovation)
        else:
            assert step.health == f.health == "nonfinite" and scaled.state == before
        assert f.state == scaled.state
    steps = many.update_many(Psi, y, weights=w, steps=True)
    assert many.state == f.state and steps["health"].tolist().count(rlslab.HEALTHS.index("nonfinite")) == 2
    if variant != "qr_block":
        last = blocks.update_many(np.repeat(Psi, 2, axis=0)[::2], y, weights=np.repeat(w, 2)[::2])
        assert blocks.state == f.state and last.innovation == steps["innovation"][-1]
    assert blocks.counts.rows in (0, 200) and pickle.loads(pickle.dumps(f)).state == f.state


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("variant", rlslab.variants())
def test_weights_of_one_change_no_bit(variant, dtype):
    Psi, y, _ = rows(600)
    f = rlslab.filter(variant, 4, forgetting=0.98, dtype=dtype)
    g = f.copy()
    for psi in (Psi, Psi.astype("float32"), Psi[::-1], np.asfortranarray(Psi)):
        a, b = f.update_many(psi, y), g.update_many(psi, y, weights=np.ones(600, psi.dtype))
        assert f.state == g.state and (a == b or variant == "qr_block")
    g.update(Psi[0], y[0], weight=1), f.update(Psi[0], y[0])
    assert f.state == g.state
    g.update(Psi[0], np.nan, weight=0), f.pass_time()
    assert f.state == g.state


def test_weights_through_a_guard_and_a_window():
    Psi, y, _ = rows(400)
    noisy = np.arange(400) % 5 == 0
    y[noisy] += 30 * np.random.default_rng(2).standard_normal(400)[noisy]
    told, untold = (rlslab.Ud(4, guard="reset", window=300) for _ in range(2))
    told.update_many(Psi, y, weights=np.where(noisy, 1e-5, 1.0))
    untold.update_many(Psi, y)
    assert told.counts.outliers == 0 < untold.counts.outliers
    assert np.allclose(told.theta, [1, 2, 3, 4], atol=0.05)


def test_weights_that_are_none():
    f = rlslab.Ud(2)
    before = f.state
    for weights in ([1.0], [[1.0, 2.0]], 3.0, [1.0, 2.0, 3.0]):
        with pytest.raises(ValueError, match="weights has shape"):
            f.update_many(np.eye(2), [1.0, 2.0], weights=weights)
    for weight in ("1", b"1", 1j, object(), [1.0]):
        with pytest.raises(TypeError):
            f.update([1.0, 2.0], 3.0, weight)
        with pytest.raises((TypeError, ValueError)):
            f.update_many(np.eye(2), [1.0, 2.0], weights=[weight, weight])
    for call in (lambda: f.update([1, 2], 3, w=1), lambda: f.update([1, 2], y=3), lambda: f.update([1, 2], 3, 1, 1),
                 lambda: f.update([1, 2], 3, 1, weight=1), lambda: f.update()):    # fmt: skip
        with pytest.raises(TypeError):
            call()
    assert f.state == before
    assert f.update([1, 2], 3, None).health == "sound"
    assert f.update_many(np.eye(2), [1, 2], weights=[True, False]).health == "sound"


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("variant", rlslab.variants())
def test_a_removed_row_leaves_no_trace(variant, dtype):
    Psi, y, _ = rows()
    f = taken(rlslab.filter(variant, 4, forgetting=0.98, prior_variance=9, dtype=dtype))
    if variant in NO_FORM:
        with pytest.raises(ValueError, match="takes no row back"):
            f.remove(Psi[0], y[0])
        return
    f.update([1.0, 1.0, 1.0, 1.0], 1e3)
    f.update(Psi[0], y[0])
    removal = f.remove([1.0, 1.0, 1.0, 1.0], 1e3, weight=0.98)
    without = taken(rlslab.filter(variant, 4, forgetting=0.98, prior_variance=9, dtype=dtype))
    without.pass_time(), without.update(Psi[0], y[0])
    tolerance = {"float32": 2e-2, "float64": 1e-9}[dtype]
    assert not removal.refused and 0 < removal.remaining < 1 and np.allclose(f.theta, without.theta, atol=tolerance)
    before = f.state
    for call in (lambda: f.remove(Psi[0], y[0], 1e6), lambda: f.remove(Psi[0], np.nan), lambda: f.remove(Psi[0], 1, -1),
                 lambda: f.remove([np.inf, 1, 1, 1], 1)):    # fmt: skip
        assert call().refused
    assert f.remove(Psi[0], y[0], 0) == (1, 1) and f.state == before
    for bad in (lambda: f.remove(Psi[:2], y[0]), lambda: f.remove(Psi[0, :3], y[0])):
        with pytest.raises(ValueError, match="psi has shape"):
            bad()
    with pytest.raises(TypeError):
        f.remove(Psi[0], "y")
    assert f.state == before


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("variant", rlslab.variants())
def test_variances_and_factors_are_of_p(variant, dtype):
    f = taken(rlslab.filter(variant, 4, forgetting=0.98, dtype=dtype))
    matrix = f.covariance if hasattr(f, "covariance") else f.information
    P = (matrix if hasattr(f, "covariance") else np.linalg.inv(matrix)).astype("float64")
    Psi = rows(80, seed=3)[0][:30]
    tolerance = {"float32": 2e-3, "float64": 1e-9}[dtype]
    if variant in NO_FORM:
        with pytest.raises(ValueError, match="has psi'P psi not at hand"):
            f.variance(Psi)
    else:
        found = f.variance(Psi)
        assert found.shape == (30,) and found.dtype == f.dtype
        assert np.allclose(found, np.einsum("ki,ij,kj->k", Psi, P, Psi), rtol=tolerance)
        for layout in (Psi[::-1][::-1], np.asfortranarray(Psi), Psi.tolist(), np.repeat(Psi, 2, axis=1)[:, ::2]):
            assert f.variance(layout).tolist() == found.tolist()
        one = f.variance(Psi[4])
        assert isinstance(one, float) and one == found[4]
        assert f.variance(np.zeros((0, 4))).shape == (0,)
        for shape in ((2, 3), (3,), (1, 2, 4), ()):
            with pytest.raises(ValueError):
                f.variance(np.zeros(shape))
    if variant in (*NO_ROOT, "ud", "ud_delta", "gentleman"):
        assert not hasattr(f, "factor")
    else:
        assert np.allclose(f.factor @ f.factor.T, matrix, rtol=tolerance, atol=tolerance * abs(matrix).max())


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("variant", rlslab.variants())
def test_draws_have_the_covariance(variant, dtype):
    f = taken(rlslab.filter(variant, 4, forgetting=0.98, dtype=dtype))
    if variant in NO_ROOT:
        for call in (lambda: f.sample(1, 2), f.least_excited):
            with pytest.raises(ValueError, match="stores no root"):
                call()
        return
    before = f.state
    P = f.covariance if hasattr(f, "covariance") else np.linalg.inv(f.information)
    draws = f.sample(5, 20000, scale=2.0)
    assert draws.shape == (20000, 4) and draws.dtype == f.dtype and f.state == before
    assert abs(np.cov(draws.T) / 4 - P).max() < 0.05 * abs(P).max()
    assert (f.sample(5, 3, 2.0) == draws[:3]).all() and (f.sample(6, 3, 2.0) != draws[:3]).all()
    assert (f.sample(5, 2, 0) == f.theta).all() and f.sample(5, 0).shape == (0, 4)
    found = f.least_excited()
    deviation = np.sqrt(np.diag(P).astype("float64"))
    C = P / np.outer(deviation, deviation)
    assert 1 - 1e-5 <= found.ratio <= np.linalg.eigvalsh(C.astype("float64"))[-1] * (1 + 1e-5)
    assert np.isclose(np.linalg.norm(found.direction), 1, rtol=1e-6) and found.direction.dtype == f.dtype
    assert np.isclose(found.deviation**2, found.direction @ P @ found.direction, rtol=1e-4)
    assert found.sentence.startswith("the rows in the filter's memory say least along (")


def test_draws_that_are_none():
    f = rlslab.Ud(2)
    for seed, n, scale in ((-1, 2, 1), (2**64, 2, 1), (1, -1, 1), (1, 2, -1), (1, 2, np.nan), (1, 2, np.inf)):
        with pytest.raises(ValueError):
            f.sample(seed, n, scale)
    with pytest.raises((ValueError, MemoryError)):
        f.sample(1, 2**61)
    for seed, n, scale in ((1.5, 2, 1), (1, 2.0, 1), (1, 2, "1"), (None, 2, 1)):
        with pytest.raises(TypeError):
            f.sample(seed, n, scale)
    assert f.sample(2**64 - 1, 1).shape == (1, 2)
    f.update([np.nan, 1], 1)
    assert np.isnan(f.sample(1, 2)).all()
    for variant in ("qr", "qr_block", "gentleman"):
        f = rlslab.filter(variant, 2, prior_variance=None)
        for _ in range(5):
            assert np.isnan(f.sample(1, 2)).all() and np.isnan(f.least_excited().ratio)
            assert f.least_excited().sentence.endswith("do not determine theta, or P has broken down")
            f.update([1.0, 0.1], 3.0)
        f.update([1.0, 2.0], 3.0)
        assert np.isfinite(f.sample(1, 2)).all()


@pytest.mark.parametrize("dtype", DTYPES)
def test_parts_merge(dtype):
    Psi, y, w = rows(500)
    w = np.abs(w.clip(0.1))
    w[np.isnan(w)] = 1
    whole = rlslab.QrBlock(4, dtype=dtype)
    older, newer = rlslab.QrBlock(4, dtype=dtype), rlslab.QrBlock(4, dtype=dtype, prior_variance=None)
    whole.update_many(Psi, y, weights=w)
    older.update_many(Psi[:300], y[:300], weights=w[:300]), newer.update_many(Psi[300:], y[300:], weights=w[300:])
    kept = newer.state
    older.merge(newer)
    assert newer.state == kept and older.counts.rows == 500 and older.health == "sound"
    tolerance = {"float32": 1e-4, "float64": 1e-12}[dtype]
    assert np.allclose(older.theta, whole.theta, rtol=tolerance) and np.allclose(older.gain, whole.gain, atol=tolerance)
    before = older.state
    for part, why in (
        (rlslab.QrBlock(4, dtype=dtype), "prior_variance=None"),
        (rlslab.QrBlock(3, dtype=dtype, prior_variance=None), "with 3 parameters"),
        (rlslab.QrBlock(4, dtype=dtype, prior_variance=None, forgetting=0.99), "a part of forgetting 1, found 0.99"),
        (rlslab.Ud(4, dtype=dtype), "found ud"),
    ):
        with pytest.raises(ValueError, match=why):
            older.merge(part)
    for part in (None, 3, rlslab.QrBlock(4, outputs=2)):
        with pytest.raises(TypeError):
            older.merge(part)
    with pytest.raises(ValueError, match="ud does not merge; qr_block does"):
        rlslab.Ud(4).merge(newer)
    assert older.state == before


def test_rows_of_an_estimator_do_not_merge():
    pytest.importorskip("sklearn")
    from rlslab.sklearn import RLSRegressor

    Psi, y, _ = rows()
    model = RLSRegressor("qr_block").fit(Psi, y)
    with pytest.raises(ValueError, match="less its first one"):
        rlslab.QrBlock(5, prior_variance=None).merge(model.filter_)
    assert np.allclose(pickle.loads(pickle.dumps(model)).coef_, model.coef_)


@pytest.mark.parametrize("variant", ["qr", "gentleman", "information"])
def test_a_row_on_which_a_parameter_rests_is_not_removed(variant):
    g = np.random.default_rng(2)
    for k in range(100):
        X = g.standard_normal((100, 4))
        X[:, 0], X[:, 2], X[k, 2] = 1, 0, 1
        f = rlslab.filter(variant, 4, prior_variance=None)
        f.update_many(X, X @ [1, 2, 3, 4] + g.standard_normal(100))
        before = f.state
        assert f.remove(X[k], 3.0).refused and f.state == before
