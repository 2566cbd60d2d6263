"""What a filter is asked beside its rows: rows taken back, parts merged, variances, draws, what its probes show."""

from __future__ import annotations

import operator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, _options, _rows
from ._stateful import in_pythons_words


class Removal(NamedTuple):
    """What the removal of a row did: see `Filter.remove`."""

    remaining: float
    noise: float

    @property
    def refused(self) -> bool:
        """Whether nothing has changed, because nothing would remain along psi."""
        return not self.remaining > 0


class LeastExcited(NamedTuple):
    """Where a filter's rows say least: see `Filter.least_excited`."""

    direction: NDArray[np.floating[Any]]
    deviation: float
    ratio: float

    @property
    def sentence(self) -> str:
        """All of it, in words."""
        if not np.isfinite(self.deviation):
            return "the rows in the filter's memory do not determine theta, or P has broken down"
        numbers = ", ".join(f"{x:.2g}" for x in self.direction.tolist())
        return (
            f"the rows in the filter's memory say least along ({numbers}): a standard deviation of "
            f"{self.deviation:.3g} times the noise's, {self.ratio:.3g} of at most {len(self.direction)} times the "
            "average variance"
        )


class Certificate(NamedTuple):
    """What the probes of a filter show: see `Filter.certificate`."""

    estimate: float
    bound: float
    theta: float
    definite: bool


