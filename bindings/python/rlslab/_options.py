"""The options of a filter, checked, and in the order in which the extension takes them."""

from __future__ import annotations

import difflib
import math
import operator
import os
import reprlib
from collections.abc import Mapping, Sequence
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from . import _core, _rows

Control = Union[str, Sequence[Any], None]
#: Numbers of the guard, in the order of the extension; the last two are counts of rows.
GUARD_NUMBERS = ("largest_variance", "innovation", "least_noise", "asymmetry")
GUARD_ROWS = ("noise_memory", "rebuild_rows")
#: numpy's name of each arithmetic.
ARITHMETICS = {"float32": "float", "float64": "double"}


def one_of(name: object, names: Sequence[str], what: str) -> str:
    """The name, if it is one of them; else ValueError with what there is."""
    if not isinstance(name, str):
        raise TypeError(f"{what} is a name, not {type(name).__name__}")
    if name in names:
        return name
    near = difflib.get_close_matches(name.lower(), names, 1) if len(names) > 3 else []
    hint = f'did you mean "{near[0]}"?' if near else "there are " + ", ".join(names)
    raise ValueError(f"no {what} {reprlib.repr(name)}; {hint}")


def arithmetic(dtype: DTypeLike) -> str:
    """The library's name of a dtype."""
    if isinstance(dtype, str) and dtype == "float":
        raise ValueError('dtype "float": write "float32" or "float64"')
    try:
        return ARITHMETICS[np.dtype(dtype).name]
    except (TypeError, KeyError):
        raise ValueError(f"dtype {reprlib.repr(dtype)}: a filter computes in float32 or float64") from None


def is_complex(dtype: DTypeLike) -> bool:
    """Whether it is one of complex numbers, which filters of their own take."""
    try:
        return np.dtype(dtype).kind == "c"
    except TypeError:
        return False


def whole(value: Any, name: str) -> int:
    """An index; TypeError for 4.0."""
    try:
        out = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is a whole number, not {type(value).__name__}") from None
    if not -(2**62) < out < 2**62:
        raise ValueError(f"{name} is beyond all memory")
    return out


def real(value: Any, name: str) -> float:
    """A number; TypeError for text."""
    if isinstance(value, (str, bytes)):
        raise TypeError(f"{name} is a number, not text")
    if isinstance(value, (complex, np.complexfloating, np.ma.MaskedArray)):
        raise TypeError(f"{name} is a real number, not {type(value).__name__}")
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"{name} is a number, not {type(value).__name__}") from None


def control_numbers(control: Control) -> tuple[str, Any]:
    """Name and numbers of a rule of forgetting; None among them: the default."""
    if control is None:
        return "", None
    if isinstance(control, str):
        return one_of(control, _core.controls(), "control"), None
    try:
        name, *given = tuple(control)
    except (TypeError, ValueError):
        raise TypeError('control is a name, or a name and its numbers: ("fortescue", 0.1, 50)') from None
    values = [math.nan if x is None else real(x, f"a number of control {reprlib.repr(name)}") for x in given]
    return one_of(name, _core.controls(), "control"), np.array(values, dtype=np.float64) if values else None


def guard_numbers(guard: str | None, options: Mapping[str, float] | None) -> tuple[str, Any, int, int]:
    """Policy, four numbers of the guard, and its two counts of rows."""
    if options is not None and not isinstance(options, Mapping):
        raise TypeError("guard_options is a dict")
    given = dict(options or {})
    if guard is None and given:
        raise ValueError("guard_options without a guard")
    for name in given:
        one_of(name, GUARD_NUMBERS + GUARD_ROWS, "guard option")
    for name in given.keys() & set(GUARD_NUMBERS):
        if math.isnan(real(given[name], name)):
            raise ValueError(f"guard_options: expected a number as {name}, or none, not NaN")
    numbers = np.array([real(given.get(n, math.nan), n) for n in GUARD_NUMBERS], dtype=np.float64)
    rows = [whole(given.get(n, 0), n) for n in GUARD_ROWS]
    return "" if guard is None else one_of(guard, _core.guards(), "guard"), numbers, rows[0], rows[1]


