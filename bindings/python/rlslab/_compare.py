"""Which variant, in which arithmetic, on a record: `compare`."""

from __future__ import annotations

import html
import json
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _program
from ._filter import Filter

Record = dict[str, Any]
#: numpy's names of the arithmetics in which a filter computes here.
_DTYPES = {"float": "float32", "double": "float64"}
_MEASURES = ("theta", "worst", "covariance")
_POINTS = ("low", "median", "high")


def compare(
    X: ArrayLike,
    y: ArrayLike,
    *,
    digits: float | None = None,
    forgetting: float = 1.0,
    prior_variance: float | None = None,
    arithmetics: str | Iterable[str] = ("float32", "float64"),
    variants: str | Iterable[str] = (),
    window: int = 0,
    guard: str | None = None,
    control: Any = None,
    intercept: bool = False,
    detrend: bool = False,
    seed: int = 1,
    threads: int | None = None,
    timings: bool = True,
    certify: bool = False,
) -> Comparison:
    """Every variant in every arithmetic on these rows, against the certified solution: what `rlslab compare` does.

    Parameters
    ----------
    X : array_like, shape (n, d)
        The rows psi, the oldest first. A data frame lends its names. A row that misses a value (NaN) is left out.
    y : array_like, shape (n,)
        The outputs.
    digits : float, optional
        Ask for the variant and arithmetic that keep so many digits of every parameter, 0.5 to 30.
    forgetting : float
        lambda, in (0, 1].
    prior_variance : float, optional
        c^2 of P0 = c^2 I. None: a diagonal P0 scaled to the data.
    arithmetics : names
        E.g. "bfloat16", "float32", "p11" (11 bits), or "all".
    variants : names
        Only these; nothing: all.
    window, guard, control
        A composition around each variant, as of `Filter`; guard is a policy.
    intercept : bool
        A constant regressor besides, the first of theta.
    detrend : bool
        Take the mean off each column first.
    seed : int
        Of stochastic rounding and of the orders of rows.
    threads : int, optional
        None: all cores. The results do not depend on it.
    timings : bool
        Measure nanoseconds; False: leave out all that differs from run to run.
    certify : bool
        Also what three probes of each filter in float32 and float64 show of its error of P at the last row. Not with
        `digits`, `window`, `guard` and `control`.

    Returns
    -------
    Comparison

    Raises
    ------
    ValueError
        For shapes that do not fit, numbers that are infinite or beyond 2^500, dependent columns, unknown names.
    RuntimeError
        Where the program is not found.

    Notes
    -----
    It runs the program `rlslab` ($RLSLAB_PROGRAM, else that of the installation, else in PATH). An interrupt ends it.

    Examples
    --------
    >>> X = np.random.default_rng(1).standard_normal((100, 3))
    >>> c = rlslab.compare(X, X @ [1.0, 2.0, 3.0] + 0.1 * X[:, 0] ** 2, timings=False)
    >>> c.best["variant"] in rlslab.variants(), c.best["arithmetic"]
    (True, 'float')
    >>> len(c.records), sorted({record["arithmetic"] for record in c.records})
    (38, ['double', 'float'])
    >>> f = c.filter()
    >>> f.update_many(X, X @ [1.0, 2.0, 3.0]).health
    'sound'
    """
    csv, names, output = _program.table(X, y, "x", "X")
    every = arithmetics == "all"
    words = _program.options(
        regressors=names,
        output=output,
        digits=digits,
        forgetting=forgetting,
        p0=prior_variance,
        all=every,
        arithmetic=() if every else _program.arithmetics(arithmetics),
        variants=_program.several(variants),
        window=window or None,
        guard=guard,
        control=_program.control(control),
        intercept=intercept,
        detrend=detrend,
        seed=seed,
        threads=threads,
        no_timings=not timings,
        certify=certify,
    )
    answer = _program.run(["compare", "-", *words], csv, ("compare.json", "compare.html"))
    around = {"window": window, "guard": guard, "control": control}
    return Comparison(answer, {name: value for name, value in around.items() if value})


