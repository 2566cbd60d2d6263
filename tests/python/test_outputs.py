"""Several outputs with one regressor: what they compute, take in place, refuse and merge."""

import copy
import pickle
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import reduce
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import rlslab

VARIANTS = [v for v in rlslab.variants() if v not in ("kalman", "extended_qr")]


def record(n=600, d=4, m=3, dtype=np.float64):
    numbers = np.random.default_rng(7)
    X = numbers.standard_normal((n, d)).astype(np.float32)
    Y = (X @ numbers.standard_normal((d, m)) + 0.1 * numbers.standard_normal((n, m))).astype(np.float32)
    return X.astype(dtype), Y.astype(dtype)


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("variant", VARIANTS)
def test_each_output_is_a_filter_of_its_own(variant, dtype):
    X, Y = record()
    made = rlslab.CLASSES[variant]
    f = made(4, outputs=3, forgetting=0.99, dtype=dtype)
    alone = [made(4, forgetting=0.99, dtype=dtype) for _ in range(3)]
    by_blocks = [made(4, outputs=1, forgetting=0.99, dtype=dtype) for _ in range(3)]
    for k in range(50):
        steps = f.update(X[k], Y[k])
        for j in range(3):
            assert steps[j].tolist()[:3] == alone[j].update(X[k], Y[k, j])[:3]
            by_blocks[j].update(X[k], Y[k, j : j + 1])
    assert f.update_many(X, Y) == "sound"
    for j in range(3):
        by_blocks[j].update_many(X, Y[:, j : j + 1])
        assert np.array_equal(f.theta[:, j], by_blocks[j].theta[:, 0])
        if variant != "joseph_rank_two":    # which takes one output row by row
            alone[j].update_many(X, Y[:, j])
            assert np.array_equal(f.theta[:, j], alone[j].theta)
    assert f.theta.shape == (4, 3) and f.theta.dtype == np.dtype(dtype)


def test_rows_are_read_in_place():
    """Rows apart in a wider table are as good as packed ones, and other layouts are copied."""
    X, Y = record()
    table = np.full((600, 9), np.nan)
    table[:, 1:5], table[:, 6:] = X, Y
    left = []
    for A, B in ((X, Y), (table[:, 1:5], table[:, 6:]), (np.asfortranarray(X), Y[::-1][::-1]), (X.tolist(), Y)):
        f = rlslab.QrBlock(4, outputs=3)
        f.update_many(A, B)
        left.append(f.state)
    assert len(set(left)) == 1


def test_what_a_square_root_is():
    X, Y = record()
    f = rlslab.QrBlock(4, outputs=3, prior_variance=None)
    f.update_many(X, Y)
    assert np.allclose(f.factor @ f.factor.T, X.T @ X, rtol=1e-12) and np.allclose(f.information, X.T @ X, rtol=1e-12)
    assert np.allclose(np.triu(f.factor, 1), 0)
    with pytest.raises(AttributeError, match="reports information"):
        _ = f.covariance
    with pytest.raises(AttributeError, match="no square root"):
        _ = rlslab.Symmetric(2, outputs=2).factor


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("variant", ["qr", "qr_block", "gentleman", "information"])
def test_theta_is_nan_until_the_rows_determine_it(variant, dtype):
    """Also of a state, a merged one and a column twice; and from row d on it is there, row by row and in blocks."""
    X, Y = record(30, 8)
    f = rlslab.CLASSES[variant](8, outputs=3, prior_variance=None, dtype=dtype)
    f.update_many(X[:7], Y[:7])
    by_row = f.copy()
    others = [rlslab.from_state(f.state), pickle.loads(pickle.dumps(f))]
    if variant == "qr_block":
        others.append(rlslab.QrBlock(8, outputs=3, prior_variance=None, dtype=dtype))
        others[-1].merge(f)
    for one in (f, *others):
        assert np.isnan(one.theta).all() and one.health == "undetermined"
        one.update_many(X[7:8], Y[7:8])
        assert np.isfinite(one.theta).all() and np.array_equal(one.theta, f.theta)
    by_row.update(X[7], Y[7])
    assert np.isfinite(by_row.theta).all()
    twice = rlslab.CLASSES[variant](9, outputs=3, prior_variance=None, dtype=dtype)
    assert twice.update_many(np.column_stack([X, X[:, 0]]), Y) == "undetermined" and np.isnan(twice.theta).all()


