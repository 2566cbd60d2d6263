"""From a record to a model: `identify` and `excitation`."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _options, _program
from ._filter import Filter

Record = dict[str, Any]
Floats = NDArray[np.float64]
Lags = Union[int, Sequence[int], None]


def identify(
    y: ArrayLike,
    u: ArrayLike | None = None,
    *,
    order: int | None = None,
    max_order: int | None = None,
    na: int | None = None,
    nb: Lags = None,
    delay: Lags = None,
    regressors: Iterable[str] = (),
    intercept: bool = False,
    detrend: bool = True,
    variant: str = "ud",
    forgetting: float = 1.0,
    prior_variance: float | None = None,
    window: int = 0,
    guard: str | None = None,
    control: Any = None,
    validate: float = 1 / 3,
    confidence: float = 0.95,
    sample_time: float | None = None,
    noise_model: int | None = None,
    instruments: int | None = None,
) -> Identification:
    """An ARX model of a record, its uncertainty, and whether to believe it: what `rlslab identify` does.

        y[k] + a1 y[k-1] + ... = b0 u[k-delay] + b1 u[k-delay-1] + ... + c + e[k]

    Parameters
    ----------
    y : array_like, shape (n,)
        The output, the oldest sample first. NaN: a missing value.
    u : array_like, shape (n,) or (n, m), optional
        The input, or several. Their names are u, or u1, u2 ..., or those of a data frame.
    order : int, optional
        na = nb = order. Nothing of order, na and regressors: it is chosen among 1 ... max_order (10).
    na, nb, delay : int, optional
        Past outputs; inputs u[k-delay] ... u[k-delay-nb]; samples from input to output. nb and delay also for each
        input.
    regressors : list of str
        A list instead: "y[k-1]", "u[k-3]", "u[k-3..k-5]". A series alone: identify(y, regressors=["y[k-1..k-3]"]).
    intercept, detrend : bool
        A constant regressor besides; take the means off first.
    variant, forgetting, prior_variance
        Of recursive least squares, as of `Filter`; the default prior is scaled to the data.
    window, guard, control
        The variant also tracks theta so over all rows: `to_dict()["tracked"]`.
    validate : float
        The part at the end that is held out.
    confidence : float
        Of the intervals in `summary`.
    sample_time : float, optional
        Seconds from sample to sample: `summary` and `to_dict` are then in seconds and hertz.
    noise_model, instruments : int, optional
        The estimate again where residuals are coloured: with so many coefficients of the noise, or so many further past
        inputs as instruments. In `summary`, and under these names in `to_dict`.

    Returns
    -------
    Identification

    Raises
    ------
    ValueError
        For options that contradict one another, and a record that cannot be modelled.
    RuntimeError
        Where the program is not found.

    Examples
    --------
    >>> u = np.sign(np.random.default_rng(1).standard_normal(400))
    >>> y = np.zeros(400)
    >>> for k in range(2, 400):
    ...     y[k] = 1.5 * y[k - 1] - 0.7 * y[k - 2] + u[k - 1] + 0.01 * np.sin(k * k)
    >>> m = rlslab.identify(y, u, na=2, nb=0, delay=1)
    >>> m.names, m.params.round(1)
    (['a1', 'a2', 'b0', 'c'], array([-1.5,  0.7,  1. ,  0. ]))
    >>> m.conf_int(0.01).shape, m.poles.round(2)
    ((4, 2), array([0.75+0.37j, 0.75-0.37j]))
    >>> m.pvalues.round(3), bool((m.recursive_coefficients[-1] == m.params).all())
    (array([0., 0., 0., 0.]), True)
    """
    inputs: ArrayLike = np.empty((len(np.atleast_1d(np.asarray(y))), 0)) if u is None else u
    csv, names, output = _program.table(inputs, y, "u", "u")
    record = _program.columns(y, "y")[0], _program.columns(inputs, "u")[0]    # copies
    listed = _program.several(regressors)

    def ask(level: float) -> _program.Answer:
        words = _program.options(
            input=() if listed else names,
            output=output,
            order=order,
            max_order=max_order,
            na=na,
            nb=_each(nb, "nb"),
            delay=_each(delay, "delay"),
            regressors=listed,
            intercept=intercept,
            keep_mean=not detrend,
            variant=variant,
            forgetting=forgetting,
            p0=prior_variance,
            window=window or None,
            guard=guard,
            control=_program.control(control),
            validate=validate,
            confidence=level,
            sample_time=sample_time,
            noise_model=noise_model,
            instruments=instruments,
            no_timings=True,
        )
        return _program.run(["identify", "-", *words], csv, ("model.json", "model.html"))

    return Identification(ask, confidence, names, record)


def _each(given: Lags, name: str) -> list[int]:
    if given is None:
        return []
    return [_options.whole(lag, name) for lag in (given if isinstance(given, (list, tuple)) else (given,))]


class Identification:
    """A model and its checks, with statsmodels' words for its parameters.

    Attributes
    ----------
    names : list of str
        Of the parameters: a1, b0, b0[u2], c.
    params, bse, tvalues : ndarray, shape (d,)
        theta as the variant has it; its certified standard deviations; params / bse. NaN: not known.
    pvalues : ndarray, shape (d,)
        Two-sided probabilities of tvalues by Student's distribution: below alpha where `conf_int(alpha)` leaves out 0.
    scale, df_resid : float
        The noise's variance, and its degrees of freedom.
    nobs : int
        Rows of the equation that were fitted.
    equation, structure : str
        "y[k] + a1 y[k-1] = b0 u[k] + e[k]"; "order 2".
    poles : ndarray of complex
    zeros : list of ndarray of complex
        Of each input.
    gain : ndarray
        Steady state, of each input; NaN: there is none.
    fit : dict
        Percent: one_step, held_out_one_step, held_out_simulated.
    resid_recursive, cusum, cusum_squares : ndarray
        Recursive residuals of the fitted rows, their sums over their standard deviation, and the sums of their squares
        over the last of these; empty: not known. `to_dict()["constancy"]` has their lines at 5 %.
    remarks : list of str
        Warnings, then hints, the most important first.
    next : str
        What to do first, as options of the command line; "": nothing.
    page : str
        The page of HTML with all figures.
    """

    def __init__(
        self,
        ask: Callable[[float], _program.Answer],
        confidence: float,
        inputs: list[str],
        record: tuple[Floats, Floats],
    ) -> None:
        answer = ask(confidence)
        self._ask, self._confidence, self._inputs, self._record = ask, confidence, inputs, record
        self._text = answer.text.rpartition("\n\n")[0] + "\n"    # the last line names the folder
        self._all: Record = json.loads(answer.files["model.json"])
        self.page = answer.files["model.html"]
        of = self._all
        self.names: list[str] = [p["name"] for p in of["parameters"]]
        self.params = _column(of["parameters"], "value")
        self.bse = _column(of["parameters"], "sd")
        with np.errstate(divide="ignore", invalid="ignore"):
            self.tvalues: Floats = self.params / self.bse
        self.pvalues = _numbers([p.get("p") for p in of["parameters"]])
        self.scale, self.df_resid = _known(of["sigma2"]), _known(of["degrees_of_freedom"])
        self.nobs: int = of["fitted"]
        self.equation: str = of["equation"]
        self.structure: str = of["structure"]
        self.poles = _complex(of["poles"])
        self.zeros = [_complex(one["zeros"]) for one in of["inputs"]]
        self.gain = _column(of["inputs"], "gain")
        self.fit: dict[str, float] = {name: _known(value) for name, value in of["fit"].items()}
        constancy = of.get("constancy") or {}
        self.resid_recursive = _numbers(constancy.get("recursive_residuals"))
        self.cusum = _numbers(constancy.get("cusum", {}).get("value"))
        self.cusum_squares = _numbers(constancy.get("cusum_of_squares", {}).get("value"))
        self.remarks: list[str] = of["warnings"] + of["hints"]
        self.next: str = of["next"]

    def conf_int(self, alpha: float = 0.05) -> Floats:
        """Intervals that cover theta with probability 1 - alpha, by Student's distribution; shape (d, 2)."""
        if not 0 < alpha < 1:
            raise ValueError("expected 0 < alpha < 1")
        of = self._all
        if abs(alpha - (1 - self._confidence)) > 1e-12:
            of = json.loads(self._ask(1 - alpha).files["model.json"])
        return np.column_stack([_column(of["parameters"], end) for end in ("low", "high")])

    def summary(self) -> str:
        """The text that the program prints."""
        return self._text

    def to_dict(self) -> Record:
        """All of it, as the program's JSON has it."""
        copy: Record = json.loads(json.dumps(self._all))
        return copy

    def rows(self, y: ArrayLike, u: ArrayLike | None = None) -> tuple[Floats, Floats]:
        """Psi (n - p, d) and the outputs (n - p,) of the equation from a record as `identify` takes it.

        p: the longest lag. Both less the means that the model took off, so that Psi @ params predicts the outputs less
        theirs. A missing value is NaN wherever it is used.
        """
        output, _ = _program.columns(y, "y")
        inputs = np.empty((len(output), 0)) if u is None else _program.columns(u, "u")[0]
        means = {one["name"]: one["mean"] for one in self._all["inputs"]}
        name = self._all["options"]["output"]
        if output.shape[1] != 1 or inputs.shape != (len(output), len(self._inputs)):
            raise ValueError(f"expected y of shape (n,) and u of shape (n, {len(self._inputs)})")
        known = {one: inputs[:, self._inputs.index(one)] - mean for one, mean in means.items()}
        known[name] = output[:, 0] - self._all["output_mean"]
        terms = [_term(p["of"]) for p in self._all["parameters"]]
        first = max((lag for _, lag in terms), default=0)
        n = max(len(output) - first, 0)
        Psi = np.ones((n, len(terms)))
        for i, (column, lag) in enumerate(terms):
            if column is not None:
                Psi[:, i] = known[column][first - lag :][:n] * (-1 if column == name else 1)
        return Psi, known[name][first:]

    def filter(self, **options: Any) -> Filter:
        """A new filter of this model's variant, prior and forgetting, for `rows`. `options`: as of `Filter`."""
        from . import filter as make    # the package is whole by now

        of, prior = self._all["options"], self._all["prior"]
        scales = np.array(prior["scales"])
        P0 = np.diag((prior["c"] / scales) ** 2 if of["p0"] is None else of["p0"] / scales)    # of p0 they are 1
        made = {"forgetting": of["forgetting"], "prior_covariance": P0, **options}
        return make(of["variant"], len(self.names), **made)

    @cached_property
    def recursive_coefficients(self) -> Floats:
        """theta after each fitted row, shape (nobs, d), from the prior on; the last one is params.

        statsmodels has these, transposed, in recursive_coefficients.filtered.
        """
        Psi, y = self.rows(*self._record)
        there = ~(np.isnan(Psi).any(axis=1) | np.isnan(y))
        f, out = self.filter(), np.empty((self.nobs, len(self.names)))
        for k, (psi, output) in enumerate(zip(Psi[there][: self.nobs], y[there])):
            f.update(psi, float(output))
            out[k] = f.theta
        out[-1] = self.params    # the same, but of qr_block, whose bits are those of the program's blocks
        return out

    def plot(self, ax: Any = None) -> Any:
        """Parameters with their intervals. Returns the axes of matplotlib; ImportError without matplotlib."""
        ax = _program.axes(ax)
        half = np.nan_to_num(np.abs(self.conf_int(1 - self._confidence) - self.params[:, np.newaxis]).T)
        ax.errorbar(self.params, range(len(self.names)), xerr=half, fmt="o")
        ax.set_yticks(range(len(self.names)), self.names)
        ax.invert_yaxis()
        ax.set_xlabel(f"theta, intervals of {100 * self._confidence:g} %")
        return ax

    def __repr__(self) -> str:
        return f"Identification({self.structure}: {self.equation})"


