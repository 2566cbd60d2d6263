"""Time and digits of the Python package beside other ways to write recursive least squares in Python.

usage: PYTHONPATH=build/study/python /usr/bin/python3 bench/python_peers.py [--beside PROGRAM | --blocks]

Prints the table of docs/python.md. Rows that are not there are left out (statsmodels). Times are the least of many
stretches; digits are against the exact solution, by fractions. --beside: what Python adds to a row of `ud`, in turns
with that program's loop in C++ (build/study/bench/rlslab_bench_c) over as many rows. --blocks: blocks of rows, many
outputs, beside the update that papers on continual learning print, in numpy.
"""

from __future__ import annotations

import gc
import math
import re
import subprocess
import sys
import time
import warnings
from fractions import Fraction

import numpy as np

import rlslab

ROWS, VARIANCE = 400, 16384.0    # of the prior, the same for all


def exact(Psi, y, prior=True):
    """theta of (Psi'Psi + I/c^2) theta = Psi'y, as fractions."""
    d = Psi.shape[1]
    ridge = 1 / Fraction(VARIANCE) if prior else Fraction(0)
    A = [[ridge if i == j else Fraction(0) for j in range(d + 1)] for i in range(d)]
    for row, output in zip(Psi.tolist(), y.tolist()):
        psi = [Fraction(x) for x in row]
        for i in range(d):
            for j in range(d):
                A[i][j] += psi[i] * psi[j]
            A[i][d] += psi[i] * Fraction(output)
    for i in range(d):    # definite: no pivot is zero
        for k in range(i + 1, d):
            c = A[k][i] / A[i][i]
            A[k] = [a - c * b for a, b in zip(A[k], A[i])]
    theta = [Fraction(0)] * d
    for i in reversed(range(d)):
        theta[i] = (A[i][d] - sum(A[i][j] * theta[j] for j in range(i + 1, d))) / A[i][i]
    return theta


def digits(theta, solution):
    error = sum((Fraction(float(a)) - b) ** 2 for a, b in zip(theta, solution))
    return math.inf if error == 0 else -0.5 * math.log10(error / sum(b * b for b in solution))


class Padasip:
    """FilterRLS of padasip, its formulas: R = (R - R x x' R / (mu + x' R x)) / mu, w += R x e."""

    def __init__(self, d):
        self.R, self.w, self.mu = VARIANCE * np.eye(d), np.zeros(d), 1.0

    def update(self, x, y):
        e = y - np.dot(self.w, x)
        top = self.R @ (x[:, None] * x[None, :]) @ self.R
        self.R = 1 / self.mu * (self.R - top / (self.mu + np.dot(np.dot(x, self.R), x)))
        self.w = self.w + np.dot(self.R, x) * e

    @property
    def theta(self):
        return self.w


class Filterpy:
    """KalmanFilter of filterpy, its formulas for constant parameters: a gain by an inverse, P in Joseph's form."""

    def __init__(self, d):
        self.P, self.x, self.eye, self.r = VARIANCE * np.eye(d), np.zeros((d, 1)), np.eye(d), np.eye(1)

    def update(self, psi, y):
        H = psi[None, :]
        e = y - H @ self.x
        PHt = self.P @ H.T
        K = PHt @ np.linalg.inv(H @ PHt + self.r)
        self.x = self.x + K @ e
        A = self.eye - K @ H
        self.P = A @ self.P @ A.T + K @ self.r @ K.T

    @property
    def theta(self):
        return self.x[:, 0]


def least_time(call, rows, stretches):
    out = math.inf
    for _ in range(stretches):
        start = time.perf_counter_ns()
        call()
        out = min(out, (time.perf_counter_ns() - start) / rows)
    return out


def data(d, dependent=False):
    generator = np.random.default_rng(1)
    Psi = generator.standard_normal((ROWS, d))
    if dependent:
        Psi[:, 1] = Psi[:, 0] + 1e-4 * Psi[:, 1]
    return Psi, Psi @ np.ones(d) + 0.1 * generator.standard_normal(ROWS)


def by_rows(make):
    def run(Psi, y):
        f = make(Psi.shape[1])
        rows = list(zip(list(Psi), y.tolist()))

        def take():
            for psi, output in rows:
                f.update(psi, output)

        return f, take

    return run


def at_once(make):
    def run(Psi, y):
        f = make(Psi.shape[1])
        return f, lambda: f.update_many(Psi, y)

    return run


def statsmodels(Psi, y):
    from statsmodels.regression.recursive_ls import RecursiveLS

    class Fit:
        theta = np.zeros(0)

    def take():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            Fit.theta = RecursiveLS(y, Psi).fit().params

    return Fit, take


WAYS = {
    "`rlslab.Ud`, `update_many`": at_once(rlslab.Ud),
    "`rlslab.Ud`, `update`": by_rows(rlslab.Ud),
    "`rlslab.Ud(dtype=\"float32\")`, `update`": by_rows(lambda d: rlslab.Ud(d, dtype="float32")),
    "`rlslab.Qr`, `update_many`": at_once(rlslab.Qr),
    "`rlslab.Conventional`, `update`": by_rows(rlslab.Conventional),
    "padasip's formulas": by_rows(Padasip),
    "filterpy's formulas": by_rows(Filterpy),
    "statsmodels' `RecursiveLS`": statsmodels,
}


