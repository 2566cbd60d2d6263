"""Time and digits of `rlslab.rolling` beside other ways to write a rolling regression in Python.

usage: PYTHONPATH=build/study/python /usr/bin/python3 bench/rolling_peers.py

Prints the tables of docs/rolling.md. Peers that are not there are left out. Ours and pandas take 10^6 rows, the others
so many that they end in seconds: their time a row does not depend on the number. Digits are the least over windows,
-log10 of the relative error of theta and of sigma, against the exact solution, by fractions.
"""

from __future__ import annotations

import math
import time
import warnings
from fractions import Fraction

import numpy as np

import rlslab

WINDOW = 250
warnings.simplefilter("ignore")


def ours(X, y):
    found = rlslab.rolling(X, y, window=WINDOW)
    return found.theta, found.sigma


def rolling_ols(method):
    def run(X, y):
        from statsmodels.regression.rolling import RollingOLS

        fit = RollingOLS(y, X, WINDOW).fit(method=method)
        fit.tvalues
        return fit.params, np.sqrt(fit.mse_resid)

    return run


def lstsq(X, y):
    theta, sigma = np.full(X.shape, np.nan), np.full(len(y), np.nan)
    for k in range(WINDOW - 1, len(y)):
        A, b = X[k + 1 - WINDOW : k + 1], y[k + 1 - WINDOW : k + 1]
        theta[k] = np.linalg.lstsq(A, b, rcond=None)[0]
        sigma[k] = math.sqrt(((b - A @ theta[k]) ** 2).sum() / (WINDOW - X.shape[1]))
    return theta, sigma


def sums(X, y):
    """Running sums of products and their differences, as in a data base or a data frame's expressions."""
    A = np.cumsum(np.concatenate([X, y[:, None]], axis=1)[:, :, None] * np.c_[X, y][:, None, :], axis=0)
    G = A[WINDOW - 1 :].copy()
    G[1:] -= A[:-WINDOW]
    d = X.shape[1]
    theta, sigma = np.full(X.shape, np.nan), np.full(len(y), np.nan)
    try:
        solved = np.linalg.solve(G[:, :d, :d], G[:, :d, d:])[:, :, 0]
    except np.linalg.LinAlgError:    # of one window, and no answer of any
        return theta, sigma
    theta[WINDOW - 1 :] = solved
    sigma[WINDOW - 1 :] = np.sqrt((G[:, d, d] - (G[:, :d, d] * solved).sum(1)) / (WINDOW - d))
    return theta, sigma


def pandas_cov(X, y):
    """The slope of one regressor beside a constant, and sigma from the variances."""
    import pandas

    x, v = pandas.Series(X[:, 1]), pandas.Series(y)
    cov, var = x.rolling(WINDOW).cov(v), x.rolling(WINDOW).var()
    slope = cov / var
    mean = v.rolling(WINDOW).mean() - slope * x.rolling(WINDOW).mean()
    rest = (v.rolling(WINDOW).var() - slope * cov) * (WINDOW - 1) / (WINDOW - 2)
    return np.column_stack([mean, slope]), np.sqrt(rest.to_numpy())


def exact(X, y):
    d = X.shape[1]
    rows = [[Fraction(v) for v in row] for row in np.c_[X, y].tolist()]
    A = [[sum(row[i] * row[j] for row in rows) for j in range(d + 1)] for i in range(d + 1)]
    for i in range(d):
        for k in range(i + 1, d + 1):
            c = A[k][i] / A[i][i]
            A[k] = [a - c * b for a, b in zip(A[k], A[i])]
    theta = [Fraction(0)] * d
    for i in reversed(range(d)):
        theta[i] = (A[i][d] - sum(A[i][j] * theta[j] for j in range(i + 1, d))) / A[i][i]
    return theta, A[d][d] / (WINDOW - d)


def digits(found, truth):
    theta, sigma = found
    right, square = truth
    off = sum((Fraction(float(a)) - b) ** 2 for a, b in zip(theta, right)) if np.isfinite(theta).all() else None
    of_theta = 0.0 if off is None else 16.0 if off == 0 else -0.5 * math.log10(off / sum(b * b for b in right))
    s = math.sqrt(square)
    of_sigma = 0.0 if not np.isfinite(sigma) else -math.log10(max(abs(sigma / s - 1), 1e-16))
    return min(max(of_theta, 0.0), 16.0), max(of_sigma, 0.0)


def data(d, rows, kind="white"):
    g = np.random.default_rng(1)
    X = g.standard_normal((rows, d))
    X[:, 0] = 1.0
    if kind == "far":
        X[:, 1:] += 1e5
    y = X.sum(1) + g.standard_normal(rows)
    if kind == "left":    # long before the windows that are judged
        X[300, 1:], y[300] = 1e12, -1e12
    return X, y


WAYS = {    # rows that are timed; of how many regressors
    "`rlslab.rolling`": (ours, 10**6, (2, 5)),
    "statsmodels' `RollingOLS`": (rolling_ols("inv"), 10**4, (2, 5)),
    "statsmodels' `RollingOLS`, `pinv`": (rolling_ols("pinv"), 3000, (2, 5)),
    "`numpy.linalg.lstsq` a window": (lstsq, 10**4, (2, 5)),
    "differences of running sums, numpy": (sums, 10**5, (2, 5)),
    "pandas' `cov` / `var`": (pandas_cov, 10**6, (2,)),
}


def main():
    kinds = ("white", "far", "left")
    print("| | ns a row, d = 2 | d = 5 | digits of theta, sigma: white | offset 1e5 | after 1e12 |")
    print("|---|---|---|---|---|---|")
    truths = {}
    for name, (run, rows, sizes) in WAYS.items():
        try:
            cells = []
            for d in (2, 5):
                if d not in sizes:
                    cells.append("")
                    continue
                X, y = data(d, rows)
                run(X[:1000], y[:1000])    # imports
                times = []
                for _ in range(3):
                    start = time.perf_counter_ns()
                    run(X, y)
                    times.append((time.perf_counter_ns() - start) / (rows - WINDOW))
                cells.append(f"{min(times):.0f}")
            for kind in kinds:
                d = sizes[-1]
                X, y = data(d, 2000, kind)
                theta, sigma = run(X, y)
                found = []
                for k in range(700, 2000, 130):
                    if (d, kind, k) not in truths:
                        truths[d, kind, k] = exact(X[k + 1 - WINDOW : k + 1], y[k + 1 - WINDOW : k + 1])
                    found.append(digits((theta[k], sigma[k]), truths[d, kind, k]))
                cells.append(", ".join(f"{min(column):.1f}" for column in zip(*found)))
        except ImportError:
            continue
        print(f"| {name} | " + " | ".join(cells) + " |", flush=True)
    X, y = data(5, 10**6)
    print("\n| `rlslab.rolling`, d = 5, 10^6 rows | seconds |\n|---|---|")
    group = np.random.default_rng(2).integers(0, 1000, 10**6)
    for words, options in {"window 250": {"window": 250}, "forgetting 0.99": {"forgetting": 0.99},
                           "window 250, 1000 groups": {"window": 250, "groups": group},
                           "window 100000": {"window": 100000}}.items():  # fmt: skip
        seconds = []
        for threads in (1, 2):
            rlslab.use_threads(threads)
            times = []
            for _ in range(3):
                start = time.perf_counter()
                rlslab.rolling(X, y, **options)
                times.append(time.perf_counter() - start)
            seconds.append(f"{min(times):.2f}")
        print(f"| {words}, one thread, two | {', '.join(seconds)} |", flush=True)


if __name__ == "__main__":
    main()