def _known(value: float | None) -> float:
    return np.nan if value is None else value


def _numbers(values: Sequence[float | None] | None) -> Floats:
    return np.array([_known(value) for value in values or ()], dtype=np.float64)


def _column(rows: list[Record], name: str) -> Floats:
    return _numbers([row[name] for row in rows])


def _complex(pairs: list[list[float | None]] | None) -> NDArray[np.complex128]:
    return np.array([complex(_known(re), _known(im)) for re, im in pairs or ()], dtype=np.complex128)


def _term(text: str) -> tuple[str | None, int]:
    """(column, lag) of "u[k-3]"; None: the constant."""
    found = re.fullmatch(r"(.+)\[k(?:-(\d+))?\]", text)
    return (found[1], int(found[2] or 0)) if found else (None, 0)


def excitation(u: ArrayLike, *, max_order: int = 20) -> Excitation:
    """Up to which order an input can identify a system, decided exactly: what `rlslab excitation` does.

    Parameters
    ----------
    u : array_like, shape (n,)
        The input, without missing values.
    max_order : int
        The largest order that is tried.

    Returns
    -------
    Excitation

    Raises
    ------
    ValueError
        For another shape, and a record that is too short.
    RuntimeError
        Where the program is not found.

    Examples
    --------
    >>> rlslab.excitation(np.sin(np.arange(200.0))).order
    2
    """
    if np.ndim(u) != 1:
        raise ValueError(f"u has shape {np.shape(u)}, expected (n,)")
    csv, names, _ = _program.table(u, None, "u", "u")
    words = _program.options(input=names[0], max_order=max_order, json=True, no_timings=True)
    return Excitation(_program.run(["excitation", "-", *words], csv))


class Excitation:
    """What an input excites.

    Attributes
    ----------
    order : int
        The input is exciting of this order: one more than the order of the models that it can identify.
    exact_order : int
        The same for exactly the numbers stored: beyond `order` that is their rounding.
    persistent_order : int
        The order of which it stays exciting, not by a few rows.
    changes : int
        Times that the input changes.
    orders : list of dict
        For each order tried: order, least_eigenvalue, condition, definite, resolved, rows_that_carry.
    """

    def __init__(self, answer: _program.Answer) -> None:
        self._all: Record = json.loads(answer.text)
        self.order: int = self._all["exciting_of_order"]
        self.exact_order: int = self._all["exact_order"]
        self.persistent_order: int = self._all["persistent_order"]
        self.changes: int = self._all["changes"]
        self.orders: list[Record] = self._all["orders"]

    def to_pandas(self) -> Any:
        """The orders as a pandas.DataFrame; ImportError without pandas."""
        return _program.to_pandas(self.orders)

    def __repr__(self) -> str:
        return f"Excitation(order {self.order}, persistently {self.persistent_order})"
