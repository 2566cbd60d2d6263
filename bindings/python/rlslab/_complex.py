"""Filters of complex numbers: echo paths, channels, the bins of a spectrum."""

from __future__ import annotations

from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _options
from ._stateful import in_pythons_words
from .fleet import Filters

Self = TypeVar("Self", bound="Complex")


STEP = np.dtype([
    ("innovation", "c16"), ("residual", "c16"), ("gamma", "f8"), ("health", "i4"), ("signal", "i4"),
])    # fmt: skip


class ComplexSteps(NamedTuple):
    """What rows did to filters of complex numbers: arrays, NaN and "nonfinite" where a row was missing."""

    innovation: NDArray[np.complexfloating[Any, Any]]
    residual: NDArray[np.complexfloating[Any, Any]]
    gamma: NDArray[np.floating[Any]]
    health: NDArray[np.int32]


class Complex(Filters):
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

    __slots__ = ()

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
            self = super().__new__(cls, arguments, m, True)
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

    def _taken(
        self, many: bool, psi: ArrayLike, y: ArrayLike, weights: ArrayLike | None, name: str
    ) -> ComplexSteps:
        given = self._given(many, psi, y, weights, name)
        table = np.empty(given[1].shape, STEP)
        self._take(len(given[0]) if many else 1, given, table)
        gamma, health = table["gamma"], table["health"]
        if self.outputs is not None:
            gamma, health = gamma[..., 0], health.max(axis=-1)
        innovation, residual = (table[name].astype(self.dtype) for name in ("innovation", "residual"))
        return ComplexSteps(innovation, residual, gamma.astype(innovation.real.dtype), health.astype(np.int32))

    def update(self, psi: ArrayLike, y: ArrayLike, *, weights: ArrayLike | None = None) -> ComplexSteps:
        """Process one row of each filter.

        Parameters
        ----------
        psi : array_like, shape (d,), of a fleet (M, d)
        y : array_like, shape (), (m,), (M,) or (M, m)
            A row with a number that is not finite is missing: its filter stays as it was. So a bin is held through
            silence: give NaN.
        weights : array_like, shape (), of a fleet (M,), optional
            As of `rlslab.Filter.update`, a real number for each filter's row.

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
        return self._taken(False, psi, y, weights, "psi")

    def update_many(self, Psi: ArrayLike, y: ArrayLike, *, weights: ArrayLike | None = None) -> ComplexSteps:
        """Process many rows, the oldest first: `update` with an axis of rows in front of each array.

        The interpreter's lock is released meanwhile. ValueError for other shapes, before any row is taken.
        """
        return self._taken(True, Psi, y, weights, "Psi")

    def reset(self) -> None:
        """Make it as it was made."""
        for i in range(self.filters or 1):
            self._reset(i)

    def __repr__(self) -> str:
        return f"Complex({', '.join(f'{k}={v!r}' for k, v in self._made.items() if v is not None)})"