def test_modules_are_loaded_when_named():
    pytest.importorskip("sklearn")
    program = "import rlslab, sys; assert 'sklearn' not in sys.modules; rlslab.sklearn.RLSClassifier(); rlslab.other"
    said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True).stderr
    assert said.endswith("AttributeError: module 'rlslab' has no attribute 'other'\n")


def part(X, Y):
    f = rlslab.QrBlock(4, outputs=3, prior_variance=None)
    f.update_many(X, Y)
    return f


def merged(older, newer):
    out = older.copy()
    out.merge(newer)
    return out


def test_the_tree_of_the_page(monkeypatch):
    """That over Dask's chunks, as it stands, here over a stand-in that computes at once."""
    page = (Path(__file__).resolve().parents[2] / "docs/python.md").read_text()
    (block,) = re.findall(r"```py\n(.*?)```", page, re.S)
    assert len(block.splitlines()) == 15
    monkeypatch.setitem(sys.modules, "dask", SimpleNamespace(delayed=lambda f: f, compute=lambda *x: x))

    def chunked(A):
        out = np.empty((13, 1), object)
        out[:, 0] = np.array_split(A, 13)
        return SimpleNamespace(to_delayed=lambda: out)

    names = {}
    exec(block, names)
    X, Y = record(3001)
    assert np.allclose(names["fit"](chunked(X), chunked(Y)).theta, np.linalg.lstsq(X, Y, rcond=None)[0], rtol=1e-12)
    ridge = names["merged"](names["part"](np.eye(4) / 0.1, np.zeros((4, 3))), names["part"](X, Y))
    expected = rlslab.QrBlock(4, outputs=3, prior_variance=0.01)
    expected.update_many(X, Y)
    assert np.allclose(ridge.theta, expected.theta, rtol=1e-12)


def test_the_tree_of_the_page_by_dask():
    """A cluster of one and of two processes: the bits of the chunks merged here, in the tree's order."""
    distributed = pytest.importorskip("distributed")
    array = pytest.importorskip("dask.array")
    page = (Path(__file__).parents[2] / "docs" / "python.md").read_text()
    names = {}
    exec(re.search(r"```py\n(import dask\n.*?)```", page, re.S)[1], names)
    g = np.random.default_rng(4)
    X, Y = g.standard_normal((700, 6)), g.standard_normal((700, 2))
    states = []
    for workers in (1, 2):
        with distributed.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster:
            with distributed.Client(cluster):
                chunks = array.from_array(X, (100, 6)), array.from_array(Y, (100, 2))
                states.append(names["fit"](*chunks).state)
    parts = [names["part"](X[i : i + 100], Y[i : i + 100]) for i in range(0, 700, 100)]
    while len(parts) > 1:
        parts = [names["merged"](*parts[i : i + 2]) for i in range(0, len(parts), 2)]
    assert states == [parts[0].state] * 2


