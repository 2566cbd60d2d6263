"""Recursive least squares with statsmodels' words: against formulas, and against statsmodels where it is."""

import warnings
from fractions import Fraction

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


N = 40
AT, X1 = np.arange(N), np.random.default_rng(3).standard_normal(N)
ONE, LATE = np.ones(N), np.random.default_rng(4).standard_normal(N)
STARTS = {
    "step dummy": [ONE, X1, AT >= 20],
    "event dummy of one row": [ONE, X1, AT == 30],
    "seasonal dummies": [*(AT // 10 == np.arange(4)[:, None]), X1],
    "rows of zeros": [ONE * (AT >= 15), X1 * (AT >= 15)],
    "a constant but for rounding": [ONE, X1, np.where(AT < 20, 13.47, 13 + LATE)],
    "another column but for rounding": [ONE, X1, np.where(AT < 20, 1.7 * X1, LATE)],
    "a sum of two": [ONE, X1, LATE, np.where(AT < 20, X1 + LATE, LATE**2)],
    "two steps": [ONE, X1, AT >= 20, AT >= 39],
    "a counter": [ONE, 4.3e9 + np.cumsum(1 + AT % 7), X1],
}


@pytest.mark.parametrize("start", STARTS)
def test_a_start_that_depends_loses_no_row(start):
    X = np.column_stack(STARTS[start]).astype(float)
    d = X.shape[1]
    y = X @ np.arange(1, d + 1) + 0.1 * np.random.default_rng(5).standard_normal(N)
    fit = RecursiveLS(y, X)
    centred = X - (X[0] * (X[0] > 1e9))    # numpy's digits for the counter; the constant is the first column
    theta, (loss,), *_ = np.linalg.lstsq(centred, y, rcond=None)
    of = slice(1, None) if start == "a counter" else slice(None)
    assert np.isclose(fit.scale, loss / (N - d), rtol=1e-4)
    variances = loss / (N - d) * np.diag(np.linalg.inv(centred.T @ centred))
    assert np.allclose(fit.bse[of], np.sqrt(variances)[of], rtol=1e-4)
    assert np.isnan(fit.resid_recursive).sum() == d and len(fit.cusum) == N - d
    determined = next(k for k in range(N) if np.linalg.matrix_rank(centred[: k + 1]) == d)
    path = fit.recursive_coefficients
    assert np.isnan(path[:determined]).all() and np.isfinite(path[determined:]).all()
    for k in range(determined + 3, N, 3):
        expected = np.linalg.lstsq(centred[: k + 1], y[: k + 1], rcond=None)[0]
        assert np.allclose(path[k][of], expected[of], rtol=1e-4, atol=1e-9)
    for k in np.flatnonzero(np.isfinite(fit.resid_recursive)):    # w w is what the row adds to the least sum of squares
        before, after = (
            np.sum((y[:m] - centred[:m] @ np.linalg.lstsq(centred[:m], y[:m], rcond=None)[0]) ** 2) for m in (k, k + 1)
        )
        assert np.isclose(fit.resid_recursive[k] ** 2, after - before, rtol=1e-4, atol=1e-5)


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


@pytest.mark.parametrize("both", [False, True])
@pytest.mark.parametrize("ten", [-310, -300, -200, -160, -155, -150, -100, 100, 150, 155, 160, 200, 300, 307])
def test_in_any_unit_the_same_or_a_clear_line(ten, both):
    X, y = rows(50, 3)
    unit, plain = 10.0**ten, RecursiveLS(y, X)
    try:
        fit = RecursiveLS(y * unit if both else y, X * unit)
    except ValueError as error:
        assert abs(ten) > 150 and "float64 does not hold the squares" in str(error)
    else:
        assert abs(ten) <= 160
        assert np.allclose(fit.tvalues, plain.tvalues, rtol=1e-9) and np.allclose(fit.cusum, plain.cusum, rtol=1e-9)
        assert np.allclose(fit.bse * (1 if both else unit), plain.bse, rtol=1e-9)


def test_a_record_without_noise_has_errors_of_rounding():
    fit = RecursiveLS(np.arange(9.0), np.column_stack([np.ones(9), np.arange(9.0)]))
    assert fit.scale < 1e-25 and np.isfinite(fit.bse).all()
    assert RecursiveLS(np.zeros(9), np.ones((9, 1))).scale == 0


def test_what_is_wrong_is_named():
    X, y = rows(10, 3)
    for bad in (np.nan, np.inf):
        with pytest.raises(ValueError, match=r"^endog\[7\] is not finite; leave such rows out$"):
            RecursiveLS(np.where(np.arange(10) == 7, bad, y), X)
    for shape in (y[:, None], y[:-1]):
        with pytest.raises(ValueError, match=r"^endog has shape .*, expected \(10,\) as exog has 10 rows$"):
            RecursiveLS(shape, X)


def test_bad_input():
    X, y = rows(10, 3)
    for endog, exog in [(y[:3], X[:3]), (y, X[:, 0]), (y[:-1], X), (y, np.ones((10, 3))), (y, X * np.nan), ("a", X),
                        (y, X.astype(complex)), ([], np.zeros((0, 3))), (y, np.zeros((10, 0)))]:
        with pytest.raises((ValueError, TypeError)):
            RecursiveLS(endog, exog)
    with pytest.raises(ValueError):
        RecursiveLS(y, X).conf_int(2)


def test_columns_that_depend_but_for_rounding_are_named():
    g, t = np.random.default_rng(1), np.arange(60.0)
    x = 1e5 * (1 + 1e-13 * g.standard_normal(60))
    x[30:] = 1e5 + 10 * g.standard_normal(30)
    for late in (x, np.exp(0.6 * t), np.exp(0.7 * t), 2**t):
        X, y = np.column_stack([np.ones(60), late]), g.standard_normal(60) + late
        try:
            fit = RecursiveLS(y, X)
        except ValueError as error:
            assert "depend on one another but for rounding in its first" in str(error)
            continue
        a, b, n = [Fraction(x) for x in late], [Fraction(x) for x in y], Fraction(60)
        A, B = [x - sum(a) / n for x in a], [x - sum(b) / n for x in b]
        AB = sum(p * q for p, q in zip(A, B))
        loss = sum(x * x for x in B) - AB * AB / sum(x * x for x in A)
        assert np.isnan(fit.resid_recursive).sum() == 2
        of_rounding = (100 * np.spacing(np.abs(y)).max()) ** 2 if y.max() > 1e10 else 0    # innovations have y's
        assert float(loss / 58) * 0.99 < fit.scale < float(loss / 58) * 1.01 + of_rounding
