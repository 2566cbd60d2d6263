"""Rows of numbers from what people have: arrays of any layout, lists, data frames."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Numbers = NDArray[np.floating[Any]]


def numbers(given: ArrayLike, name: str) -> Numbers:
    """An array of float64 or float32 in this machine's order of bytes; TypeError for what is no real number."""
    in_list = given if isinstance(given, (list, tuple)) else ()
    if any(isinstance(part, np.ma.MaskedArray) for part in (given, *in_list)):
        raise TypeError(f"{name} is a masked array: leave its masked rows out; pass_time() passes their time")
    try:
        array: NDArray[Any] = np.asarray(given)
    except ValueError:
        raise ValueError(f"{name} is no table of numbers: its rows differ in length") from None
    if array.dtype.names:
        raise TypeError(f"{name} is a structured array: give np.column_stack of the columns that it is to have")
    if array.dtype.kind not in "fiub":
        raise TypeError(f"{name} holds {array.dtype}, not real numbers")
    if array.dtype in (np.float32, np.float64) and array.dtype.isnative:
        return array
    return array.astype(np.float64)


def contiguous(array: Numbers) -> Numbers:
    """One after another and aligned, as it is where it is so."""
    return np.require(array, requirements=["C", "A"])


def row(psi: ArrayLike, size: int) -> Numbers:
    """psi as d contiguous numbers."""
    array = numbers(psi, "psi")
    if array.shape != (size,):
        raise ValueError(f"psi has shape {array.shape}, expected ({size},)")
    return contiguous(array)


def in_place(Psi: Numbers) -> bool:
    """Whether each row's numbers stand one after another, and the rows in order."""
    rows, size = Psi.shape
    unit = Psi.itemsize
    across, along = Psi.strides
    return (
        Psi.flags.aligned
        and (size < 2 or along == unit)
        and (rows < 2 or (across >= size * unit and across % unit == 0))
    )


def block(Psi: ArrayLike, y: ArrayLike, size: int) -> tuple[Numbers, Numbers]:
    """Rows and outputs of one type, each row contiguous: in place where they are so, else a copy."""
    P, v = numbers(Psi, "Psi"), numbers(y, "y")
    if P.ndim != 2 or P.shape[1] != size:
        raise ValueError(f"Psi has shape {P.shape}, expected (n, {size})")
    if v.shape != P.shape[:1]:
        raise ValueError(f"y has shape {v.shape}, expected ({P.shape[0]},) as Psi has {P.shape[0]} rows")
    if P.dtype != v.dtype:
        P, v = P.astype(np.float64, copy=False), v.astype(np.float64, copy=False)
    return P if in_place(P) else contiguous(P), contiguous(v)


def prior(given: ArrayLike | None, shape: tuple[int, ...], name: str) -> Numbers | None:
    """Finite numbers of float64 in that shape."""
    if given is None:
        return None
    array = numbers(given, name)
    if array.shape != shape:
        raise ValueError(f"{name} has shape {array.shape}, expected {shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} holds a number that is not finite")
    own = np.array(array, dtype=np.float64, order="C")  # the caller's may change; copies and pickles are made of it
    own.flags.writeable = False
    return own
