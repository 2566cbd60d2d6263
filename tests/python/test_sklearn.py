"""The estimator: scikit-learn's own checks, and what it computes."""

import pickle
import warnings
from pathlib import Path

import numpy as np
import pytest
from data import rows

pytest.importorskip("sklearn")
pd = pytest.importorskip("pandas")
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


@pytest.mark.parametrize("forgetting, d, n", [(1, 6, 300), (0.99, 6, 300), (0.95, 6, 300), (1, 3, 15), (1, 3, 8),
                                              (1, 3, 6), (0.95, 3, 12), (0.8, 3, 300)])    # fmt: skip
def test_an_interval_covers_what_it_says(forgetting, d, n):
    """1000 models: a share outside of 3.3 binomial deviations has a probability of 0.001."""
    g, inside, variances = np.random.default_rng(3), np.zeros(2), []
    for _ in range(1000):
        X = g.standard_normal((n + 1, d))
        y = X @ np.arange(d) + 3 + 0.5 * g.standard_normal(n + 1)
        model = RLSRegressor(forgetting=forgetting).fit(X[:n], y[:n])
        mean, deviation = model.predict(X[n:], return_std=True)
        (low, high), = model.predict(X[n:], interval=0.95)[1]
        inside += abs(mean[0] - y[n]) < 1.96 * deviation[0], low < y[n] < high
        variances.append(model.noise_variance_)
    close = abs(inside - 950) < 3.3 * np.sqrt(1000 * 0.95 * 0.05)
    many = n == 300 and forgetting >= 0.95    # else 1.96 deviations are too few
    assert close[1] and (close[0] or not many), inside
    assert abs(np.mean(variances) / 0.25 - 1) < (0.03 if many else 0.15)


def test_the_interval_is_that_of_least_squares():
    """Of statsmodels where it is there; and the same from parts, of a pickle, too."""
    X, y = rows(12, 3)
    model = RLSRegressor().fit(X[:10], y[:10])
    parts = pickle.loads(pickle.dumps(RLSRegressor().partial_fit(X[:7], y[:7]))).partial_fit(X[7:10], y[7:10])
    assert model.noise_degrees_ == parts.noise_degrees_ == 10 - 4
    A = np.column_stack([X, np.ones(12)])
    theta, (loss,), *_ = np.linalg.lstsq(A[:10], y[:10], rcond=None)
    along = np.einsum("ij,jk,ik->i", A[10:], np.linalg.inv(A[:10].T @ A[:10]), A[10:])
    half = 2.446911851144969 * np.sqrt(loss / 6 * (1 + along))    # Student's quantile of 0.975 with 6 degrees
    for one in (model, parts):
        mean, limits = one.predict(X[10:], interval=0.95)
        assert np.array_equal(mean, one.predict(X[10:])) and limits.shape == (2, 2)
        assert np.allclose(limits, np.column_stack([A[10:] @ theta - half, A[10:] @ theta + half]), rtol=1e-10)
    assert np.isnan(RLSRegressor().fit(X[:4], y[:4]).predict(X, interval=0.5)[1]).all()
    several = RLSRegressor().fit(X, np.column_stack([y, y]))
    for call in (lambda: model.predict(X, interval=95), lambda: model.predict(X, interval=np.nan),
                 lambda: model.predict(X, True, 0.9), lambda: several.predict(X, interval=0.9)):
        with pytest.raises(ValueError, match="^(interval: expected a probability|return_std and interval are)[^\n]*$"):
            call()
    api = pytest.importorskip("statsmodels.api")
    other = api.OLS(y[:10], A[:10]).fit().get_prediction(A[10:]).conf_int(obs=True, alpha=0.2)
    assert np.allclose(model.predict(X[10:], interval=0.8)[1], other, rtol=1e-10)


def spoilt(y, X):
    y[200] += 1000


def changed(y, X):
    y[:300] += X[:300] @ [5, -3, 2]


