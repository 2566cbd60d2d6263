"""Recursive least squares: every textbook variant, with the same bits as in C++.

A filter:

    f = rlslab.Ud(4, forgetting=0.99)             # or rlslab.filter("ud", 4, forgetting=0.99)
    step = f.update([1.0, 2.0, 0.5, 3.0], 0.7)    # Step(innovation, residual, gamma, health, signal)
    steps = f.update_many(Psi, y, steps=True)     # Psi (n, d); theta=True: theta after each row; weights=w
    f.theta, f.gain, f.covariance, f.factor       # psi @ f.theta predicts y
    f.remove(psi, y), f.variance(Psi), f.sample(seed, n), f.least_excited()
    f.save("out.state"); f = rlslab.load("out.state")

Which one, and how far to trust it:

    rlslab.compare(Psi, y, digits=3)              # which variant, in which arithmetic; .best, .code, .filter()
    rlslab.Ud(4, certify=3).certificate()         # digits of P and theta, shown by the running filter
    rlslab.certified(Psi, y).digits(f.theta)      # the exact solution, with a proven bound

Bad rows, changes, silence: `guard="reset"`, `window=200`, `control=...` of `rlslab.Filter`.

Several at once:

    rlslab.QrBlock(4, outputs=3)                  # y of 3 numbers; f.update_many(X, Y), f.theta (4, 3)
    rlslab.Fleet("ud", 1000, 4)                   # a thousand filters; guard=, outputs=; device="cuda"
    rlslab.Fleet("ud", 257, 20, dtype="complex64", outputs=2)    # complex numbers: the bins of a spectrum

Regressions and models:

    rlslab.rolling(X, y, window=250, groups=g)    # theta, t, residual, sigma of each row's window, of each group
    rlslab.identify(y, u)                         # an ARX model with its uncertainty; .params, .bse, .conf_int()
    from rlslab.sklearn import RLSRegressor, RLSClassifier
    from rlslab.results import RecursiveLS        # statsmodels' words

`help(rlslab.Filter)` has the options, `help(rlslab.Ud)` the formulas of a variant. `variants()`, `arithmetics()`,
`guards()` and `controls()` list the names. `compare`, `identify`, `excitation`, `study`, `sweep` and `cite` run the
program `rlslab`, `certified` an extension of its own.
"""

from __future__ import annotations

import importlib
import os
from typing import TYPE_CHECKING, Any

from . import _options, _variants
from ._asked import Certificate, LeastExcited, Removal
from ._certified import Certified, certified
from ._complex import Complex, ComplexSteps
from ._compare import Comparison, compare
from ._core import Counts, Step, controls, guards, use_threads, variants
from ._filter import HEALTHS, SIGNALS, STEP, Filter
from ._identify import Excitation, Identification, excitation, identify
from ._rolling import Rolled, rolling
from ._stateful import Path
from ._studies import Study, Sweep, cite, study, sweep
from ._variants import *  # noqa: F403
from ._variants import VERSION as __version__
from .fleet import Fleet
from .outputs import Outputs

#: The class of each variant, by its name.
CLASSES: dict[str, type[Filter]] = {c._variant: c for c in (getattr(_variants, n) for n in _variants.__all__)}


def filter(variant: str, size: int, **options: Any) -> Filter:
    """A filter of the variant of that name, e.g. from a configuration.

    Parameters
    ----------
    variant : str
        One of `variants()`.
    size : int
        The number of parameters d.
    **options
        As of `Filter`.

    Raises
    ------
    ValueError
        For another name, and as `Filter` does.

    Examples
    --------
    >>> rlslab.filter("ud", 4, dtype="float32")
    Ud(4, dtype='float32')
    """
    return CLASSES[_options.one_of(variant, variants(), "variant")](size, **options)


def arithmetics() -> tuple[str, ...]:
    """The dtypes in which a filter computes. In C++ they are float and double."""
    return tuple(_options.ARITHMETICS)


def from_state(state: bytes) -> Filter:
    """The filter that a state is of, written here, by C++ or by C; it goes on with the same bits.

    It is an `Outputs` where the state is of several outputs. Variant, dtype, size, window, guard and control are the
    state's, and so are forgetting and prior, until `reset` starts with their defaults.

    Raises
    ------
    ValueError
        For bytes that are no state or are damaged, and for a state of what no filter here is.

    Examples
    --------
    >>> f = rlslab.Ud(2, guard="reset", window=50)
    >>> rlslab.from_state(f.state)
    Ud(2, window=50, guard='reset')
    """
    variant, options = _options.saved(state)
    out = CLASSES[variant](**options)
    out.restore(state)
    return out


def load(path: Path) -> Filter:
    """The filter whose state is in a file, written by `Filter.save`, by C++ or by C: see `from_state`.

    Examples
    --------
    >>> f = rlslab.Ud(2, forgetting=0.98)
    >>> f.save("filter.state")
    >>> rlslab.load("filter.state")
    Ud(2)
    """
    with open(path, "rb") as file:
        state = file.read(8)
        if state[:4] == b"\x89RLS":    # what is no state may have no end
            state += file.read()
    try:
        return from_state(state)
    except ValueError as error:
        raise ValueError(f"{os.fspath(path)!s}: {error}") from None


if not TYPE_CHECKING:    # to which any name would be one

    def __getattr__(name: str) -> Any:
        """The modules that are loaded when they are named."""
        if name in ("results", "sklearn"):
            return importlib.import_module(f"{__name__}.{name}")
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}", name=name)


__all__ = [
    "CLASSES", "HEALTHS", "SIGNALS", "STEP", "Certificate", "Certified", "Comparison", "Complex", "ComplexSteps",
    "Counts", "Excitation", "Filter", "Fleet", "Identification", "LeastExcited", "Outputs", "Removal", "Rolled",
    "Step", "Study", "Sweep", "arithmetics", "certified", "cite", "compare", "controls", "excitation", "filter",
    "from_state", "guards", "identify", "load", "rolling", "study", "sweep", "use_threads", "variants",
    *_variants.__all__,
]  # fmt: skip
