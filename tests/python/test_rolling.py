"""Rolling and grouped regressions: each row beside least squares of its window alone."""

import pickle
import subprocess
import sys
import threading
from fractions import Fraction

import numpy as np
import pytest

import rlslab
from rlslab._rolling import ANSWERS


def alone(X, y, forgetting=1.0):
    """Every answer of one window by numpy, its rows the oldest first; None where they are too few."""
    age = np.arange(len(y))[::-1]
    use = np.isfinite(X).all(1) & np.isfinite(y)
    w, X, y = forgetting ** age[use], X[use], y[use]
    n, d = X.shape
    if n < d:
        return None
    A, b = X * np.sqrt(w)[:, None], y * np.sqrt(w)
    theta = np.linalg.lstsq(A, b, rcond=None)[0]
    N, r, rss = w.sum(), (w**2).sum() / w.sum(), ((b - A @ theta) ** 2).sum()
    sigma = np.sqrt(rss / (N - r * d)) if n > d and N > r * d else np.nan
    error = sigma * np.sqrt(r * np.diag(np.linalg.inv(A.T @ A)))
    r2 = 1 - rss / (w @ (y - np.average(y, weights=w)) ** 2)
    return {"theta": theta, "t": theta / error, "error": error, "sigma": sigma, "r2": r2, "rows": float(n)}


