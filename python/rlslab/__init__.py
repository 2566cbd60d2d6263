"""Recursive least squares: every textbook variant, with the same bits as in C++.

    import rlslab
    f = rlslab.Ud(4, forgetting=0.99)             # or rlslab.filter("ud", 4, forgetting=0.99)
    step = f.update([1.0, 2.0, 0.5, 3.0], 0.7)    # Step(innovation, residual, gamma, health, signal)
    steps = f.update_many(Psi, y, steps=True)     # Psi (n, d); an array of steps
    f.theta, f.gain, f.covariance

`help(rlslab.Filter)` has the options, `help(rlslab.Ud)` the formulas of a variant. `variants()`, `arithmetics()`,
`guards()` and `controls()` list the names. `rlslab.sklearn` has an estimator for scikit-learn.

    rlslab.compare(Psi, y, digits=3)              # which variant, in which arithmetic; .best, .code, .filter()
    rlslab.identify(y, u)                         # a model with its uncertainty; .params, .bse, .conf_int()
    rlslab.certified(Psi, y).digits(f.theta)      # the exact solution, with a proven bound

These and `excitation`, `study`, `sweep` and `cite` run the program `rlslab`, `certified` an extension of its own.
"""

from __future__ import annotations

from typing import Any

from . import _options, _variants
from ._certified import Certified, certified
from ._compare import Comparison, compare
from ._core import Counts, Step, controls, guards, variants
from ._filter import HEALTHS, SIGNALS, STEP, Filter, Path
from ._identify import Excitation, Identification, excitation, identify
from ._studies import Study, Sweep, cite, study, sweep
from ._variants import *  # noqa: F403
from ._variants import VERSION as __version__
from .fleet import Fleet

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


def load(path: Path) -> Filter:
    """The filter whose state is in a file, written by `Filter.save`, by C++ or by C.

    Its options but dtype and size are defaults; the state brings its own forgetting. ValueError for a file that is no
    state or is damaged, and for one with a window, guard or control: make that filter, then call its `load`.

    Examples
    --------
    >>> f = rlslab.Ud(2, forgetting=0.98)
    >>> f.save("filter.state")
    >>> rlslab.load("filter.state")
    Ud(2)
    """
    with open(path, "rb") as file:
        state = file.read()
    if len(state) < 100:
        raise ValueError(f"{path}: the state is cut short")
    name, arithmetic = (state[a:b].rstrip(b"\0").decode("ascii", "replace") for a, b in ((40, 72), (72, 96)))
    dtype = {v: k for k, v in _options.ARITHMETICS.items()}.get(arithmetic)
    if state[:4] != b"\x89RLS" or dtype is None or name not in CLASSES:
        raise ValueError(f"{path}: not the state of a filter of float or double, or one with something around it")
    out = CLASSES[name](1, dtype=dtype)
    size = int.from_bytes(state[24:28], "little")
    if size != 1:    # so that damage to the size does not ask for its memory
        if 4 * size * size > len(state):
            raise ValueError(f"{path}: the state is damaged")
        out = CLASSES[name](size, dtype=dtype)
    out.restore(state)
    return out


__all__ = [
    "CLASSES", "HEALTHS", "SIGNALS", "STEP", "Certified", "Comparison", "Counts", "Excitation", "Filter", "Fleet",
    "Identification", "Step", "Study", "Sweep", "arithmetics", "certified", "cite", "compare", "controls", "excitation",
    "filter", "guards", "identify", "load", "study", "sweep", "variants", *_variants.__all__,
]  # fmt: skip
