"""The program `rlslab`, run as a child: its numbers are those of the command line, and an interrupt ends it."""

from __future__ import annotations

import io
import os
import re
import shutil
import subprocess
import tempfile
import warnings
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _rows

Floats = NDArray[np.float64]
#: What the program calls these.
ARITHMETICS = {"float32": "float", "float64": "double"}
#: What the program calls otherwise.
_OPTIONS = {"p0": "prior_variance", "arithmetic": "arithmetics", "input": "u", "output": "y"}
#: Words that are missing values in a file.
_MISSING = {"", ".", "?", "na", "n/a", "#n/a", "nan", "null", "inf", "infinity"}


class Answer(NamedTuple):
    """What the program printed, its exit code, and the files that it left in --out, by their paths there."""

    text: str
    code: int
    files: dict[str, str]


def path() -> str:
    """Where the program is: $RLSLAB_PROGRAM, else in the installation or build of the package, else in PATH."""
    given = os.environ.get("RLSLAB_PROGRAM")
    if given:
        return given
    for folder in Path(__file__).resolve().parents[1:6]:
        for place in ("bin/rlslab", "program/rlslab"):    # installed; in a build
            if (folder / place).is_file():
                return str(folder / place)
    found = shutil.which("rlslab")
    if found is None:
        raise RuntimeError(
            "this runs the program rlslab, which is not there: install the package rlslab, or name it in RLSLAB_PROGRAM"
        )
    return found


def run(words: Sequence[str], data: str = "", files: Sequence[str] = (), out: Path | str | None = None) -> Answer:
    """The answer to `rlslab WORDS`, with `data` on its standard input, and those of its files that --out leaves: in the
    folder `out`, or in one that is removed once they are read.

    Its exit code 2, wrong input, is a ValueError with the program's line; its warnings become Python's. Another end is
    a RuntimeError. An interrupt ends the child.
    """
    if not files:
        return _child([path(), *words], data)
    if out is None:
        with tempfile.TemporaryDirectory(prefix="rlslab-") as folder:
            return run(words, data, files, folder)
    answer = _child([path(), *words, "--out", str(out)], data)
    read = {name: Path(out, name).read_text(encoding="utf-8", errors="replace") for name in files}
    return answer._replace(files=read)


