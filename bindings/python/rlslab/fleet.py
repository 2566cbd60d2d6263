"""Many filters of one problem, a row each at a time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _core, _options, _rows
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

    def update(self, Psi: ArrayLike, y: ArrayLike) -> int:
        """Process a row for each filter.

        Parameters
        ----------
        Psi : array_like, shape (M, d)
            In place where it is contiguous.
        y : array_like, shape (M,)

        Returns
        -------
        int
            How many rows were missing: a filter whose row has a number that is not finite stays as it was.
        """
        P, v = _rows.block(Psi, y, self.size)
        if len(v) != self.filters:
            raise ValueError(f"{len(v)} rows for {self.filters} filters")
        return self._update(_rows.contiguous(P), v)

    @property
    def theta(self) -> NDArray[np.floating[Any]]:
        """The estimated parameters of all, shape (M, d), a copy."""
        out = np.empty((self.filters, self.size))
        self._theta(out)
        return out.astype(self._made["dtype"], copy=False)

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
