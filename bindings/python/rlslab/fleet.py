"""Many filters of one problem, a row each at a time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _core, _options, _rows
from ._filter import STEP
from ._stateful import Stateful
from ._stateful import remade as _remade  # noqa: F401  where older pickles look for it

Self = TypeVar("Self", bound="Fleet")


class Fleet(Stateful, _core.Fleet):
    """M filters of one variant, size and prior, updated together.

    Plain filters share the lanes of vector instructions; with a guard, window, control or probes they take their rows
    one after another, in one call.

    Each filter computes the bits that it would compute alone.

    Parameters
    ----------
    variant : str
        One of `rlslab.variants()`, but `qr_block`.
    filters : int
        Their number M >= 1.
    size : int
        The number of parameters d of each.
    forgetting, prior_variance, prior_theta, prior_covariance, dtype
        As of `rlslab.Filter`, the same for all.
    window, guard, guard_options, control, certify, digits
        As of `rlslab.Filter`: of every filter, which counts and mends for itself.
    outputs : int, optional
        m outputs of each filter, with dtype complex64 or complex128: what is made then is an `rlslab.Complex`.
    device : {"cpu", "cuda"}
        "cuda": on a GPU, with the same bits; what is made then is a `CudaFleet` (`docs/gpu.md`).

    Raises
    ------
    ValueError
        For a number that no filter has, and an unknown name.

    Examples
    --------
    >>> fleet = rlslab.Fleet("ud", filters=3, size=2)
    >>> for psi in ([1.0, 0.0], [1.0, 1.0]):
    ...     missing = fleet.update(np.tile(psi, (3, 1)), [1.0, 2.0, 3.0])
    >>> fleet.theta.shape, missing
    ((3, 2), 0)
    """

    __slots__ = ("_made",)

    def __new__(
        cls: type[Self],
        variant: str,
        filters: int,
        size: int,
        *,
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
        device: str = "cpu",
        outputs: int | None = None,
    ) -> Self:
        around = _options.composed(window, guard, guard_options, control, certify, digits)
        if around and (_options.is_complex(dtype) or device != "cpu"):
            raise ValueError("a guard, window, control or probes are of fleets of real numbers, on the CPU")
        if _options.is_complex(dtype):
            from ._complex import Complex

            if prior_theta is not None or prior_covariance is not None or device != "cpu":
                raise ValueError("complex numbers: on the CPU, with theta0 = 0 and P0 = prior_variance I")
            return Complex(  # type: ignore[return-value]
                variant, size, filters=filters, outputs=outputs, forgetting=forgetting, prior_variance=prior_variance,
                dtype=dtype,
            )  # fmt: skip
        if outputs is not None:
            raise ValueError("outputs= is of fleets of complex numbers; of real ones make an rlslab.Outputs each")
        arguments = _options.arguments(
            variant, size, forgetting, prior_variance, prior_theta, prior_covariance, dtype, window, guard,
            guard_options, control, certify, digits, filters=filters,
        )  # fmt: skip
        if arguments[-1] < 1:
            raise ValueError("expected filters >= 1")
        if _options.one_of(device, ("cpu", "cuda"), "device") == "cuda":
            from ._cuda import CudaFleet

            return CudaFleet(variant, arguments[-1], arguments[2], arguments[3:7], np.dtype(dtype))  # type: ignore
        self = super().__new__(cls, *arguments)
        self._made = {**_options.made(arguments, dtype, "filters"), **around}
        return self

    @overload
    def update(self, Psi: ArrayLike, y: ArrayLike, *, steps: Literal[False] = False) -> int: ...
    @overload
    def update(self, Psi: ArrayLike, y: ArrayLike, *, steps: Literal[True]) -> NDArray[np.void]: ...
    def update(self, Psi: ArrayLike, y: ArrayLike, *, steps: bool = False) -> int | NDArray[np.void]:
        """Process a row for each filter.

        Parameters
        ----------
        Psi : array_like, shape (M, d)
            In place where it is contiguous.
        y : array_like, shape (M,)
        steps : bool
            Whether to return the step of each filter.

        Returns
        -------
        int, or numpy.ndarray of dtype `rlslab.STEP`, shape (M,)
            How many rows were missing: a filter whose row has a number that is not finite stays as it was. With `steps`
            the bits that each filter alone would return; NaN and "nonfinite" where the row was missing.
        """
        P, v = _rows.block(Psi, y, self.size)
        if len(v) != self.filters:
            raise ValueError(f"{len(v)} rows for {self.filters} filters")
        out = np.empty(len(v), STEP) if steps else None
        missing = self._update(_rows.contiguous(P), v, out)
        return missing if out is None else out

    @overload
    def update_many(
        self, Psi: ArrayLike, y: ArrayLike, *, steps: Literal[False] = False, theta: Literal[False] = False
    ) -> int: ...
    @overload
    def update_many(
        self, Psi: ArrayLike, y: ArrayLike, *, steps: Literal[True], theta: Literal[False] = False
    ) -> NDArray[np.void]: ...
    @overload
    def update_many(
        self, Psi: ArrayLike, y: ArrayLike, *, steps: Literal[False] = False, theta: Literal[True]
    ) -> NDArray[np.floating[Any]]: ...
    @overload
    def update_many(
        self, Psi: ArrayLike, y: ArrayLike, *, steps: Literal[True], theta: Literal[True]
    ) -> tuple[NDArray[np.void], NDArray[np.floating[Any]]]: ...
    def update_many(self, Psi: ArrayLike, y: ArrayLike, *, steps: bool = False, theta: bool = False) -> Any:
        """Process n rows for each filter, the oldest first, as `update` would one after another.

        Parameters
        ----------
        Psi : array_like, shape (n, M, d)
        y : array_like, shape (n, M)
        steps, theta : bool
            Whether to return the step of each row, shape (n, M), and theta after each row, shape (n, M, d); with both
            the pair.

        Returns
        -------
        int, or array, or pair of arrays
            Without `steps` and `theta` how many rows were missing.

        Raises
        ------
        ValueError, TypeError
            As `update` does, before any row is taken.

        Examples
        --------
        >>> fleet = rlslab.Fleet("ud", filters=3, size=1)
        >>> fleet.update_many(np.ones((4, 3, 1)), np.arange(12.0).reshape(4, 3), theta=True)[-1].round(2).tolist()
        [[4.5], [5.5], [6.5]]
        """
        P, v = _rows.numbers(Psi, "Psi"), _rows.numbers(y, "y")
        if P.ndim != 3 or P.shape[1:] != (self.filters, self.size):
            raise ValueError(f"Psi has shape {P.shape}, expected (n, {self.filters}, {self.size})")
        if v.shape != P.shape[:2]:
            raise ValueError(f"y has shape {v.shape}, expected {P.shape[:2]}")
        if P.dtype != v.dtype:
            P, v = P.astype(np.float64, copy=False), v.astype(np.float64, copy=False)
        table = np.empty(v.shape, STEP) if steps else None
        path = np.empty(P.shape, self._made["dtype"]) if theta else None
        missing = 0
        for k in range(len(v)):
            row = _rows.contiguous(P[k]), _rows.contiguous(v[k])
            missing += self._update(*row, None if table is None else table[k])
            if path is not None:
                path[k] = self.theta
        if table is not None:
            return table if path is None else (table, path)
        return missing if path is None else path

    @property
    def theta(self) -> NDArray[np.floating[Any]]:
        """The estimated parameters of all, shape (M, d), a copy."""
        out = np.empty((self.filters, self.size))
        self._theta(out)
        return out.astype(self._made["dtype"], copy=False)

    def _matrix(self, covariance: bool) -> NDArray[np.floating[Any]]:
        name, other = ("covariance", "information") if covariance else ("information", "covariance")
        by_columns = np.empty((self.filters, self.size, self.size))
        if self._matrices(by_columns) != covariance:
            raise AttributeError(f"{self.variant} reports {other}, not {name}", name=name, obj=self)
        return np.ascontiguousarray(by_columns.transpose(0, 2, 1), dtype=self._made["dtype"])

    @property
    def covariance(self) -> NDArray[np.floating[Any]]:
        """P of each filter, shape (M, d, d), a copy. AttributeError for a variant that holds P^-1: `information`."""
        return self._matrix(True)

    @property
    def information(self) -> NDArray[np.floating[Any]]:
        """P^-1 of each filter, shape (M, d, d), a copy. AttributeError for a variant that holds P: `covariance`."""
        return self._matrix(False)

    @property
    def health(self) -> NDArray[np.intp]:
        """Places in `rlslab.HEALTHS`, shape (M,): the worst of a filter's steps, the last where it is guarded."""
        out = np.empty(self.filters)
        self._health(out)
        return out.astype(np.intp)

    @property
    def variant(self) -> str:
        """The variant's name."""
        return str(self._made["variant"])

    def reset(self, which: int) -> None:
        """Make one filter as it was made. IndexError where there is none of that number."""
        self._reset(which)

    def __repr__(self) -> str:
        return f"Fleet({self.variant!r}, filters={self.filters}, size={self.size})"
