"""Time and digits of the Python package beside other ways to write recursive least squares in Python.

usage: PYTHONPATH=build/study/python /usr/bin/python3 bench/python_peers.py [--beside build/study/bench/rlslab_bench_c]

Prints the table of docs/python.md. Rows that are not there are left out (statsmodels). Times are the least of many
stretches; digits are against the exact solution, by fractions. --beside: what Python adds to a row of `ud`, in turns
with that program's loop in C++.
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
        printed = subprocess.run([program, "200"], check=True, capture_output=True, text=True).stdout
        for found in re.finditer(r"\| `ud` \| double \| (\d+) \| ([0-9.]+) \|", printed):
            place = "C++", int(found[1])
            least[place] = min(least.get(place, math.inf), float(found[2]))
        for place, take in takes.items():
            least[place] = min(least.get(place, math.inf), least_time(take, ROWS, 5))
    print("| d | C++ | `update` | more | `update_many` | times as long |")
    print("|---|---|---|---|---|---|")
    for d in (4, 16):
        cpp, one, many = (least[way, d] for way in ("C++", "update", "update_many"))
        print(f"| {d} | {cpp:.1f} | {one:.1f} | {one - cpp:.1f} | {many:.1f} | {many / cpp:.3f} |")


def main():
    gc.disable()
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
