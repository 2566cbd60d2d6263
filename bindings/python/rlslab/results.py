"""Recursive least squares of a record with the words of statsmodels: params, bse, cusum and the others.

The sums are the filter's own: theta, the inverse of P and the steps of each row.
"""

from __future__ import annotations

import bisect
import statistics
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _rows, filter

Floats = NDArray[np.float64]
_NORMAL = statistics.NormalDist()


def _scaled(X: Floats) -> Floats:
    """Each column over its largest number, which is what its rounding is relative to."""
    most = np.abs(X).max(axis=0)
    scaled: Floats = X / np.where(most > 0, most, 1)
    return scaled


def _ranks(X: Floats) -> list[int]:
    """The first row at which the rows so far have rank 1, ..., d, by which theta is determined; else ValueError."""
    n, d = X.shape
    if not np.isfinite(X).all():
        row = int(np.flatnonzero(~np.isfinite(X).all(axis=1))[0])
        raise ValueError(f"exog[{row}] holds a number that is not finite; leave such rows out")
    scaled = _scaled(X)

    def rank(k: int) -> int:
        return int(np.linalg.matrix_rank(scaled[: k + 1]))

    out = [bisect.bisect_left(range(n), r, key=rank) for r in range(1, d + 1)]
    if out[-1] == n:
        raise ValueError("the rows do not determine theta: columns of exog are dependent")
    return out


def _independent(scaled: Floats) -> list[int]:
    """Columns, the first ones, on which all others depend."""
    out: list[int] = []
    for j in range(scaled.shape[1]):
        if np.linalg.matrix_rank(scaled[:, np.array([*out, j])]) > len(out):
            out.append(j)
    return out


def _too_near(row: int) -> ValueError:
    return ValueError(
        f"columns of exog depend on one another but for rounding in its first {row + 1} rows: take offsets off them "
        "(the rows less one of them, but for the constant), or begin with other rows"
    )


