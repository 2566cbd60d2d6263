"""compare: the program's own numbers, the recommended filter, and what is refused."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from data import rows, same
from test_input import SAME, refuses

import rlslab
from rlslab import _program

QUICK = {"variants": ["conventional", "ud", "qr"], "timings": False}


def asked(path, *words):
    """The JSON of the program on a file."""
    done = subprocess.run(
        [_program.path(), "compare", str(path), "--json", "--no-timings", *words], capture_output=True, text=True
    )
    assert done.returncode in (0, 1), done.stderr
    return json.loads(done.stdout)


def written(path, X, y, names):
    """A file by another way: each number by numpy's shortest digits, rows ended as on Windows."""
    with open(path, "w", newline="\r\n") as file:
        file.write(",".join([*names, "out"]) + "\n")
        for row, v in zip(X, y):
            file.write(",".join(np.format_float_scientific(x) for x in (*row, v)) + "\n")


@pytest.mark.parametrize("options", [{}, {"forgetting": 0.97}, {"digits": 3.0}, {"window": 30}], ids=str)
def test_the_numbers_are_those_of_the_program(tmp_path, options):
    X, y = rows(120, 3)
    X[:, 2] = X[:, 1] + 1e-3 * X[:, 2]
    names = ["x1", "x2", "x3"]
    written(tmp_path / "file.csv", X, y, names)
    words = [f"--{name}={value:g}" for name, value in options.items()]
    theirs = asked(tmp_path / "file.csv", "--regressors", ",".join(names), "--output", "out", *words)
    ours = rlslab.compare(X, y, timings=False, **options).to_dict()
    assert ours.pop("run")["rows"] == theirs.pop("run")["rows"] == 120
    text = [json.dumps(one).replace(str(tmp_path / "file.csv"), "standard input") for one in (ours, theirs)]
    text[1] = text[1].replace("out[k]", "y[k]")
    assert text[0] == text[1]
    assert json.dumps(rlslab.compare(X, y * 2, timings=False, **options).to_dict()) != text[0]


@pytest.mark.parametrize("options", [{"variants": "ud"}, {"prior_variance": 1e6, "forgetting": 0.97}, {"digits": 3.0},
                                     {"window": 30, "guard": "reset"}, {"control": ("kulhavy", 0.97, 0)}], ids=str)
def test_the_code_for_python_makes_the_same_filter(tmp_path, options):
    X, y = rows(120, 3)
    written(tmp_path / "file.csv", X, y, "abc")
    words = ["--regressors", "a,b,c", "--output", "out", "--code", "python"]
    for name, value in options.items():
        value = ":".join(map(str, value)) if isinstance(value, tuple) else str(value)
        words.append(f"--{'p0' if name == 'prior_variance' else name}={value}")
    done = subprocess.run(
        [_program.path(), "compare", str(tmp_path / "file.csv"), *words], capture_output=True, text=True, check=True
    )
    made: dict = {}
    exec(done.stdout, made)
    assert "# out[k] = psi'theta,  psi = (a[k], b[k], c[k])\n" in done.stdout
    f, g = made["f"], rlslab.compare(X, y, timings=False, **options).filter()
    f.update_many(X, y), g.update_many(X, y)
    assert f.state == g.state


def test_the_records():
    X, y = rows(120, 3)
    c = rlslab.compare(X, y, timings=False, forgetting=0.98)
    of = {(r["variant"], r["arithmetic"]): r for r in c.records}
    assert len(of) == len(c.records) and {v for v, _ in of} >= set(rlslab.variants())
    for result in c.to_dict()["results"]:
        record = of[result["variant"], result["arithmetic"]]
        assert record["theta_digits"] == result["theta_digits"] and record["operations"] == result["operations"]
        assert record["worst_low"] == result["spread"]["worst"]["low"]
    recommended = {r["arithmetic"]: r["variant"] for r in c.recommended}
    assert [(r["arithmetic"], r["variant"]) for r in c.records if r["recommended"]] == list(recommended.items())
    assert c.best is of[recommended["float"], "float"]
    assert c.names == ["x1", "x2", "x3"] and len(c.theta) == len(c.least_squares) == 3
    assert 0 < c.radius < 1e-30 and c.condition > 1
    assert "* " + c.best["variant"] in c.table() and c.table().startswith("in float   use " + c.best["variant"])
    assert c.code.count("filter(") == 1 and f"psi = (x1[k], x2[k], x3[k])" in c.code
    assert c.page.startswith("<!") and "recommended" in c.records[0]
    assert c.best["variant"] in repr(c) and "<table>" in c._repr_html_()
    c.to_dict().clear()
    assert c.to_dict()["results"]


