"""Filters of complex numbers: echo paths, channels, the bins of a spectrum."""

from __future__ import annotations

from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _core, _options, _rows
from ._stateful import Stateful, in_pythons_words

Self = TypeVar("Self", bound="Complex")


class ComplexSteps(NamedTuple):
    """What rows did to filters of complex numbers: arrays, NaN and "nonfinite" where a row was missing."""

    innovation: NDArray[np.complexfloating[Any, Any]]
    residual: NDArray[np.complexfloating[Any, Any]]
    gamma: NDArray[np.floating[Any]]
    health: NDArray[np.int32]


class Complex(Stateful, _core.Complex):
    """Recursive least squares of complex numbers, alone or M filters in lockstep, of one output or m.

    ``rlslab.Ud(d, dtype="complex64")`` makes one filter, ``rlslab.Fleet("ud", M, d, dtype="complex64")`` a fleet;
    ``outputs=m`` gives several outputs of one psi. The model is y = psi'theta, psi' the conjugate transpose: it
    minimises prior + sum_i forgetting^(k-i) |y_i - psi_i'theta|^2. For an echo path d = h^T u without conjugation give
    ``u.conj()`` as psi, and theta is h. Each filter has the bits that it has alone.

    Parameters
    ----------
    variant : str
        One of `rlslab.variants()`, but `qr_block`. Several outputs: of the variants that report P.
    size : int
        The number of parameters d >= 1.
    filters, outputs : int, optional
        M and m. None: one, and the arrays have no axis for it.
    forgetting, prior_variance
        As of `rlslab.Filter`, the same for all.
    dtype : "complex128" or "complex64"
        The arithmetic. A filter of complex64 rounds each part of a row once.

    Raises
    ------
    ValueError
        For a number that no filter has, an unknown name, and several outputs of a variant that reports P^-1.

    Examples
    --------
    >>> f = rlslab.Ud(2, dtype="complex128")
    >>> rng = np.random.default_rng(1)
    >>> U = rng.standard_normal((50, 2)) + 1j * rng.standard_normal((50, 2))
    >>> steps = f.update_many(U.conj(), U @ [1 + 2j, 3 - 1j])
    >>> f.theta.round(3)
    array([1.+2.j, 3.-1.j])
    """

    __slots__ = ("_made",)

    def __new__(
        cls: type[Self],
        variant: str,
        size: int,
        *,
        filters: int | None = None,
        outputs: int | None = None,
        forgetting: float = 1.0,
        prior_variance: float | None = 16384.0,
        dtype: DTypeLike = "complex128",
    ) -> Self:
        parts = _options.one_of(np.dtype(dtype).name, ("complex128", "complex64"), "dtype")
        real = "float64" if parts == "complex128" else "float32"
        M = 1 if filters is None else _options.whole(filters, "filters")
        m = 1 if outputs is None else _options.whole(outputs, "outputs")
        if M < 1 or m < 1:
            raise ValueError("expected filters >= 1 and outputs >= 1")
        arguments = _options.arguments(variant, size, forgetting, prior_variance, None, None, real, filters=M)
        _options.expect_memory(2 * M * arguments[2] * (arguments[2] + m))
        try:
            self = super().__new__(cls, arguments, m)
        except ValueError as error:
            raise in_pythons_words(error) from None
        self._made = {
            "variant": variant,
            "size": arguments[2],
            "filters": None if filters is None else M,
            "outputs": None if outputs is None else m,
            "forgetting": arguments[3],
            "prior_variance": arguments[4] or None,
            "dtype": parts,
        }
        return self

    @property
    def filters(self) -> int | None:
        """The number of filters M; None of one filter, whose arrays have no axis for it."""
        return self._made["filters"]  # type: ignore[no-any-return]

    @property
    def outputs(self) -> int | None:
        """The number of outputs m; None of one output, whose arrays have no axis for it."""
        return self._made["outputs"]  # type: ignore[no-any-return]

    @property
    def dtype(self) -> np.dtype[Any]:
        """The arithmetic: complex128 or complex64."""
        return np.dtype(self._made["dtype"])

    def _axes(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """The axis of filters and that of outputs, or none."""
        M, m = self.filters, self.outputs
        return () if M is None else (M,), () if m is None else (m,)

    def _taken(self, many: bool, psi: ArrayLike, y: ArrayLike, name: str) -> ComplexSteps:
        lead, tail = self._axes()
        P, v = numbers(psi, name), numbers(y, "y")
        rows = (P.shape[:1] or (0,)) if many else ()
        for array, called, shape in ((P, name, (*lead, self.size)), (v, "y", lead + tail)):
            if array.shape != rows + shape:
                wanted = str(("n", *shape) if rows else shape).replace("'n'", "n")
                raise ValueError(f"{called} has shape {array.shape}, expected {wanted}")
        if not P.dtype == v.dtype == self.dtype == np.complex64:
            P, v = P.astype(np.complex128, copy=False), v.astype(np.complex128, copy=False)
        real = P.real.dtype
        innovation, residual = (np.empty(v.shape, np.complex128) for _ in range(2))
        gamma, health = np.empty(rows + lead), np.empty(rows + lead, np.int32)
        pairs = [np.require(x, requirements=["C", "A"]).reshape(-1).view(real) for x in (P, v)]
        self._update(rows[0] if rows else 1, *pairs, innovation, residual, gamma, health)
        kind = self.dtype
        return ComplexSteps(
            innovation.astype(kind, copy=False), residual.astype(kind, copy=False),
            gamma.astype(np.empty(0, kind).real.dtype, copy=False), health,
        )  # fmt: skip

    def update(self, psi: ArrayLike, y: ArrayLike) -> ComplexSteps:
        """Process one row of each filter.

        Parameters
        ----------
        psi : array_like, shape (d,), of a fleet (M, d)
        y : array_like, shape (), (m,), (M,) or (M, m)
            A row with a number that is not finite is missing: its filter stays as it was. So a bin is held through
            silence: give NaN.

        Returns
        -------
        ComplexSteps
            ``innovation`` y - psi'theta(k-1) and ``residual`` y - psi'theta(k) in the shape of y; ``gamma``, real, and
            ``health``, places in `rlslab.HEALTHS`, a number for each filter.

        Examples
        --------
        >>> f = rlslab.Fleet("ud", 3, 2, dtype="complex64", outputs=2)
        >>> f.update(np.ones((3, 2)), 1j * np.ones((3, 2))).innovation.shape
        (3, 2)
        """
        return self._taken(False, psi, y, "psi")

    def update_many(self, Psi: ArrayLike, y: ArrayLike) -> ComplexSteps:
        """Process many rows, the oldest first: `update` with an axis of rows in front of each array.

        The interpreter's lock is released meanwhile. ValueError for other shapes, before any row is taken.
        """
        return self._taken(True, Psi, y, "Psi")

    @property
    def theta(self) -> NDArray[np.complexfloating[Any, Any]]:
        """The estimated parameters, a copy: shape (d,), of a fleet (M, d), with a last axis of m outputs."""
        lead, tail = self._axes()
        out = np.empty((*lead, self.size, *tail), np.complex128)
        self._theta(out.view(np.float64))
        return out.astype(self.dtype, copy=False)

    def _square(self, covariance: bool) -> NDArray[np.complexfloating[Any, Any]]:
        name, other = ("covariance", "information") if covariance else ("information", "covariance")
        if covariance != self._reports_covariance:
            raise AttributeError(f"{self.variant} reports {other}, not {name}", name=name, obj=self)
        by_columns = np.empty((*self._axes()[0], self.size, self.size), np.complex128)
        self._matrix(by_columns.view(np.float64))
        return np.ascontiguousarray(by_columns.swapaxes(-1, -2), dtype=self.dtype)

    @property
    def covariance(self) -> NDArray[np.complexfloating[Any, Any]]:
        """P, shape (d, d), of a fleet (M, d, d), a copy. AttributeError for a variant that holds P^-1."""
        return self._square(True)

    @property
    def information(self) -> NDArray[np.complexfloating[Any, Any]]:
        """P^-1, shape (d, d), of a fleet (M, d, d), a copy. AttributeError for a variant that holds P."""
        return self._square(False)

    @property
    def health(self) -> NDArray[np.int32]:
        """A place in `rlslab.HEALTHS`, of a fleet shape (M,): undetermined until theta is, then the worst so far."""
        out = np.empty(self._axes()[0])
        self._health(out.reshape(-1))
        return out.astype(np.int32)

    def reset(self) -> None:
        """Make it as it was made."""
        self._reset()

    def __repr__(self) -> str:
        return f"Complex({', '.join(f'{k}={v!r}' for k, v in self._made.items() if v is not None)})"


def numbers(given: ArrayLike, name: str) -> NDArray[Any]:
    """complex64 or complex128; what is real as complex128."""
    array = _rows.numbers(given, name, "fiubc")
    return array if array.dtype.kind == "c" else array.astype(np.complex128)
