"""A classifier for scikit-learn: `rlslab.sklearn` has it."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray
from sklearn.base import ClassifierMixin  # type: ignore[import]
from sklearn.exceptions import NotFittedError  # type: ignore[import]
from sklearn.utils.multiclass import check_classification_targets  # type: ignore[import]
from sklearn.utils.validation import check_is_fitted  # type: ignore[import]

from ._linear import Linear, reference, validated

Classifier = TypeVar("Classifier", bound="RLSClassifier")


class RLSClassifier(ClassifierMixin, Linear):  # type: ignore[misc]
    """Classification by recursive least squares on 0 and 1: a column for each class, the largest score wins.

    Rows can come in parts, and so can classes: one that appears later is as if its column had been 0 from the first row
    on, exactly. There is no prior, as in `RLSRegressor`: columns that are constant or depend on others need one.

    Parameters
    ----------
    variant : str
        One of `rlslab.variants()`, but `kalman` and `extended_qr`. `qr_block` takes 256 rows at a time.
    prior_variance : float or None
        c^2 of P0 = c^2 I, a ridge of 1 / c^2 on all coefficients, the constant too. A variant other than `qr`,
        `qr_block`, `gentleman` and `information` needs it.
    forgetting, dtype
        As of `rlslab.Filter`.
    fit_intercept : bool
        Whether a constant is estimated, too.

    Attributes
    ----------
    classes_ : ndarray of shape (n_classes,)
        Those seen so far, in order.
    coef_ : ndarray of shape (n_classes, n_features)
        NaN after `partial_fit` where the rows so far do not determine them.
    intercept_ : ndarray of shape (n_classes,)
    n_features_in_ : int
    filter_ : rlslab.Outputs
        Its outputs are the classes in the order in which they came, its rows those of X less the first. So it does not
        merge: take parts of one-hot Y in `rlslab.QrBlock`.

    Examples
    --------
    >>> from rlslab.sklearn import RLSClassifier
    >>> model = RLSClassifier().partial_fit([[0.0], [1.0], [5.0], [6.0]], ["low", "low", "mid", "mid"])
    >>> model.partial_fit([[10.0], [11.0]], ["high", "high"]).predict([[0.5], [10.5]])
    array(['low', 'high'], dtype='<U4')
    """

    __module__ = "rlslab.sklearn"    # where pickles look for it

    def __init__(
        self,
        variant: str = "qr_block",
        *,
        forgetting: float = 1.0,
        prior_variance: float | None = None,
        dtype: DTypeLike = "float64",
        fit_intercept: bool = True,
    ) -> None:
        self.variant = variant
        self.forgetting = forgetting
        self.prior_variance = prior_variance
        self.dtype = dtype
        self.fit_intercept = fit_intercept

    def fit(self: Classifier, X: ArrayLike, y: ArrayLike) -> Classifier:
        """Forget all and process these rows. ValueError for data that are not finite or do not determine theta."""
        return self._fitted(X, y, None, first=True, whole=True)

    def partial_fit(self: Classifier, X: ArrayLike, y: ArrayLike, classes: ArrayLike | None = None) -> Classifier:
        """Process these rows after those before. `classes`: labels that later rows will have; none has to be named."""
        return self._fitted(X, y, classes, first=not hasattr(self, "filter_"), whole=False)

    def _fitted(
        self: Classifier, X: ArrayLike, y: ArrayLike, classes: ArrayLike | None, first: bool, whole: bool
    ) -> Classifier:
        rows, labels = validated(self, X, y, reset=first, labels=True)
        check_classification_targets(labels)
        there = np.unique(labels if classes is None else np.concatenate([np.asarray(classes), labels]))
        known: NDArray[Any] = there[:0] if first else self._labels
        if (known.dtype.kind in "OSU") != (there.dtype.kind in "OSU"):
            raise ValueError(f"labels of {there.dtype} after labels of {known.dtype}")
        new = np.setdiff1d(there, known)
        self._expect_range(rows, first)
        if first:
            self._start_several(len(new))
            self._first = reference(rows) if self.fit_intercept else self._first
        elif len(new):
            self.filter_.add_outputs(len(new))
            self._first_y = np.zeros(len(known) + len(new))
        self._labels: NDArray[Any] = np.concatenate([known, new])
        self._order = np.argsort(self._labels)
        self.classes_ = self._labels[self._order]
        Y = np.zeros((len(labels), len(self._labels)))
        Y[np.arange(len(labels)), self._order[np.searchsorted(self.classes_, labels)]] = 1
        self._take_several(rows, Y, whole)
        self.coef_, self.intercept_ = self.coef_[self._order], self.intercept_[self._order]
        return self

    def _scores(self, X: ArrayLike) -> NDArray[np.float64]:
        check_is_fitted(self)
        scores = self._predicted(validated(self, X, reset=False))[:, self._order]
        if not np.isfinite(scores).all():
            raise NotFittedError("the rows so far do not determine theta: more rows, or prior_variance")
        return scores

    def decision_function(self, X: ArrayLike) -> NDArray[np.float64]:
        """The scores, shape (n, n_classes); of two classes the second's less the first's, shape (n,)."""
        scores = self._scores(X)
        return scores[:, 1] - scores[:, 0] if scores.shape[1] == 2 else scores

    def predict(self, X: ArrayLike) -> NDArray[Any]:
        """The class of the largest score, the first of equal ones."""
        best = self._scores(X).argmax(axis=1)
        return np.asarray(self.classes_[best])
