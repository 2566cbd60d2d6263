"""The estimator: scikit-learn's own checks, and what it computes."""

import warnings

import numpy as np
import pytest
from data import rows

pytest.importorskip("sklearn")
from sklearn.utils.estimator_checks import check_estimator    # noqa: E402

import rlslab    # noqa: E402
from rlslab.sklearn import RLSRegressor    # noqa: E402

CHECKS = list(check_estimator(RLSRegressor(), generate_only=True))


@pytest.mark.parametrize("estimator, check", CHECKS, ids=lambda x: getattr(getattr(x, "func", None), "__name__", "rls"))
def test_scikit_learns_checks(estimator, check):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        check(estimator)


def test_there_are_checks():
    assert len(CHECKS) >= 40


@pytest.mark.parametrize("variant", rlslab.variants())
def test_parts_are_the_whole(variant):
    X, y = rows()
    whole = RLSRegressor(variant, forgetting=0.99).fit(X, y + 5)
    parts = RLSRegressor(variant, forgetting=0.99)
    for k in range(0, 200, 50):
        parts.partial_fit(X[k : k + 50], y[k : k + 50] + 5)
    assert np.array_equal(whole.coef_, parts.coef_) and whole.intercept_ == parts.intercept_
    assert np.allclose(whole.coef_, [1, 2, 3, 4], atol=0.1) and abs(whole.intercept_ - 5) < 0.1
    assert np.isclose(whole.noise_variance_, parts.noise_variance_)
    assert 0.005 < whole.noise_variance_ < 0.02


@pytest.mark.parametrize("variant", ["ud", "qr"])
def test_the_deviation_is_that_of_least_squares(variant):
    X, y = rows(50, 3)
    model = RLSRegressor(variant, prior_variance=1e10 if variant == "ud" else None).fit(X, y)
    mean, deviation = model.predict(X[:5], return_std=True)
    A = np.column_stack([X, np.ones(50)])
    theta, (loss,), *_ = np.linalg.lstsq(A, y, rcond=None)
    variance = loss / 46
    expected = np.sqrt(variance * (1 + np.einsum("ij,jk,ik->i", A, np.linalg.inv(A.T @ A), A)))[:5]
    assert np.allclose(mean, A[:5] @ theta, rtol=1e-5) and np.allclose(deviation, expected, rtol=1e-4)
    assert np.isnan(RLSRegressor().fit(X[:2], y[:2]).predict(X[:1], return_std=True)[1]).all()


def test_its_own_parameters_are_checked_when_it_is_fitted():
    X, y = rows()
    for bad in ({"variant": "udd"}, {"forgetting": 2}, {"guard": "x"}):
        model = RLSRegressor(**bad)
        with pytest.raises(ValueError):
            model.fit(X, y)