class RecursiveLS:
    """Least squares of y on X by `rlslab.Qr` without prior, row by row, without forgetting.

    Parameters
    ----------
    endog : array_like, shape (n,)
        y.
    exog : array_like, shape (n, d)
        The regressors, with a column of ones for a constant. n > d.

    Attributes
    ----------
    params : ndarray, shape (d,)
        theta after the last row.
    scale : float
        The noise's variance: the sum of squared recursive residuals over n - d.
    bse : ndarray, shape (d,)
        Standard errors: the roots of scale diag(P).
    tvalues, pvalues : ndarray, shape (d,)
        params / bse; two-sided probabilities by the normal distribution.
    resid_recursive : ndarray, shape (n,)
        w = innovation sqrt(gamma), which are independent with the noise's variance; NaN for the d rows that no row
        before them can predict: the first d, or that in which a dummy first differs from the other columns.
    recursive_coefficients : ndarray, shape (n, d)
        theta after each row; NaN before it is determined.
    cusum, cusum_squares : ndarray, shape (n - d,)
        Sums of w over their standard deviation; sums of their squares over the last of these sums.
    nobs, df_model, df_resid : int

    Raises
    ------
    ValueError
        For shapes that do not fit, n <= d, rows that do not determine theta, and rows that do but for rounding only.

    Examples
    --------
    >>> from rlslab.results import RecursiveLS
    >>> x = np.arange(6.0)
    >>> fit = RecursiveLS([1.1, 2.9, 5.1, 6.9, 9.1, 10.9], np.column_stack([np.ones(6), x]))
    >>> fit.params.round(3), fit.nobs
    (array([1.043, 1.983]), 6)
    >>> fit.conf_int().shape
    (2, 2)
    """

    def __init__(self, endog: ArrayLike, exog: ArrayLike) -> None:
        given = _rows.numbers(exog, "exog")
        if given.ndim != 2:
            raise ValueError(f"exog has shape {given.shape}, expected (n, d)")
        d = given.shape[1]
        n, outputs = len(given), _rows.numbers(endog, "endog")
        if outputs.shape != (n,):
            raise ValueError(f"endog has shape {outputs.shape}, expected ({n},) as exog has {n} rows")
        X, y = _rows.block(given.astype(np.float64), outputs.astype(np.float64), d)
        if not np.isfinite(y).all():
            raise ValueError(f"endog[{int(np.argmin(np.isfinite(y)))}] is not finite; leave such rows out")
        if not n > d > 0:
            raise ValueError(f"{n} rows do not determine {d} parameters and a variance")
        f = filter("qr", d, prior_variance=None)
        self.resid_recursive: Floats = np.full(n, np.nan)
        self.recursive_coefficients: Floats = np.full((n, d), np.nan)
        ranks = _ranks(X)
        for k in range(n):
            step = f.update(X[k], float(y[k]))
            if k > ranks[-1]:
                self.resid_recursive[k] = step.innovation * np.sqrt(step.gamma)
            if k >= ranks[-1]:
                self.recursive_coefficients[k] = f.theta
        most, of_y = np.abs(X).max(axis=0), np.abs(y).max()
        beyond = (
            "float64 does not hold the squares of these numbers: scale them (columns of exog of up to "
            f"{most.min():.1e} to {most.max():.1e}, endog of up to {of_y:.1e})"
        )
        health = f.copy().pass_time().health    # the last step tells of the rows before it
        if health != "sound":
            raise ValueError(beyond if health == "nonfinite" else f"the rows do not determine theta: health {health}")
        scaled = _scaled(X)
        self.resid_recursive[: ranks[0]] = y[: ranks[0]]    # rows of zeros
        for r, (first, last) in enumerate(zip(ranks, ranks[1:]), 1):
            if last > first + 1:    # rows that r columns predict before the others show
                seen, of = slice(first + 1, last), filter("qr", r, prior_variance=None)
                columns = _independent(scaled[:last])
                if len(columns) != r:
                    raise _too_near(last)
                steps = of.update_many(X[:last, columns], y[:last], steps=True)[seen]
                self.resid_recursive[seen] = steps["innovation"] * np.sqrt(steps["gamma"])
        self.nobs, self.df_model, self.df_resid = n, d, n - d
        self.params: Floats = np.asarray(f.theta, dtype=np.float64)
        w = self._seen()
        if len(w) != n - d:    # the filter asks for more than a rank: a pivot above its own rounding
            raise _too_near(int(np.flatnonzero(np.isnan(self.resid_recursive))[-1]))
        P = np.empty((d, d))
        with np.errstate(all="ignore"):
            self.scale = float(np.sum(w**2)) / (n - d)
            for j, psi in enumerate(np.eye(d)):    # K = P psi gamma of one row more, solved for with R
                after = f.copy()
                P[j] = np.float64(after.update(psi, self.params[j]).gamma) ** -1 * after.gain
            self.normalized_cov_params: Floats = (P + P.T) / 2
            self.bse: Floats = np.sqrt(self.scale * np.diag(P))
        least = np.finfo(float).tiny    # a smaller number has lost digits
        squares = np.array([*np.diag(P), self.scale if w.any() else 1.0])
        if not (np.isfinite(self.bse).all() and (squares >= least).all()):
            raise ValueError(beyond)
        with np.errstate(divide="ignore", invalid="ignore"):
            self.tvalues: Floats = self.params / self.bse
            self.cusum: Floats = np.cumsum(w) / np.std(w, ddof=1)
            self.cusum_squares: Floats = np.cumsum(w**2) / np.sum(w**2)
        self.pvalues: Floats = np.array([2 * _NORMAL.cdf(-abs(t)) if t == t else np.nan for t in self.tvalues])

    def _seen(self) -> Floats:
        """The recursive residuals of the rows that theta could predict."""
        seen: Floats = self.resid_recursive[np.isfinite(self.resid_recursive)]
        return seen

    def conf_int(self, alpha: float = 0.05) -> Floats:
        """Intervals that cover theta with probability 1 - alpha, by the normal distribution; shape (d, 2)."""
        if not 0 < alpha < 1:
            raise ValueError("expected 0 < alpha < 1")
        half = _NORMAL.inv_cdf(1 - alpha / 2) * self.bse
        return np.column_stack([self.params - half, self.params + half])

    def summary(self) -> str:
        """A table: coefficients, standard errors, t, p and intervals of 95 %."""
        lines = [
            f"Recursive least squares: {self.nobs} rows, {self.df_model} parameters, noise variance {self.scale:.4g}",
            f"{'':>6}{'coef':>12}{'std err':>12}{'t':>10}{'P>|t|':>8}{'[0.025':>12}{'0.975]':>12}",
        ]
        for i, (low, high) in enumerate(self.conf_int()):
            lines.append(
                f"{'x' + str(i + 1):>6}{self.params[i]:12.4g}{self.bse[i]:12.4g}{self.tvalues[i]:10.3f}"
                f"{self.pvalues[i]:8.3f}{low:12.4g}{high:12.4g}"
            )
        return "\n".join(lines)