class Asked(_core.Filter):
    """The part of `rlslab.Filter` that answers."""

    __slots__ = ()
    _merges = True

    @property
    def dtype(self) -> np.dtype[Any]:
        """The arithmetic: float64 or float32."""
        return np.dtype(np.float32 if self._arithmetic == "float" else np.float64)

    @property
    def factor(self) -> NDArray[np.floating[Any]]:
        """F, shape (d, d), a copy: F F' is `covariance`, or `information`; of `qr` and `qr_block` F = R'.

        AttributeError for a variant that stores no square root.
        """
        by_columns = np.empty((self.size, self.size))
        try:
            self._factor(by_columns)
        except ValueError as error:
            raise AttributeError(str(error), name="factor", obj=self) from None
        return np.ascontiguousarray(by_columns.T, dtype=self.dtype)

    def remove(self, psi: ArrayLike, y: float, weight: float = 1.0) -> Removal:
        """Take back a row that the filter holds, as if it had never come.

        Parameters
        ----------
        psi : array_like, shape (d,)
        y : float
        weight : float
            The row's weight now: ``forgetting**n`` for one n steps old, times its own. 0 takes nothing back.

        Returns
        -------
        Removal
            ``remaining`` 1 - weight psi'P psi, of the P before: the share of what is known along psi that other rows
            said, with the error of that P; ``noise``, the error that the removal made, in units of u / remaining;
            ``refused``: nothing would remain but rounding (remaining is then 0), or a number is not finite or
            weight < 0 (NaN). Nothing has changed then.

        Raises
        ------
        ValueError
            If psi is not of shape (d,); of `kalman`, `extended_qr` and `qr_block`, and with a window, a guard or a
            rule of forgetting: what weight a row has there nobody knows.

        Examples
        --------
        >>> f = rlslab.Ud(1)
        >>> _ = f.update([1.0], 3.0), f.update([1.0], 50.0)
        >>> removal = f.remove([1.0], 50.0)
        >>> f.theta.round(3), removal.refused, round(removal.remaining, 3)
        (array([3.]), False, 0.5)
        """
        row = _rows.row(psi, self.size).astype(np.float64, copy=False)
        return Removal(*self._remove(row, _rows.output(y), _options.real(weight, "weight")))

    def merge(self, newer: Asked) -> None:
        """Append the rows of `newer`, made with ``prior_variance=None``, to those taken. Of `qr_block` alone.

        This one may have a prior, which counts once. Parts of the rows can so be taken in parallel, and merged in any
        tree: docs/python.md has one. ValueError for another variant, size, dtype or forgetting; this one is then as it
        was. RuntimeError while another thread uses one of the two.

        Examples
        --------
        >>> older, newer = (rlslab.QrBlock(2, prior_variance=None) for _ in range(2))
        >>> _ = older.update_many([[1.0, 0.0]], [3.0]), newer.update_many([[1.0, 1.0]], [5.0])
        >>> older.merge(newer)
        >>> older.theta.round(6).tolist(), older.counts.rows
        ([3.0, 2.0], 2)
        """
        if not (self._merges and getattr(newer, "_merges", True)):
            raise ValueError("rows of an estimator are less its first one: merge parts of rlslab.QrBlock in its place")
        try:
            self._merge(newer)
        except ValueError as error:
            raise in_pythons_words(error) from None

    def variance(self, Psi: ArrayLike) -> NDArray[np.floating[Any]] | float:
        """psi'P psi of each row: the variance of psi'theta, in units of the noise's.

        From the numbers that the variant stores, P not formed: d^2 multiplications a row at most.

        Parameters
        ----------
        Psi : array_like, shape (n, d) or (d,)

        Returns
        -------
        numpy.ndarray of shape (n,), or float for one psi
            NaN while the rows do not determine theta.

        Raises
        ------
        ValueError
            If the shape is another; of `kalman`, `extended_qr` and `qr_block`.

        Examples
        --------
        >>> f = rlslab.Ud(2, prior_variance=4)
        >>> f.variance([[1.0, 0.0], [1.0, 1.0]]), f.variance([0.0, 1.0])
        (array([4., 8.]), 4.0)
        """
        rows = _rows.numbers(Psi, "Psi")
        table = rows[None] if rows.ndim == 1 else rows
        P, _ = _rows.block(table, np.zeros(table.shape[:1]), self.size)
        out = np.empty(len(P))
        self._variance(P.astype(np.float64, copy=False), out)
        return float(out[0]) if rows.ndim == 1 else out.astype(self.dtype, copy=False)

    def sample(self, seed: int, n: int, scale: float = 1.0) -> NDArray[np.floating[Any]]:
        """n draws of theta from what the rows leave open: theta + scale S z, S S' = P.

        S is the stored factor (of `qr` and its kin R^-1, by substitution); P is not formed. z is nearly normal, of
        variance 1 and at most 6 in size. The draws are the same on every machine and in every language, and draw k of a
        seed is the same whatever n is.

        Parameters
        ----------
        seed : int
            From 0 to 2^64 - 1.
        n : int
        scale : float
            The noise's standard deviation, >= 0. docs/python.md estimates it (``how_sure``).

        Returns
        -------
        numpy.ndarray, shape (n, d)
            NaN where the rows do not determine theta, or P is not definite.

        Raises
        ------
        ValueError
            For another seed, n or scale, and of variants that store P or P^-1 and no root: `conventional`,
            `conventional_two_sided`, `symmetric`, `joseph`, `joseph_rank_two`, `kalman`, `information`.

        Examples
        --------
        >>> f = rlslab.Ud(2)
        >>> _ = f.update_many([[1, 0], [1, 1], [1, 2]], [3, 5, 7])
        >>> draws = f.sample(seed=1, n=1000, scale=0.1)
        >>> draws.shape, bool(np.allclose(np.cov(draws.T), 0.01 * f.covariance, rtol=0.2))
        ((1000, 2), True)
        """
        count, start = _options.whole(n, "n"), operator.index(seed)
        if count < 0 or not 0 <= start < 2**64:
            raise ValueError("n is >= 0, and seed from 0 to 2^64 - 1")
        _options.expect_memory(2 * count * self.size)    # float64 first
        out = np.empty((count, self.size))
        self._sample(start, count, _options.real(scale, "scale"), out)
        return out.astype(self.dtype, copy=False)

    def least_excited(self) -> LeastExcited:
        """Is it excited now? The direction of theta along which the rows in the filter's memory say least.

        With D_jj = sqrt(P_jj) and C = D^-1 P D^-1, the correlations of theta's errors, two power steps from each of two
        starts find v, where v'C v is nearly largest, from the stored factor. docs/closed_loop.md shows what it is for.

        Returns
        -------
        LeastExcited
            ``direction`` u = D v / |D v|, shape (d,); ``deviation`` sqrt(u'P u), the standard deviation of u'theta in
            units of the noise's; ``ratio`` v'C v, the variance along v over that of the average direction, each
            parameter in units of its own deviation. From 1, uncorrelated, to d, all along one direction; never above
            the largest eigenvalue of C but for rounding. ``sentence`` says it in words. All NaN where the rows do not
            determine theta. What is known badly by itself, one parameter that no row excites, shows in
            ``variance(np.eye(d))`` and not in `ratio`.

        Raises
        ------
        ValueError
            As `sample`, of variants that store no root.

        Examples
        --------
        >>> f = rlslab.Ud(2)
        >>> _ = f.update_many([[1.0, 1.0]] * 20, [3.0] * 20)
        >>> found = f.least_excited()
        >>> found.direction.round(2), round(found.deviation), round(found.ratio, 2)
        (array([ 0.71, -0.71]), 128, 2.0)
        """
        direction = np.empty(self.size)
        deviation, ratio = self._least_excited(direction)
        return LeastExcited(direction.astype(self.dtype, copy=False), deviation, ratio)

    def certificate(self) -> Certificate:
        """What the probes of ``certify=s`` show of the error of P and theta now; the filter stays as it is.

        With P that of exact arithmetic after the same rows, Phat the filter's, E = Phat P^-1 - I in the unit of each
        parameter, x_i the probes and m_i = P^-1 x_i::

            m_i = forgetting m_i + psi (psi'x_i) at each row       r_i = Phat m_i - x_i = E x_i
            estimate^2 = sum |r_i|^2 / s                           bound = 10 (max |r_i| + u sqrt(d))

        Returns
        -------
        Certificate
            ``estimate`` of ||E||_F, within a factor of 2 in 85 % where 3 probes meet an E of rank one; ``bound``, above
            ||E||_F except with probability 0.08^s; ``theta``, above |thetahat - theta| / |thetahat| wherever ``bound``
            is above ||E||_F; ``definite``, bound < 1, which proves a symmetric Phat positive definite. Infinite where
            nothing is known: without a prior before the rows determine theta, and from a rule on that adds to P.

        Raises
        ------
        ValueError
            If the filter was made without `certify`.

        Notes
        -----
        The probes' own rounding, of about 1e-16 times the condition number of P, is part of what they show. A row costs
        2 d (s + 1) multiplications more, and `certificate` s + 1 products with P; in float64 a few more.

        Examples
        --------
        >>> f = rlslab.Ud(2, dtype="float32", certify=3)
        >>> _ = f.update_many([[1, 0], [1, 1], [1, 2]], [3, 5, 7])
        >>> found = f.certificate()
        >>> found.definite, found.estimate < found.bound < 1e-4
        (True, True)
        """
        return Certificate(*self._certificate())
