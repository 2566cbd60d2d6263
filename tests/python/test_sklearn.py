"""The estimator: scikit-learn's own checks, and what it computes."""

import warnings
from pathlib import Path

import numpy as np
import pytest
from data import rows

pytest.importorskip("sklearn")
from sklearn.utils.estimator_checks import check_estimator    # noqa: E402

import rlslab    # noqa: E402
from rlslab.sklearn import RLSRegressor    # noqa: E402

CASES = Path(__file__).resolve().parents[1] / "data" / "cases"
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
    starts_without = variant in ("qr", "qr_block", "gentleman", "information")
    options = {"forgetting": 0.99, "prior_variance": None if starts_without else 1e6}
    if not starts_without:
        with pytest.raises(ValueError, match="prior_variance"):
            RLSRegressor(variant).fit(X, y)
    whole = RLSRegressor(variant, **options).fit(X, y + 5)
    parts = RLSRegressor(variant, **options)
    for k in range(0, 200, 50):
        parts.partial_fit(X[k : k + 50], y[k : k + 50] + 5)
    assert np.array_equal(whole.coef_, parts.coef_) and whole.intercept_ == parts.intercept_
    assert np.allclose(whole.coef_, [1, 2, 3, 4], atol=0.1) and abs(whole.intercept_ - 5) < 0.1
    assert np.isclose(whole.noise_variance_, parts.noise_variance_)
    assert 0.005 < whole.noise_variance_ < 0.02


@pytest.mark.parametrize("offset", [0, 2000, 4.3e9])
@pytest.mark.parametrize("variant", ["ud", "qr", "gentleman"])
def test_the_deviation_is_that_of_least_squares(variant, offset):
    X, y = rows(50, 3)
    X = np.round(X * 2**20) / 2**20    # so that an offset does not round them
    model = RLSRegressor(variant, prior_variance=1e10 if variant == "ud" else None).fit(X + offset, y)
    mean, deviation = model.predict(X[:5] + offset, return_std=True)
    A = np.column_stack([X, np.ones(50)])
    theta, (loss,), *_ = np.linalg.lstsq(A, y, rcond=None)
    variance = loss / 46
    expected = np.sqrt(variance * (1 + np.einsum("ij,jk,ik->i", A, np.linalg.inv(A.T @ A), A)))[:5]
    assert np.allclose(mean, A[:5] @ theta, rtol=1e-5) and np.allclose(deviation, expected, rtol=1e-4)
    assert np.isclose(model.noise_variance_, variance)


def test_years_beside_a_constant():
    """JuliaStats/GLM.jl 426: a default prior of 1e6 I gave 545.68, -0.03413."""
    year, miles, price = np.loadtxt(CASES / "s12_years.csv", delimiter=",", skiprows=1, unpack=True)
    for variant in ("qr", "gentleman", "information", "qr_block"):
        model = RLSRegressor(variant).fit(np.column_stack([year, miles]), price)
        assert np.allclose(model.coef_, [706.3333863524359, -0.019551452553601335], rtol=1e-10)
        assert np.isclose(model.intercept_, -1409540.0331094302, rtol=1e-10)


@pytest.mark.parametrize("n", [1, 2, 4])
def test_too_few_rows(n):
    X, y = rows(6, 4)
    model = RLSRegressor().partial_fit(X[:n], y[:n])
    assert np.isnan(model.coef_).all() and np.isnan(model.predict(X[:1], return_std=True)).all()
    with pytest.raises(ValueError, match=f"n_samples = {n}.*prior_variance"):
        RLSRegressor().fit(X[:n], y[:n])
    model.partial_fit(X[n:5], y[n:5])    # as many rows as parameters: no row says anything of the noise
    assert np.allclose(model.predict(X[:5]), y[:5]) and np.isnan(model.noise_variance_)
    assert RLSRegressor().fit(X[:5], y[:5]).intercept_ == model.intercept_
    assert np.isfinite(model.partial_fit(X[5:], y[5:]).noise_variance_)


