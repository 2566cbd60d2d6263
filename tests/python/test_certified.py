"""The certified solution: against exact rational arithmetic, and what is refused."""

import itertools
import math
import signal
import subprocess
import sys
import threading
import time
from fractions import Fraction

import numpy as np
import pytest
from data import rows
from test_input import SAME, refuses

import rlslab


def solved(A, b):
    """Gauss and Jordan on Fractions; any pivot will do."""
    M = [[*row, right] for row, right in zip(A, b)]
    for j in range(len(M)):
        pivot = next(i for i in range(j, len(M)) if M[i][j])
        M[j], M[pivot] = M[pivot], M[j]
        M[j] = [x / M[j][j] for x in M[j]]
        for i in range(len(M)):
            if i != j:
                M[i] = [x - M[i][j] * p for x, p in zip(M[i], M[j])]
    return [row[-1] for row in M]


def exact(X, y, forgetting=1.0, P0=None, theta0=None):
    """The minimiser as Fractions."""
    d, weight = X.shape[1], Fraction(forgetting)
    M = [[Fraction(0)] * d for _ in range(d)]
    b = [Fraction(0)] * d
    if P0 is not None:
        unit = [[Fraction(int(i == j)) for i in range(d)] for j in range(d)]
        columns = [solved([[Fraction(x) for x in row] for row in P0.tolist()], column) for column in unit]
        M = [[columns[j][i] for j in range(d)] for i in range(d)]
        if theta0 is not None:
            b = [sum(M[i][j] * Fraction(theta0[j]) for j in range(d)) for i in range(d)]
    for row, out in zip(X.tolist(), y.tolist()):
        psi = [Fraction(x) for x in row]
        M = [[weight * M[i][j] + psi[i] * psi[j] for j in range(d)] for i in range(d)]
        b = [weight * b[i] + psi[i] * Fraction(out) for i in range(d)]
    return solved(M, b)


def distance(a, b):
    """|a - b| / |b|, rounded up."""
    square = sum((x - z) ** 2 for x, z in zip(a, b)) / sum(z**2 for z in b)
    return math.sqrt(square) * (1 + 1e-9)


@pytest.mark.parametrize("d, forgetting, scale", itertools.product([1, 4], [1.0, 0.96], [1.0, 2.0**-300, 2.0**300]))
def test_the_bound_holds(d, forgetting, scale):
    X, y = rows(40, d, seed=d)
    X, y = X * scale, y * scale
    P0, theta0 = np.diag(np.arange(1.0, d + 1)) / scale**2, np.arange(d) / 3
    for prior in ({}, {"prior_covariance": P0, "prior_theta": theta0}):
        c = rlslab.certified(X, y, forgetting=forgetting, **prior)
        truth = exact(X, y, forgetting, *([P0, theta0] if prior else []))
        assert c.radius < 1e-30 and distance(c.theta, truth) <= c.radius
        assert all(isinstance(x, Fraction) and not x.denominator & (x.denominator - 1) for x in c.theta)
        given = np.asarray(c) * (1 + 2.0**-20)
        proven, measured = c.digits(given), -math.log10(distance([Fraction(x) for x in given], truth))
        assert proven <= measured + 1e-6 and abs(proven - measured) < 1e-6
        assert c.digits_worst(given) <= proven + 1e-9


def test_the_digits_that_are_asked_for():
    X, y = rows(30, 3)
    few, many = rlslab.certified(X, y), rlslab.certified(X, y, digits=400)
    assert many.radius < 1e-300    # in float64 no bound is less
    truth = exact(X, y)
    for i, text in enumerate(many.strings(200)):
        assert abs(Fraction(text) - truth[i]) <= Fraction(1, 2 * 10**199) * 10 * abs(truth[i])
    assert few.strings(10) == many.strings(10)
    assert few.covariance[0][1] == few.covariance[1][0] and len(few.covariance) == 3
    assert math.isinf(rlslab.certified([[2.0]], [4.0]).digits([2.0]))
    assert math.isnan(few.digits([math.nan, 0, 0]))
    wrong = [x + 1 for x in few.theta]
    assert distance(wrong, truth) > few.radius    # the bound can fail


@pytest.mark.parametrize("change", SAME)
def test_layouts_that_are_taken(change):
    X, y = rows(9, 3)
    assert rlslab.certified(change(X), change(y)).theta == rlslab.certified(X, y).theta
    assert rlslab.certified(X, y).digits(change(np.arange(3.0))) == rlslab.certified(X, y).digits([0, 1, 2])