@pytest.mark.parametrize(
    "options, spoil",
    [
        ({"guard": "reset"}, spoilt), ({"guard": "rebuild"}, spoilt),
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


@pytest.mark.parametrize("options", [{}, {"guard": "rebuild"}, {"window": 1000}, {"forgetting": 0.9999}], ids=str)
def test_the_noise_forgets_what_a_guard_starts_again_for(options):
    """An outlier before it knows the noise: the rows up to its new start are of no theta, in parts, too."""
    for seed in range(9):
        g = np.random.default_rng(seed)
        X = g.standard_normal((1000, 3))
        y = X @ [1, 2, 3] + 4 + 0.1 * g.standard_normal(1000)
        y[40] = 1000
        model = RLSRegressor(**{"guard": "reset", **options}).fit(X, y)
        assert model.filter_.counts.changes == 1
        assert 0.008 < model.noise_variance_ < 0.0125
        parts = RLSRegressor(**{"guard": "reset", **options})
        for k in range(0, 1000, 50):
            parts.partial_fit(X[k : k + 50], y[k : k + 50])
        assert np.isclose(parts.noise_variance_, model.noise_variance_)


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


@pytest.mark.parametrize("guard", [None, "reset"])
@pytest.mark.parametrize("bad", [np.nan, np.inf, None])
def test_y_that_is_not_finite(bad, guard):
    X, y = rows(20, 3)
    y = y.astype(object)
    y[3] = bad
    with pytest.raises(ValueError, match="^Input (y )?contains [^\n]*: leave such rows out$"):
        RLSRegressor(guard=guard).fit(X, y)


def test_masked_rows_are_refused_as_elsewhere():
    X, y = rows(20, 3)
    hidden, part = np.ma.masked_where(X == X[3, 1], X), np.ma.masked_where(y == y[5], y)
    plain = RLSRegressor().fit(X, y)
    assert np.array_equal(RLSRegressor().fit(np.ma.array(X), np.ma.array(y)).coef_, plain.coef_)
    for call, name in [(lambda: RLSRegressor().fit(hidden, y), "X"), (lambda: RLSRegressor().fit(list(hidden), y), "X"),
                       (lambda: RLSRegressor(guard="reset").partial_fit(X, part), "y"),
                       (lambda: plain.predict(hidden), "X")]:
        with pytest.raises(TypeError, match=f"^{name} is a masked array: leave its masked rows out"):
            call()


ALONE = ("kalman", "extended_qr", "qr_block")    # take no guard
FREE = ("qr", "qr_block", "gentleman", "information")


@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("guard", [None, "report", "reset", "rebuild"])
@pytest.mark.parametrize("variant", FREE)
def test_the_answer_is_that_of_the_rows_in_any_unit_or_none(variant, guard, dtype):
    """Also by squares that overflow, vanish, or are less than what a guard puts into P^-1."""
    if variant == "qr_block" and guard:
        pytest.skip("qr_block takes no guard")
    g = np.random.default_rng(0)
    X = g.uniform(-1, 1, (1000, 3))
    y, answers = X @ [1, 2, 3] + 4 + 0.1 * g.standard_normal(1000), {}
    tens = [*range(-310, 301, 10), -5, 5, 307.6, 308.2] if dtype == "float64" else [*range(-40, 38, 5), 18.3, 38]
    for ten in tens:
        unit = 10.0**ten
        try:
            model = RLSRegressor(variant, dtype=dtype, guard=guard).fit(X * unit, y)
        except ValueError as error:
            assert "scale" in str(error) and "columns of X of up to" in str(error) and "\n" not in str(error)
            assert abs(ten) > 3, ten
        else:
            answers[ten] = model.coef_ * unit
            barely = ten < (-150 if dtype == "float64" else -20)    # squares that have lost digits
            assert np.allclose(answers[ten], [1, 2, 3], atol=0.05 if barely else 0.02), (ten, answers[ten])
    assert 0 in answers and len(answers) < len(tens)
    if guard is None and variant[:2] == "qr":
        assert {-300, 300} <= set(answers) if dtype == "float64" else {-35, 35} <= set(answers)


@pytest.mark.parametrize("guard", [None, "report", "reset"])
@pytest.mark.parametrize("variant", rlslab.variants())
def test_no_prior_is_an_answer(variant, guard):
    X, y = rows(200, 3, dtype=np.float32)
    with pytest.raises(ValueError, match="prior_variance, or None"):
        RLSRegressor(variant, prior_variance=np.inf, guard=guard).fit(X, y)
    try:
        model = RLSRegressor(variant, prior_variance=1e4, dtype="float32", guard=guard).fit(X * 1e18, y)
        assert np.allclose(model.coef_ * 1e18, [1, 2, 3], atol=0.1)
    except ValueError as error:
        if "cannot be composed" not in str(error):
            assert "squares float32 does not hold" in str(error) and "prior_variance 1.0e+04" in str(error)
    if guard and variant not in ALONE:
        with pytest.raises(ValueError, match="no row of X is finite"):
            RLSRegressor(variant, prior_variance=1e4, guard=guard, fit_intercept=False).fit(X * np.nan, y)


def test_what_a_part_spoils_is_said_then():
    X, y = rows(100, 3)
    model = RLSRegressor("gentleman").partial_fit(X[:50], y[:50])
    with pytest.raises(ValueError, match="squares float64 does not hold"):
        model.partial_fit(X[50:] * 1e200, y[50:])
    guarded = RLSRegressor(guard="reset").partial_fit(X[:50], y[:50])
    before = guarded.coef_
    assert np.array_equal(guarded.partial_fit(X[50:] * np.nan, y[50:]).coef_, before)


def test_what_is_not_determined_for_its_size_or_memory():
    X, y = rows(60, 3)
    with pytest.raises(ValueError, match="squares float32 does not hold .columns of X of up to 2.*e-30 to .*e-30"):
        RLSRegressor("gentleman", dtype="float32").fit(X * 1e-30, y)
    with pytest.raises(ValueError, match="keep more rows in memory"):
        RLSRegressor(forgetting=1e-300).fit(X, y)
    with pytest.raises(ValueError) as error:
        RLSRegressor(fit_intercept=False).fit(X[:2], y[:2])
    assert "constant" not in str(error.value) and "memory" not in str(error.value)


def test_its_own_parameters_are_checked_when_it_is_fitted():
    X, y = rows()
    for bad in ({"variant": "udd"}, {"forgetting": 2}, {"guard": "x"}):
        model = RLSRegressor(**bad)
        with pytest.raises(ValueError):
            model.fit(X, y)


@pytest.mark.parametrize("dtype", [np.float16, np.float32, ">f4"])
def test_a_short_y_is_as_good_as_its_numbers(dtype):
    """What is taken off y so that an offset costs no digits is taken off in float64."""
    P = np.random.default_rng(0).normal(size=(200, 2))
    y = (P @ [3, -2]).astype(dtype)
    y[0] = -60000    # no longer in the window
    for one in (y, pd.Series(y) if np.dtype(dtype).isnative else y):
        model, same = RLSRegressor(window=50).fit(P, one), RLSRegressor(window=50).fit(P, y.astype(np.float64))
        assert np.array_equal(model.coef_, same.coef_) and np.allclose(model.coef_, [3, -2], atol=2e-3)
    wide = np.linspace(-40, 40, 81).reshape(-1, 1)
    assert np.allclose(RLSRegressor().fit(wide, (1000 * wide[:, 0]).astype(np.float16)).coef_, 1000, rtol=1e-3)


@pytest.mark.parametrize("variant", ["qr", "gentleman", "information"])
def test_a_window_of_as_many_rows_as_parameters_is_an_answer(variant):
    P = np.random.default_rng(0).normal(size=(40, 2))
    v = P @ [3, -2] + 7
    for n in (3, 4, 40):
        model = RLSRegressor(variant, window=3).fit(P[:n], v[:n])
        assert np.allclose([*model.coef_, model.intercept_], [3, -2, 7])
    with pytest.raises(ValueError, match="do not determine 3 parameters"):
        RLSRegressor(variant, window=2).fit(P, v)


@pytest.mark.parametrize(
    "X, y, named",
    [
        (pd.DataFrame({"t": pd.to_timedelta([1, 2, 3], "s")}), [1, 2, 3], "X: column 't' holds timedelta64"),
        (pd.DataFrame({"c": pd.Categorical(["1", "2", "3"])}), [1, 2, 3], "X: column 'c' holds category"),
        (pd.DataFrame({"d": pd.date_range("2026", periods=3)}), [1, 2, 3], "X: column 'd' holds datetime64"),
        ([[1.0], [2.0], [3.0]], ["a", "b", "c"], "y holds <U1"),
        ([[1.0], [2.0], [3.0]], np.array([1, 2, 3], "m8[s]"), "y holds timedelta64"),
    ],
    ids=lambda x: x if isinstance(x, str) else "",
)
def test_what_holds_no_numbers_is_named(X, y, named):
    with pytest.raises((TypeError, ValueError), match=named):
        RLSRegressor().fit(X, y)


def test_an_option_of_the_guard_is_a_number():
    with pytest.raises(ValueError, match="guard_options"):
        rlslab.Ud(2, guard="reset", guard_options={"innovation": np.nan})


def test_an_outlier_in_the_first_row_leaves_with_the_window():
    g = np.random.default_rng(4)
    X = g.standard_normal((500, 2))
    y = 1 + X @ [2, 3] + 0.1 * g.standard_normal(500)
    right = np.linalg.lstsq(np.column_stack([X, np.ones(500)])[-50:], y[-50:], rcond=None)[0]
    for spoil in ((0, 1e15), (1e12, 1e12), (1e15, 0)):
        X[0, 0], y[0] = spoil
        model = RLSRegressor(window=50).fit(X, y)
        np.testing.assert_allclose([*model.coef_, model.intercept_], right, rtol=1e-12)


@pytest.mark.parametrize("interval", ["0.9", [0.9], 1j, 0, 1, np.nan])
def test_an_interval_is_a_probability(interval):
    model = RLSRegressor().fit(*rows(30, 2))
    with pytest.raises((TypeError, ValueError), match="^interval"):
        model.predict(np.ones((1, 2)), interval=interval)
    low, high = model.predict(np.ones((1, 2)), interval=1 - 1e-16)[1][0]
    assert np.isfinite([low, high]).all() and low < high


def test_columns_that_depend_leave_nan():
    a = np.random.default_rng(0).standard_normal((50, 2))
    model = RLSRegressor().partial_fit(np.column_stack([a, a.sum(1)]), a[:, 0] ** 2)
    assert np.isnan(model.coef_).all() and np.isnan(model.intercept_)