def beside(program, turns=40):
    """Turns of both, some milliseconds each; the least of all turns."""
    ways = {"update": by_rows(rlslab.Ud), "update_many": at_once(rlslab.Ud)}
    takes = {(way, d): run(*data(d))[1] for way, run in ways.items() for d in (4, 16)}
    least = {}
    for _ in range(turns):
        printed = subprocess.run([program, "30", str(ROWS)], check=True, capture_output=True, text=True).stdout
        for found in re.finditer(r"\| `ud` \| double \| (\d+) \| ([0-9.]+) \|", printed):
            place = "C++", int(found[1])
            least[place] = min(least.get(place, math.inf), float(found[2]))
        for place, take in takes.items():
            least[place] = min(least.get(place, math.inf), least_time(take, ROWS, 30))
    print("| d | C++ | `update` | more | `update_many` | times as long |")
    print("|---|---|---|---|---|---|")
    for d in (4, 16):
        cpp, one, many = (least[way, d] for way in ("C++", "update", "update_many"))
        print(f"| {d} | {cpp:.1f} | {one:.1f} | {one - cpp:.1f} | {many:.1f} | {many / cpp:.3f} |")


# The published case: d = 768 random features of 64 inputs, 10 classes, 24 blocks of 256 rows, a ridge of 0.1.
D, K, BLOCKS, CLASSES, RIDGE = 768, 256, 24, 10, 0.1


def blocks_of(dtype):
    g = np.random.default_rng(7)
    W, centres = g.standard_normal((64, D)) / 8, g.standard_normal((CLASSES, 64))
    for _ in range(BLOCKS):
        label = g.integers(0, CLASSES, K)
        X = np.maximum((centres[label] + 0.7 * g.standard_normal((K, 64))) @ W, 0).astype(np.float32)
        yield np.ascontiguousarray(X, dtype), np.eye(CLASSES, dtype=dtype)[label]


class Published:
    """R -= R X'(I + X R X')^-1 X R, W += R X'(Y - X W), with the new R."""

    def __init__(self, dtype, by_cholesky):
        self.R, self.theta = np.eye(D, dtype=dtype) / dtype(RIDGE), np.zeros((D, CLASSES), dtype)
        self.by_cholesky = by_cholesky

    def update_many(self, X, Y):
        RX = self.R @ X.T
        S = X @ RX + np.eye(len(X), dtype=X.dtype)
        if self.by_cholesky:
            L = np.linalg.cholesky(S)
            K_t = np.linalg.solve(L.T, np.linalg.solve(L, RX.T))
            self.R, self.theta = self.R - RX @ K_t, self.theta + K_t.T @ (Y - X @ self.theta)
        else:
            self.R = self.R - RX @ np.linalg.inv(S) @ (X @ self.R)
            self.theta = self.theta + self.R @ X.T @ (Y - X @ self.theta)


class Gram:
    """X'X and X'Y, and one solve at the end."""

    def __init__(self, dtype):
        self.H, self.b = RIDGE * np.eye(D, dtype=dtype), np.zeros((D, CLASSES), dtype)

    def update_many(self, X, Y):
        self.H += X.T @ X
        self.b += X.T @ Y

    @property
    def theta(self):
        return np.linalg.solve(self.H, self.b)


def blocks():
    def ours(kind):
        return lambda dtype: kind(D, outputs=CLASSES, prior_variance=1 / RIDGE, dtype=np.dtype(dtype).name)

    ways = {"`rlslab.QrBlock`": ours(rlslab.QrBlock), "`rlslab.JosephRankTwo`": ours(rlslab.JosephRankTwo),
            "published, inverse": lambda dtype: Published(dtype, False),
            "published, by Cholesky, K e": lambda dtype: Published(dtype, True), "Gram, one solve": Gram}
    truth = None
    print("| | error, float32 | ms a block | error, float64 | ms a block |")
    print("|---|---|---|---|---|")
    for name, make in ways.items():
        cells = []
        for dtype in (np.float64, np.float32):
            rows, times = list(blocks_of(dtype)), []
            for _ in range(3):
                f = make(dtype)
                start = time.perf_counter()
                for X, Y in rows:
                    f.update_many(X, Y)
                theta = np.asarray(f.theta, np.float64)
                times.append((time.perf_counter() - start) / BLOCKS * 1e3)
            truth = theta if truth is None else truth
            error = np.linalg.norm(theta - truth) / np.linalg.norm(truth)
            cells[:0] = ["taken as right" if theta is truth else f"{error:.0e}", f"{min(times):.1f}"]
        print(f"| {name} | " + " | ".join(cells) + " |", flush=True)


def main():
    gc.disable()
    if sys.argv[1:2] == ["--blocks"]:
        return blocks()
    if sys.argv[1:2] == ["--beside"]:
        return beside(*sys.argv[2:3])
    print("| | ns a row, d = 4 | d = 16 | digits, white | digits, dependent |")
    print("|---|---|---|---|---|")
    for name, run in WAYS.items():
        try:
            cells = []
            for d in (4, 16):
                _, take = run(*data(d))
                slow = name.startswith("statsmodels")
                cells.append(f"{least_time(take, ROWS, 3 if slow else 60):.0f}")
            for dependent in (False, True):
                Psi, y = data(5, dependent)
                f, take = run(Psi, y)
                take()
                cells.append(f"{digits(f.theta, exact(Psi, y, not name.startswith('statsmodels'))):.1f}")
        except ImportError:
            continue
        print(f"| {name} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
