"""Estimators for scikit-learn."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray
from scipy.special import stdtrit  # type: ignore[import]
from sklearn.base import RegressorMixin  # type: ignore[import]
from sklearn.utils.validation import check_is_fitted, column_or_1d  # type: ignore[import]

from . import HEALTHS, SIGNALS, Filter, Outputs, _options, filter
from ._classifier import RLSClassifier
from ._linear import EstimatorsQrBlock, Linear, reference, validated, with_advice

__all__ = ["RLSClassifier", "RLSRegressor"]

Self = TypeVar("Self", bound="RLSRegressor")


class RLSRegressor(RegressorMixin, Linear):  # type: ignore[misc]
    """Linear regression by recursive least squares: rows can come in parts, and old ones can be forgotten.

    There is no prior, so that no unit, offset or scale of the data changes the answer. The variants that can start so
    are `qr`, `qr_block`, `gentleman` and `information`.

    Parameters
    ----------
    variant : str
        One of `rlslab.variants()`.
    prior_variance : float or None
        c^2 of P0 = c^2 I. It pulls theta, the constant too, towards 0 by about P theta / c^2, in units of the data; the
        other variants need it.
    forgetting, dtype, window, guard, guard_options, control
        As of `rlslab.Filter`. A guard skips the rows of X that are not finite.
    fit_intercept : bool
        Whether a constant is estimated, too.

    Attributes
    ----------
    coef_ : ndarray of shape (n_features,), or (m, n_features) of m columns of y
        NaN after `partial_fit` where the rows so far do not determine them (of several columns of y, and with a window,
        until they do).
    intercept_ : float, or ndarray of shape (m,)
    n_features_in_ : int
    noise_variance_ : float
        Of y, one column, about its prediction: the mean of gamma e^2 / (gamma + r lambda (1 - gamma)), e the innovation
        and r = (1 + lambda^n) / (1 + lambda), over the rows taken, weighted as by `forgetting`, of a window the last.
        Rows that a guard sets aside do not enter, nor those before it started again, nor those of gamma <= 0.001, which
        show theta. NaN for too few rows.
    noise_degrees_ : float
        Of freedom of `noise_variance_`: (sum w)^2 / sum w^2 of the rows that entered, of weights w = lambda^(n-k). So
        n - d at lambda 1 without a prior; as rows are forgotten it grows to (1 + lambda) / (1 - lambda) alone.
    filter_ : rlslab.Filter, or rlslab.Outputs of several columns of y
        With `fit_intercept` its rows are those of X less the first, and a 1; its outputs are y less the first. Where
        that is an outlier beside the others of its call, their median stands for it. So it does not merge with
        another's.

    Examples
    --------
    >>> from rlslab.sklearn import RLSRegressor
    >>> X = np.array([[0.0], [1.0], [2.0], [3.0]])
    >>> model = RLSRegressor().partial_fit(X[:2], [1, 3]).partial_fit(X[2:], [5, 7])
    >>> model.predict([[4.0]]).round(2)
    array([9.])
    """

    def __init__(
        self,
        variant: str = "qr",
        *,
        forgetting: float = 1.0,
        prior_variance: float | None = None,
        dtype: DTypeLike = "float64",
        window: int = 0,
        guard: str | None = None,
        guard_options: Mapping[str, float] | None = None,
        control: _options.Control = None,
        fit_intercept: bool = True,
    ) -> None:
        self.variant = variant
        self.forgetting = forgetting
        self.prior_variance = prior_variance
        self.dtype = dtype
        self.window = window
        self.guard = guard
        self.guard_options = guard_options
        self.control = control
        self.fit_intercept = fit_intercept

    def fit(self: Self, X: ArrayLike, y: ArrayLike) -> Self:
        """Forget all and process these rows, the oldest first; y is of shape (n,), or (n, m).

        ValueError for data that are not finite, for rows that do not determine theta, and where theta is none that they
        determine: their squares overflow, or vanish, or a guard's own P outweighs them.
        """
        return self._fitted(X, y, first=True, whole=True)

    def partial_fit(self: Self, X: ArrayLike, y: ArrayLike) -> Self:
        """Process these rows after those before.

        ValueError as of `fit`, but for rows that do not determine theta yet, or that a guard sets aside.
        """
        return self._fitted(X, y, first=not hasattr(self, "filter_"), whole=False)

    def _fitted(self: Self, X: ArrayLike, y: ArrayLike, first: bool, whole: bool) -> Self:
        rows, outputs = validated(
            self, X, y, y_numeric=True, multi_output=True, reset=first, finite=self.guard is None
        )
        if outputs.shape[1:] == (1,):
            outputs = column_or_1d(outputs, warn=True)
        several = outputs.ndim == 2
        if several and (self.guard is not None or self.window or self.control is not None):
            raise ValueError("several columns of y: without guard, window and control")
        if several and (first or isinstance(self.filter_, Outputs)):
            self._expect_range(rows, first)
        if first:
            self._start_several(outputs.shape[1]) if several else self._start()
        elif several != isinstance(self.filter_, Outputs) or outputs.shape[1:] != self._first_y.shape:
            raise ValueError(f"y has shape {outputs.shape}, not (n,) + {self._first_y.shape} as before")
        if not several:
            self._expect_an_answer(rows, outputs, self._process(rows, outputs), whole)
            return self
        if first and self.fit_intercept:
            self._first, self._first_y = reference(rows), reference(outputs)
        self._take_several(rows, outputs, whole)
        return self

    def predict(self, X: ArrayLike, return_std: bool = False, interval: float | None = None) -> Any:
        """X theta, and on request how far the next y may be from it: noise and theta's error together.

        Parameters
        ----------
        X : array_like, shape (n, n_features)
        return_std : bool
            Also the standard deviation of y about the mean, s sqrt(1 + r psi'P psi), shape (n,): s^2 is
            `noise_variance_`, r as there, after all rows.
        interval : float, optional
            Also the limits between which y is with this probability, in (0, 1): shape (n, 2), the mean -+ t of these
            deviations, t Student's quantile at (1 + interval) / 2 with `noise_degrees_` of freedom. As statsmodels'
            `get_prediction(X).conf_int(obs=True)` where nothing is forgotten and there is no prior. NaN for too few
            rows. With forgetting it is for stationary rows, to first order in d (1 - lambda).

        Returns
        -------
        The mean, shape (n,) or (n, m), or a pair of it and what was requested.

        Raises
        ------
        ValueError
            For both of them, another `interval`, and for several columns of y, which have neither.
        """
        check_is_fitted(self)
        valid = validated(self, X, reset=False)
        if interval is not None:
            interval = _options.real(interval, "interval")
            if return_std or not 0 < interval < 1:
                raise ValueError(f"interval: expected a probability in (0, 1), without return_std, found {interval!r}")
        if isinstance(self.filter_, Outputs):
            if return_std or interval is not None:
                raise ValueError("return_std and interval are of one column of y")
            return self._predicted(valid)
        rows = self._rows(valid)
        mean = rows @ self.filter_.theta.astype(np.float64)    # less the reference of y
        if not return_std and interval is None:
            return mean + self._first_y
        along = np.array([self._along(row, y) for row, y in zip(rows, mean)])
        deviation = np.sqrt(self.noise_variance_ * (1 + self._share(self._n) * along))
        mean = mean + self._first_y
        if interval is None:
            return mean, deviation
        q = -stdtrit(self.noise_degrees_, (1 - interval) / 2)
        return mean, np.column_stack([mean - q * deviation, mean + q * deviation])

    def _expect_an_answer(self, X: NDArray[Any], y: NDArray[Any], steps: NDArray[np.void], whole: bool) -> None:
        """ValueError where theta is no number, or is not of these rows."""
        theta = np.append(self.coef_, self.intercept_)
        if not whole and (self.guard is not None or (np.isfinite(theta).all() and not steps["health"][-1])):
            return
        finite = np.isfinite(X).all(axis=1)
        if not finite.any():
            raise ValueError("no row of X is finite")
        most = np.abs(X[finite]).max(axis=0)
        sizes = f"columns of X of up to {most.min():.1e} to {most.max():.1e}, y of up to {np.abs(y).max():.1e}"
        if self.prior_variance is not None:
            sizes += f", prior_variance {self.prior_variance:.1e}"
        held = f"squares {self.filter_.dtype} does not hold ({sizes})"
        memory = ", keep more rows in memory" if self.forgetting < 1 or self.window or self.control else ""
        now = self.filter_.copy()
        if whole and self.window and self.guard is None:    # time would drop one of its rows: the same rows, all kept
            now = self._made(window=0)
            now.update_many(self._rows(X[-self.window :]), y[-self.window :] - self._first_y)
        after = now.pass_time().health    # the last step tells of the rows before it
        if whole and after == "undetermined":
            among = ", the constant among them" if self.fit_intercept else ""
            raise ValueError(
                f"n_samples = {len(X)}: the rows do not determine {self.filter_.size} parameters{among}: leave out "
                f"columns that depend on others, scale those whose {held}{memory}, or give prior_variance"
            )
        last = HEALTHS[steps["health"][-1]] if self.guard is None else after
        health = next((h for h in (after, last) if h in ("nonfinite", "indefinite")), "sound")
        lost = steps["health"][-self.window :] == HEALTHS.index("nonfinite")
        none = after == "sound" and not np.isfinite(theta).all()
        if health != "sound" or none or (whole and (lost & finite[-self.window :]).sum() >= (~lost).sum()):
            other = "another variant" if self.filter_.dtype == np.float64 else "another variant, or float64"
            raise ValueError(
                f"the rows leave no theta, health {health}: scale what has {held}{memory}, or take {other}"
            )
        if whole and self._outweighed(X[finite]):
            raise ValueError(
                "the guard's limit of P, or its new start, outweighs the rows: scale them, or set largest_variance of "
                f"guard_options ({sizes})"
            )

    def _outweighed(self, X: NDArray[Any]) -> bool:
        """Whether a guard put more into P^-1 than all rows have of some column: by a restart, or by its limit of P."""
        counts, limit = self.filter_.counts, (self.guard_options or {}).get("largest_variance")
        own = self.guard is not None and (limit is None or counts.breakdowns + counts.changes > 0)
        if not own or self.prior_variance is not None or self.control is not None:
            return False
        return bool((np.diag(self.filter_.information) > 2 * (self._rows(X) ** 2).sum(axis=0)).any())

    def _along(self, psi: NDArray[Any], y: float) -> float:
        """psi'P psi, of the gain that this row would have: offsets and scales cost it no digits, as they do in P."""
        if self.control is None:
            gamma = float(self.filter_.copy().update(psi, y).gamma)    # 0: not determined
            return self.forgetting * (1 / gamma - 1) if gamma > 0 else np.nan
        f = self.filter_
        return float(psi @ (f.covariance @ psi if f._reports_covariance else np.linalg.solve(f.information, psi)))

    def _share(self, n: Any) -> Any:
        """r after n rows; 1 where a rule of its own forgets."""
        if self.control is not None:
            return 1.0
        memory = np.minimum(n, self.window) if self.window else n
        return (1 + self.forgetting**memory) / (1 + self.forgetting)

    def _made(self, window: int) -> Filter:
        make: Any = EstimatorsQrBlock if self.variant == "qr_block" else functools.partial(filter, self.variant)
        made: Filter = make(
            self.n_features_in_ + bool(self.fit_intercept), forgetting=self.forgetting,
            prior_variance=self.prior_variance, dtype=self.dtype, window=window, guard=self.guard,
            guard_options=self.guard_options, control=self.control,
        )  # fmt: skip
        return made

    def _start(self) -> None:
        if self.prior_variance == np.inf:
            raise ValueError("expected a finite prior_variance, or None: no prior")
        try:
            self.filter_ = self._made(self.window)
        except ValueError as error:
            raise with_advice(error) from None
        self._first = np.full(self.n_features_in_, np.nan if self.fit_intercept else 0.0)
        self._first_y = np.float64(self._first[0])
        self._n, self._sum = 0, 0.0    # rows since the start; of the squares
        self._weight, self._weight2 = 0.0, 0.0    # of their weights, and of these squared
        self._squares = np.empty(0)    # of the rows in the window

    def _process(self, X: NDArray[Any], y: NDArray[Any]) -> NDArray[np.void]:
        if not np.isfinite(self._first).all():
            seen = np.isfinite(X).all(axis=1)
            if seen.any():
                self._first, self._first_y = reference(X[seen]), np.float64(reference(y[seen]))
        steps: NDArray[np.void] = self.filter_.update_many(self._rows(X), y - self._first_y, steps=True)
        squares = self._squares_of(steps)
        if self.window:
            squares = self._squares = np.concatenate([self._squares, squares])[-self.window :]
            self._sum = self._weight = self._weight2 = 0.0
        weights = self.forgetting ** np.arange(len(squares) - 1.0, -1.0, -1.0)
        past, seen = self.forgetting ** len(squares), np.isfinite(squares)
        self._sum = past * self._sum + float(weights[seen] @ squares[seen])
        self._weight = past * self._weight + float(weights[seen].sum())
        self._weight2 = past**2 * self._weight2 + float(weights[seen] @ weights[seen])
        self.noise_variance_ = self._sum / self._weight if self._weight > 0 else np.nan
        self.noise_degrees_ = self._weight**2 / self._weight2 if self._weight2 > 0 else 0.0
        theta = self.filter_.theta.astype(np.float64)
        if self.prior_variance is None and not self.window:    # a step tells of the rows before it
            if self.filter_.copy().pass_time().health == "undetermined":
                theta = np.full_like(theta, np.nan)
        self.coef_ = theta[: self.n_features_in_]
        self.intercept_ = 0.0
        if self.fit_intercept:
            self.intercept_ = float(self._first_y + theta[-1] - self._first @ self.coef_)
        return steps

    def _squares_of(self, steps: NDArray[np.void]) -> NDArray[np.float64]:
        """What each row says of the noise's variance (docs/theory.md 61), as `Assessed` of C++ has it; NaN: nothing."""
        none, windup, change, breakdown = (SIGNALS.index(s) for s in ("none", "windup", "change", "breakdown"))
        signal, gamma, k = steps["signal"], steps["gamma"], np.arange(len(steps) + 1) - 1
        restarts = np.isin(signal, (change, breakdown)) & (self.guard != "report")
        begun = np.maximum.accumulate(np.where(np.append(False, restarts), k, -1 - self._n))
        n = k - begun    # rows since the start before each row, and now
        self._n = int(n[-1])
        taken = (steps["health"] == HEALTHS.index("sound")) & np.isin(signal, (none, windup)) & (gamma > 0.001)
        expected = gamma + self._share(n[:-1]) * self.forgetting * (1 - gamma)
        if begun[-1] >= 0:    # what came before is of another theta
            self._sum, self._weight, self._weight2, self._squares = 0.0, 0.0, 0.0, np.empty(0)
            taken &= k[1:] > begun[-1]
        return np.where(taken, steps["innovation"] * steps["residual"] / expected, np.nan)

    def _more_tags(self) -> dict[str, bool]:
        return {"multioutput": True}

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.target_tags.multi_output = True
        return tags
