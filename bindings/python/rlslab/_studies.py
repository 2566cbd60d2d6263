"""Studies, sweeps of a record, and how to cite: `study`, `sweep`, `cite`."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Union

from numpy.typing import ArrayLike

from . import _program

Record = dict[str, Any]
Values = Union[str, float, Iterable[Any]]


def _factors(given: Mapping[str, Values] | None, option: str) -> list[str]:
    """Words "--set=NAME=A,B" for each."""
    words = []
    if given is not None and not isinstance(given, Mapping):
        raise ValueError(f"{option[2:]}: expected a dict of values by name, found {given!r}")
    for name, values in (given or {}).items():
        listed: list[Any] = [values] if isinstance(values, str) or not isinstance(values, Iterable) else list(values)
        if not listed:
            raise ValueError(f"{option[2:]}: {name}: expected at least one value, found {values!r}")
        if name == "arithmetic":
            listed = list(_program.arithmetics(listed))
        words.append(f"{option}={_program.named(name)}={','.join(map(_program.word, listed))}")
    return words


def study(
    name: str,
    *,
    set: Mapping[str, Values] | None = None,
    seeds: int | None = None,
    budget: str = "quick",
    seed: int = 1,
    threads: int | None = None,
    out: str | Path | None = None,
) -> Study:
    """Run a study: a question with claims. What `rlslab study` does.

    Parameters
    ----------
    name : str
        As `rlslab list` shows it.
    set : dict, optional
        Other values for its factors, e.g. {"kappa": [1e2, 1e4]}. Claims are then not judged.
    seeds : int, optional
        So many replicates. Claims are then not judged.
    budget : str
        "quick" or "full".
    seed : int
        The first seed.
    threads : int, optional
        None: all cores. The results do not depend on it.
    out : path, optional
        A folder for all tables, figures and the report. The same call goes on there where it was stopped.

    Returns
    -------
    Study

    Raises
    ------
    ValueError
        For an unknown study, factor or value.
    RuntimeError
        Where the program is not found.

    Examples
    --------
    >>> s = rlslab.study("gain_error")
    >>> len(s.verdicts), {v["verdict"] for v in s.verdicts}
    (6, {'holds'})
    >>> rlslab.study("gain_error", set={"lambda": [0.5], "variant": "ud"}).verdicts[0]["verdict"]
    'not judged: factors changed'
    """
    words = _program.options(seeds=seeds, budget=budget, seed=seed, threads=threads)
    files = (f"{name}.csv", "verdicts.json", "report.html")
    answer = _program.run(["study", _program.named(name), *_factors(set, "--set"), *words], "", files, out)
    return Study(name, answer)


class Study:
    """What a study found.

    Attributes
    ----------
    name : str
    records : list of dict
        A row for each trial and what it tried: the factors, then the measures.
    verdicts : list of dict
        Of each claim: claim, kind, verdict ("holds", "fails", "undecided"; with `set` or `seeds` "not judged: ..."),
        and if it was judged band, data, proof, measured.
    changed : bool
        A verdict changed against the record, or a verification failed.
    report : str
        The page of HTML.
    """

    def __init__(self, name: str, answer: _program.Answer) -> None:
        self.name = name
        self.records = _program.records(answer.files[f"{name}.csv"])
        self.verdicts: list[Record] = json.loads(answer.files["verdicts.json"])["studies"][0]["claims"]
        self.changed = answer.code == 1
        self.report = answer.files["report.html"]
        self._text = answer.text

    def summary(self) -> str:
        """The text that the program prints."""
        return self._text

    def to_pandas(self) -> Any:
        """The records as a pandas.DataFrame; ImportError without pandas."""
        return _program.to_pandas(self.records)

    def __repr__(self) -> str:
        return f"Study({self.name}: {len(self.records)} rows, {len(self.verdicts)} verdicts)"


def sweep(
    X: ArrayLike,
    y: ArrayLike,
    vary: Mapping[str, Values],
    *,
    row_orders: int = 1,
    intercept: bool = False,
    detrend: bool = False,
    seed: int = 1,
    threads: int | None = None,
    out: str | Path | None = None,
) -> Sweep:
    """The variants on these rows over forgetting, prior and arithmetic: what `rlslab sweep` does.

    Parameters
    ----------
    X, y : array_like
        As of `compare`.
    vary : dict
        Values of `variant`, `arithmetic`, `forgetting` and `prior` ("scaled", or c^2 of P0 = c^2 I). What is not there
        is all variants, float and double, 1, "scaled".
    row_orders : int
        So many orders of the rows, the record's first, where forgetting = 1.
    intercept, detrend, seed, threads
        As of `compare`.
    out : path, optional
        A folder for the table, figures and the report. The same call goes on there where it was stopped.

    Returns
    -------
    Sweep

    Raises
    ------
    ValueError
        As `compare` does, and for an unknown factor or value.
    RuntimeError
        Where the program is not found.

    Examples
    --------
    >>> X = np.random.default_rng(1).standard_normal((60, 2))
    >>> s = rlslab.sweep(X, X @ [1.0, 2.0], {"forgetting": [0.9, 1], "variant": ["ud", "qr"]})
    >>> len(s.records), sorted({record["forgetting"] for record in s.records})
    (8, [0.9, 1])
    """
    csv, names, output = _program.table(X, y, "x", "X")
    words = _program.options(
        regressors=names,
        output=output,
        row_orders=_program.word(row_orders),
        intercept=intercept,
        detrend=detrend,
        seed=seed,
        threads=threads,
    )
    return Sweep(
        _program.run(["sweep", "-", *words, *_factors(vary, "--vary")], csv, ("sweep.csv", "report.html"), out)
    )


class Sweep:
    """What a sweep found.

    Attributes
    ----------
    records : list of dict
        A row for each variant and combination: the factors, then what was measured.
    report : str
        The page of HTML.
    """

    def __init__(self, answer: _program.Answer) -> None:
        self.records = _program.records(answer.files["sweep.csv"])
        self.report = answer.files["report.html"]

    def to_pandas(self) -> Any:
        """The records as a pandas.DataFrame; ImportError without pandas."""
        return _program.to_pandas(self.records)

    def __repr__(self) -> str:
        return f"Sweep({len(self.records)} rows)"


def cite(*variants: str) -> str:
    """BibTeX of rlslab, and of the sources of these variants: what `rlslab cite` prints.

    Raises
    ------
    ValueError
        For another name.
    RuntimeError
        Where the program is not found.

    Examples
    --------
    >>> print(rlslab.cite("ud"))  # doctest: +ELLIPSIS
    @software{rlslab,
    ...
    """
    return _program.run(["cite", *map(_program.named, variants)]).text
