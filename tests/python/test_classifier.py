"""Several columns of y in RLSRegressor, and RLSClassifier: scikit-learn's own checks, and what they compute."""

import pickle
import warnings

import numpy as np
import pytest

pytest.importorskip("sklearn")
from sklearn.base import clone    # noqa: E402
from sklearn.datasets import load_digits, load_iris    # noqa: E402
from sklearn.exceptions import NotFittedError    # noqa: E402
from sklearn.linear_model import LinearRegression    # noqa: E402
from sklearn.utils.estimator_checks import check_estimator    # noqa: E402

import rlslab    # noqa: E402
from rlslab.sklearn import RLSClassifier, RLSRegressor    # noqa: E402

CHECKS = list(check_estimator(RLSClassifier(), generate_only=True))
OWN_PRIOR = {"qr": None, "qr_block": None, "gentleman": None, "information": None, "joseph_rank_two": 1e6, "ud": 1e6}
NEAR = {"rtol": 1e-4, "atol": 1e-4}    # a prior of 1e6 pulls by some 1e-6 P


def flowers():
    X, y = load_iris(return_X_y=True)
    order = np.random.default_rng(3).permutation(len(y))
    return X[order], y[order]


@pytest.mark.parametrize("estimator, check", CHECKS, ids=lambda x: getattr(getattr(x, "func", None), "__name__", "rls"))
def test_scikit_learns_checks(estimator, check):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        check(estimator)


def test_there_are_checks():
    assert len(CHECKS) >= 40


@pytest.mark.parametrize("fit_intercept", [True, False])
@pytest.mark.parametrize("variant", OWN_PRIOR)
def test_columns_are_those_of_least_squares(variant, fit_intercept):
    X, _ = flowers()
    Y = np.column_stack([X[:, 0], np.sin(X[:, 1]), X[:, 2] ** 2]) + 1000
    model = RLSRegressor(variant, prior_variance=OWN_PRIOR[variant], fit_intercept=fit_intercept).fit(X[:, 1:], Y)
    expected = LinearRegression(fit_intercept=fit_intercept).fit(X[:, 1:], Y)
    assert model.coef_.shape == (3, 3) and np.shape(model.intercept_) == (3,)
    assert np.allclose(model.coef_, expected.coef_, **NEAR)
    assert np.allclose(model.predict(X[:, 1:]), expected.predict(X[:, 1:]), **NEAR)
    assert np.isclose(model.score(X[:, 1:], Y), expected.score(X[:, 1:], Y), **NEAR)
    again = pickle.loads(pickle.dumps(model))
    for part in (model, again):
        part.partial_fit(X[:5, 1:], Y[:5])
    assert np.array_equal(model.coef_, again.coef_)


def test_columns_that_are_refused():
    X, y = flowers()
    Y = np.column_stack([y, y])
    model = RLSRegressor().fit(X, Y)
    before = model.filter_.state
    for other in (y, Y[:, :1], np.column_stack([Y, y])):
        with pytest.raises(ValueError, match="as before"):
            model.partial_fit(X, other)
    with pytest.raises(ValueError, match="one column"):
        model.predict(X, return_std=True)
    assert model.filter_.state == before
    for options in ({"guard": "reset"}, {"window": 20}, {"control": "ridge"}):
        with pytest.raises(ValueError, match="without guard, window and control"):
            RLSRegressor(**options).fit(X, Y)
    with pytest.raises(ValueError, match="leave out columns that depend"):
        RLSRegressor().fit(np.column_stack([X, X[:, 0]])[:4], Y[:4])
    with pytest.raises(ValueError, match="NaN"):
        RLSRegressor().fit(X, np.where(Y == 2, np.nan, Y))
    holed = np.where(X > 6, np.nan, X)
    for call in (
        lambda: RLSRegressor().fit(holed, Y), lambda: model.partial_fit(holed, Y), lambda: model.predict(holed),
        lambda: RLSClassifier().fit(holed, y), lambda: RLSClassifier().fit(X, y).predict(holed),
    ):    # fmt: skip
        with pytest.raises(ValueError, match="leave such rows out$"):
            call()
    with pytest.raises(ValueError, match='guard="reset"'):
        RLSRegressor().fit(holed, y)


@pytest.mark.parametrize("variant", ["qr", "qr_block", "gentleman", "information"])
def test_too_few_rows(variant):
    """30 rows of 64 columns: refused by `fit`, in the same words; NaN, and no prediction, after `partial_fit`."""
    numbers = np.random.default_rng(1)
    X, Y = numbers.standard_normal((30, 64)), numbers.standard_normal((30, 2))
    y = np.arange(30) % 3
    said = "n_samples = 30: the rows leave no theta of 65 parameters, health undetermined: leave out columns that"
    with pytest.raises(ValueError, match=said):
        RLSRegressor(variant).fit(X, Y)
    with pytest.raises(ValueError, match=said):
        RLSClassifier(variant).fit(X, y)
    assert np.isnan(RLSRegressor(variant).partial_fit(X, Y).coef_).all()
    model = RLSClassifier(variant).partial_fit(X, y)
    with pytest.raises(NotFittedError, match="the rows so far do not determine theta"):
        model.predict(X)
    with pytest.raises(ValueError, match="determine 65 parameters"):
        RLSRegressor(variant).fit(X, Y[:, 0])
    enough = numbers.standard_normal((65, 64))
    assert np.isfinite(RLSRegressor(variant).fit(enough, enough[:, :2]).coef_).all()


