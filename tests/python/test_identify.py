"""identify and excitation: the program's own numbers, statsmodels' words, a running filter; what is refused."""

import json
import os
import subprocess

import numpy as np
import pytest
from data import same
from test_input import SAME, refuses

import rlslab
from rlslab import _program
from rlslab.results import RecursiveLS


def record(n=400, seed=3, inputs=1):
    """y of a known system of order 2, and its inputs."""
    generator = np.random.default_rng(seed)
    u = np.sign(generator.standard_normal((n, inputs)))
    y = np.zeros(n)
    for k in range(2, n):
        y[k] = 1.5 * y[k - 1] - 0.7 * y[k - 2] + u[k - 1].sum() + 0.5 * u[k - 2, 0] + 0.1 * generator.standard_normal()
    return y, u[:, 0] if inputs == 1 else u


def simpson(f, a, b=np.pi / 2, n=20000):
    x = np.linspace(a, b, 2 * n + 1)
    weights = np.r_[1, np.tile([4, 2], n)[:-1], 1]
    return (b - a) / (6 * n) * (weights @ f(x))


def asked(path, *words):
    done = subprocess.run(
        [_program.path(), "identify", str(path), "--json", "--no-timings", *words], capture_output=True, text=True
    )
    assert done.returncode in (0, 1), done.stderr
    return json.loads(done.stdout)


def test_the_numbers_are_those_of_the_program(tmp_path):
    y, u = record(inputs=2)
    np.savetxt(tmp_path / "file.csv", np.column_stack([u, y]), "%.17e", ",", header="u1,u2,y", comments="")
    for options in ({}, {"na": 2, "nb": [1, 2], "delay": [1, 0]}, {"order": 2, "forgetting": 0.99, "validate": 0.5}):
        words = _program.options(**options)
        theirs = asked(tmp_path / "file.csv", "--input", "u1,u2", "--output", "y", *words)
        m = rlslab.identify(y, u, **options)
        ours = m.to_dict()
        for one in (theirs, ours):
            one.pop("run"), one.pop("file")
        assert ours == theirs
        assert m.params.tolist() == [p["value"] for p in theirs["parameters"]]
    assert rlslab.identify(y + 1e-9, u, order=2).to_dict()["parameters"] != ours["parameters"]


def test_the_words_of_statsmodels():
    y, u = record()
    m = rlslab.identify(y, u, na=2, nb=1, delay=1)
    assert m.names == ["a1", "a2", "b0", "b1", "c"]
    assert np.allclose(m.params[:4], [-1.5, 0.7, 1, 0.5], atol=0.05)
    assert np.array_equal(m.tvalues, m.params / m.bse) and (m.bse > 0).all()
    interval = m.conf_int()
    assert same(interval, [[p["low"], p["high"]] for p in m.to_dict()["parameters"]])
    wide, narrow = m.conf_int(0.001), m.conf_int(0.5)
    half = [(i[:, 1] - i[:, 0]) / 2 for i in (wide, interval, narrow)]
    assert (half[0] > half[1]).all() and (half[1] > half[2]).all()
    # Student's quantile at so many degrees of freedom is nearly the normal's.
    assert np.allclose(half[1] / m.bse, 1.97, atol=0.01) and np.allclose(half[0] / m.bse, 3.33, atol=0.03)
    # P(|T| >= t) = 2 integral of cos^(nu - 1) beyond atan(t / sqrt nu), over that from 0 on: by Simpson's rule.
    nu = m.df_resid
    for t, p in zip(m.tvalues, m.pvalues):
        tail, whole = (simpson(lambda x: np.cos(x) ** (nu - 1), a) for a in (np.arctan(abs(t) / np.sqrt(nu)), 0.0))
        assert abs(p - tail / whole) < 1e-9
    more = rlslab.identify(y, u, order=2)    # u[k] has no effect
    alpha = more.pvalues[more.names.index("b0")]
    assert 0.01 < alpha < 0.99
    for change, leaves_out_0 in ((1e-3, True), (-1e-3, False)):
        low, high = more.conf_int(alpha + change)[more.names.index("b0")]
        assert (low * high > 0) == leaves_out_0
    refuses(lambda: m.conf_int(0))
    refuses(lambda: m.conf_int(2))
    assert abs(m.scale - 0.01) < 0.002 and abs(m.df_resid - (m.nobs - 5)) < 1e-6
    assert m.equation in m.summary() and "next" in m.to_dict() and isinstance(m.next, str)
    assert np.allclose(np.sort_complex(m.poles), [0.75 - 0.37j, 0.75 + 0.37j], atol=0.02)
    assert np.allclose(m.zeros[0], [-0.5], atol=0.05) and np.allclose(m.gain, 7.5, atol=0.5)
    assert m.fit["one_step"] > 90 and m.remarks == m.to_dict()["warnings"] + m.to_dict()["hints"]
    assert m.page.startswith("<!") and m.structure in repr(m)
    assert "Hz" in rlslab.identify(y, u, order=2, sample_time=0.01).summary() and "Hz" not in m.summary()
    refuses(lambda: rlslab.identify(y, u, order=2, sample_time=-1.0))
    again = rlslab.identify(y, u, order=2, noise_model=1, instruments=2).to_dict()
    assert again["noise_model"] and again["instruments"] and "noise_model" not in m.to_dict()