def test_probes_stand_beside_the_truth():
    X, y = rows(120, 3)
    c = rlslab.compare(X, y, **QUICK, certify=True)
    ud = next(r for r in c.records if r["variant"] == "ud" and r["arithmetic"] == "float")
    assert 0 < ud["probes_truth"] < ud["probes_bound"] and ud["probes_estimate"] < ud["probes_bound"]
    assert abs(ud["predicted_covariance"] - ud["covariance_median"]) < 1 and ud["predicted_at_least"] is False
    assert "Probes: 3 in a filter" in c.table() and "What probes show" in c.page
    plain = rlslab.compare(X, y, **QUICK)
    assert "probes_bound" not in plain.records[0] and "What probes show" not in plain.page
    with pytest.raises(ValueError, match="certify: does not go with"):
        rlslab.compare(X, y, **QUICK, certify=True, window=30)


@pytest.mark.parametrize("options", [{}, {"prior_variance": 1e6}, {"digits": 4}, {"digits": 12}], ids=str)
def test_the_filter_keeps_the_digits_that_were_counted(options):
    X, y = (a.astype(np.float32).astype(np.float64) for a in rows(120, 3))    # stored as they are
    c = rlslab.compare(X, y, timings=False, **options)
    f = c.filter()
    assert f.variant == c.best["variant"] and {"float": "float32", "double": "float64"}[c.best["arithmetic"]] == f.dtype
    f.update_many(X, y)
    if "digits" in options:
        assert rlslab.certified(X, y).digits_worst(f.theta) >= options["digits"]
        return
    P0 = np.diag(c.to_dict()["prior"]["P0"]) if "prior" in c.to_dict() else 1e6 * np.eye(3)
    kept = rlslab.certified(X, y, prior_covariance=P0).digits_worst(f.theta)
    assert abs(kept - c.best["theta_digits_worst"]) < 2e-3
    assert abs(rlslab.certified(X, y).digits_worst(f.theta) - kept) > 2e-3    # another problem has others


def test_the_filter_has_what_was_said():
    X, y = rows(120, 3)
    around = {"window": 40, "guard": "reset", "control": ("random_walk", 1e-4)}
    for options in ({"window": 40, "guard": "reset"}, {"control": ("random_walk", 1e-4)}, {"forgetting": 0.97}):
        f = rlslab.compare(X, y, timings=False, **options).filter()
        assert {name: f._made.get(name) for name in options} == options, repr(f)
        assert not (set(around) - set(options)) & set(f._made)
        assert f.update_many(X, y).health == "sound"
    other = rlslab.compare(X, y, timings=False).filter(dtype="float64", forgetting=0.9)
    assert other.dtype == np.float64 and other._made["forgetting"] == 0.9


def test_a_prior_of_ones_own():
    """The filter is the plain one with it, bit for bit."""
    X, y = rows(60, 2)
    c = rlslab.compare(X, y, timings=False, arithmetics="float64", prior_variance=256.0)
    assert "rlslab::Prior<double>{.variance = 256" in c.code
    f, plain = c.filter(), rlslab.filter(c.best["variant"], 2, prior_variance=256.0)
    f.update_many(X, y)
    plain.update_many(X, y)
    assert same(f.theta, plain.theta)


@pytest.mark.parametrize("change", SAME)
def test_layouts_that_are_taken(change):
    X, y = rows(40, 3)
    expected = rlslab.compare(X, y, **QUICK).to_dict()
    assert rlslab.compare(change(X), change(y), **QUICK).to_dict() == expected