def test_parts_merge_in_a_tree_of_threads():
    X, Y = record(4000)
    expected = np.linalg.lstsq(X, Y, rcond=None)[0]
    with ThreadPoolExecutor(4) as pool:
        parts = list(pool.map(part, np.array_split(X, 13), np.array_split(Y, 13)))
        first = [pickle.dumps(p) for p in parts]
        chain = reduce(merged, parts)
        while len(parts) > 1:
            pairs = [parts[i : i + 2] for i in range(0, len(parts), 2)]
            parts = list(pool.map(lambda pair: merged(*pair) if len(pair) == 2 else pair[0], pairs))
    assert np.allclose(parts[0].theta, expected, rtol=1e-12) and np.allclose(chain.theta, expected, rtol=1e-12)
    again = reduce(merged, map(pickle.loads, first))
    assert again.state == chain.state
    for options, said in (
        ({"prior_variance": 16384}, "expected a newer part of prior_variance=None: only the older one's counts"),
        ({"forgetting": 0.99}, "expected a part of forgetting 1, found 0.99"),
        ({"outputs": 2}, "parameters and 3 outputs, found qr_block in float64 with 4 parameters and 2 outputs"),
        ({"dtype": "float32"}, "in float64 with 4 parameters and 3 outputs, found qr_block in float32 with 4"),
    ):
        other = rlslab.QrBlock(4, **{"outputs": 3, "prior_variance": None, **options})
        for one in (other, rlslab.from_state(other.state)):    # whose options are in the state alone
            with pytest.raises(ValueError, match=said):
                again.merge(one)
    with pytest.raises(ValueError, match="qr_block does"):
        rlslab.Qr(4, outputs=3).merge(again)
    with pytest.raises(TypeError, match="outputs="):
        again.merge(rlslab.QrBlock(4))
    assert again.state == chain.state


@pytest.mark.parametrize("variant", ["qr_block", "joseph_rank_two", "ud", "information"])
def test_an_unusable_row(variant):
    X, Y = record()
    X[3, 1] = Y[300, 2] = np.nan
    f, cleaned = (rlslab.CLASSES[variant](4, outputs=3) for _ in range(2))
    before = f.state
    with pytest.raises(ValueError, match=r"^row 3, .*; unusable=\"leave_out\" leaves.*$"):
        f.update_many(X, Y)
    assert f.state == before and f.left_out == 0
    assert f.update_many(X, Y, unusable="leave_out") == "sound" and f.left_out == 2
    good = np.isfinite(X).all(axis=1) & np.isfinite(Y).all(axis=1)
    cleaned.update_many(X[good], Y[good])
    assert f.state == cleaned.state


def test_an_output_that_begins_later_was_zero():
    X, Y = record()
    Y[:300, 2] = 0
    f, grown = rlslab.QrBlock(4, outputs=3), rlslab.QrBlock(4, outputs=2)
    f.update_many(X[:300], Y[:300])
    grown.update_many(X[:300], Y[:300, :2])
    grown.add_outputs(1)
    assert grown.state == f.state
    assert pickle.loads(pickle.dumps(grown)).theta.shape == (4, 3)
    with pytest.raises(ValueError):
        rlslab.QrBlock(4, outputs=1, prior_theta=[1, 2, 3, 4]).add_outputs(1)


def test_states_copies_pickles_files(tmp_path):
    X, Y = record()
    f = rlslab.Ud(4, outputs=3, dtype="float32", prior_covariance=np.eye(4))
    f.update_many(X, Y)
    others = [f.copy(), copy.deepcopy(f), pickle.loads(pickle.dumps(f)), rlslab.Ud(4, outputs=3, dtype="float32")]
    f.save(tmp_path / "state")
    others[-1].load(tmp_path / "state")
    theta = f.theta
    f.update_many(X, -Y)
    for other in others:
        assert np.array_equal(other.theta, theta)
        other.update_many(X, -Y)
        assert other.state == f.state
    assert repr(f) == "Ud(4, outputs=3, dtype='float32')"
    again = rlslab.load(tmp_path / "state")
    assert isinstance(again, rlslab.Outputs) and np.array_equal(again.theta, theta)
    again.update_many(X, -Y)
    assert again.state == f.state
    with pytest.raises(ValueError, match="state"):
        rlslab.from_state(f.state[:-1])
    with pytest.raises(ValueError, match="state"):
        rlslab.Ud(4, outputs=2, dtype="float32").restore(f.state)
    with pytest.raises(ValueError, match="another arithmetic: ud in float32 with 4 parameters"):
        rlslab.Ud(4, outputs=3).restore(f.state)
    f.reset()
    assert f.state == rlslab.Ud(4, outputs=3, dtype="float32", prior_covariance=np.eye(4)).state