@pytest.mark.parametrize(
    "options",
    [{"order": 2}, {"na": 2, "nb": [0, 1], "delay": [1, 2], "intercept": True}, {"order": 1, "detrend": False},
     {"regressors": ["y[k-1..k-2]", "u2[k-1]", "u1[k-3]"]}, {"regressors": ["u2[k-1]", "y[k-2]"]},
     {"order": 2, "variant": "qr", "forgetting": 0.99},
     {"order": 2, "prior_variance": 100.0}, {"order": 2, "prior_variance": 3.0}],
    ids=str,
)  # fmt: skip
def test_a_running_filter(options):
    """From the rows of the equation it finds theta as the model has it, bit for bit."""
    y, u = record(inputs=2)
    m = rlslab.identify(y + 4, u - 2, **options)
    Psi, outputs = m.rows(y + 4, u - 2)
    f = m.filter()
    f.update_many(Psi[: m.nobs], outputs[: m.nobs])
    assert same(f.theta, m.params)
    assert m.recursive_coefficients.shape == (m.nobs, len(m.names))
    assert same(m.recursive_coefficients[-1], m.params)
    f.update_many(Psi[m.nobs :], outputs[m.nobs :])
    assert not same(f.theta, m.params) and f.health == "sound"
    assert m.filter(forgetting=0.9)._made["forgetting"] == 0.9


def test_constancy():
    """The recursive residuals are those of rlslab.results, row by row."""
    y, u = record()
    m = rlslab.identify(y, u, order=2)
    Psi, outputs = m.rows(y, u)
    r = RecursiveLS(outputs[: m.nobs], Psi[: m.nobs])
    n = len(m.params)
    assert len(m.resid_recursive) == len(m.cusum) == len(m.cusum_squares) == m.nobs - n
    assert np.allclose(m.resid_recursive, r.resid_recursive[n:], rtol=1e-9, atol=1e-12)
    assert np.allclose(m.cusum_squares, r.cusum_squares, rtol=1e-9)
    assert np.allclose(m.cusum, r.cusum, rtol=0.01)    # another estimate of the deviation


def test_recursive_coefficients():
    """Each is the least-squares solution of the rows so far, with the prior; rows that miss a value are none."""
    y, u = record(inputs=2)
    y[60] = u[9, 0] = np.nan
    m = rlslab.identify(y, u, order=2, forgetting=0.98)
    kept = m.recursive_coefficients
    assert kept is m.recursive_coefficients and len(kept) == m.nobs
    Psi, outputs = m.rows(y, u)
    there = ~(np.isnan(Psi).any(axis=1) | np.isnan(outputs))
    Psi, outputs = Psi[there], outputs[there]
    scales, c = np.array(m.to_dict()["prior"]["scales"]), m.to_dict()["prior"]["c"]
    for k in (20, 100, m.nobs):
        w = 0.98 ** np.arange(k - 1, -1, -1.0)
        M = (Psi[:k].T * w) @ Psi[:k] + 0.98**k * np.diag((scales / c) ** 2)
        assert np.allclose(kept[k - 1], np.linalg.solve(M, (Psi[:k].T * w) @ outputs[:k]), rtol=1e-7, atol=1e-9)
    assert same(kept[-1], m.params)
    in_blocks = rlslab.identify(y, u, order=2, variant="qr_block")
    assert same(in_blocks.recursive_coefficients[-1], in_blocks.params)
    y[:] = 0    # the record may change
    assert same(rlslab.Identification.recursive_coefficients.func(m), kept)


