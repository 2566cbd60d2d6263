"""Rolling and grouped regressions: arrays and data frames in, the same out."""

from __future__ import annotations

import sys
from collections.abc import Hashable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, _options, _rows

#: What `rolling` can return, in the order of the extension; the first three have a number for each regressor.
ANSWERS = ("theta", "t", "error", "residual", "innovation", "sigma", "r2", "rows")


class Rolled:
    """What `rolling` returns: an attribute for each name in `returns`, in whose order it also unpacks.

    Examples
    --------
    >>> theta, rows = rlslab.rolling([1.0, 2.0, 3.0], [2.0, 4.0, 6.0], window=2, returns=("theta", "rows"))
    >>> theta[:, 0].round(3), rows
    (array([nan,  2.,  2.]), array([1., 2., 2.]))
    """

    __slots__ = {
        "theta": "theta of the window that ends with each row, shape (n, d).",
        "t": "theta_j / error_j, shape (n, d).",
        "error": "The standard error of theta_j, sigma sqrt(r P_jj), shape (n, d).",
        "residual": "y - psi'theta of the window's last row, shape (n,).",
        "innovation": "y - psi'theta by theta of the group's row before, which does not know this y; shape (n,).",
        "sigma": "The noise's standard deviation, shape (n,).",
        "r2": "The part of y's variance, or of y^2 without a constant, that is explained, shape (n,).",
        "rows": "How many rows of the window count, shape (n,).",
        "_asked": "The names, in the order asked.",
    }
    theta: Any
    t: Any
    error: Any
    residual: Any
    innovation: Any
    sigma: Any
    r2: Any
    rows: Any

    def __init__(self, answers: dict[str, Any]) -> None:
        self._asked = tuple(answers)
        for name, answer in answers.items():
            setattr(self, name, answer)

    def __iter__(self) -> Iterator[Any]:
        return (getattr(self, name) for name in self._asked)

    def __repr__(self) -> str:
        return f"Rolled({', '.join(f'{name} {getattr(self, name).shape}' for name in self._asked)})"

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if name in ANSWERS:
                raise AttributeError(f"{name} was not asked for: name it in returns", name=name)
            raise AttributeError(f"'Rolled' object has no attribute {name!r}", name=name)


def rolling(
    X: ArrayLike,
    y: ArrayLike,
    window: int | None = None,
    forgetting: float | None = None,
    groups: ArrayLike | Sequence[Hashable] | None = None,
    min_periods: int | None = None,
    returns: str | Sequence[str] = ("theta", "t", "residual", "sigma"),
) -> Rolled:
    """Least squares over the last rows, for each row and group: rolling, expanding or exponentially weighted.

    With the rows of a window, or all so far, each of weight w = forgetting^(rows of the group after it), and
    P^-1 = sum w psi psi':

        N = sum w,   r = sum w^2 / N,   sigma^2 = sum w (y - psi'theta)^2 / (N - r d)
        error_j = sigma sqrt(r P_jj),   t_j = theta_j / error_j

    Without forgetting N is the number n of rows, r = 1, and sigma^2 = RSS / (n - d), as of ordinary least squares.

    Parameters
    ----------
    X : array_like or DataFrame, shape (n, d) or (n,)
        The regressors, the oldest row first. No constant is added: `np.column_stack([np.ones(len(x)), x])`.
    y : array_like or Series, shape (n,)
    window : int, optional
        Only the last `window` rows of the group count. None: all since the group's first.
    forgetting : float, optional
        lambda, 0 < lambda <= 1; None is 1. With a window, too.
    groups : array_like, shape (n,), optional
        Numbers, strings, categories or other hashable things. Each group is a record of its own, in the order of its
        rows, which need not stand together. Rows whose group is missing (None, NaN) have NaN.
    min_periods : int, optional
        At least so many rows must count: with a window, from so many on there are answers. None: the window has to be
        full (as in pandas and statsmodels). Below d it has no effect.
    returns : str or sequence of str
        Any of "theta", "t", "error", "residual", "innovation", "sigma", "r2", "rows".

    Returns
    -------
    Rolled
        Arrays of float64; where X is a DataFrame (or a Series), or y a Series, DataFrames and Series with its index,
        theta, t and error with the columns of X. It unpacks in the order of `returns`.

    Raises
    ------
    ValueError
        For other shapes, X, y and groups with different indexes, and options that are none.
    TypeError
        For what is no real number.

    Notes
    -----
    There is no prior: theta is NaN until the window determines it, and where it does not, as with a second constant
    column. A column may depend on those before it up to 13 digits of its own size, whatever the units of the columns.

    A row with a number that is not finite keeps its place in the window, lets its time pass, and is left out, as in
    statsmodels' RollingOLS: it has theta of the window's other rows, and no residual.

    No row is taken out of a sum: what has left the window, be it 1e12, has no effect on any bit. One thing is asked of
    all rows of all groups that are not left out: whether a column of X is the same number in them. Beside such a
    constant r2 is less y's mean, and offsets cost no digits; a row of zeros among them, for padding, ends that. r2 is
    never outside [0, 1]; with t of one regressor beside a constant it gives the correlation, `np.sign(t) *
    np.sqrt(r2)`. t, error, sigma and r2 are of squares: columns and y between 1e-150 and 1e150. After a gap so long
    that the weights are below 2^-1000 sigma, error and t are NaN.

    Computes in float64, rows of float32 too. `rlslab.use_threads(2)` lets two threads share the groups and the
    windows, with the same bits. `docs/rolling.md` has times.

    Examples
    --------
    >>> day = np.arange(8.0)
    >>> X, y = np.column_stack([np.ones(8), day]), 1 + 2 * day
    >>> rlslab.rolling(X, y, window=3).theta.round(6).tolist()[1:4]
    [[nan, nan], [1.0, 2.0], [1.0, 2.0]]
    >>> rlslab.rolling(X, y, groups=list("abababab"), returns="rows").rows
    array([1., 1., 2., 2., 3., 3., 4., 4.])
    """
    asked = (returns,) if isinstance(returns, str) else tuple(returns)
    for name in asked:
        _options.one_of(name, ANSWERS, "answer")
    W = 0 if window is None else _options.whole(window, "window")
    if window is not None and W < 1:
        raise ValueError("expected window >= 1 row")
    least = -1 if min_periods is None else _options.whole(min_periods, "min_periods")
    if min_periods is not None and least < 0:
        raise ValueError("expected min_periods >= 0")
    factor = 1.0 if forgetting is None else _options.real(forgetting, "forgetting")
    index, columns = _labels(X, y, groups)
    P, v = _rows.numbers(X, "X"), _rows.numbers(y, "y")
    if P.ndim == 1:
        P = P.reshape(-1, 1)
    if P.ndim != 2 or P.shape[1] < 1:
        raise ValueError(f"X has shape {P.shape}, expected (n, d)")
    if v.shape != P.shape[:1]:
        raise ValueError(f"y has shape {v.shape}, expected ({P.shape[0]},) as X has {P.shape[0]} rows")
    if P.dtype != v.dtype:
        P, v = P.astype(np.float64, copy=False), v.astype(np.float64, copy=False)
    P, v = P if _rows.in_place(P) else _rows.contiguous(P), _rows.contiguous(v)
    codes = None if groups is None else _codes(groups, len(v))
    out = {name: np.empty(P.shape if name in ANSWERS[:3] else v.shape) for name in dict.fromkeys(asked)}
    _core.rolling(P, v, codes, W, factor, least, tuple(out.get(name) for name in ANSWERS))
    if index is None:
        return Rolled(out)
    frames = sys.modules["pandas"]
    return Rolled({
        name: frames.DataFrame(answer, index, columns) if answer.ndim == 2 else frames.Series(answer, index, name=name)
        for name, answer in out.items()
    })  # fmt: skip


