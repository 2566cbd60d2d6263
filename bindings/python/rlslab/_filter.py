"""The filter of any variant: what its eighteen classes share."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _core, _options, _rows
from ._asked import Asked, Certificate, LeastExcited, Removal  # noqa: F401
from ._core import Counts, Step
from ._stateful import Stateful
from ._stateful import remade as _remade  # noqa: F401  where older pickles look for it

if TYPE_CHECKING:
    from .outputs import Outputs


Self = TypeVar("Self", bound="Filter")

#: What the health of a step can be. `steps["health"]` of `Filter.update_many` holds places in this tuple.
HEALTHS: tuple[str, ...] = _core.healths()
#: What a guard can see of a row. `steps["signal"]` holds places in this tuple.
SIGNALS: tuple[str, ...] = _core.signals()
#: The dtype of the steps of many rows.
STEP = np.dtype(
    [("innovation", "=f8"), ("residual", "=f8"), ("gamma", "=f8"), ("health", "=i4"), ("signal", "=i4")]
)

_core.use(np.ndarray, _rows.SCALARS, _rows.row, _rows.output)


class Filter(Stateful, Asked):
    """Recursive least squares of one output: what the classes of all variants share.

    After k rows theta minimises

        J = lambda^k (theta - theta0)' P0^-1 (theta - theta0) + sum_i lambda^(k-i) (y_i - psi_i'theta)^2

    where lambda is ``forgetting``, theta0 ``prior_theta`` and P0 the prior's covariance, in units of the noise's
    variance. A prior keeps theta from the answer without one by b, (I - A) b = A (theta - theta0), A = lambda^k P
    P0^-1. So the default, theta0 = 0 and P0 = 16384 I, decides where theta is large in its unit, or where a constant
    stands beside a column far from 0; ``prior_variance=None`` is none. docs/python.md computes b. Make one by its
    class, `rlslab.Ud(4)`, or by its name, `rlslab.filter("ud", 4)`.

    Parameters
    ----------
    size : int
        The number of parameters d >= 1.
    forgetting : float
        lambda, 0 < lambda <= 1; 1 keeps all rows for ever. A row's weight halves in log(2) / (1 - lambda) rows.
    prior_variance : float or None
        c^2 of P0 = c^2 I. None: no prior, which `qr`, `qr_block`, `gentleman` and `information` allow; their health is
        then "undetermined" until the rows determine theta.
    prior_theta : array_like, shape (d,), optional
        theta0; 0 where it is left out.
    prior_covariance : array_like, shape (d, d), optional
        P0 in place of c^2 I, symmetric and positive definite.
    dtype : "float64" or "float32"
        The arithmetic. A filter of float32 rounds each number of a row once. "complex128" or "complex64": what is made
        is an `rlslab.Complex`, of a plain variant.
    window : int
        Only the last `window` rows count; 0: all.
    guard : str or None
        What to do about rows that are not finite, outliers, changes, windup and breakdown: a policy of
        `rlslab.guards()`. "report" counts, "reset" also skips outliers and starts again where it must.
    guard_options : dict, optional
        Numbers of the guard: "largest_variance" of a parameter, in units of the noise's; "innovation", in standard
        deviations, beyond which a row is an outlier; "least_noise", a standard deviation; "asymmetry" of P;
        "noise_memory" and "rebuild_rows", in rows.
    control : str or tuple, optional
        A rule of `rlslab.controls()` that sets lambda, or changes P, at each row; with numbers of its own as
        ("fortescue", 0.1, 50), None among them for a default.
    certify : int
        Random probes, 1 to 6, that follow every row in float64; True: 3; 0: none. `certificate` then shows how
        many digits of P and theta are left. The filter's bits stay. Not of `kalman`, `extended_qr` and `qr_block`.
    outputs : int, optional
        m outputs of one psi: what is made is an `rlslab.Outputs`. A plain variant: the options from `window` on are
        left out.
    digits : int
        Of P, that the guard asks of the probes: a bound above 10^-digits at every 100th row is a breakdown, about which
        `guard` does what it does, "rebuild" from the last rows. 0: none. Not in `state`.

    Raises
    ------
    ValueError
        For a number that no filter has, an unknown name, and a window, guard or control that the variant cannot carry.
    TypeError
        For text or objects in place of numbers.

    Notes
    -----
    A breakdown is a result, never an exception: the step's health says so, and theta may be NaN from then on. Threads
    take turns at one filter: what is called while `update_many` runs in another thread raises RuntimeError.

    Examples
    --------
    >>> f = rlslab.Ud(2, forgetting=0.99)
    >>> for psi, y in [([1, 0], 3), ([1, 1], 5), ([1, 2], 7)]:
    ...     step = f.update(psi, y)
    >>> f.theta.round(3)
    array([3., 2.])
    """

    __slots__ = ("_made",)
    _variant: ClassVar[str] = ""

    @overload
    def __new__(
        cls: type[Self],
        size: int,
        *,
        outputs: None = ...,
        forgetting: float = ...,
        prior_variance: float | None = ...,
        prior_theta: ArrayLike | None = ...,
        prior_covariance: ArrayLike | None = ...,
        dtype: DTypeLike = ...,
        window: int = ...,
        guard: str | None = ...,
        guard_options: Mapping[str, float] | None = ...,
        control: _options.Control = ...,
        certify: int = ...,
        digits: int = ...,
    ) -> Self: ...
    @overload
    def __new__(    # type: ignore[misc]
        cls,
        size: int,
        *,
        outputs: int,
        forgetting: float = ...,
        prior_variance: float | None = ...,
        prior_theta: ArrayLike | None = ...,
        prior_covariance: ArrayLike | None = ...,
        dtype: DTypeLike = ...,
    ) -> Outputs: ...
    def __new__(
        cls: type[Any],
        size: int,
        *,
        outputs: int | None = None,
        forgetting: float = 1.0,
        prior_variance: float | None = 16384.0,
        prior_theta: ArrayLike | None = None,
        prior_covariance: ArrayLike | None = None,
        dtype: DTypeLike = "float64",
        window: int = 0,
        guard: str | None = None,
        guard_options: Mapping[str, float] | None = None,
        control: _options.Control = None,
        certify: int = 0,
        digits: int = 0,
    ) -> Any:
        if not cls._variant:
            raise TypeError("Filter is of no variant: rlslab.Ud(4), or rlslab.filter('ud', 4)")
        plain = not (window or guard is not None or guard_options or control is not None or certify or digits)
        if _options.is_complex(dtype):
            from ._complex import Complex

            if not plain or prior_theta is not None or prior_covariance is not None:
                raise ValueError(
                    "complex numbers are of a plain variant: size, outputs, forgetting, prior_variance, dtype"
                )
            return Complex(
                cls._variant, size, outputs=outputs, forgetting=forgetting, prior_variance=prior_variance, dtype=dtype
            )
        if outputs is not None:
            from .outputs import Outputs

            if not plain:
                raise ValueError("outputs= is of a plain variant: without window, guard, control, certify and digits")
            return Outputs(
                cls._variant, size, outputs, forgetting=forgetting, prior_variance=prior_variance,
                prior_theta=prior_theta, prior_covariance=prior_covariance, dtype=dtype,
            )  # fmt: skip
        arguments = _options.arguments(
            cls._variant, size, forgetting, prior_variance, prior_theta, prior_covariance, dtype, window, guard,
            guard_options, control, certify, digits,
        )  # fmt: skip
        self = _core.Filter.__new__(cls, *arguments)
        made = {
            "size": arguments[2],
            "forgetting": arguments[3],
            "prior_variance": arguments[4] or None,
            "prior_theta": arguments[5],
            "prior_covariance": arguments[6],
            "dtype": np.dtype(dtype).name,
            **_options.composed(window, guard, guard_options, control, certify, digits),
        }
        defaults = Filter.__new__.__kwdefaults__ or {}
        self._made = {
            name: value
            for name, value in made.items()
            if name not in defaults or isinstance(value, np.ndarray) or value != defaults[name]
        }
        return self

    @overload
    def update_many(
        self, Psi: ArrayLike, y: ArrayLike, *, weights: ArrayLike | None = None, steps: Literal[False] = False,
        theta: Literal[False] = False,
    ) -> Step | None: ...
    @overload
    def update_many(
        self, Psi: ArrayLike, y: ArrayLike, *, weights: ArrayLike | None = None, steps: Literal[True],
        theta: Literal[False] = False,
    ) -> NDArray[np.void]: ...
    @overload
    def update_many(
        self, Psi: ArrayLike, y: ArrayLike, *, weights: ArrayLike | None = None, steps: Literal[False] = False,
        theta: Literal[True],
    ) -> NDArray[np.floating[Any]]: ...
    @overload
    def update_many(
        self, Psi: ArrayLike, y: ArrayLike, *, weights: ArrayLike | None = None, steps: Literal[True],
        theta: Literal[True],
    ) -> tuple[NDArray[np.void], NDArray[np.floating[Any]]]: ...
    def update_many(
        self, Psi: ArrayLike, y: ArrayLike, *, weights: ArrayLike | None = None, steps: bool = False,
        theta: bool = False,
    ) -> Any:
        """Process many rows, the oldest first, as `update` would one after another.

        Parameters
        ----------
        Psi : array_like, shape (n, d)
            In place where each row is contiguous, as in an array of order C or some of its rows; a copy is made of
            other layouts.
        y : array_like, shape (n,)
        weights : array_like, shape (n,), optional
            One for each row, as of `update`; all 1 where left out. 0: a missing output.
        steps : bool
            Whether to return the step of each row.
        theta : bool
            Whether to return theta after each row, shape (n, d): the bits of `theta` after `update`, row by row, of
            `qr_block` too. With `steps` the pair of both.

        Returns
        -------
        Step or None, or numpy.ndarray of dtype `rlslab.STEP`
            The step of the last row, None for no rows; with `steps` the step of each. Its "health" and "signal" are
            places in `rlslab.HEALTHS` and `rlslab.SIGNALS`. Without `steps` `qr_block` takes its rows in blocks and
            reports NaN and its health.

        Raises
        ------
        ValueError
            If the shapes are others, before any row is taken.
        TypeError
            If there is something else than real numbers.

        Notes
        -----
        The interpreter's lock is released meanwhile.

        Examples
        --------
        >>> Psi = np.array([[1.0, 0.0], [1.0, 1.0], [1.0, 2.0]])
        >>> f = rlslab.Ud(2)
        >>> steps = f.update_many(Psi, Psi @ [3.0, 2.0], steps=True)
        >>> bool((steps["health"] == rlslab.HEALTHS.index("sound")).all())
        True
        """
        P, v = _rows.block(Psi, y, self.size)
        w = None
        if weights is not None:
            P, v, w = _rows.weighted(P, v, weights)
        if theta:
            table, path = np.empty(len(v), STEP), np.empty(P.shape)
            self._theta_path(P, v, w, table, path)
            path = path.astype(self.dtype, copy=False)
            return (table, path) if steps else path
        if not steps:
            return self._update_many(P, v, None, w)
        out = np.empty(len(v), STEP)
        self._update_many(P, v, out, w)
        return out

    @property
    def theta(self) -> NDArray[np.floating[Any]]:
        """The estimated parameters, shape (d,), a copy; NaN until the rows determine them.

        Where columns depend on one another it may be any number, 1e15 as well: `health` is "undetermined" then.
        """
        out = np.empty(self.size)
        self._theta(out)
        return out.astype(self.dtype, copy=False)

    @property
    def gain(self) -> NDArray[np.floating[Any]]:
        """The gain K of the last row, shape (d,), a copy: theta(k) = theta(k-1) + K innovation.

        Of a row of weight w a state keeps K / sqrt(w), the gain of the row as the filter took it: so it is after
        `load`.
        """
        out = np.empty(self.size)
        self._gain(out)
        return out.astype(self.dtype, copy=False)

    def _matrix(self, covariance: bool) -> NDArray[np.floating[Any]]:
        name, other = ("covariance", "information") if covariance else ("information", "covariance")
        if covariance != self._reports_covariance:
            raise AttributeError(f"{self.variant} reports {other}, not {name}", name=name, obj=self)
        by_columns = np.empty((self.size, self.size))
        (self._covariance if covariance else self._information)(by_columns)
        return np.ascontiguousarray(by_columns.T, dtype=self.dtype)

    @property
    def covariance(self) -> NDArray[np.floating[Any]]:
        """P, shape (d, d), a copy, in units of the noise's variance.

        AttributeError for a variant that holds P^-1: `information` then. P of `conventional`, which stores all of it,
        may have lost its symmetry.
        """
        return self._matrix(True)

    @property
    def information(self) -> NDArray[np.floating[Any]]:
        """P^-1, shape (d, d), a copy. AttributeError for a variant that holds P: `covariance` then."""
        return self._matrix(False)

    @property
    def options(self) -> dict[str, Any]:
        """What the filter was made with, but for defaults: `type(f)(**f.options)` makes another.

        Of a filter from a state alone forgetting and prior are not known, and are left out.
        """
        return dict(self._made)

    def __repr__(self) -> str:
        size, *rest = [repr(v) if k == "size" else f"{k}={v!r}" for k, v in self._made.items()]
        return f"{type(self).__name__}({', '.join([size, *rest])})"
