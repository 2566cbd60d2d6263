"""What the estimators for scikit-learn share."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator  # type: ignore[import]

from . import _rows
from ._variants import QrBlock
from .outputs import Outputs


def validated(estimator: Any, *given: Any, finite: bool = True, labels: bool = False, **how: Any) -> Any:
    """scikit-learn's look at X and y, a function from 1.6 on and a method before; in one line what it refuses."""
    try:
        from sklearn.utils.validation import validate_data  # type: ignore[import]
    except ImportError:
        how["force_all_finite"], validate = finite, type(estimator)._validate_data
    else:
        how["ensure_all_finite"], validate = finite, validate_data
    for name, part in zip("X" if labels else "Xy", given):
        rows = part if isinstance(part, (list, tuple)) else ()
        if any(isinstance(one, np.ma.MaskedArray) and np.any(one.mask) for one in (part, *rows)):
            raise _rows.is_masked(name)
        of_pandas = hasattr(part, "dtypes") and hasattr(part, "to_numpy")
        if of_pandas or (isinstance(part, np.ndarray) and part.dtype.kind in "mMUSV"):
            _rows.numbers(part, name)    # names the column that has none
    try:
        valid = validate(estimator, *given, **how)
        if labels:
            return valid
        if len(given) > 1:    # in float64: what is taken off y is not to round it
            valid = valid[0], _rows.numbers(valid[1], "y").astype(np.float64)
        if len(given) > 1 and valid[1].dtype.kind == "f" and not np.isfinite(valid[1]).all():    # of a None
            raise ValueError("Input y contains NaN.")
        return valid
    except ValueError as error:
        line, more, _ = str(error).partition("\n")
        of_y = line.startswith("Input y contains") or line == "Input contains NaN"    # the latter of objects
        if not of_y and (not more or "NaN" not in line):
            raise
        several = isinstance(getattr(estimator, "filter_", None), Outputs)
        if len(given) > 1:
            several = np.shape(given[1])[1:] not in ((), (1,))
        skips = not of_y and not several and hasattr(estimator, "guard")    # what several columns do not take
        guard = ', or guard="reset", which skips and counts them in fit and partial_fit' if skips else ""
        raise ValueError(f"{line.rstrip('.')}: leave such rows out{guard}") from None


def reference(rows: NDArray[Any]) -> Any:
    """What is taken off the rows: the first one; of a column where that is an outlier the median of the last ones."""
    first, last = np.asarray(rows[0], dtype=np.float64), np.asarray(rows[-1023:], dtype=np.float64)
    if len(last) < 8:
        return first
    with np.errstate(all="ignore"):
        middle = np.sort(last, axis=0)[(len(last) - 1) // 2]
        spread = np.sort(abs(last - middle), axis=0)[9 * (len(last) - 1) // 10]
        return np.where(abs(first - middle) <= 1024 * spread, first, middle)


class EstimatorsOutputs(Outputs):
    """Of rows less the estimator's own reference: they do not merge with those of another."""

    __slots__ = ()
    _merges = False


class EstimatorsQrBlock(QrBlock):
    """Likewise, of one output."""

    __slots__ = ()
    _merges = False


class Linear(BaseEstimator):  # type: ignore[misc]
    """What both estimators do: the filter's rows, and several outputs of them."""

    filter_: Any
    _first: NDArray[np.float64]    # the reference, of the first call's rows, and that of y; 0 without a constant
    _first_y: Any
    coef_: NDArray[np.float64]
    intercept_: Any

    def _rows(self, X: NDArray[Any]) -> NDArray[Any]:
        """The filter's rows: less the reference, so that an offset costs no digits, and a 1."""
        rows = np.asarray(X, dtype=np.float64)
        return np.column_stack([rows - self._first, np.ones(len(rows))]) if self.fit_intercept else rows

    def _expect_range(self, X: NDArray[Any], first: bool) -> None:
        """Before anything changes: that the filter's rows are numbers of `dtype`."""
        with np.errstate(all="ignore"):
            rows = np.asarray(X, np.float64) - ((reference(X) if first else self._first) if self.fit_intercept else 0.0)
            if not np.isfinite(rows.astype(self.dtype)).all():
                name = np.dtype(self.dtype).name
                raise ValueError(f"a row of X, less the first one, is beyond {name}: no row was taken")

    def _start_several(self, outputs: int) -> None:
        if self.prior_variance == np.inf:
            raise ValueError("expected a finite prior_variance, or None: no prior")
        try:
            self.filter_ = EstimatorsOutputs(
                self.variant, self.n_features_in_ + bool(self.fit_intercept), outputs, forgetting=self.forgetting,
                prior_variance=self.prior_variance, dtype=self.dtype,
            )  # fmt: skip
        except ValueError as error:
            raise with_advice(error) from None
        self._first, self._first_y = np.zeros(self.n_features_in_), np.zeros(outputs)

    def _take_several(self, X: NDArray[Any], Y: NDArray[Any], whole: bool) -> None:
        health = self.filter_.update_many(self._rows(X), Y - self._first_y)
        self._theta = self.filter_.theta.astype(np.float64)
        theta = self._theta.T
        self.coef_, self.intercept_ = theta[:, : self.n_features_in_], self._first_y
        if self.fit_intercept:
            self.intercept_ = self._first_y + theta[:, -1] - self.coef_ @ self._first
        if health in ("nonfinite", "indefinite") or (whole and not np.isfinite(theta).all()):
            raise ValueError(
                f"n_samples = {len(X)}: the rows leave no theta of {self.filter_.size} parameters, health {health}: "
                f"leave out columns that depend on others or are constant{self._constant(X)}, or give prior_variance "
                "(a ridge of 1 / prior_variance)"
            )

    def _constant(self, X: NDArray[Any]) -> str:
        """Which columns the constant has already, or are 0 where there is none."""
        found = (X == (X[0] if self.fit_intercept else 0)).all(axis=0) & (len(X) > 1)
        names = [str(k) for k in getattr(self, "feature_names_in_", np.arange(X.shape[1]))[found]]
        return f" ({', '.join([*names[:8], *['...'] * (len(names) > 8)])})" if names else ""

    def _predicted(self, X: NDArray[Any]) -> NDArray[np.float64]:
        """Of several outputs, shape (n, m)."""
        out: NDArray[np.float64] = self._rows(X) @ self._theta + self._first_y
        return out


def with_advice(error: ValueError) -> ValueError:
    wanted = "; prior_variance gives one, qr needs none" if str(error).startswith("expected a prior:") else ""
    return ValueError(f"{error}{wanted}")