def data(n, d, seed=1):
    g = np.random.default_rng(seed)
    X = g.standard_normal((n, d))
    X[:, d // 2] = 2.0    # a constant, not the first
    return X, X @ np.arange(1.0, d + 1) + g.standard_normal(n)


def same(a, b, rows=slice(None)):
    pairs = ((name, getattr(a, name)[rows], getattr(b, name)[rows]) for name in ANSWERS)
    return [name for name, one, other in pairs if not np.array_equal(one, other, equal_nan=True)]


@pytest.mark.parametrize("forgetting", [None, 0.97])
@pytest.mark.parametrize("window", [None, 2, 7, 40, 1000])
@pytest.mark.parametrize("d", [2, 3, 9])
def test_every_row_is_its_window_alone(d, window, forgetting):
    n = 240
    X, y = data(n, d)
    g = np.random.default_rng(2)
    groups, bad = g.choice(["a", "b", "c"], n), g.random(n) < 0.1
    X[bad, 0], y[::17] = np.nan, np.inf
    found = rlslab.rolling(X, y, window, forgetting, groups, min_periods=0, returns=ANSWERS)
    compared = 0
    for name in "abc":
        rows = np.flatnonzero(groups == name)
        theta = np.full(d, np.nan)
        for k, row in enumerate(rows):
            last = rows[max(0, k + 1 - window) if window else 0 : k + 1]
            finite = np.isfinite(X[row]).all() and np.isfinite(y[row])
            forecast = X[row] @ theta if finite else np.nan
            np.testing.assert_allclose(found.innovation[row], y[row] - forecast, rtol=1e-9, atol=1e-9)
            theta, expected = found.theta[row], alone(X[last], y[last], forgetting or 1.0)
            assert np.isnan(theta).all() or np.isfinite(theta).all()
            assert np.isnan(found.residual[row]) == (not finite or np.isnan(theta).any())
            if finite and np.isfinite(theta).all():
                np.testing.assert_allclose(found.residual[row], y[row] - X[row] @ theta, rtol=1e-9, atol=1e-9)
            if expected is None:
                assert np.isnan(theta).all()
            elif expected["rows"] >= d + 3:
                compared += 1
                for answer, number in expected.items():
                    np.testing.assert_allclose(getattr(found, answer)[row], number, rtol=2e-8, atol=1e-9)
    assert compared > 30 or window in (2, 7)


def exact(X, y):
    """theta and RSS of integers, as fractions."""
    d = X.shape[1]
    rows = [[Fraction(int(x)) for x in (*row, out)] for row, out in zip(X, y)]
    A = [[sum(row[i] * row[j] for row in rows) for j in range(d + 1)] for i in range(d + 1)]
    for i in range(d):
        for k in range(i + 1, d + 1):
            c = A[k][i] / A[i][i]
            A[k] = [a - c * b for a, b in zip(A[k], A[i])]
    theta = [Fraction(0)] * d
    for i in reversed(range(d)):
        theta[i] = (A[i][d] - sum(A[i][j] * theta[j] for j in range(i + 1, d))) / A[i][i]
    return theta, A[d][d]


def subtracting(X, y, window):
    """Sums from which the old row is taken: what the law below catches."""
    A, b, yy, theta, sigma = 0.0, 0.0, 0.0, [], []
    for k in range(len(y)):
        for at, sign in ((k, 1), (k - window, -1)):
            if at >= 0:
                A, b, yy = A + sign * np.outer(X[at], X[at]), b + sign * X[at] * y[at], yy + sign * y[at] ** 2
        theta.append(np.linalg.lstsq(A, b, rcond=None)[0])
        sigma.append(np.sqrt(abs(yy - b @ theta[-1]) / max(window - len(b), 1)))
    return np.array(theta), np.array(sigma)


def test_what_has_left_the_window_leaves_no_trace():
    g, n, d, W = np.random.default_rng(3), 400, 3, 20
    X, y = g.integers(-9, 10, (n, d)).astype(float), g.integers(-99, 100, n).astype(float)
    dirty, spoilt = X.copy(), y.copy()
    dirty[100, 1], spoilt[100], dirty[101], spoilt[101], dirty[250, 0] = 1e12, -1e12, 1e12, 1e12, np.nan
    for forgetting in (None, 0.9):
        clean = rlslab.rolling(X, y, W, forgetting, returns=ANSWERS)
        found = rlslab.rolling(dirty, spoilt, W, forgetting, returns=ANSWERS)
        after = np.r_[0:100, 101 + W + 1 : 250, 250 + W + 1 : n]    # one more: the innovation knows theta before
        assert same(clean, found, after) == []                      # not one bit
    found = rlslab.rolling(dirty, spoilt, W, returns=ANSWERS)
    theta, sigma = subtracting(dirty[:200], spoilt[:200], W)
    worst, others = 0.0, 0.0
    for k in range(101 + W, 101 + 3 * W):
        right, rss = exact(X[k - W + 1 : k + 1], y[k - W + 1 : k + 1])
        right, s = np.array([float(x) for x in right]), float(rss / (W - d)) ** 0.5
        worst = max(worst, np.abs(found.theta[k] / right - 1).max(), abs(found.sigma[k] / s - 1))
        others = max(others, np.abs(theta[k] / right - 1).max(), abs(sigma[k] / s - 1))
    assert worst < 1e-12
    assert others > 1


def test_groups_and_threads_change_no_bit():
    n, W = 30000, 50
    X, y = data(n, 4)
    groups = np.random.default_rng(4).integers(0, 5, n)
    groups[: n // 2] = 3    # one is cut into pieces
    for window, forgetting in ((W, None), (W, 0.98), (None, 0.98), (None, None)):
        try:
            made = []
            for threads in (1, 2, 5):
                rlslab.use_threads(threads)
                made.append(rlslab.rolling(X, y, window, forgetting, groups, returns=ANSWERS))
        finally:
            rlslab.use_threads(1)
        assert same(made[0], made[1]) == same(made[0], made[2]) == []
        rows = groups == 3
        single = rlslab.rolling(X[rows], y[rows], window, forgetting, returns=ANSWERS)
        for name in ANSWERS:
            assert np.array_equal(getattr(single, name), getattr(made[0], name)[rows], equal_nan=True), name


def test_long_windows_of_many_columns():
    """Whose triangles are made a part at a time."""
    X, y = data(1300, 20)
    found = rlslab.rolling(X, y, 401, 0.999, returns=ANSWERS)
    for k in (400, 401, 555, 801, 802, 1203, 1299):
        for answer, number in alone(X[k - 400 : k + 1], y[k - 400 : k + 1], 0.999).items():
            np.testing.assert_allclose(getattr(found, answer)[k], number, rtol=1e-9)
    X[300, 1:9], y[300] = 1e12, 1e12
    assert same(found, rlslab.rolling(X, y, 401, 0.999, returns=ANSWERS), slice(702, None)) == []


def test_when_there_are_answers():
    X, y = data(10, 2)
    first = lambda **options: int(np.isnan(rlslab.rolling(X, y, **options).theta[:, 0]).sum())
    assert [first(window=5), first(window=5, min_periods=0), first(window=5, min_periods=3)] == [4, 1, 2]
    assert [first(), first(min_periods=4), first(window=11), first(window=1)] == [1, 3, 10, 10]
    found = rlslab.rolling(X, y, 2, returns=ANSWERS)
    assert np.isfinite(found.theta[1:]).all() and np.isnan(found.sigma).all() and np.isnan(found.t).all()
    X[3] = np.nan
    found = rlslab.rolling(X, y, 4, returns=ANSWERS)
    assert np.isfinite(found.theta[3:]).all() and found.rows[3] == 3 and np.isnan(found.residual[3])
    assert np.isnan(rlslab.rolling(X, y, 4, min_periods=4).theta[3:7]).all()


@pytest.mark.parametrize("kind", ["constant", "sum", "late"])
def test_columns_that_depend_on_one_another_have_no_theta(kind):
    g = np.random.default_rng(5)
    for case in range(40):
        X, W = g.standard_normal((300, 4)) * 10.0 ** g.integers(-8, 9, 4), int(g.choice([6, 30, 120]))
        X[:, 0], good = 1.0, slice(0, 0)
        if kind == "constant":
            X[:, 3] = 7.3
        elif kind == "sum":
            X[:, 3] = X[:, 1] * 0.1 + X[:, 2] * 0.7
        else:
            X[120:, 2], good = X[120:, 1] * 3.3, slice(W, 120)
        found = rlslab.rolling(X, g.standard_normal(300), W, returns=ANSWERS)
        singular = slice(120 + W, None) if kind == "late" else slice(None)
        for name in ("theta", "t", "error", "residual", "sigma", "r2"):
            assert np.isnan(getattr(found, name)[singular]).all()
            assert np.isfinite(getattr(found, name)[good]).all()
    for n in (1000, 50000):    # for ever
        X = np.column_stack([np.ones(n), np.full(n, 7.3), g.standard_normal(n)])
        assert np.isnan(rlslab.rolling(X, X[:, 2]).theta).all()


def test_r2_is_never_beyond_one():
    g = np.random.default_rng(6)
    x = 1e8 + g.standard_normal(3000) * 10.0 ** g.integers(-6, 7, 3000)
    for y in (x, 3 * x + 1e-9 * g.standard_normal(3000), g.standard_normal(3000), np.full(3000, 4.2)):
        for X in (x, np.column_stack([x, np.ones(3000)])):
            for window, forgetting in ((5, None), (60, 0.9), (None, 0.9)):
                r2 = rlslab.rolling(X, y, window, forgetting, returns="r2").r2
                assert not ((r2 < 0) | (r2 > 1)).any()
    assert np.isnan(rlslab.rolling(np.column_stack([np.ones(9), x[:9]]), np.full(9, 4.2), returns="r2").r2).all()


@pytest.mark.parametrize("options", [{"window": 50}, {"forgetting": 0.97}, {}])
def test_offsets_cost_no_digits_beside_a_constant(options):
    g = np.random.default_rng(9)
    X = g.integers(-(2**20), 2**20, (1200, 3)) / 2.0**20
    X[:, 1], y = 2.0, np.round((X[:, 0] - 3 * X[:, 2] + g.standard_normal(1200)) * 2**20) / 2**20
    far = X + np.array([2.0**30, 0.0, -(2.0**31)])    # exact
    far[::50], X[::50] = np.nan, np.nan               # the constant's, too
    near, found = (rlslab.rolling(A, y + off, **options, returns=ANSWERS) for A, off in ((X, 0.0), (far, 2.0**30)))
    assert np.isfinite(found.sigma[60])
    for name in ("sigma", "r2", "innovation", "residual"):
        np.testing.assert_allclose(getattr(found, name), getattr(near, name), rtol=1e-11, atol=1e-12)
    for name in ("theta", "t", "error"):
        np.testing.assert_allclose(getattr(found, name)[:, ::2], getattr(near, name)[:, ::2], rtol=1e-11, atol=1e-12)
    shift = found.theta[:, 0] * 2.0**30 - found.theta[:, 2] * 2.0**31
    np.testing.assert_allclose(found.theta[:, 1] * 2 + shift, near.theta[:, 1] * 2 + 2.0**30, rtol=1e-12)


def test_units_do_not_matter():
    X, y = data(500, 5)
    units = 2.0 ** np.array([-26, 26, 0, 13, -300])
    a, b = (rlslab.rolling(X * u, y * v, 30, returns=ANSWERS) for u, v in ((1.0, 1.0), (units, 2.0**200)))
    assert np.array_equal(a.theta * 2.0**200 / units, b.theta, equal_nan=True)
    assert np.array_equal(a.t, b.t, equal_nan=True) and np.array_equal(a.r2, b.r2, equal_nan=True)


def test_layouts_and_dtypes():
    X, y = (array.astype("float32") for array in data(60, 3))
    found = rlslab.rolling(X, y, 9, returns=ANSWERS)
    assert found.theta.dtype == np.float64
    wide, doubled = np.zeros((60, 7), "float32"), np.repeat(y, 2)
    wide[:, 2:5] = X
    for P, v in (
        (X.astype(float), y.astype(float)), (np.asfortranarray(X), y), (wide[:, 2:5], doubled[::2]),
        (X.astype(">f4"), y), (X.tolist(), y.tolist()), (X[::-1][::-1], y.astype(float)),
    ):  # fmt: skip
        assert same(found, rlslab.rolling(P, v, 9, returns=ANSWERS)) == []
    X.flags.writeable = False
    rlslab.rolling(X, y)
    one = rlslab.rolling(X[:, 0], y, 9, returns=ANSWERS)
    assert one.theta.shape == (60, 1) and same(one, rlslab.rolling(X[:, :1], y, 9, returns=ANSWERS)) == []


GROUPS = [1, 7, 1, 1, 7, 7, 1, 7]


@pytest.mark.parametrize(
    "groups",
    [
        GROUPS, np.array(GROUPS, "uint8"), [str(g) for g in GROUPS], [float(g) for g in GROUPS],
        [("k", g) for g in GROUPS],
        [(g,) * (1 + (g == 7)) for g in GROUPS], np.array(GROUPS, "M8[D]"), [g == 7 for g in GROUPS],
        [g - 5 for g in GROUPS], [{1: "x", 7: 7}[g] for g in GROUPS], np.array([str(g) for g in GROUPS], object),
        np.repeat(GROUPS, 2)[::2], (g for g in ()),
    ],
)  # fmt: skip
def test_groups_are_anything_that_compares(groups):
    X, y = data(8, 2)
    if not isinstance(groups, (list, np.ndarray)):
        with pytest.raises(ValueError, match="groups has shape"):
            rlslab.rolling(X, y, groups=groups)
        return
    expected = rlslab.rolling(X, y, groups=np.array(GROUPS), returns=ANSWERS)
    assert same(expected, rlslab.rolling(X, y, groups=groups, returns=ANSWERS)) == []
    assert expected.rows.tolist() == [1, 1, 2, 3, 2, 3, 4, 4]


def test_missing_groups():
    X, y = data(6, 2)
    days = np.array([1, "NaT", 1, 1, "NaT", 2], "M8[D]")
    for groups in ([1, None, 1, 1, None, 2], np.array([1, np.nan, 1, 1, np.nan, 2]), days):
        found = rlslab.rolling(X, y, groups=groups, returns=ANSWERS)
        np.testing.assert_array_equal(found.rows, [1, np.nan, 2, 3, np.nan, 1])
        assert np.isnan(found.theta[[1, 4]]).all()
    assert np.isnan(rlslab.rolling(X, y, groups=[None] * 6).theta).all()


@pytest.mark.parametrize(
    "options, error, words",
    [
        ({"window": 0}, ValueError, "window >= 1"), ({"window": 2.5}, TypeError, "whole number"),
        ({"window": "30D"}, TypeError, "whole number"), ({"window": 2**70}, ValueError, "memory"),
        ({"forgetting": 0}, ValueError, "0 < forgetting <= 1"), ({"forgetting": np.nan}, ValueError, "forgetting"),
        ({"forgetting": "a"}, TypeError, "forgetting"),
        ({"window": 3, "min_periods": 5}, ValueError, "min_periods <= window"),
        ({"min_periods": -1}, ValueError, "min_periods >= 0"), ({"returns": "bse"}, ValueError, "no answer 'bse'"),
        ({"returns": ("theta", 3)}, TypeError, "answer"), ({"groups": [1, 2]}, ValueError, "groups has shape"),
        ({"groups": np.zeros((4, 1))}, ValueError, "groups has shape"), ({"groups": 5}, ValueError, "groups has shape"),
        ({"groups": np.ma.array([1, 2, 3, 4])}, TypeError, "masked"),
        ({"groups": [[1], [2], [3], [4]]}, TypeError, "groups holds"),
    ],
)  # fmt: skip
def test_options_that_are_none(options, error, words):
    with pytest.raises(error, match=words) as raised:
        rlslab.rolling(np.ones((4, 1)), np.arange(4.0), **options)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    "X, y, error",
    [
        (np.ones((4, 0)), np.ones(4), ValueError), (np.ones((4, 1)), np.ones(3), ValueError), (3, 4, ValueError),
        (np.ones((4, 1)), np.ones((4, 1)), ValueError), (np.ones((4, 1), complex), np.ones(4), TypeError),
        ([["a"]], [1], TypeError), (np.ma.ones((4, 1)), np.ones(4), TypeError),
        (np.ones((2, 2, 2)), np.ones(2), ValueError),
    ],
)  # fmt: skip
def test_rows_that_are_none(X, y, error):
    with pytest.raises(error):
        rlslab.rolling(X, y)


def test_small_records():
    assert [a.shape for a in rlslab.rolling(np.zeros((0, 3)), [], window=3, groups=[])] == [(0, 3), (0, 3), (0,), (0,)]
    assert np.isnan(rlslab.rolling(np.zeros((5, 3)), np.zeros(5), 4).theta).all()
    found = rlslab.rolling(np.ones((4, 1)), np.arange(4.0), 2**60, min_periods=1)
    np.testing.assert_allclose(found.theta[:, 0], [0, 0.5, 1, 1.5], atol=1e-15)
    huge = rlslab.rolling(np.full((4, 1), 1e200), [np.inf, 1e200, 1e200, 1e200], 2)
    assert np.isnan(huge.theta[0, 0]) and huge.theta[3, 0] == pytest.approx(1)
    assert repr(rlslab.rolling([1.0], [2.0], returns="rows")) == "Rolled(rows (1,))"


def test_what_is_returned():
    X, y = data(9, 2)
    found = rlslab.rolling(X, y, returns=("sigma", "theta", "sigma"))
    sigma, theta = found
    assert sigma is found.sigma and theta is found.theta
    with pytest.raises(AttributeError, match="name it in returns"):
        found.r2
    with pytest.raises(AttributeError, match="colour"):
        found.colour
    assert np.array_equal(pickle.loads(pickle.dumps(found)).theta, theta, equal_nan=True)


def test_threads_of_python():
    X, y = data(4000, 3)
    expected, found = rlslab.rolling(X, y, 50, returns=ANSWERS), []

    def run():
        found.append(rlslab.rolling(X, y, 50, returns=ANSWERS))

    threads = [threading.Thread(target=run) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [same(expected, f) for f in found] == [[]] * 4


def test_pandas_is_not_imported():
    call = "rlslab.rolling([1.0, 2], [1.0, 2], groups=['a', 'b'])"
    code = f"import sys, rlslab; {call}; assert 'pandas' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_frames():
    pandas = pytest.importorskip("pandas")
    X, y = data(60, 3)
    days = pandas.date_range("2020-01-01", periods=60)
    frame = pandas.DataFrame(X, days, ["a", "b", "c"]).assign(y=y, g=pandas.Categorical(list("xyz") * 20))
    expected = rlslab.rolling(X, y, 9, groups=list("xyz") * 20, returns=ANSWERS)
    found = rlslab.rolling(frame[["a", "b", "c"]], frame["y"], 9, groups=frame["g"], returns=ANSWERS)
    assert same(expected, found) == []
    assert found.theta.columns.tolist() == ["a", "b", "c"] and found.t.index.equals(days)
    assert isinstance(found.sigma, pandas.Series) and found.sigma.name == "sigma" and found.r2.index.equals(days)
    one = rlslab.rolling(frame["a"], frame["y"], 9)
    assert one.theta.columns.tolist() == ["a"] and isinstance(rlslab.rolling(X, frame["y"]).theta, pandas.DataFrame)
    assert isinstance(rlslab.rolling(X, y, groups=frame["g"]).theta, np.ndarray)
    for nothing in (pandas.Series([None, "x"] * 30), pandas.Categorical([None, "x"] * 30)):
        assert np.isnan(rlslab.rolling(X, y, groups=nothing, returns="rows").rows[::2]).all()
    nullable = frame[["a", "b"]].convert_dtypes().mask(frame["b"] > 1)
    assert np.isnan(rlslab.rolling(nullable, y, 9).residual[frame["b"] > 1]).all()
    with pytest.raises(ValueError, match="y has another index than X"):
        rlslab.rolling(frame[["a"]], frame["y"].iloc[::-1], 9)
    with pytest.raises(ValueError, match="groups has another index"):
        rlslab.rolling(frame[["a"]], frame["y"], 9, groups=frame["g"].reset_index(drop=True))
    with pytest.raises(TypeError, match="column 'g'"):
        rlslab.rolling(frame[["a", "g"]], y)


@pytest.mark.filterwarnings("ignore")
def test_statsmodels_and_pandas_agree():
    pandas = pytest.importorskip("pandas")
    rolling = pytest.importorskip("statsmodels.regression.rolling")
    X, y = data(300, 3)
    X[40:45, 0], y[100] = np.nan, np.nan
    for options, own in (({}, {}), ({"min_nobs": 20, "expanding": True}, {"min_periods": 20})):
        fit = rolling.RollingOLS(y, X, 30, **options).fit(method="lstsq")
        found = rlslab.rolling(X, y, 30, returns=ANSWERS, **own)
        for name, theirs in (("theta", fit.params), ("t", fit.tvalues), ("error", fit.bse), ("r2", fit.rsquared),
                             ("sigma", np.sqrt(fit.mse_resid))):  # fmt: skip
            theirs = np.where(theirs == 0, np.nan, theirs) if name == "sigma" else theirs
            np.testing.assert_allclose(getattr(found, name), theirs, rtol=1e-7, err_msg=name)
    x, y = pandas.Series(X[:, 0]), pandas.Series(y)
    found = rlslab.rolling(np.column_stack([np.ones(300), x]), y, 30, min_periods=2, returns=("theta", "r2"))
    both = x.notna() & y.notna()
    slope = x.rolling(30, 2).cov(y) / x.where(both).rolling(30, 2).var()
    np.testing.assert_allclose(found.theta[1], slope.where(found.theta[1].notna()), rtol=1e-7)
    corr = x.rolling(30, 3).corr(y)
    own = np.sign(found.theta[1]) * np.sqrt(found.r2)
    np.testing.assert_allclose(own[corr.notna()], corr[corr.notna()], rtol=1e-7)


@pytest.mark.parametrize(
    ("groups", "rows"),
    [
        ([float("nan"), "a", "a"], [np.nan, 1, 2]),
        ([1, "1", 2], [1, 1, 1]),
        ([True, "True", False], [1, 1, 1]),
        ([2**53, 2**53 + 1, 0.5], [1, 1, 1]),
        (["a", "a\0", "b"], [1, 1, 1]),
        ((None, "a", "a"), [np.nan, 1, 2]),
        ([("a", 1), ("a", 1), "a"], [1, 2, 1]),
    ],
)
def test_groups_of_a_list_are_what_they_are(groups, rows):
    found = rlslab.rolling([1.0, 2, 3], [1.0, 2, 3], groups=groups, returns="rows").rows
    assert np.array_equal(found, np.array(rows, float), equal_nan=True)


def test_a_group_that_is_none_is_named():
    with pytest.raises(TypeError, match="groups holds list"):
        rlslab.rolling([1.0, 2], [1.0, 2], groups=[[1], [1]])


def test_a_gap_of_any_length_changes_no_answer():
    y = np.full(5000, np.nan)
    y[:50] = 1 + np.random.default_rng(0).standard_normal(50)
    for forgetting, last in ((0.9, 4999), (0.5, 900)):
        found = rlslab.rolling(np.ones((5000, 1)), y, forgetting=forgetting, returns=("sigma", "t", "error"))
        for answer in (found.sigma, found.t[:, 0], found.error[:, 0]):
            np.testing.assert_allclose(answer[49:last], answer[49], rtol=1e-9)
    assert np.isnan(found.sigma[-1]), "weights below 2^-1000"


def test_a_row_that_is_left_out_ends_no_constant():
    X, y = data(400, 2)
    expected = rlslab.rolling(X, y, 50, returns=("r2", "sigma"))
    X, y = np.vstack([X, np.zeros((1, 2))]), np.append(y, np.nan)
    found = rlslab.rolling(X, y, 50, returns=("r2", "sigma"))
    np.testing.assert_array_equal(found.r2[:400], expected.r2)
    np.testing.assert_array_equal(found.sigma[:400], expected.sigma)
