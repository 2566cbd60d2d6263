"""Many filters of one problem, a row each at a time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, TypeVar, Union, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _core, _options, _rows
from ._filter import STEP
from ._stateful import Stateful, in_pythons_words
from ._stateful import remade as _remade  # noqa: F401  where older pickles look for it

Self = TypeVar("Self", bound="Fleet")
Rows = tuple[NDArray[Any], NDArray[Any], Union[NDArray[Any], None]]


class Filters(Stateful, _core.Fleet):
    """What `rlslab.Fleet` and `rlslab.Complex` have in common: M filters of m outputs."""

    __slots__ = ("_made",)

    @property
    def filters(self) -> int | None:
        """The number of filters M; None of one filter, whose arrays have no axis for it."""
        return self._made["filters"]  # type: ignore[no-any-return]

    @property
    def outputs(self) -> int | None:
        """The number of outputs m; None of one output, whose arrays have no axis for it."""
        return self._made.get("outputs")

    @property
    def dtype(self) -> np.dtype[Any]:
        """The arithmetic."""
        return np.dtype(self._made["dtype"])

    def _axes(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """The axis of filters and that of outputs, or none."""
        M, m = self.filters, self.outputs
        return () if M is None else (M,), () if m is None else (m,)

    def _given(self, many: bool, psi: ArrayLike, y: ArrayLike, weights: ArrayLike | None, name: str) -> Rows:
        """Rows, outputs and weights of these filters, all of one precision, each contiguous."""
        lead, tail = self._axes()
        kinds = "fiubc" if self.dtype.kind == "c" else "fiub"
        P, v = _rows.numbers(psi, name, kinds), _rows.numbers(y, "y", kinds)
        given = [(P, name, (*lead, self.size)), (v, "y", lead + tail)]
        if weights is not None:
            given.append((_rows.numbers(weights, "weights"), "weights", lead))
        rows = (P.shape[:1] or (0,)) if many else ()
        for array, called, shape in given:
            if array.shape != rows + shape:
                wanted = str(("n", *shape) if many else shape).replace("'n'", "n")
                raise ValueError(f"{called} has shape {array.shape}, expected {wanted}")
        real = "f" if all(array.dtype.char in "fF" for array, _, _ in given) else "d"
        number = real.upper() if "c" in kinds else real
        P, v, *w = (
            _rows.contiguous(array.astype(real if called == "weights" else number, copy=False))
            for array, called, _ in given
        )
        return P, v, w[0] if w else None

    def _take(self, rows: int, given: Rows, table: NDArray[np.void] | None) -> int:
        P, v, w = (None if x is None else x.reshape(-1).view(x.real.dtype) for x in given)
        return self._update(rows, P, v, w, table)

    @property
    def theta(self) -> NDArray[Any]:
        """The estimated parameters, a copy: shape (d,), of a fleet (M, d), with a last axis of m outputs."""
        lead, tail = self._axes()
        out = np.empty((*lead, self.size, *tail), np.result_type(self.dtype, np.float64))
        self._theta(out.view(np.float64))
        return out.astype(self.dtype, copy=False)

    def _matrix(self, covariance: bool) -> NDArray[Any]:
        name, other = ("covariance", "information") if covariance else ("information", "covariance")
        if self._matrices(None) != covariance:
            raise AttributeError(f"{self.variant} reports {other}, not {name}", name=name, obj=self)
        by_columns = np.empty((*self._axes()[0], self.size, self.size), np.result_type(self.dtype, np.float64))
        self._matrices(by_columns.view(np.float64))
        return np.ascontiguousarray(by_columns.swapaxes(-1, -2), dtype=self.dtype)

    @property
    def covariance(self) -> NDArray[Any]:
        """P, shape (d, d), of a fleet (M, d, d), a copy. AttributeError for a variant that holds P^-1."""
        return self._matrix(True)

    @property
    def information(self) -> NDArray[Any]:
        """P^-1, shape (d, d), of a fleet (M, d, d), a copy. AttributeError for a variant that holds P."""
        return self._matrix(False)

    @property
    def health(self) -> NDArray[np.intp]:
        """Places in `rlslab.HEALTHS`, of a fleet shape (M,): the worst of its steps, the last where it is guarded."""
        out = np.empty(self._axes()[0])
        self._health(out.reshape(-1))
        return out.astype(np.intp)


class Fleet(Filters):
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
        As of `rlslab.Filter`, the same for all. complex64 or complex128: what is made is an `rlslab.Complex`.
    window, guard, guard_options, control, certify, digits
        As of `rlslab.Filter`: of every filter, which counts and mends for itself.
    outputs : int, optional
        m outputs of each filter, which share its P: of plain variants that report P. Each has the bits of a filter of
        its own, but those behind the first of `extended_qr`, whose first turns with P.
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

    __slots__ = ()

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
        m = 1 if outputs is None else _options.whole(outputs, "outputs")
        if m < 1 or (outputs is not None and device != "cpu"):
            raise ValueError("expected outputs >= 1, on the CPU")
        arguments = _options.arguments(
            variant, size, forgetting, prior_variance, prior_theta, prior_covariance, dtype, window, guard,
            guard_options, control, certify, digits, filters=filters,
        )  # fmt: skip
        if arguments[-1] < 1:
            raise ValueError("expected filters >= 1")
        _options.expect_memory(arguments[-1] * arguments[2] * (arguments[2] + m))
        if _options.one_of(device, ("cpu", "cuda"), "device") == "cuda":
            from ._cuda import CudaFleet

            return CudaFleet(variant, arguments[-1], arguments[2], arguments[3:7], np.dtype(dtype))  # type: ignore
        try:
            self = super().__new__(cls, arguments, m, False)
        except ValueError as error:
            raise in_pythons_words(error) from None
        self._made = {**_options.made(arguments, dtype, "filters"), **around, **({"outputs": m} if outputs else {})}
        return self

    @overload
    def update(
        self, Psi: ArrayLike, y: ArrayLike, *, weights: ArrayLike | None = None, steps: Literal[False] = False
    ) -> int: ...
    @overload
    def update(
        self, Psi: ArrayLike, y: ArrayLike, *, weights: ArrayLike | None = None, steps: Literal[True]
    ) -> NDArray[np.void]: ...
    def update(
        self, Psi: ArrayLike, y: ArrayLike, *, weights: ArrayLike | None = None, steps: bool = False
    ) -> int | NDArray[np.void]:
        """Process a row for each filter.

        Parameters
        ----------
        Psi : array_like, shape (M, d)
            In place where it is contiguous.
        y : array_like, shape (M,), of m outputs (M, m)
        weights : array_like, shape (M,), optional
            As of `rlslab.Filter.update`. 0, a missing output: time passes. Below 0, infinite or NaN: a missing row.
        steps : bool
            Whether to return the step of each filter.

        Returns
        -------
        int, or numpy.ndarray of dtype `rlslab.STEP`, in the shape of y
            How many rows were missing: a filter whose row has a number that is not finite stays as it was. With `steps`
            the bits that each filter alone would return; NaN and "nonfinite" where the row was missing.
        """
        given = self._given(False, Psi, y, weights, "Psi")
        table = np.empty(given[1].shape, STEP) if steps else None
        missing = self._take(1, given, table)
        return missing if table is None else table

    @overload
    def update_many(
        self, Psi: ArrayLike, y: ArrayLike, *, weights: ArrayLike | None = None, steps: Literal[False] = False,
        theta: Literal[False] = False,
    ) -> int: ...
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
        """Process n rows for each filter, the oldest first, as `update` would one after another.

        Parameters
        ----------
        Psi : array_like, shape (n, M, d)
        y : array_like, shape (n, M), of m outputs (n, M, m)
        weights : array_like, shape (n, M), optional
        steps, theta : bool
            Whether to return the step of each row, in the shape of y, and theta after each row, shape (n, M, d) or
            (n, M, d, m); with both the pair. Without theta the interpreter's lock is released meanwhile.

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
        P, v, w = self._given(True, Psi, y, weights, "Psi")
        table = np.empty(v.shape, STEP) if steps else None
        if not theta:
            missing = self._take(len(P), (P, v, w), table)
            return missing if table is None else table
        lead, tail = self._axes()
        path = np.empty((len(P), *lead, self.size, *tail), self.dtype)
        for k in range(len(P)):
            self._take(1, (P[k], v[k], None if w is None else w[k]), None if table is None else table[k])
            path[k] = self.theta
        return path if table is None else (table, path)

    @property
    def filters(self) -> int:
        """The number of filters M."""
        return int(self._made["filters"])

    def reset(self, which: int) -> None:
        """Make one filter as it was made. IndexError where there is none of that number."""
        self._reset(which)

    def __repr__(self) -> str:
        return f"Fleet({self.variant!r}, filters={self.filters}, size={self.size})"
