"""An estimator for scikit-learn."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray
from sklearn.base import BaseEstimator, RegressorMixin  # type: ignore[import]
from sklearn.utils.validation import check_is_fitted  # type: ignore[import]

from . import _options, filter

Self = TypeVar("Self", bound="RLSRegressor")


def _validated(estimator: Any, *given: Any, **how: Any) -> Any:
    """scikit-learn's look at X and y: a function from 1.6 on, a method before."""
    try:
        from sklearn.utils.validation import validate_data
    except ImportError:
        return estimator._validate_data(*given, **how)
    return validate_data(estimator, *given, **how)


class RLSRegressor(RegressorMixin, BaseEstimator):  # type: ignore[misc]
    """Linear regression by recursive least squares: rows can come in parts, and old ones can be forgotten.

    Parameters
    ----------
    variant : str
        One of `rlslab.variants()`.
    forgetting, prior_variance, dtype, window, guard, guard_options, control
        As of `rlslab.Filter`.
    fit_intercept : bool
        Whether a constant is estimated, too: the last of theta.

    Attributes
    ----------
    coef_ : ndarray of shape (n_features,)
    intercept_ : float
    n_features_in_ : int
    noise_variance_ : float
        Of y about its prediction, from the rows so far, weighted as by `forgetting`; NaN for too few rows.
    filter_ : rlslab.Filter

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
        variant: str = "ud",
        *,
        forgetting: float = 1.0,
        prior_variance: float | None = 1e6,
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
        """Forget all and process these rows, the oldest first. ValueError for data that are not finite."""
        rows, outputs = _validated(self, X, y, y_numeric=True, reset=True)
        self._start()
        return self._process(rows, outputs)

    def partial_fit(self: Self, X: ArrayLike, y: ArrayLike) -> Self:
        """Process these rows after those before."""
        first = not hasattr(self, "filter_")
        rows, outputs = _validated(self, X, y, y_numeric=True, reset=first)
        if first:
            self._start()
        return self._process(rows, outputs)

    def predict(self, X: ArrayLike, return_std: bool = False) -> Any:
        """X theta; with `return_std` also the standard deviation of y about it, noise and theta's error together."""
        check_is_fitted(self)
        rows = self._rows(_validated(self, X, reset=False))
        mean = rows @ self._theta
        if not return_std:
            return mean
        if self.filter_._reports_covariance:
            along = np.einsum("ij,jk,ik->i", rows, self.filter_.covariance, rows)
        else:
            along = np.einsum("ij,ji->i", rows, np.linalg.solve(self.filter_.information, rows.T))
        return mean, np.sqrt(self.noise_variance_ * (1 + along))

    def _rows(self, X: NDArray[Any]) -> NDArray[Any]:
        return np.column_stack([X, np.ones(len(X))]) if self.fit_intercept else np.asarray(X, dtype=np.float64)

    def _start(self) -> None:
        self.filter_ = filter(
            self.variant, self.n_features_in_ + bool(self.fit_intercept), forgetting=self.forgetting,
            prior_variance=self.prior_variance, dtype=self.dtype, window=self.window, guard=self.guard,
            guard_options=self.guard_options, control=self.control,
        )  # fmt: skip
        self._loss = self._weight = 0.0

    def _process(self: Self, X: NDArray[Any], y: NDArray[Any]) -> Self:
        steps = self.filter_.update_many(self._rows(X), y, steps=True)
        # The sum of innovation x residual is the least J; a row weighs lambda to the power of its age.
        losses = np.nan_to_num(steps["innovation"] * steps["residual"])
        weights = self.forgetting ** np.arange(len(losses) - 1.0, -1.0, -1.0)
        past = self.forgetting ** len(losses)
        self._loss = past * self._loss + float(weights @ losses)
        self._weight = past * self._weight + float(weights.sum())
        freedom = self._weight - self.filter_.size
        self.noise_variance_ = self._loss / freedom if freedom > 0 else np.nan
        self._theta = self.filter_.theta.astype(np.float64)
        self.coef_ = self._theta[: self.n_features_in_]
        self.intercept_ = float(self._theta[-1]) if self.fit_intercept else 0.0
        return self