class Comparison:
    """What `compare` found.

    Attributes
    ----------
    records : list of dict
        A row for each variant in each arithmetic: variant, arithmetic, recommended; the digits of theta, of its worst
        component and of P after the last row (theta_digits, theta_digits_worst, covariance_digits) and their spread
        along the record (theta_low, theta_median, theta_high, worst_low ...); breakdown_step, breakdown_kind; runs,
        broken; asymmetry; operations and ns_per_update of one row; predicted_covariance, digits of P foretold from the
        rows, predicted_at_least: a lower bound; with `certify` probes_estimate, probes_bound, probes_truth of
        ||Phat P^-1 - I||_F. None: there is none.
    best : dict or None
        The record of the recommended variant: in float or else in double; with `digits` what keeps them.
    recommended : list of dict
        The recommendation in each arithmetic: arithmetic, variant (None: none), why, losses.
    warnings : list of str
        What is wrong with the question, and the remedy.
    code : str
        C++ that makes the best filter; "": there is none.
    names : list of str
        Of the parameters.
    theta, least_squares : list of str
        The exact minimisers with the prior and without, to 30 digits.
    radius : float
        The proven relative error of theta.
    condition : float
        kappa_2 of the rows; infinity: beyond 1e308.
    page : str
        The page of HTML with all figures.
    """

    def __init__(self, answer: _program.Answer, around: Record) -> None:
        self._text = answer.text.rpartition("\n\n")[0] + "\n"    # the last line names the folder
        self._all: Record = json.loads(answer.files["compare.json"])
        self._around = around
        self.page = answer.files["compare.html"]
        self.recommended: list[Record] = self._all["recommendation"]
        self.warnings: list[str] = self._all["warnings"]
        self.names: list[str] = self._all["data"]["parameters"]
        reference = self._all["reference"]
        self.theta: list[str] = reference["theta"]
        self.least_squares: list[str] = reference["least_squares"]
        self.radius: float = reference["radius"]
        self.condition: float = np.inf if reference["condition"] is None else reference["condition"]
        wanted = self._all.get("digits")
        advice = wanted["advice"] if wanted else None
        self.code: str = (advice["code"] if advice else "") if wanted else self._all["code"]
        chosen = {r["arithmetic"]: r["variant"] for r in self.recommended}
        if wanted:
            chosen = {advice["arithmetic"]: advice["variant"]} if advice else {}
        self.records: list[Record] = [_flat(r, chosen) for r in self._all["results"]]
        order = ("float", "double") if not wanted else tuple(chosen)
        self.best: Record | None = next(
            (r for name in order for r in self.records if r["recommended"] and r["arithmetic"] == name), None
        )

    def table(self) -> str:
        """The text that the program prints."""
        return self._text

    def to_dict(self) -> Record:
        """All of it, as the program's JSON has it."""
        copy: Record = json.loads(json.dumps(self._all))
        return copy

    def to_pandas(self) -> Any:
        """The records as a pandas.DataFrame; ImportError without pandas."""
        return _program.to_pandas(self.records)

    def filter(self, **options: Any) -> Filter:
        """A new filter of the best variant, with the prior, forgetting and composition of this comparison.

        Its rows are those of X (with `intercept` a one before them, with `detrend` less the means). `options`: as of
        `Filter`, in place of these. ValueError where there is no best, or none that a filter here can be.
        """
        from . import filter as make    # the package is whole by now

        if self.best is None:
            raise ValueError("no variant is recommended: table() says why")
        dtype = _DTYPES.get(self.best["arithmetic"])
        if dtype is None:
            raise ValueError(f"a filter computes in float32 or float64, not in {self.best['arithmetic']}")
        d = len(self.names)
        made: Record = {"forgetting": self._all["options"]["forgetting"], "dtype": dtype, **self._around}
        wanted = self._all.get("digits")
        if wanted:
            trial = wanted["tried"][-1]
            if any(trial["exponents"]) or trial["output_exponent"]:
                raise ValueError("the best filter takes scaled columns: `code` has the powers of two")
            made["prior_covariance"] = np.diag(trial["p0"])
            if wanted["advice"]["guarded"]:
                made["guard"] = "reset"
        elif "prior" in self._all:
            made["prior_covariance"] = np.diag(self._all["prior"]["P0"])
        else:
            made["prior_variance"] = self._all["options"]["p0"]
        return make(self.best["variant"], d, **{**made, **options})

    def plot(self, ax: Any = None) -> Any:
        """Digits of the worst component for each variant, from low to high, a colour for each arithmetic.

        A cross: it broke down. Returns the axes of matplotlib; ImportError without matplotlib.
        """
        ax = _program.axes(ax)
        names = list(dict.fromkeys(r["variant"] for r in self.records))
        arithmetics = list(dict.fromkeys(r["arithmetic"] for r in self.records))
        for i, arithmetic in enumerate(arithmetics):
            shift = (i - (len(arithmetics) - 1) / 2) * 0.6 / len(arithmetics)
            for broken in (False, True):
                rows = [
                    r for r in self.records
                    if r["arithmetic"] == arithmetic and bool(r["broken"]) == broken and r["worst_median"] is not None
                ]  # fmt: skip
                middle = np.array([r["worst_median"] for r in rows], dtype=float)
                ends = np.array([[r["worst_low"], r["worst_high"]] for r in rows], dtype=float).reshape(-1, 2).T
                ax.errorbar(
                    middle,
                    [names.index(r["variant"]) + shift for r in rows],
                    xerr=np.nan_to_num(np.abs(ends - middle)),
                    fmt="x" if broken else "o",
                    color=f"C{i}",
                    label=None if broken else arithmetic,
                )
        ax.set_yticks(range(len(names)), names)
        ax.invert_yaxis()
        ax.set_xlabel("digits of the worst component")
        ax.legend()
        return ax

    def _repr_html_(self) -> str:
        """The recommendation and the records as a table."""
        columns = {
            "variant": "variant", "arithmetic": "arithmetic", "theta_median": "theta",
            "worst_median": "worst component", "covariance_median": "P", "breakdown_kind": "breakdown",
            "operations": "operations", "ns_per_update": "ns",
        }  # fmt: skip
        rows = ""
        for r in self.records:
            weight = "bold" if r["recommended"] else "normal"
            cells = (html.escape("-" if r[c] is None else str(r[c])) for c in columns)
            rows += f'<tr style="font-weight:{weight}">' + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"
        head = "".join(f"<th>{title}</th>" for title in columns.values())
        return f"<p>{html.escape(repr(self))}</p><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"

    def __repr__(self) -> str:
        data = self._all["data"]
        advice = f"use {self.best['variant']} in {self.best['arithmetic']}" if self.best else "nothing is recommended"
        return f"Comparison({data['rows']} rows, {data['size']} parameters: {advice})"


def _flat(result: Record, chosen: dict[str, str]) -> Record:
    """A result of the JSON as a row of a table."""
    breakdown = result["breakdown"] or {"step": None, "kind": None}
    out: Record = {"variant": result["variant"], "arithmetic": result["arithmetic"]}
    out["recommended"] = chosen.get(result["arithmetic"]) == result["variant"]
    for name in ("theta_digits", "theta_digits_worst", "covariance_digits"):
        out[name] = result[name]
    for measure in _MEASURES:
        spread = result["spread"][measure] or dict.fromkeys(_POINTS)
        out.update({f"{measure}_{point}": spread[point] for point in _POINTS})
    out["breakdown_step"], out["breakdown_kind"] = breakdown["step"], breakdown["kind"]
    for name in ("runs", "broken", "asymmetry", "operations", "ns_per_update"):
        out[name] = result[name]
    for group, names in (("predicted", ("covariance", "at_least")), ("probes", ("estimate", "bound", "truth"))):
        if group in result:
            out.update({f"{group}_{name}": (result[group] or {}).get(name) for name in names})
    if "obstacle" in result:
        out["obstacle"] = result["obstacle"]
    return out