@pytest.mark.parametrize("scale", [2.0**-300, 2.0**300])
def test_scales(scale):
    """Digits in double do not change with units: powers of two, far from its ends."""
    X, y = rows(60, 3)
    plain, scaled = (rlslab.compare(X * s, y * s, arithmetics="float64", **QUICK) for s in (1.0, scale))
    assert plain.records == scaled.records
    assert scaled.filter().update_many(X * scale, y * scale).health == "sound"
    c = rlslab.compare(X * scale, y * scale, digits=3, arithmetics="float32", **QUICK)
    refuses(c.filter)    # its columns are scaled first
    assert c.best and "powers of two" in c.code + " powers of two"


def test_rows_that_miss_a_value_are_left_out():
    X, y = rows(40, 3)
    holes, gaps = X.copy(), y.copy()
    holes[4, 1] = gaps[7] = np.nan
    c = rlslab.compare(holes, gaps, **QUICK)
    assert c.to_dict()["data"]["rows"] == 38 and c.to_dict()["data"]["skipped"] == 2
    assert c.records == rlslab.compare(np.delete(X, [4, 7], 0), np.delete(y, [4, 7]), **QUICK).records


def test_one_parameter_and_an_intercept():
    X, y = rows(30, 1)
    assert rlslab.compare(X, y, **QUICK).names == ["x1"]
    c = rlslab.compare(X + 5, y, intercept=True, **QUICK)
    assert len(c.names) == 2 and c.filter().size == 2
    assert rlslab.compare(X + 5, y + 3, detrend=True, **QUICK).best


def test_names_of_arithmetics():
    X, y = rows(30, 2)
    c = rlslab.compare(X, y, arithmetics=["p11", "bfloat16", "float32"], **QUICK)
    assert {r["arithmetic"] for r in c.records} == {"p11", "bfloat16", "float"}
    assert len({r["arithmetic"] for r in rlslab.compare(X, y, arithmetics="all", **QUICK).records}) > 6
    none = rlslab.compare(X, y, arithmetics="bfloat16", **QUICK)
    assert none.best is None and none.code == "" and "nothing is recommended" in repr(none)
    refuses(none.filter)


def test_what_is_refused():
    X, y = rows(20, 3)
    for call in (
        lambda: rlslab.compare(X[:, 0], y, arithmetics="float33"),
        lambda: rlslab.compare(X[np.newaxis], y),
        lambda: rlslab.compare(3.0, y),
        lambda: rlslab.compare(X, y[:-1]),
        lambda: rlslab.compare(X, X),
        lambda: rlslab.compare(X[:, :0], y),
        lambda: rlslab.compare(X[:0], y[:0]),
        lambda: rlslab.compare(X * np.nan, y),
        lambda: rlslab.compare(X * np.inf, y),
        lambda: rlslab.compare(X * 2.0**600, y),
        lambda: rlslab.compare(X[:2], y[:2]),
        lambda: rlslab.compare(np.column_stack([X, X[:, 0]]), y),
        lambda: rlslab.compare(X.astype(object), y),
        lambda: rlslab.compare(X + 1j, y),
        lambda: rlslab.compare(X.astype(str), y),
        lambda: rlslab.compare(np.ma.masked_array(X), y),
        lambda: rlslab.compare([[1, 2], [3]], [1, 2]),
        lambda: rlslab.compare(X, y, forgetting=0),
        lambda: rlslab.compare(X, y, forgetting=None, prior_variance=-1),
        lambda: rlslab.compare(X, y, forgetting=[1, 2]),
        lambda: rlslab.compare(X, y, digits=99),
        lambda: rlslab.compare(X, y, digits=True),
        lambda: rlslab.compare(X, y, variants="udd"),
        lambda: rlslab.compare(X, y, variants="--help"),
        lambda: rlslab.compare(X, y, guard="--help"),
        lambda: rlslab.compare(X, y, variants=[3]),
        lambda: rlslab.compare(X, y, window=-1),
        lambda: rlslab.compare(X, y, window=3.5),
        lambda: rlslab.compare(X, y, guard="rest"),
        lambda: rlslab.compare(X, y, control=7),
        lambda: rlslab.compare(X, y, control=("fortescue", "x")),
        lambda: rlslab.compare(X, y, seed=-1),
        lambda: rlslab.compare(X, y, threads=0),
        lambda: rlslab.compare(X, y, variants="u\0d"),
    ):
        refuses(call, most=300)
    with pytest.raises(ValueError, match="^prior_variance: "):
        rlslab.compare(X, y, prior_variance=-1)
    X[2, 1] = np.inf
    with pytest.raises(ValueError, match=r"^X\[2, 1\] is inf, expected a finite number"):
        rlslab.compare(X, y)
    y[3] = -np.inf
    with pytest.raises(ValueError, match=r"^y\[3\] is -inf"):
        rlslab.compare(X[:, :1], y)


