"""study, sweep and cite: the program's own numbers, and what is refused."""

import subprocess

import pytest
from data import rows
from test_input import refuses

import rlslab
from rlslab import _program


def test_a_study(tmp_path):
    s = rlslab.study("gain_error", out=tmp_path / "out")
    again = rlslab.study("gain_error")
    assert s.records == again.records and s.verdicts == again.verdicts
    assert not s.changed and len(s.verdicts) == 6
    assert {v["verdict"] for v in s.verdicts} <= {"holds", "fails", "undecided"}
    assert (tmp_path / "out/report.html").read_text() == s.report and "holds" in s.summary()
    lines = (tmp_path / "out/gain_error.csv").read_text().splitlines()
    head, *body = [line for line in lines if not line.startswith("#")]
    assert list(s.records[0]) == head.split(",") and len(s.records) == len(body)
    varied = rlslab.study("gain_error", set={"lambda": [0.5, 0.75], "variant": "ud"})
    assert {v["verdict"] for v in varied.verdicts} == {"not judged: factors changed"} and not varied.changed
    assert {(r["lambda"], r["variant"]) for r in varied.records} == {(0.5, "ud"), (0.75, "ud")}
    assert len(rlslab.study("gain_error", seeds=2, set={"lambda": 1, "variant": "ud"}).records) > 1


def test_a_sweep():
    X, y = rows(60, 2)
    s = rlslab.sweep(X, y, {"forgetting": [0.9, 1], "arithmetic": ["float32", "p11"], "variant": ["ud", "qr"]})
    assert {(r["variant"], r["arithmetic"], r["forgetting"]) for r in s.records} == {
        (v, a, f) for v in ("ud", "qr") for a in ("float", "p11") for f in (0.9, 1)
    }
    one = rlslab.compare(X, y, variants="ud", arithmetics="float32", forgetting=0.9, timings=False).records[0]
    swept = next(r for r in s.records if (r["variant"], r["arithmetic"], r["forgetting"]) == ("ud", "float", 0.9))
    assert one["worst_low"] == round(swept["worst_low"], 1)
    assert s.report.startswith("<!") and len(s.records) == 8
    scaled = rlslab.sweep(X, y, {"prior": ["scaled", 1e4], "variant": "ud", "arithmetic": "float64"})
    assert [r["prior"] for r in scaled.records] == ["scaled", 10000]


def test_cite():
    ours = rlslab.cite("ud", "joseph")
    assert ours == subprocess.run([_program.path(), "cite", "ud", "joseph"], capture_output=True, text=True).stdout
    assert ours.startswith("@") and ours != rlslab.cite()


def test_what_is_refused():
    X, y = rows(20, 2)
    for call in (
        lambda: rlslab.study("gain_eror"),
        lambda: rlslab.study("slicot", set={"colour": "red"}),
        lambda: rlslab.study("slicot", budget="slow"),
        lambda: rlslab.study("slicot", seeds=0),
        lambda: rlslab.study("slicot", seed=1.5),
        lambda: rlslab.study(3),
        lambda: rlslab.sweep(X, y, {"forgetting": [2]}),
        lambda: rlslab.sweep(X, y, {"forgetting": [1]}, row_orders=True),
        lambda: rlslab.sweep(X, y, {"forgetting": []}),
        lambda: rlslab.sweep(X, y, {"order": [1, 2]}),
        lambda: rlslab.sweep(X, y[:3], {}),
        lambda: rlslab.sweep(X, y, [1]),
        lambda: rlslab.sweep(X[:, :0], y, {}),
        lambda: rlslab.sweep(X, X[:, :0], {}),
        lambda: rlslab.identify(X[:, :0], y),
        lambda: rlslab.cite("udd"),
        lambda: rlslab.cite("--help"),
        lambda: rlslab.study("--help"),
        lambda: rlslab.study("../slicot"),
        lambda: rlslab.study("slicot", set={"--out": 1}),
        lambda: rlslab.cite(3),
    ):
        refuses(call, most=1000)
    with pytest.raises(ValueError, match=r"^vary: forgetting: expected at least one value, found \[\]"):
        rlslab.sweep(X, y, {"forgetting": []})


def test_pandas():
    pytest.importorskip("pandas")
    X, y = rows(40, 2)
    s = rlslab.sweep(X, y, {"variant": ["ud", "qr"]})
    assert len(s.to_pandas()) == len(s.records)
    assert len(rlslab.study("slicot").to_pandas()) > 2