@pytest.mark.parametrize(
    "make, named",
    [
        (lambda: rlslab.Ud(4, outputs=0), "outputs >= 1"),
        (lambda: rlslab.Ud(4, outputs=-1), "outputs >= 1"),
        (lambda: rlslab.Ud(4, outputs=2.0), "outputs is a whole number"),
        (lambda: rlslab.Ud(4, outputs=2**50), "GB"),
        (lambda: rlslab.Kalman(4, outputs=2), "kalman has one output"),
        (lambda: rlslab.Ud(4, outputs=2, guard="reset"), "plain variant"),
        (lambda: rlslab.Ud(4, outputs=2, prior_variance=None), "prior"),
        (lambda: rlslab.Ud(4, outputs=2, dtype="float16"), "float16"),
        (lambda: rlslab.Outputs("udd", 4, 2), "no variant 'udd'"),
    ],
)
def test_what_is_not_made(make, named):
    with pytest.raises((TypeError, ValueError, MemoryError), match=named):
        make()


@pytest.mark.parametrize(
    "X, Y, named",
    [
        (np.zeros((5, 3)), np.zeros((5, 3)), r"X has shape \(5, 3\), expected \(n, 4\)"),
        (np.zeros((5, 4)), np.zeros(5), r"Y has shape \(5,\), expected \(n, 3\)"),
        (np.zeros((5, 4)), np.zeros((5, 2)), r"Y has shape \(5, 2\)"),
        (np.zeros((5, 4)), np.zeros((4, 3)), "Y has 4 rows, X 5"),
        (np.zeros((5, 4), complex), np.zeros((5, 3)), "X holds complex128"),
        (np.zeros((5, 4)), [["a"] * 3] * 5, "Y holds <U1"),
        (np.ma.masked_less(np.zeros((5, 4)), 1), np.zeros((5, 3)), "masked"),
    ],
)
def test_rows_that_are_none(X, Y, named):
    f = rlslab.QrBlock(4, outputs=3)
    before = f.state
    with pytest.raises((TypeError, ValueError), match=named):
        f.update_many(X, Y)
    assert f.state == before


def test_no_rows_and_single_ones():
    f = rlslab.QrBlock(4, outputs=3)
    before = f.state
    assert f.update_many(np.zeros((0, 4)), np.zeros((0, 3))) == "sound" and f.state == before
    for psi, y in (([1, 2, 3], [1, 2, 3]), ([1, 2, 3, 4], [1, 2]), ([1, 2, 3, 4], 1.0)):
        with pytest.raises(ValueError, match="has shape"):
            f.update(psi, y)
    for one, y in ((f, np.zeros((9, 3))), (rlslab.Ud(4), 0.0)):
        with pytest.raises(ValueError, match=r"psi has shape \(9, 4\), expected \(4,\); update_many takes many rows"):
            one.update(np.zeros((9, 4)), y)
    with pytest.raises(ValueError, match="unusable"):
        f.update_many(np.zeros((1, 4)), np.zeros((1, 3)), unusable="skip")
    steps = f.update([1, 2, 3, 4], [1.0, np.nan, 2.0])    # the row is lost for all
    assert np.isnan(steps["innovation"]).any() and not f.theta.any()


def test_threads_do_not_change_the_bits():
    X, Y = record(2000, 40, 5)
    states = set()
    try:
        for threads in (1, 2, 5):
            rlslab.use_threads(threads)
            f = rlslab.QrBlock(40, outputs=5)
            f.update_many(X, Y)
            states.add(f.state)
    finally:
        rlslab.use_threads(1)
    assert len(states) == 1
    for threads in (0, 1025):
        with pytest.raises(ValueError, match="threads"):
            rlslab.use_threads(threads)