def test_where_the_program_is(tmp_path, monkeypatch):
    X, y = rows(20, 2)
    monkeypatch.setenv("RLSLAB_PROGRAM", str(tmp_path / "nothing"))
    refuses(lambda: rlslab.compare(X, y), RuntimeError)
    silent = tmp_path / "silent"
    silent.write_text("#!/bin/sh\nkill -9 $$\n")
    silent.chmod(0o755)
    monkeypatch.setenv("RLSLAB_PROGRAM", str(silent))
    refuses(lambda: rlslab.compare(X, y), RuntimeError)
    monkeypatch.delenv("RLSLAB_PROGRAM")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(_program, "__file__", str(tmp_path / "rlslab/_program.py"))
    refuses(lambda: rlslab.compare(X, y), RuntimeError)


def test_an_interrupt_ends_it(tmp_path):
    """KeyboardInterrupt, and no child and no folder left behind."""
    script = """
import os, sys, threading
import signal
import numpy as np, rlslab
signal.signal(signal.SIGINT, signal.default_int_handler)  # which a job in a shell's background ignores
X = np.random.default_rng(1).standard_normal((20000, 12))
threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    rlslab.compare(X, X[:, 0], arithmetics="all")
except KeyboardInterrupt:
    print(os.listdir(os.environ["TMPDIR"]))
"""
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, timeout=60)
    assert done.stdout == "[]\n", done.stdout + done.stderr


def test_pandas():
    pandas = pytest.importorskip("pandas")
    X, y = rows(40, 2)
    frame = pandas.DataFrame(X, columns=["slope", "level"])
    c = rlslab.compare(frame, pandas.Series(y, name="out"), **QUICK)
    assert c.names == ["slope", "level"] and "out[k] = psi'theta" in c.code
    table = c.to_pandas()
    assert len(table) == len(c.records) and table.loc[table["recommended"], "variant"].iloc[0] == c.best["variant"]
    odd_names = [["größe", "Δ"], ["a b", "c"], ["a", "a"], [0, 1], ["y", "out"], ["nan", "x"], ["1", "2"]]
    for names in (*odd_names, ["a\nb", 'c"']):
        odd = rlslab.compare(pandas.DataFrame(X, columns=names), pandas.Series(y, name="out"), **QUICK)
        assert odd.records == c.records


def test_plot():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    X, y = rows(400, 3)
    X[:, 2] = X[:, 1] + 1e-4 * X[:, 2]
    c = rlslab.compare(X, y, timings=False, forgetting=0.9)
    ax = c.plot()
    assert [label.get_text() for label in ax.get_yticklabels()] == list(dict.fromkeys(r["variant"] for r in c.records))
    assert c.plot(ax) is ax
    ax.figure.savefig(os.devnull, format="png")


@pytest.mark.parametrize("missing, call", [("pandas", "to_pandas"), ("matplotlib.pyplot", "plot")])
def test_without_what_is_optional(monkeypatch, missing, call):
    monkeypatch.setitem(sys.modules, missing, None)
    X, y = rows(20, 1)
    refuses(getattr(rlslab.compare(X, y, **QUICK), call), ImportError)
