"""The exact solution, with a proven bound: `certified`."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _options, _rows

if TYPE_CHECKING:
    from ._reference import Solution

Floats = NDArray[np.float64]


def certified(
    X: ArrayLike,
    y: ArrayLike,
    *,
    forgetting: float = 1.0,
    prior_variance: float | None = None,
    prior_theta: ArrayLike | None = None,
    prior_covariance: ArrayLike | None = None,
    digits: int = 30,
) -> Certified:
    """The theta that exact arithmetic would find for the very bits of these numbers, and a proven bound of its error.

    It minimises, after n rows,

        lambda^n (theta - theta0)' P0^-1 (theta - theta0) + sum_i lambda^(n-i) (y_i - psi_i' theta)^2

    Parameters
    ----------
    X : array_like, shape (n, d)
        The rows psi, the oldest first. A row that misses a value (NaN) is left out, as by `compare`.
    y : array_like, shape (n,)
        The outputs.
    forgetting : float
        lambda, in (0, 1].
    prior_variance : float, optional
        c^2 of P0 = c^2 I. Without it and prior_covariance there is no prior: plain least squares.
    prior_theta, prior_covariance : array_like, optional
        theta0, shape (d,); P0, shape (d, d), symmetric.
    digits : int
        That are certified of theta and of P, 1 to 10000.

    Returns
    -------
    Certified

    Raises
    ------
    ValueError
        For shapes that do not fit; columns that are exactly dependent; infinite numbers; a P0 that is not positive
        definite; where 2^16 bits (or 4 times those of `digits`) do not certify so many digits.
    ImportError
        Where the extension `rlslab._reference` was not built.

    Notes
    -----
    With forgetting = 1 the sums are exact integers, otherwise balls of rising precision. Others run meanwhile: the
    interpreter's lock is released.

    Examples
    --------
    >>> c = rlslab.certified([[1, 0], [1, 1], [1, 2]], [1, 2, 4])
    >>> c.strings(5), c.radius < 1e-30
    (('8.3333e-1', '1.5000e0'), True)
    >>> round(c.digits([0.8333, 1.5]), 2)
    4.71
    """
    try:
        from ._reference import certified as solve
    except ImportError as error:
        raise ImportError(
            f"certified needs the extension rlslab._reference, which ./lab python builds ({error})"
        ) from None
    given = _rows.numbers(X, "X").astype(np.float64)
    if given.ndim != 2 or given.shape[1] == 0:
        raise ValueError(f"X has shape {given.shape}, expected (n, d)")
    rows, outputs = _rows.block(given, _rows.numbers(y, "y").astype(np.float64), given.shape[1])
    there = ~(np.isnan(rows).any(axis=1) | np.isnan(outputs))
    rows, outputs = _rows.contiguous(rows[there]), _rows.contiguous(outputs[there])
    n, d = rows.shape
    if n == 0:
        raise ValueError("no row has all its values")
    if not 1 <= _options.whole(digits, "digits") <= 10000:
        raise ValueError("expected digits from 1 to 10000")
    variance = 0.0 if prior_variance is None else _options.real(prior_variance, "prior_variance")
    theta0 = _rows.prior(prior_theta, (d,), "prior_theta")
    P0 = _rows.prior(prior_covariance, (d, d), "prior_covariance")
    if prior_variance is not None and not 0 < variance < np.inf:
        raise ValueError("expected a finite prior_variance > 0, or None: no prior")
    if prior_variance is not None and P0 is not None:
        raise ValueError("expected prior_variance or prior_covariance, not both")
    if theta0 is not None and prior_variance is None and P0 is None:
        raise ValueError("prior_theta goes with prior_variance or prior_covariance")
    solution = solve(rows, outputs, n, d, _options.real(forgetting, "forgetting"), variance, theta0, P0, digits)
    status, rank, *_ = solution.proven()
    if status == "singular":
        raise ValueError(f"the columns of X are dependent: rank {rank} of {d}, and there is no prior")
    if status == "undefined":
        raise ValueError("X, y or P0 holds an infinity, or P0 is not positive definite")
    if status != "certified":
        raise ValueError(f"{digits} digits could not be certified: the problem is too close to a dependent one")
    return Certified(solution, n, len(there) - n, d)


class Certified:
    """The exact solution, enclosed.

    Attributes
    ----------
    theta : tuple of Fraction
        The middle of the enclosure, exactly: numbers of finitely many bits.
    covariance : tuple of tuple of Fraction
        Likewise P.
    radius : float
        Proven: the distance of `theta` from the exact solution is at most radius times the exact solution's norm.
    covariance_radius : float
        Likewise of P in the Frobenius norm.
    bits : int
        Working precision that certified it.
    rows, skipped : int
        Rows taken; rows left out because they miss a value.
    """

    def __init__(self, solution: Solution, rows: int, skipped: int, size: int) -> None:
        self._solution = solution
        self.rows, self.skipped, self._size = rows, skipped, size
        _, _, self.bits, self.radius, self.covariance_radius = solution.proven()
        self.theta = tuple(_dyadic(*part) for part in solution.theta())
        flat = [_dyadic(*part) for part in solution.covariance()]
        self.covariance = tuple(tuple(flat[i * size : (i + 1) * size]) for i in range(size))

    def strings(self, digits: int = 30) -> tuple[str, ...]:
        """theta correctly rounded to so many significant digits, fewer where the enclosure determines fewer."""
        if not 1 <= _options.whole(digits, "digits") <= 10000:
            raise ValueError("expected digits from 1 to 10000")
        return self._solution.strings(digits)

    def digits(self, theta: ArrayLike) -> float:
        """-log10(|theta given - theta|_2 / |theta|_2), proven: of an upper bound of the error.

        At most about the digits that were asked for; infinity: equal, and known exactly; NaN: not finite.
        """
        return self._digits(theta)[0]

    def digits_worst(self, theta: ArrayLike) -> float:
        """The least over the components of -log10 of the relative error, likewise proven."""
        return self._digits(theta)[1]

    def _digits(self, theta: ArrayLike) -> tuple[float, float]:
        given = _rows.row(theta, self._size, "theta").astype(np.float64)
        return self._solution.digits(_rows.contiguous(given))

    def __array__(self, dtype: object = None, copy: object = None) -> Floats:
        """theta in float64, each component rounded once."""
        return np.array([_nearest(x) for x in self.theta], dtype=np.float64)

    def __repr__(self) -> str:
        return f"Certified({', '.join(self.strings(10))}; radius {self.radius:.0e})"


def _dyadic(x: int, exponent: int) -> Fraction:
    return Fraction(x << exponent) if exponent >= 0 else Fraction(x, 1 << -exponent)


def _nearest(x: Fraction) -> float:
    try:
        return float(x)
    except OverflowError:
        return np.inf if x > 0 else -np.inf
