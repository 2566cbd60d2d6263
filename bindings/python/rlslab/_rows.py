"""Rows of numbers from what people have: arrays of any layout, lists, data frames."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Numbers = NDArray[np.floating[Any]]
#: numpy's real scalars; its differences of time are integers, too.
SCALARS = tuple(
    t for t in np.ScalarType
    if issubclass(t, (np.floating, np.integer, np.bool_)) and not issubclass(t, np.timedelta64)
)


def is_masked(name: str) -> TypeError:
    """What is said of a masked array."""
    return TypeError(f"{name} is a masked array: leave its masked rows out; pass_time() passes their time")


def numbers(given: ArrayLike, name: str, kinds: str = "fiub") -> NDArray[Any]:
    """An array of float64 or float32 in this machine's order of bytes; TypeError for what is no real number.

    Where `kinds` has "c", complex numbers are taken, as complex128 or complex64.
    """
    if type(given) is np.ndarray and given.dtype.char in "fd" and given.dtype.isnative:
        return given    # at once: of many short blocks most of the time would go below
    in_list = given if isinstance(given, (list, tuple)) else ()
    masked = any(isinstance(part, np.ma.MaskedArray) for part in (given, *in_list))
    try:
        array: NDArray[Any] = np.asarray(given)
    except ValueError:
        raise ValueError(f"{name} is no table of numbers: its rows differ in length") from None
    if in_list and array.dtype.kind in "fc" and np.isnan(array).any():    # which is what np.ma.masked becomes
        masked = masked or any(part is np.ma.masked for part in np.array(given, object).flat)
    if masked:
        raise is_masked(name)
    if array.dtype.names:
        raise TypeError(f"{name} is a structured array: give np.column_stack of the columns that it is to have")
    if array.dtype.kind not in kinds and hasattr(given, "dtypes") and hasattr(given, "to_numpy"):
        array = _of_frame(given, name)
    if array.dtype.kind not in kinds:
        raise TypeError(f"{name} holds {array.dtype}, not {'complex' if 'c' in kinds else 'real'} numbers")
    if array.dtype.kind == "c":
        return array.astype(np.complex64 if array.dtype == np.complex64 else np.complex128, copy=False)
    if array.dtype in (np.float32, np.float64) and array.dtype.isnative:
        return array
    return array.astype(np.float64)


def _of_frame(given: Any, name: str) -> NDArray[Any]:
    """Of a data frame or a series of pandas, a column at a time: numbers, true and false, their nullable kinds."""
    out = []
    for label, column in given.items() if given.ndim == 2 else [(given.name, given)]:
        if column.dtype.kind not in "fiub":
            of = name if label is None else f"{name}: column {label!r}"
            raise TypeError(f"{of} holds {column.dtype}, not real numbers: leave it out, or give its .astype(float)")
        out.append(column.to_numpy(np.float64, na_value=np.nan))
    table: NDArray[Any] = np.column_stack(out) if given.ndim == 2 else out[0]
    return table


def contiguous(array: Numbers) -> Numbers:
    """One after another and aligned, as it is where it is so."""
    ready = array.flags.c_contiguous and array.flags.aligned
    return array if ready else np.require(array, requirements=["C", "A"])


def row(psi: ArrayLike, size: int, name: str = "psi") -> Numbers:
    """psi as d contiguous numbers."""
    array = numbers(psi, name)
    if array.shape != (size,):
        many = "; update_many takes many rows" if array.ndim == 2 and name != "theta" else ""
        raise ValueError(f"{name} has shape {array.shape}, expected ({size},){many}")
    return contiguous(array)


def output(y: ArrayLike) -> float:
    """y of one row, a number or an array of one."""
    array = numbers(y, "y")
    if array.size != 1 or (array.ndim and not isinstance(y, np.ndarray)):
        raise ValueError(f"y has shape {array.shape}, expected a number")
    return float(array.reshape(()))


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


def weighted(P: Numbers, v: Numbers, weights: ArrayLike) -> tuple[Numbers, Numbers, Numbers]:
    """Rows and outputs of `block` and their weights, all of one type."""
    w = numbers(weights, "weights")
    if w.shape != v.shape:
        raise ValueError(f"weights has shape {w.shape}, expected {v.shape}: one for each row")
    if w.dtype != P.dtype:
        P, v, w = (array.astype(np.float64, copy=False) for array in (P, v, w))
    return P, v, contiguous(w)


def tables(X: ArrayLike, Y: ArrayLike, size: int, outputs: int) -> tuple[Numbers, Numbers]:
    """Rows of regressors and of outputs, likewise."""
    P, V = numbers(X, "X"), numbers(Y, "Y")
    for array, name, columns in ((P, "X", size), (V, "Y", outputs)):
        if array.ndim != 2 or array.shape[1] != columns:
            raise ValueError(f"{name} has shape {array.shape}, expected (n, {columns})")
    if len(P) != len(V):
        raise ValueError(f"Y has {len(V)} rows, X {len(P)}")
    if P.dtype != V.dtype:
        P, V = P.astype(np.float64, copy=False), V.astype(np.float64, copy=False)
    return P if in_place(P) else contiguous(P), V if in_place(V) else contiguous(V)


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
