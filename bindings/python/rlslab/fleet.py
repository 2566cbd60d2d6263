"""Many filters of one problem, a row each at a time."""

from __future__ import annotations

import reprlib
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _core, _options, _rows

Self = TypeVar("Self", bound="Fleet")


class Fleet(_core.Fleet):
    """M filters of one variant, size and prior, updated together in the lanes of vector instructions.

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
    _made: dict[str, Any]

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
        device: str = "cpu",
    ) -> Self:
        arguments = _options.arguments(
            variant, size, forgetting, prior_variance, prior_theta, prior_covariance, dtype, filters=filters
        )
        if arguments[-1] < 1:
            raise ValueError("expected filters >= 1")
        if _options.one_of(device, ("cpu", "cuda"), "device") == "cuda":
            from ._cuda import CudaFleet

            return CudaFleet(variant, arguments[-1], arguments[2], arguments[3:7], np.dtype(dtype))  # type: ignore
        self = super().__new__(cls, *arguments)
        self._made = {
            "variant": variant,
            "filters": arguments[-1],
            "size": arguments[2],
            "forgetting": arguments[3],
            "prior_variance": arguments[4] or None,
            "prior_theta": arguments[5],
            "prior_covariance": arguments[6],
            "dtype": np.dtype(dtype).name,
        }
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
        """The worst health of each filter's steps, shape (M,), as places in `rlslab.HEALTHS`."""
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

    @property
    def state(self) -> bytes:
        """The state of all, in the library's format."""
        return self._state()

    def restore(self, state: bytes) -> None:
        """Go on from the state of such a fleet. ValueError for other bytes; this one is then as it was."""
        self._load(state)

    def copy(self: Self) -> Self:
        """A fleet that goes on from here on its own."""
        out = self._clone()
        out._made = self._made
        return out

    __copy__ = copy

    def __deepcopy__(self: Self, memo: dict[int, Any]) -> Self:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        return _remade, (1, type(self), self._made, self.state)

    def __repr__(self) -> str:
        return f"Fleet({self.variant!r}, filters={self.filters}, size={self.size})"


def _remade(version: int, made_of: type[Fleet], options: dict[str, Any], state: bytes) -> Fleet:
    if version != 1:
        raise ValueError(f"a pickle of version {reprlib.repr(version)}; this rlslab reads version 1")
    if not (isinstance(made_of, type) and issubclass(made_of, Fleet) and isinstance(options, dict)):
        raise ValueError("a damaged pickle of a fleet")
    out = made_of(**options)
    out.restore(state)
    return out