def test_filters_of_estimators_do_not_merge():
    X, y = flowers()
    parts = [RLSClassifier().fit(X[:75], y[:75]), pickle.loads(pickle.dumps(RLSClassifier().fit(X[75:], y[75:])))]
    own = rlslab.QrBlock(5, outputs=3, prior_variance=None)
    for older, newer in (parts, (own, parts[1].filter_), (parts[0].filter_, own)):
        with pytest.raises(ValueError, match="less its first one"):
            getattr(older, "filter_", older).merge(getattr(newer, "filter_", newer))


@pytest.mark.parametrize("variant", OWN_PRIOR)
def test_the_classes_of_flowers(variant):
    X, y = flowers()
    names = np.array(["setosa", "versicolor", "virginica"])[y]
    model = RLSClassifier(variant, prior_variance=OWN_PRIOR[variant]).fit(X[:100], names[:100])
    assert model.classes_.tolist() == ["setosa", "versicolor", "virginica"]
    expected = LinearRegression().fit(X[:100], names[:100, None] == model.classes_)
    assert np.allclose(model.coef_, expected.coef_, **NEAR)
    assert np.allclose(model.decision_function(X), expected.predict(X), **NEAR)
    assert model.score(X[100:], names[100:]) > 0.7


@pytest.mark.parametrize("variant", OWN_PRIOR)
def test_a_class_that_appears_later_was_zero(variant):
    """As if all classes had been named at first, bit for bit; also where it sorts before those that were there."""
    X, y = flowers()
    first, later = np.flatnonzero(y > 0), np.flatnonzero(y == 0)
    prior = OWN_PRIOR[variant]
    known = RLSClassifier(variant, prior_variance=prior).partial_fit(X[first], y[first], classes=[2, 1, 0])
    grown = RLSClassifier(variant, prior_variance=prior).partial_fit(X[first], y[first])
    assert grown.classes_.tolist() == [1, 2] and grown.decision_function(X).shape == (150,)
    assert np.array_equal(grown.decision_function(X) > 0, grown.predict(X) == 2)
    for model in (known, grown):
        model.partial_fit(X[later], y[later])
        assert model.classes_.tolist() == [0, 1, 2]
    assert np.array_equal(known.coef_, grown.coef_) and np.array_equal(known.intercept_, grown.intercept_)
    assert np.array_equal(known.predict(X), grown.predict(X))
    saboteur = RLSClassifier(variant, prior_variance=prior).partial_fit(X[first], 3 - y[first])
    assert not np.array_equal(saboteur.partial_fit(X[later], y[later]).coef_, known.coef_)


def test_digits_in_parts():
    X, y = load_digits(return_X_y=True)
    with pytest.raises(ValueError, match=r"constant \(0, 32, 39\), or give prior_variance"):
        RLSClassifier().fit(X, y)
    model = RLSClassifier(prior_variance=100, dtype="float32")
    for k in range(0, 1200, 100):
        model.partial_fit(X[k : k + 100], y[k : k + 100])
    assert model.score(X[1200:], y[1200:]) > 0.85


def test_labels_that_are_none():
    X, y = flowers()
    model = RLSClassifier().partial_fit(X, y)
    before = model.filter_.state
    with pytest.raises(ValueError, match="labels of"):
        model.partial_fit(X, y.astype(str))
    with pytest.raises(ValueError, match="continuous"):
        model.partial_fit(X, y + 0.5)
    with pytest.raises(ValueError, match="NaN"):
        model.partial_fit(np.where(X > 6, np.nan, X), y)
    assert model.filter_.state == before and clone(model).get_params() == model.get_params()
    early = RLSClassifier().partial_fit(X[:2], y[:2])
    with pytest.raises(NotFittedError, match="do not determine"):
        early.predict(X)
    with pytest.raises(ValueError, match="prior_variance gives one"):
        RLSClassifier("ud").fit(X, y)
    with pytest.raises(ValueError, match="kalman has one output"):
        RLSClassifier("kalman", prior_variance=1).fit(X, y)


def test_a_refused_part_leaves_the_model_as_it_was():
    model = RLSClassifier(dtype="float32").partial_fit([[0.0], [1.0], [2.0]], [0, 1, 1])
    before = model.predict([[1.0], [0.1]]), model.filter_.state
    with pytest.raises(ValueError, match="beyond float32: no row was taken"):
        model.partial_fit([[1e39]], [2])
    assert list(model.classes_) == [0, 1] and model.filter_.state == before[1]
    assert (model.predict([[1.0], [0.1]]) == before[0]).all()
    X = np.random.default_rng(0).standard_normal((50, 2))
    Y = np.c_[X[:, 0], X[:, 1] + 1]
    for refused in (np.vstack([[1e39, 0], X]), np.vstack([X, [1e39, 0]])):
        regressor = RLSRegressor("qr_block", dtype="float32")
        with pytest.raises(ValueError, match="beyond float32"):
            regressor.partial_fit(refused, np.vstack([[0, 0], Y]))
        assert np.allclose(regressor.partial_fit(X, Y).predict(X), Y, atol=1e-4)
    guarded = RLSRegressor(guard="reset")
    for _ in range(2):
        with pytest.raises(ValueError, match="without guard"):
            guarded.partial_fit(X, Y)