def _child(command: list[str], data: str) -> Answer:
    try:
        done = subprocess.run(
            command, input=data.encode(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False
        )
    except OSError as error:
        raise RuntimeError(f"{command[0]} does not run: {error.strerror}") from None
    said = done.stderr.decode("utf-8", "replace").strip()
    lines = [re.sub(r"^\w+: ((-|standard input): )?", "", line) for line in said.splitlines()]
    if done.returncode == 2:
        raise ValueError(_in_python(lines[-1] if lines else "wrong input"))
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{' '.join(command[:2])} ended with {done.returncode}: {lines[-1] if lines else ''}")
    for line in lines:
        if line.startswith("warning: "):
            warnings.warn(line[len("warning: ") :], stacklevel=4)
    return Answer(done.stdout.decode("utf-8", "replace"), done.returncode, {})


def _in_python(line: str) -> str:
    """A message of the program with the names of options as Python has them."""

    def name(found: re.Match[str]) -> str:
        return _OPTIONS.get(found[1], found[1].replace("-", "_")) if found[1] else found[0]

    return re.sub(r'"[^"]*"|--([a-z][a-z0-9-]*)', name, line)    # what is quoted is the user's


def options(**given: Any) -> list[str]:
    """Words of the command line: True is the option alone; None, False and nothing in a list leave it out."""
    words: list[str] = []
    for name, value in given.items():
        option = "--" + name.replace("_", "-")
        if value is True:
            words.append(option)
        elif isinstance(value, (list, tuple)):
            if value:
                words.append(f"{option}={','.join(map(word, value))}")
        elif value is not None and value is not False:
            words.append(f"{option}={word(value)}")
    return words


def word(value: Any) -> str:
    """A value as the command line takes it: numbers so that they are read back as they are."""
    if isinstance(value, (bool, np.bool_)):
        raise TypeError(f"expected a number or a name, not {value}")
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if not isinstance(value, str):
        raise TypeError(f"expected a number or a name, not {type(value).__name__}")
    if "\0" in value:
        raise ValueError("a name holds a zero byte")
    return value


def named(name: Any) -> str:
    """A name; TypeError for anything else."""
    if not isinstance(name, str):
        raise TypeError(f"expected a name, not {type(name).__name__}")
    if name.startswith("-"):
        raise ValueError(f"{word(name)!r} is an option, not a name")
    return word(name)


def several(names: str | Iterable[str]) -> list[str]:
    """One name or several, as a list."""
    return [named(name) for name in ([names] if isinstance(names, str) else names)]


def arithmetics(names: str | Iterable[str]) -> list[str]:
    """Names of arithmetics, numpy's among them, as the program calls them."""
    return [ARITHMETICS.get(name, name) for name in several(names)]


def control(given: Any) -> str | None:
    """A rule of forgetting with its numbers in the form NAME:A:B."""
    if given is None or isinstance(given, str):
        return given
    try:
        name, *numbers = given
    except TypeError:
        raise TypeError('control is a name, or a name and its numbers: ("fortescue", 0.1, 50)') from None
    return ":".join([word(name), *map(word, numbers)])


def columns(X: ArrayLike, name: str) -> tuple[Floats, list[str] | None]:
    """Columns of float64, shape (n, m) also for one column, and the names that a data frame or series has for them."""
    labels = getattr(X, "columns", None)
    if labels is None and hasattr(X, "index"):    # a series
        labels = [getattr(X, "name", None)]
    array = _rows.numbers(X, name).astype(np.float64)
    if array.ndim == 1:
        array = array[:, np.newaxis]
    if array.ndim != 2:
        raise ValueError(f"{name} has shape {array.shape}, expected (n, m)")
    return array, None if labels is None else [label if isinstance(label, str) else "" for label in labels]


def table(X: ArrayLike, y: ArrayLike | None, letter: str, name: str) -> tuple[str, list[str], str]:
    """Columns and output as CSV, with the names in it: those of a data frame where each is a plain word of its own,
    otherwise letter1 ... and y. NaN: a missing value."""
    values, given = columns(X, name)
    if letter == "x" and not values.shape[1]:
        raise ValueError(f"{name} has no columns")
    names = [f"{letter}{j + 1}" for j in range(values.shape[1])]
    if letter == "u" and len(names) == 1:
        names = ["u"]
    output = "y"
    parts = [values]
    if y is not None:
        target, called = columns(y, "y")
        if target.shape[1] != 1 or len(target) != len(values):
            shape, n = np.shape(target[:, 0] if target.shape[1] == 1 else target), len(values)
            raise ValueError(f"y has shape {shape}, expected ({n},) as {name} has {n} rows")
        parts.append(target)
        if called and _plain(called):
            output = called[0]
    if given and _plain([*given, output]):
        names = given
    elif output in names:
        output = "y"
    rows = np.column_stack(parts)
    if not len(rows):
        raise ValueError(f"{name} has no rows")
    for i, j in np.argwhere(np.isinf(rows))[:1]:
        where = f"{name}[{i}, {j}]" if j < values.shape[1] else f"y[{i}]"
        raise ValueError(f"{where} is {rows[i, j]}, expected a finite number, or NaN for a missing value")
    out = io.StringIO()
    out.write(",".join([*names, output] if y is not None else names) + "\n")
    for row in rows.tolist():
        out.write(",".join(map(repr, row)) + "\n")
    return out.getvalue(), names, output


def _plain(names: list[str]) -> bool:
    """Whether a file's first row shows that these are names, each once."""
    return len(set(names)) == len(names) and all(
        name.isidentifier() and name.lower() not in _MISSING for name in names
    )


def records(csv: str) -> list[dict[str, Any]]:
    """The rows of a table that the program wrote; numbers as numbers, an empty cell as None."""
    import csv as reader

    lines = [line for line in csv.splitlines() if line and not line.startswith("#")]
    return [{name: _cell(cell) for name, cell in row.items()} for row in reader.DictReader(lines)]


def _cell(text: str) -> Any:
    if text == "":
        return None
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def to_pandas(rows: Sequence[Mapping[str, Any]]) -> Any:
    """The rows as a pandas.DataFrame."""
    try:
        import pandas  # type: ignore[import]
    except ImportError:
        raise ImportError("to_pandas needs pandas (python3-pandas)") from None
    return pandas.DataFrame(list(rows))


def axes(given: Any) -> Any:
    """Those axes of matplotlib, or new ones."""
    if given is not None:
        return given
    try:
        import matplotlib.pyplot  # type: ignore[import]
    except ImportError:
        raise ImportError("plot needs matplotlib (python3-matplotlib)") from None
    return matplotlib.pyplot.subplots()[1]
