"""Recursive least squares with statsmodels' words: against formulas, and against statsmodels where it is."""

import warnings

import numpy as np
import pytest
from data import rows

from rlslab.results import RecursiveLS


def test_they_are_those_of_least_squares():
    X, y = rows(60, 3)
    fit = RecursiveLS(y, X)
    theta, (loss,), *_ = np.linalg.lstsq(X, y, rcond=None)
    assert np.allclose(fit.params, theta, rtol=1e-12)
    assert np.isclose(fit.scale, loss / 57)
    assert np.allclose(fit.bse, np.sqrt(loss / 57 * np.diag(np.linalg.inv(X.T @ X))))
    assert np.isclose(fit.cusum_squares[-1], 1) and len(fit.cusum) == 57
    assert np.allclose(fit.conf_int(0.05).mean(axis=1), fit.params)
    assert np.allclose((fit.conf_int()[:, 1] - fit.params) / fit.bse, 1.959964, atol=1e-6)
    assert len(fit.summary().splitlines()) == 5
    for k in (3, 10, 59):
        assert np.allclose(fit.recursive_coefficients[k], np.linalg.lstsq(X[: k + 1], y[: k + 1], rcond=None)[0])


def test_they_are_those_of_statsmodels():
    recursive_ls = pytest.importorskip("statsmodels.regression.recursive_ls")
    X, y = rows(60, 3)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        theirs = recursive_ls.RecursiveLS(y, X).fit()
    ours = RecursiveLS(y, X)
    for name in ("params", "bse", "tvalues", "pvalues", "cusum", "cusum_squares", "scale"):
        assert np.allclose(getattr(ours, name), getattr(theirs, name), rtol=1e-5, atol=1e-7), name
    assert np.allclose(ours.conf_int(), theirs.conf_int(), rtol=1e-5)
    assert np.allclose(ours.resid_recursive[3:], theirs.resid_recursive[3:], rtol=1e-5, atol=1e-7)
    assert np.allclose(ours.recursive_coefficients[5:], theirs.recursive_coefficients.filtered.T[5:], rtol=1e-5)


def test_bad_input():
    X, y = rows(10, 3)
    for endog, exog in [(y[:3], X[:3]), (y, X[:, 0]), (y[:-1], X), (y, np.ones((10, 3))), (y, X * np.nan), ("a", X),
                        (y, X.astype(complex)), ([], np.zeros((0, 3))), (y, np.zeros((10, 0)))]:
        with pytest.raises((ValueError, TypeError)):
            RecursiveLS(endog, exog)
    with pytest.raises(ValueError):
        RecursiveLS(y, X).conf_int(2)