def _labels(X: Any, y: Any, groups: Any) -> tuple[Any, Any]:
    """The index of what is of pandas, which has to be one, and X's columns; None, None without it."""
    pandas = sys.modules.get("pandas")    # it is loaded where something is of it
    if pandas is None:
        return None, None
    kinds = pandas.DataFrame, pandas.Series
    labelled = {name: g for name, g in (("X", X), ("y", y), ("groups", groups)) if isinstance(g, kinds)}
    index = None
    for name, given in labelled.items():
        if index is not None and not index.equals(given.index):
            raise ValueError(f"{name} has another index than {next(iter(labelled))}: align them first, as by reindex")
        index = given.index if index is None else index
    if "X" not in labelled and "y" not in labelled:
        return None, None
    if isinstance(X, pandas.DataFrame):
        return index, X.columns
    return index, [X.name if X.name is not None else 0] if "X" in labelled else None


def _missing(group: Any) -> bool:
    """None, NaN, pandas' NA and NaT, a masked one."""
    if group is None or group is np.ma.masked:
        return True
    try:
        hash(group)
        return bool(group != group)
    except TypeError as error:    # NA has no truth
        if "NA" in str(error):
            return True
        raise TypeError(f"groups holds {type(group).__name__}, which is no group: numbers, words or tuples") from None


def _codes(groups: Any, rows: int) -> NDArray[np.int64]:
    """A number below `rows` for each group, -1 where it is missing."""
    pandas = sys.modules.get("pandas")
    if isinstance(groups, np.ma.MaskedArray):
        raise _rows.is_masked("groups")
    if pandas is not None and isinstance(groups, (pandas.Series, pandas.Index, pandas.Categorical)):
        found = pandas.factorize(groups)[0]
    else:
        if isinstance(groups, (list, tuple)):    # as they are: numpy would make "1" of 1 beside "a"
            array = np.empty(len(groups), object)
            array[:] = groups
        else:
            array = np.asarray(groups)
        if array.shape != (rows,):
            raise ValueError(f"groups has shape {array.shape}, expected ({rows},) as X has {rows} rows")
        if array.dtype.kind == "O":
            places: dict[Any, int] = {}
            found = np.array([-1 if _missing(g) else places.setdefault(g, len(places)) for g in array], np.int64)
        elif array.dtype.kind in "iu" and rows and 0 <= array.min() and array.max() < rows:
            found = array
        else:
            found = np.unique(array, return_inverse=True)[1].reshape(-1)
            found = np.where(array != array, -1, found)
    if found.shape != (rows,):
        raise ValueError(f"groups has shape {found.shape}, expected ({rows},) as X has {rows} rows")
    return np.ascontiguousarray(found, np.int64)