def saved(state: bytes) -> tuple[str, dict[str, Any]]:
    """Variant and options of the filter that a state is of, without defaults."""
    variant, arithmetic, size, window, guard, control, numbers, of_guard, *rows, certify, outputs = _core.saved(state)
    dtype = next(name for name, called in ARITHMETICS.items() if called == arithmetic)

    def short(number: float) -> float | None:
        """As it was written, for a number of float32; None: the default."""
        return None if math.isnan(number) else float(str(np.dtype(dtype).type(number)))

    given = zip(GUARD_NUMBERS + GUARD_ROWS, [*map(short, of_guard), *(n or None for n in rows)])
    options: dict[str, Any] = {
        "dtype": dtype,
        "window": window,
        "guard": guard or None,
        "guard_options": {name: value for name, value in given if value is not None} or None,
        "control": (control, *map(short, numbers)) if numbers else control or None,
        "certify": certify,
        "outputs": outputs or None,
    }
    return variant, {"size": size, **options}


def expect_memory(numbers: int) -> None:
    """MemoryError where so many numbers are more than the machine has: not after its memory was asked for."""
    try:
        bytes_there = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        bytes_there = 2**62
    if 4 * numbers > bytes_there:
        raise MemoryError(f"this takes {4e-9 * numbers:.3g} GB or more; the machine has {1e-9 * bytes_there:.3g} GB")


def arguments(
    variant: str,
    size: int,
    forgetting: float,
    prior_variance: float | None,
    prior_theta: ArrayLike | None,
    prior_covariance: ArrayLike | None,
    dtype: DTypeLike,
    window: int = 0,
    guard: str | None = None,
    guard_options: Mapping[str, float] | None = None,
    control: Control = None,
    certify: int = 0,
    digits: int = 0,
    filters: int = 1,
    outputs: int | None = None,
) -> tuple[Any, ...]:
    """What `_core.Filter`, `_core.Fleet` and `_core.Outputs` are made with."""
    d = whole(size, "size")
    if d < 1:
        raise ValueError("expected size >= 1")
    rows, M = whole(window, "window"), whole(filters, "filters")
    m = 0 if outputs is None else whole(outputs, "outputs")
    if outputs is not None and m < 1:
        raise ValueError("expected outputs >= 1")
    expect_memory(max(M, 1) * d * (d + max(rows, 0)) + d * m)
    variance = 0.0 if prior_variance is None else real(prior_variance, "prior_variance")
    if prior_variance is not None and not 0 < variance < float("inf"):
        raise ValueError("expected a finite prior_variance > 0, or None: no prior")
    name, numbers = control_numbers(control)
    policy, of_guard, memory, rebuild = guard_numbers(guard, guard_options)
    return (
        one_of(variant, _core.variants(), "variant"),
        arithmetic(dtype),
        d,
        real(forgetting, "forgetting"),
        variance,
        _rows.prior(prior_theta, (d,), "prior_theta"),
        _rows.prior(prior_covariance, (d, d), "prior_covariance"),
        rows,
        policy,
        name,
        numbers,
        of_guard,
        memory,
        rebuild,
        whole(certify, "certify") if certify is not True else 3,
        whole(digits, "digits"),
        m or M,
    )


def composed(
    window: Any, guard: Any, guard_options: Any, control: Any, certify: Any, digits: Any
) -> dict[str, Any]:
    """What is around a variant, as it is kept: without defaults."""
    given = {
        "window": window,
        "guard": guard,
        "guard_options": dict(guard_options) if guard_options else None,
        "control": control if control is None or isinstance(control, str) else tuple(control),
        "certify": 3 if certify is True else certify,
        "digits": digits,
    }
    return {name: value for name, value in given.items() if value}


def made(arguments: tuple[Any, ...], dtype: DTypeLike, count: str) -> dict[str, Any]:
    """What a fleet, or several outputs, of these `arguments` was made with; `count` names the last one."""
    variant, _, size, forgetting, prior_variance, prior_theta, prior_covariance = arguments[:7]
    return {
        "variant": variant,
        "size": size,
        count: arguments[-1],
        "forgetting": forgetting,
        "prior_variance": prior_variance or None,
        "prior_theta": prior_theta,
        "prior_covariance": prior_covariance,
        "dtype": np.dtype(dtype).name,
    }