def test_against_statsmodels():
    """Where there is neither prior nor forgetting to speak of, they are statsmodels', transposed."""
    statsmodels = pytest.importorskip("statsmodels.api")
    y, u = record()
    m = rlslab.identify(y, u, order=2, prior_variance=1e12)
    Psi, outputs = m.rows(y, u)
    theirs = statsmodels.RecursiveLS(outputs[: m.nobs], Psi[: m.nobs]).fit()
    assert theirs.recursive_coefficients.filtered.shape == m.recursive_coefficients.T.shape
    assert np.allclose(theirs.recursive_coefficients.filtered[:, 20:].T, m.recursive_coefficients[20:], atol=1e-5)
    assert np.allclose(theirs.params, m.params, atol=1e-6) and np.allclose(theirs.tvalues, m.tvalues, rtol=1e-4)
    # statsmodels takes the normal distribution, here nearly Student's
    assert np.allclose(theirs.pvalues, m.pvalues, atol=0.005)


def test_a_series_alone_and_missing_values():
    y, _ = record()
    m = rlslab.identify(y, regressors="y[k-1..k-2]")
    assert m.names[:2] == ["a1", "a2"] and m.rows(y)[0].shape == (398, len(m.names))
    y[50] = np.nan
    m = rlslab.identify(y, regressors=["y[k-1..k-2]"])
    assert m.to_dict()["skipped"] == 3 and np.isnan(m.rows(y)[0]).any(axis=1).sum() == 2
    refuses(lambda: m.rows(y, y))
    refuses(lambda: rlslab.identify(y, y, order=2).rows(y))


def test_tracked():
    y, u = record()
    m = rlslab.identify(y, u, order=2, control=("random_walk", 1e-4), guard="report")
    assert len(m.to_dict()["tracked"]["rows"]) > 300


@pytest.mark.parametrize("change", SAME)
def test_layouts_that_are_taken(change):
    y, u = record(100, inputs=2)
    assert same(rlslab.identify(change(y), change(u), order=1).params, rlslab.identify(y, u, order=1).params)


@pytest.mark.parametrize("scale", [2.0**-300, 2.0**300])
def test_scales(scale):
    y, u = record()
    m, plain = rlslab.identify(y * scale, u * scale, order=2), rlslab.identify(y, u, order=2)
    assert same(m.params[:5], plain.params[:5]) and np.allclose(m.bse[:5], plain.bse[:5], rtol=1e-9)


def test_what_is_refused():
    y, u = record(60)
    for call in (
        lambda: rlslab.identify(y, u[:-1]),
        lambda: rlslab.identify(y[:, np.newaxis, np.newaxis], u),
        lambda: rlslab.identify(np.column_stack([y, y]), u),
        lambda: rlslab.identify(3.0),
        lambda: rlslab.identify([], []),
        lambda: rlslab.identify(y, u.astype(str)),
        lambda: rlslab.identify(y, u * np.nan, order=2),
        lambda: rlslab.identify(y, u * 0, order=2),
        lambda: rlslab.identify(y, u, order=2, na=2),
        lambda: rlslab.identify(y, u, regressors=["--help"]),
        lambda: rlslab.identify(y, u, order=2, variant="--help"),
        lambda: rlslab.identify(y, u, order=50),
        lambda: rlslab.identify(y, u, order=0),
        lambda: rlslab.identify(y, u, max_order="many"),
        lambda: rlslab.identify(y, u, na=2, nb=[1, 2, 3]),
        lambda: rlslab.identify(y, u, na=2, nb="1"),
        lambda: rlslab.identify(y, u, regressors=["v[k-1]"]),
        lambda: rlslab.identify(y, u, validate=1),
        lambda: rlslab.identify(y, u, confidence=1),
        lambda: rlslab.identify(y, u, variant="udd"),
        lambda: rlslab.identify(y, u, forgetting=2),
        lambda: rlslab.excitation(np.column_stack([u, u])),
        lambda: rlslab.excitation([]),
        lambda: rlslab.excitation(u * np.nan),
        lambda: rlslab.excitation(u, max_order=0),
    ):
        refuses(call, most=300)


def test_excitation():
    e = rlslab.excitation(np.sin(np.arange(200.0)), max_order=6)
    assert e.order == 2 and e.exact_order >= 2 and len(e.orders) == 6 and e.orders[1]["resolved"]
    assert rlslab.excitation(np.ones(50)).order == 1
    step = rlslab.excitation(np.arange(100) > 50)
    assert step.order > step.persistent_order and step.changes == 1
    assert "2" in repr(e)


def test_pandas_and_plot():
    pandas = pytest.importorskip("pandas")
    y, u = record(inputs=2)
    m = rlslab.identify(pandas.Series(y, name="speed"), pandas.DataFrame(u, columns=["left", "right"]), order=2)
    assert "b0[left]" in m.names and "speed[k]" in m.equation
    Psi, outputs = m.rows(y, u)
    assert Psi.shape[1] == len(m.params)
    assert len(rlslab.excitation(u[:, 0]).to_pandas()) > 3
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    m.plot().figure.savefig(os.devnull, format="png")