def test_rows_that_miss_a_value_are_left_out():
    X, y = rows(20, 3)
    holes, gaps = X.copy(), y.copy()
    holes[4, 1] = gaps[7] = np.nan
    c = rlslab.certified(holes, gaps)
    assert (c.rows, c.skipped) == (18, 2)
    assert c.theta == rlslab.certified(np.delete(X, [4, 7], 0), np.delete(y, [4, 7])).theta


def test_what_is_refused():
    X, y = rows(6, 3)
    for call in (
        lambda: rlslab.certified(X, y[:-1]),
        lambda: rlslab.certified(X[0], y[:1]),
        lambda: rlslab.certified(X[:, :0], y),
        lambda: rlslab.certified(X[:0], y[:0]),
        lambda: rlslab.certified(X * np.nan, y),
        lambda: rlslab.certified(np.where(X == X[1, 1], np.inf, X), y),
        lambda: rlslab.certified(X[:2], y[:2]),
        lambda: rlslab.certified(np.column_stack([X, X[:, 0]]), y),
        lambda: rlslab.certified(X.astype(object), y),
        lambda: rlslab.certified(X + 1j, y),
        lambda: rlslab.certified(X, y, forgetting=0),
        lambda: rlslab.certified(X, y, forgetting=1.5),
        lambda: rlslab.certified(X, y, forgetting=math.nan),
        lambda: rlslab.certified(X, y, forgetting="1"),
        lambda: rlslab.certified(X, y, prior_variance=0),
        lambda: rlslab.certified(X, y, prior_variance=math.inf),
        lambda: rlslab.certified(X, y, prior_theta=[0, 0, 0]),
        lambda: rlslab.certified(X, y, prior_variance=1, prior_theta=[0, 0]),
        lambda: rlslab.certified(X, y, prior_variance=1, prior_covariance=np.eye(3)),
        lambda: rlslab.certified(X, y, prior_covariance=-np.eye(3)),
        lambda: rlslab.certified(X, y, prior_covariance=[[1, 2, 0], [0, 1, 0], [0, 0, 1]]),
        lambda: rlslab.certified(X, y, digits=0),
        lambda: rlslab.certified(X, y, digits=2.0),
        lambda: rlslab.certified(X, y).digits([1, 2]),
        lambda: rlslab.certified(X, y).strings(0),
    ):
        refuses(call)
    refuses(lambda: type(rlslab.certified(X, y)._solution)(), TypeError)


def test_threads():
    """They run at once, each with its own numbers."""
    X, y = rows(200, 4)
    found = {}

    def solve(i):
        found[i] = rlslab.certified(X[: 50 + i], y[: 50 + i], forgetting=0.99).theta

    threads = [threading.Thread(target=solve, args=(i,)) for i in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(found[i] == rlslab.certified(X[: 50 + i], y[: 50 + i], forgetting=0.99).theta for i in range(8))


LONG = """
import signal
import numpy as np, rlslab
signal.signal(signal.SIGINT, signal.default_int_handler)  # which a job in a shell's background ignores
X = np.random.default_rng(1).standard_normal((10**5, 40))
print("started", flush=True)
rlslab.certified(X, X @ np.ones(40), forgetting=0.99, digits=10000)
"""


def test_an_interrupt_ends_it():
    """Alone it takes ten minutes."""
    with subprocess.Popen([sys.executable, "-c", LONG], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as child:
        try:
            assert child.stdout.readline() == b"started\n"
            time.sleep(1)
            child.send_signal(signal.SIGINT)
            _, said = child.communicate(timeout=100)
        finally:
            child.kill()
    assert said.splitlines()[-1] == b"KeyboardInterrupt" and child.returncode != 0


def test_handlers_of_signals_run_meanwhile():
    """Without changing a number. After the call a handler would run once, on the line that made it."""
    X, y = rows(10**4, 12)
    at = []

    def handle(_, frame):
        if frame.f_code is rlslab.certified.__code__:
            at.append(frame.f_lineno)
        if at == [frame.f_lineno]:
            assert rlslab.certified(X[:20], y[:20]).rows == 20

    before = signal.signal(signal.SIGALRM, handle)
    signal.setitimer(signal.ITIMER_REAL, 0.02, 0.02)
    try:
        n = most = 0
        while most < 4 and n < len(X):
            n += 500
            at.clear()
            found = rlslab.certified(X[:n], y[:n], forgetting=0.99, digits=10000)
            most = max(map(at.count, at), default=0)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert most >= 4
    assert found.theta == rlslab.certified(X[:n], y[:n], forgetting=0.99, digits=10000).theta


def test_without_the_extension(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "rlslab._reference", None)
    refuses(lambda: rlslab.certified([[1.0]], [1.0]), ImportError)
