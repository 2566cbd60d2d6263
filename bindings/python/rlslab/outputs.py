"""Several outputs with one regressor: a readout, a classifier's scores."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _core, _options, _rows
from ._filter import HEALTHS, STEP
from ._stateful import Stateful, in_pythons_words

Self = TypeVar("Self", bound="Outputs")


class Outputs(Stateful, _core.Outputs):
    """m outputs of one regressor psi, with one P and one gain for all: y = psi'theta, theta of shape (d, m).

    ``rlslab.QrBlock(d, outputs=m)``, or another variant's class, makes one. Each column of theta is that of a filter of
    its own, bit for bit, in blocks where no product or square leaves the arithmetic's range. An output costs a row 2 d
    multiplications more, and 4 d in the forms that solve for theta. `qr_block` takes many rows 256 at a time and
    `joseph_rank_two` 64, by threads where `rlslab.use_threads` says so. A block has other roundings than its rows: of
    `joseph_rank_two` in float32 from the prior of 2^14 P was off by 3 % where row by row it had 7 digits.

    Parameters
    ----------
    variant : str
        One of `rlslab.variants()`, but `kalman` and `extended_qr`.
    size : int
        The number of parameters d of each output.
    outputs : int
        Their number m >= 1.
    forgetting, prior_variance, prior_theta, prior_covariance, dtype
        As of `rlslab.Filter`, the same for all.

    Raises
    ------
    ValueError
        For a number that no filter has, an unknown name, and a variant of one output.

    Examples
    --------
    >>> X = np.random.default_rng(1).standard_normal((1000, 3))
    >>> Y = X @ [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]
    >>> f = rlslab.QrBlock(3, outputs=2, prior_variance=None)
    >>> f.update_many(X, Y)
    'sound'
    >>> f.theta.round(3)
    array([[1., 2.],
           [3., 4.],
           [5., 6.]])
    """

    __slots__ = ("_made",)
    _merges = True

    def __new__(
        cls: type[Self],
        variant: str,
        size: int,
        outputs: int,
        *,
        forgetting: float = 1.0,
        prior_variance: float | None = 16384.0,
        prior_theta: ArrayLike | None = None,
        prior_covariance: ArrayLike | None = None,
        dtype: DTypeLike = "float64",
    ) -> Self:
        arguments = _options.arguments(
            variant, size, forgetting, prior_variance, prior_theta, prior_covariance, dtype, outputs=outputs
        )
        self = super().__new__(cls, *arguments)
        self._made = _options.made(arguments, dtype, "outputs")
        return self

    def update(self, psi: ArrayLike, y: ArrayLike) -> NDArray[np.void]:
        """Process one row.

        Parameters
        ----------
        psi : array_like, shape (d,)
            A number that is not finite spoils all outputs.
        y : array_like, shape (m,)
            Where one is not finite the row is lost for all outputs: its time passes, P / forgetting.

        Returns
        -------
        numpy.ndarray of dtype `rlslab.STEP`, shape (m,)
            The step of each output; its "health" is a place in `rlslab.HEALTHS`.

        Examples
        --------
        >>> f = rlslab.Ud(2, outputs=3)
        >>> f.update([1.0, 2.0], [3.0, 4.0, 5.0])["innovation"]
        array([3., 4., 5.])
        """
        p, v = _rows.row(psi, self.size), _rows.row(y, self.outputs, "y")
        if p.dtype != v.dtype:
            p, v = p.astype(np.float64, copy=False), v.astype(np.float64, copy=False)
        out = np.empty(self.outputs, STEP)
        self._update(p, v, out)
        return out

    def update_many(self, X: ArrayLike, Y: ArrayLike, *, unusable: str = "refuse") -> str:
        """Process many rows, the oldest first.

        Parameters
        ----------
        X : array_like, shape (n, d)
            In place where it is of the filter's dtype and each row is contiguous, as in an array of order C.
        Y : array_like, shape (n, m)
        unusable : {"refuse", "leave_out"}
            What to do about a row with a number that is not finite, in X or in Y. "refuse": ValueError names it, and no
            row is taken. "leave_out": such rows are left out, as if they had never come, and counted in `left_out`.

        Returns
        -------
        str
            The health after the last block of rows, or at the last row, one of `rlslab.HEALTHS`.

        Raises
        ------
        ValueError
            If the shapes are others, before any row is taken.
        TypeError
            If there is something else than real numbers.

        Notes
        -----
        The interpreter's lock is released meanwhile. In blocks two calls differ from one in the last bits.

        Examples
        --------
        >>> f = rlslab.JosephRankTwo(1, outputs=2)
        >>> f.update_many([[1.0], [2.0], [np.nan]], np.ones((3, 2)), unusable="leave_out"), f.left_out
        ('sound', 1)
        """
        _options.one_of(unusable, ("refuse", "leave_out"), "unusable")
        P, V = _rows.tables(X, Y, self.size, self.outputs)
        try:
            return HEALTHS[self._update_many(P, V, unusable == "leave_out")]
        except ValueError as error:
            raise in_pythons_words(error) from None

    def merge(self, newer: Outputs) -> None:
        """Append the rows of `newer`, made with ``prior_variance=None``, to those taken. Of `qr_block` alone.

        This one may have a prior, which counts once. Parts of the rows can so be taken in parallel, and merged in a
        tree: docs/python.md has one. ValueError for another variant, size, dtype, forgetting or number of outputs; this
        one is then as it was. So it is for `filter_` of an estimator, whose rows are less its first one.

        Examples
        --------
        >>> X, Y = np.eye(2), np.array([[1.0, 2.0], [3.0, 4.0]])
        >>> older, newer = (rlslab.QrBlock(2, outputs=2, prior_variance=None) for _ in range(2))
        >>> _ = older.update_many(X[:1], Y[:1]), newer.update_many(X[1:], Y[1:])
        >>> older.merge(newer)
        >>> older.theta.round(6).tolist()
        [[1.0, 2.0], [3.0, 4.0]]
        """
        if not (self._merges and getattr(newer, "_merges", True)):
            raise ValueError("rows of an estimator are less its first one: merge parts of rlslab.QrBlock in its place")
        try:
            self._merge(newer)
        except ValueError as error:
            raise in_pythons_words(error) from None

    def add_outputs(self, more: int) -> None:
        """Append outputs that were 0 in all rows so far, as a class is that was not seen before: exactly.

        ValueError where ``prior_theta`` is not 0.

        Examples
        --------
        >>> f = rlslab.Ud(2, outputs=1)
        >>> f.add_outputs(2)
        >>> f.theta.shape
        (2, 3)
        """
        count = _options.whole(more, "more")
        _options.expect_memory(self.size * (self.outputs + max(count, 0)))
        self._add_outputs(count)
        self._made = {**self._made, "outputs": self.outputs}

    def reset(self) -> None:
        """Make it as it was made, with as many outputs as now."""
        self._reset()

    @property
    def dtype(self) -> np.dtype[Any]:
        """The arithmetic: float64 or float32."""
        return np.dtype(np.float32 if self._arithmetic == "float" else np.float64)

    @property
    def health(self) -> str:
        """The health of the last row or block, one of `rlslab.HEALTHS`."""
        return HEALTHS[self._health]

    @property
    def theta(self) -> NDArray[np.floating[Any]]:
        """The estimated parameters, shape (d, m), a copy: ``X @ f.theta`` predicts. NaN until determined.

        Where columns depend on one another it may be any number, 1e15 as well: `health` is "undetermined" then.
        """
        out = np.empty((self.size, self.outputs))
        self._theta(out)
        return out.astype(self.dtype, copy=False)

    def _square(self, name: str) -> NDArray[np.floating[Any]]:
        if name != "factor" and (name == "covariance") != self._reports_covariance:
            other = "covariance" if self._reports_covariance else "information"
            raise AttributeError(f"{self.variant} reports {other}, not {name}", name=name, obj=self)
        by_columns = np.empty((self.size, self.size))
        try:
            (self._factor if name == "factor" else self._matrix)(by_columns)
        except ValueError as error:
            raise AttributeError(str(error), name=name, obj=self) from None
        return np.ascontiguousarray(by_columns.T, dtype=self.dtype)

    @property
    def covariance(self) -> NDArray[np.floating[Any]]:
        """P, shape (d, d), a copy, the same for all outputs. AttributeError for a variant that holds P^-1."""
        return self._square("covariance")

    @property
    def information(self) -> NDArray[np.floating[Any]]:
        """P^-1, shape (d, d), a copy, the same for all outputs. AttributeError for a variant that holds P."""
        return self._square("information")

    @property
    def factor(self) -> NDArray[np.floating[Any]]:
        """F, shape (d, d), a copy: F F' is `covariance`, or `information`; of `qr` and `qr_block` F = R'.

        AttributeError for a variant that stores no square root.
        """
        return self._square("factor")

    def __repr__(self) -> str:
        name = "".join(word.title() for word in self.variant.split("_"))
        return f"{name}({self.size}, outputs={self.outputs}, dtype={self.dtype.name!r})"