def test_a_column_beside_the_constant_is_an_error():
    X, y = rows(60, 3)
    dummies = np.eye(3)[np.arange(60) % 3]
    for variant in ("qr", "gentleman", "information", "qr_block"):
        with pytest.raises(ValueError, match="do not determine"):
            RLSRegressor(variant).fit(np.column_stack([X, np.full(60, 13.47)]), y)
    assert np.allclose(RLSRegressor(fit_intercept=False).fit(dummies, y).coef_, [y[k::3].mean() for k in range(3)])


@pytest.mark.parametrize("forgetting", [1, 0.99, 0.95])
def test_an_interval_covers_what_it_says(forgetting):
    """1000 models: a share outside of 3.3 binomial deviations has a probability of 0.001."""
    g, covered, variances = np.random.default_rng(3), 0, []
    for _ in range(1000):
        X = g.standard_normal((301, 6))
        y = X @ np.arange(6) + 3 + 0.5 * g.standard_normal(301)
        model = RLSRegressor(forgetting=forgetting).fit(X[:300], y[:300])
        mean, deviation = model.predict(X[300:], return_std=True)
        covered += abs(mean[0] - y[300]) < 1.96 * deviation[0]
        variances.append(model.noise_variance_)
    assert abs(covered - 950) < 3.3 * np.sqrt(1000 * 0.95 * 0.05)
    assert abs(np.mean(variances) / 0.25 - 1) < 0.03


def spoilt(y, X):
    y[200] += 1000


def changed(y, X):
    y[:300] += X[:300] @ [5, -3, 2]


@pytest.mark.parametrize(
    "options, spoil",
    [
        ({"guard": "reset"}, spoilt), ({"guard": "rebuild"}, spoilt), 
        ({"variant": "ud", "prior_variance": 1e6, "guard": "hand_over"}, spoilt),
        ({"guard": "reset", "forgetting": 0.99}, changed), ({"window": 50}, changed), ({"window": 50}, spoilt),
        ({"window": 50, "forgetting": 0.98, "guard": "reset"}, changed), ({"control": ("reset", 100, 1e6)}, None),
        ({"variant": "ud", "prior_variance": 1e6, "guard": "reset", "control": ("kulhavy", 0.99)}, spoilt),
    ],
    ids=str,
)    # fmt: skip
def test_the_noise_is_that_of_the_rows_taken(options, spoil):
    g, variances = np.random.default_rng(7), []
    for _ in range(40):
        X = g.standard_normal((500, 3))
        X[:60, 1] = X[0, 1]    # depends on the constant at first
        y = X @ [1, 2, 3] + 4 + 0.1 * g.standard_normal(500)
        if spoil:
            spoil(y, X)
        model = RLSRegressor(**options)
        for k in range(0, 499, 97):
            model.partial_fit(X[k : min(k + 97, 499)], y[k : min(k + 97, 499)])
        variances.append(model.noise_variance_)
        assert 0.05 < model.predict(X[499:], return_std=True)[1][0] < 0.2
    assert 0.008 < np.mean(variances) < 0.012, np.mean(variances)


def test_rows_that_are_not_finite():
    X, y = rows(100, 3)
    bad = X.copy()
    bad[[0, 50], 1] = np.nan
    for call in (RLSRegressor().fit, RLSRegressor().partial_fit):
        with pytest.raises(ValueError, match="^[^\n]*NaN[^\n]*guard[^\n]*$"):
            call(bad, y)
    model = RLSRegressor(guard="reset").fit(bad, y)
    without = RLSRegressor(guard="reset").fit(np.delete(X, [0, 50], 0), np.delete(y, [0, 50]))
    assert model.filter_.counts.unusable == 2
    assert np.array_equal(model.coef_, without.coef_) and model.intercept_ == without.intercept_
    with pytest.raises(ValueError, match="NaN"):
        model.predict(bad)


def test_its_own_parameters_are_checked_when_it_is_fitted():
    X, y = rows()
    for bad in ({"variant": "udd"}, {"forgetting": 2}, {"guard": "x"}):
        model = RLSRegressor(**bad)
        with pytest.raises(ValueError):
            model.fit(X, y)
