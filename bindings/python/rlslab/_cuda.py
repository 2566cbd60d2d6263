"""Fleets on a GPU: the library of bindings/python/gpu.cpp, and rows that stay where torch, cupy or jax have them."""

from __future__ import annotations

import ctypes
import pathlib
import threading
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _rows

_library: ctypes.CDLL | None = None


def _call(name: str, *arguments: Any) -> None:
    """ValueError or RuntimeError with the library's sentence where it fails."""
    global _library
    if _library is None:
        path = pathlib.Path(__file__).with_name("_gpu.so")
        if not path.exists():
            raise RuntimeError("this rlslab was built without fleets on a GPU (clang-16)")
        _library = ctypes.CDLL(str(path))
    words = ctypes.create_string_buffer(256)
    if code := getattr(_library, "rlslab_gpu_" + name)(*arguments, words):
        raise (ValueError if code == 2 else RuntimeError)(words.value.decode())


def _address(array: NDArray[Any] | None) -> ctypes.c_void_p:
    return ctypes.c_void_p(None if array is None else array.ctypes.data)


def _on_gpu(array: Any, name: str, dtype: np.dtype[Any], shape: tuple[int, ...]) -> tuple[int, list[int]]:
    """The address of an array that is on the GPU, and its strides in numbers."""
    if hasattr(array, "block_until_ready"):
        array.block_until_ready()  # jax: what makes it may not have been started
    about = getattr(array, "__cuda_array_interface__", None)
    if about is None:
        raise TypeError(f"{name} is not on the GPU, as the other is")
    if about.get("mask") is not None:
        raise _rows.is_masked(name)
    if tuple(about["shape"]) != shape:
        raise ValueError(f"{name} has shape {tuple(about['shape'])}, expected {shape}")
    if np.dtype(about["typestr"]) != dtype:
        raise ValueError(f"{name} holds {np.dtype(about['typestr'])} on the GPU, this fleet {dtype}")
    strides = about.get("strides") or [int(np.prod(shape[k + 1 :])) * dtype.itemsize for k in range(len(shape))]
    if any(n % dtype.itemsize for n in (about["data"][0], *strides)):
        raise ValueError(f"{name} is not aligned")
    return int(about["data"][0]), [stride // dtype.itemsize for stride in strides]


class CudaFleet:
    """What `rlslab.Fleet(..., device="cuda")` makes: M filters on the first GPU, with the bits of the CPU.

    `variant` is one of ud, ud_delta, conventional, carlson, gentleman, qr, inverse_qr; `size` 1 to 32.
    """

    device = "cuda"

    def __init__(self, variant: str, filters: int, size: int, options: tuple[Any, ...], dtype: np.dtype[Any]) -> None:
        forgetting, variance, theta, covariance = options
        self.variant, self.filters, self.size, self.dtype = variant, filters, size, dtype
        self._fleet, self._turn = ctypes.c_void_p(), threading.Lock()
        _call(
            "make", ctypes.byref(self._fleet), variant.encode(), int(dtype.itemsize == 8), ctypes.c_int64(filters),
            ctypes.c_int64(size), ctypes.c_double(forgetting), ctypes.c_double(variance), _address(theta),
            _address(covariance),
        )

    def _use(self, name: str, *arguments: Any) -> None:
        if not self._turn.acquire(blocking=False):
            raise RuntimeError("in use by another thread: threads take turns at one fleet")
        try:
            _call(name, self._fleet, *arguments)
        finally:
            self._turn.release()

    def __reduce__(self) -> Any:
        raise TypeError("a fleet on a GPU is not copied: make another, and restore() the state of this one")

    def __del__(self) -> None:
        if _library is not None and getattr(self, "_fleet", None):
            _library.rlslab_gpu_drop(self._fleet)

    def update(self, Psi: Any, y: Any) -> None:
        """Process a row for each filter: arrays of numpy, copied, or of the GPU (torch, cupy, jax), where they are.

        The GPU's have the fleet's dtype and any strides. Rows with a number that is not finite are missing: `missing`
        counts them.
        """
        shape = (self.filters, self.size)
        if hasattr(Psi, "__cuda_array_interface__") or hasattr(y, "__cuda_array_interface__"):
            psi_at, psi_strides = _on_gpu(Psi, "Psi", self.dtype, shape)
            y_at, y_strides = _on_gpu(y, "y", self.dtype, shape[:1])
            strides = (ctypes.c_int64 * 3)(*psi_strides, *y_strides)
            self._use("update", ctypes.c_void_p(psi_at), ctypes.c_void_p(y_at), strides)
            return
        P, v = _rows.block(Psi, y, self.size)
        if len(v) != self.filters:
            raise ValueError(f"{len(v)} rows for {self.filters} filters")
        P, v = np.asfortranarray(P, self.dtype), np.ascontiguousarray(v, self.dtype)
        self._use("update", _address(P), _address(v), None)

    def _read(self, theta: Any = None, health: Any = None, missing: Any = None) -> None:
        self._use("read", _address(theta), _address(health), _address(missing))

    @property
    def theta(self) -> NDArray[np.floating[Any]]:
        """The estimated parameters of all, shape (M, d), a copy on the host."""
        out = np.empty((self.filters, self.size), order="F")
        self._read(theta=out)
        return out.astype(self.dtype, copy=False)

    @property
    def health(self) -> NDArray[np.intp]:
        """The worst health of each filter's steps, shape (M,), as places in `rlslab.HEALTHS`."""
        out = np.empty(self.filters, np.uint8)
        self._read(health=out)
        return out.astype(np.intp)

    @property
    def missing(self) -> int:
        """How many rows were missing so far, of all filters."""
        out = np.zeros(1, np.int64)
        self._read(missing=out)
        return int(out[0])

    @property
    def state(self) -> bytes:
        """The state of all, in the library's format."""
        size = ctypes.c_int64()
        self._use("state", None, ctypes.byref(size))
        out = ctypes.create_string_buffer(size.value)
        self._use("state", out, ctypes.byref(size))
        return out.raw

    def restore(self, state: bytes) -> None:
        """Go on from the state of such a fleet."""
        state = bytes(memoryview(state))
        self._use("load", state, ctypes.c_int64(len(state)))

    def __repr__(self) -> str:
        return f"Fleet({self.variant!r}, filters={self.filters}, size={self.size}, device='cuda')"
