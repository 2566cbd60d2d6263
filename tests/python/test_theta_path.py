"""theta of every row: the bits of `theta` after `update`, row by row."""

import numpy as np
import pytest

import rlslab


def rows(n=60, d=3):
    g = np.random.default_rng(1)
    X = g.standard_normal((n, d))
    return X, X @ np.arange(1.0, d + 1) + g.standard_normal(n)


def one_by_one(f, X, y):
    steps, path = [], []
    for psi, out in zip(X, y):
        steps.append(f.update(psi, out))
        path.append(f.theta)
    return steps, np.array(path)


@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("variant", rlslab.variants())
def test_every_variant(variant, dtype):
    X, y = rows()
    a, b, c = (rlslab.filter(variant, 3, forgetting=0.97, dtype=dtype) for _ in range(3))
    steps, path = one_by_one(a, X, y)
    theta = b.update_many(X, y, theta=True)
    assert theta.dtype == dtype and theta.shape == (60, 3) and np.array_equal(theta, path)
    assert b.state == a.state and b.counts.rows == 60
    table, again = c.update_many(X, y, theta=True, steps=True)
    assert np.array_equal(again, path) and np.array_equal(table["innovation"], [s.innovation for s in steps])
    assert [rlslab.HEALTHS[h] for h in table["health"]] == [s.health for s in steps]
    table["gamma"][:] = 0    # the caller's own


@pytest.mark.parametrize("options", [{"window": 20, "prior_variance": None}, {"guard": "reset"}, {"certify": 2}])
def test_composed(options):
    X, y = rows()
    y[30], X[40, 1] = 1e6, np.nan
    a, b = rlslab.Qr(3, **options), rlslab.Qr(3, **options)
    path = one_by_one(a, X, y)[1]
    assert np.array_equal(b.update_many(X, y, theta=True), path, equal_nan=True)
    assert b.state == a.state


def test_without_a_prior_theta_is_nan_until_the_rows_determine_it():
    X, y = rows()
    path = rlslab.Gentleman(3, prior_variance=None).update_many(X, y, theta=True)
    assert np.isnan(path[:2]).any(1).all() and np.isfinite(path[2:]).all()
    assert np.array_equal(path, one_by_one(rlslab.Gentleman(3, prior_variance=None), X, y)[1], equal_nan=True)
    assert np.allclose(path[-1], np.linalg.lstsq(X, y, rcond=None)[0])


def test_layouts_and_other_shapes():
    X, y = rows()
    expected = rlslab.Ud(3).update_many(X, y, theta=True)
    assert np.array_equal(rlslab.Ud(3).update_many(np.asfortranarray(X), y.tolist(), theta=True), expected)
    narrow = rlslab.Ud(3).update_many(X.astype("f4"), y.astype("f4"), theta=True)
    assert np.array_equal(narrow, one_by_one(rlslab.Ud(3), X.astype("f4"), y.astype("f4"))[1])
    assert rlslab.Ud(3).update_many(X[:0], y[:0], theta=True).shape == (0, 3)
    f = rlslab.Ud(3)
    for bad in ((X[:, :2], y), (X, y[:5]), (X[0], y)):
        with pytest.raises(ValueError):
            f.update_many(*bad, theta=True)
    assert f.counts.rows == 0
