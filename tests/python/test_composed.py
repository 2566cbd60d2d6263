"""Guards, windows, rules of forgetting and fleets."""

import copy
import os
import pickle
import subprocess
from pathlib import Path

import numpy as np
import pytest
from data import rows, same
from test_bits import hash_of, numbers
from test_input import refuses

import rlslab

ROOT = Path(__file__).resolve().parents[2]

MADE = [
    {"guard": "reset"}, {"guard": "report", "forgetting": 0.99},
    {"guard": "rebuild", "guard_options": {"rebuild_rows": 20, "innovation": 4.0}}, {"window": 50},
    {"window": 50, "guard": "reset"}, {"control": ("fortescue", 0.01, 50)}, {"control": "kulhavy"},
    {"control": ("kulhavy", 0.9, None), "guard": "reset"}, {"control": ("random_walk", 0.001)},
    {"control": "ridge", "forgetting": 0.99}, {"control": ("reset", 100), "dtype": "float32"},
]  # fmt: skip


@pytest.mark.parametrize("options", MADE, ids=repr)
def test_compositions_run_and_are_copied_and_saved(options, tmp_path):
    Psi, y = rows()
    f = rlslab.Ud(4, **options)
    f.update_many(Psi[:100], y[:100])
    others = [f.copy(), pickle.loads(pickle.dumps(f)), type(f)(**f.options)]
    others[2].restore(f.state)
    f.save(tmp_path / "a.state")
    found = [rlslab.from_state(f.state), rlslab.load(tmp_path / "a.state")]
    assert all(other.dtype == f.dtype and other.state == f.state for other in found)
    found.append(pickle.loads(pickle.dumps(found[0])))
    assert all(other.options.get(name) == f.options.get(name) for other in found for name in ("guard", "window"))
    f.update_many(Psi[100:], y[100:])
    assert np.allclose(f.theta, [1, 2, 3, 4], atol=0.3)
    for other in others:
        assert repr(other) == repr(f)
    for other in [*others, *found]:
        other.update_many(Psi[100:], y[100:])
        assert other.state == f.state
    with pytest.raises(ValueError):
        rlslab.Ud(4, dtype=f.dtype).restore(f.state)


def test_the_options_of_a_state():
    for f in (
        rlslab.Ud(3, window=20, guard="reset", dtype="float32", guard_options={"innovation": 4.1, "asymmetry": 0.1}),
        rlslab.Carlson(2, guard="rebuild", guard_options={"noise_memory": 9, "rebuild_rows": 7}),
        rlslab.Qr(2, control=("kulhavy", 0.9), guard="rebuild", guard_options={"rebuild_rows": 1}),
        rlslab.Ud(1, control=("fortescue", 0.1, None, 0.25), dtype="float32"), rlslab.Ud(2, guard="rebuild"),
    ):    # fmt: skip
        assert repr(rlslab.from_state(f.state)) == repr(f)
    assert repr(rlslab.from_state(rlslab.Ud(2, control="constant", forgetting=0.9).state)) == "Ud(2)"
    walk = rlslab.Kalman(2, control=("random_walk", 0.1))
    assert rlslab.from_state(walk.state).update([1, 2], 3) == walk.update([1, 2], 3)


KEPT = dict(line.split(" ", 1) for line in (ROOT / "tests/data/states.txt").read_text().splitlines())


@pytest.mark.parametrize("name", KEPT)
def test_states_that_cpp_wrote(name, tmp_path):
    """Several are of arithmetics that are not here."""
    variant, _, arithmetic = name.partition("-")
    file = tmp_path / "kept.state"
    file.write_bytes(KEPT[name].encode().decode("unicode_escape").encode("latin-1"))
    if variant in rlslab.variants() and arithmetic.partition("-edition")[0] in ("float", "double"):
        expected = {"float": "float32"}.get(arithmetic, "float64")
        f = rlslab.load(file)
        assert (f.variant, f.dtype) == (variant, expected) and f.counts.rows == 0
    else:
        refuses(lambda: rlslab.load(file))


def test_compositions_that_cpp_saved(tmp_path):
    """tests/portability/digest.cpp writes them after 100 rows, and prints a hash of theta after 200."""
    if "RLSLAB_BITS" not in os.environ:
        pytest.skip("RLSLAB_BITS names no program of tests/portability/digest.cpp: ctest does")
    command = [os.environ["RLSLAB_BITS"], "composed", str(tmp_path)]
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    number = numbers()
    rows = [[next(number) for _ in range(6)] for _ in range(200)]
    ours = []
    for line in printed.splitlines():
        f = rlslab.load(tmp_path / line.split()[0])
        for *psi, y in rows[100:]:
            f.update(psi, y)
        ours.append(f"{line.split()[0]} {hash_of(f.theta.tolist())}")
    assert ours == printed.splitlines() and len(set(ours)) == 3


def test_a_guard_skips_what_is_no_number_and_counts():
    f = rlslab.Ud(2, guard="reset")
    f.update([1, 0], 3)
    before = f.theta
    step = f.update([1, np.nan], 3)
    assert (step.signal, f.signal, f.counts.unusable, f.counts.rows) == ("unusable", "unusable", 1, 2)
    assert same(f.theta, before)
    Psi, y = rows(100, 2)
    y[50] += 100
    steps = f.update_many(Psi, y, steps=True)
    assert [rlslab.SIGNALS[s] for s in steps["signal"][[49, 50, 51]]] == ["none", "outlier", "none"]
    assert f.counts.outliers == 1


def test_a_broken_filter_is_not_sound_when_it_is_loaded():
    f = rlslab.Ud(2)
    f.update([1.0, float("nan")], 1.0)
    assert f.health == "nonfinite" and np.isnan(f.theta).any()
    assert rlslab.from_state(f.state).health == pickle.loads(pickle.dumps(f)).health == "undetermined"
    assert rlslab.from_state(rlslab.Ud(2).state).health == "sound"


def test_a_window_is_the_last_rows():
    Psi, y = rows()
    f = rlslab.Ud(4, window=50, prior_variance=1e4)
    f.update_many(Psi, y)
    P = Psi[-50:].T @ Psi[-50:] + np.eye(4) / 1e4
    assert np.allclose(f.theta, np.linalg.solve(P, Psi[-50:].T @ y[-50:]), rtol=1e-6)


@pytest.mark.parametrize("variant", ["qr", "gentleman", "information"])
def test_a_window_in_which_a_regressor_stands_still_is_not_sound(variant):
    a, b, y = np.loadtxt(ROOT / "tests/data/cases/s11_window_stands_still.csv", delimiter=",", skiprows=1).T
    X = np.column_stack([np.ones_like(a), a, b])
    f = rlslab.filter(variant, 3, window=15, prior_variance=None)
    for k in range(len(y)):
        f.update(X[k], y[k])
        kept = slice(max(0, k - 14), k + 1)
        if 44 <= k <= 59 or k < 2:
            assert f.health == "undetermined", k
        elif 60 < k or 2 < k < 44:    # the row that determines theta has no innovation itself
            assert f.health == "sound", k
            # Taking rows back has cost some digits until the window is factored anew.
            assert np.allclose(f.theta, np.linalg.lstsq(X[kept], y[kept], rcond=None)[0], rtol=1e-9, atol=1e-9), k
    assert np.allclose(f.theta, [1.031295238330194, -1.0035351107366406, 0.9984758478280881], rtol=1e-12)


def test_what_does_not_go_together_says_why():
    for name, options, word in [("ud", {"control": "fortescue"}, "VARIANCE"),
                                ("ud", {"control": ("kulhavy", 2)}, "range"),
                                ("ud", {"window": 5, "control": "kulhavy"}, "window"), ("ud", {"window": -1}, "window"),
                                ("qr_block", {"guard": "reset"}, "qr_block")]:
        with pytest.raises(ValueError, match=word):
            rlslab.filter(name, 2, **options)


@pytest.mark.parametrize("variant", [v for v in rlslab.variants() if v != "qr_block"])
@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_a_fleet_is_its_filters(variant, dtype):
    fleet = rlslab.Fleet(variant, 5, 3, forgetting=0.99, dtype=dtype)
    alone = [rlslab.filter(variant, 3, forgetting=0.99, dtype=dtype) for _ in range(5)]
    Psi, y = rows(5 * 30, 3)
    for k in range(30):
        psi, outputs = Psi[k * 5 : k * 5 + 5], y[k * 5 : k * 5 + 5]
        assert fleet.update(psi if k % 2 else np.asfortranarray(psi), outputs.tolist()) == 0
        for f, row, output in zip(alone, psi, outputs):
            f.update(row, output)
    assert same(fleet.theta, [f.theta for f in alone]) and fleet.theta.dtype == dtype
    assert (fleet.health == 0).all()
    for other in (copy.copy(fleet), copy.deepcopy(fleet), pickle.loads(pickle.dumps(fleet))):
        assert other.state == fleet.state and same(other.theta, fleet.theta)
    assert fleet.update(np.full((5, 3), np.nan), np.zeros(5)) == 5
    fleet.reset(2)
    assert (fleet.theta[2] == 0).all() and same(fleet.theta[1], alone[1].theta)


@pytest.mark.parametrize("variant", [v for v in rlslab.variants() if v != "qr_block"])
@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_steps_paths_and_matrices_of_a_fleet_are_its_filters(variant, dtype):
    options = {"forgetting": 0.99, "dtype": dtype}
    fleet, again = (rlslab.Fleet(variant, 11, 3, **options) for _ in range(2))
    alone = [rlslab.filter(variant, 3, **options) for _ in range(11)]
    Psi, y = (array.reshape(20, 11, *array.shape[1:]) for array in rows(220, 3))
    y[7, 4] = np.nan    # missing there; a filter alone is not offered it
    table, path = fleet.update_many(Psi, y, steps=True, theta=True)
    assert table.shape == (20, 11) and path.shape == (20, 11, 3) and path.dtype == dtype
    for k in range(20):
        one = again.update(Psi[k], y[k], steps=True)
        assert one.tobytes() == table[k].tobytes() and np.array_equal(again.theta, path[k])
        for m, f in enumerate(alone):
            if (k, m) == (7, 4):
                assert np.isnan(one[m]["innovation"]) and rlslab.HEALTHS[one[m]["health"]] == "nonfinite"
                continue
            step = f.update(Psi[k, m], y[k, m])
            assert tuple(one[m])[:3] == step[:3] and rlslab.HEALTHS[one[m]["health"]] == step.health
            assert np.array_equal(f.theta, path[k, m])
    name = "covariance" if hasattr(alone[0], "covariance") else "information"
    assert same(getattr(fleet, name), [getattr(f, name) for f in alone]) and getattr(fleet, name).dtype == dtype
    with pytest.raises(AttributeError, match=f"reports {name}"):
        getattr(fleet, "information" if name == "covariance" else "covariance")
    assert fleet.update_many(Psi[:2], np.full((2, 11), np.nan)) == 22
    assert fleet.update_many(Psi[:0], y[:0], theta=True).shape == (0, 11, 3)
    state = fleet.state
    for bad in ((Psi[:, :5], y[:, :5]), (Psi, y[:5]), (Psi[0], y[0]), (Psi[:, :, :2], y)):
        with pytest.raises(ValueError):
            fleet.update_many(*bad)
    assert fleet.state == state


@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("options", [{}, {"prior_theta": [1, 2, 3], "prior_covariance": np.eye(3) + 1}])
def test_outputs_of_a_fleet_are_filters_with_weights(dtype, options):
    """Each output of each filter has the bits of a filter of its own."""
    rng = np.random.default_rng(9)
    Psi, Y, w = rng.standard_normal((40, 5, 3)), rng.standard_normal((40, 5, 2)), rng.integers(0, 4, (40, 5)) / 2
    Y[7, 4, 1], Psi[9, 2, 0], w[11, 1], w[12, 3] = np.nan, np.inf, -1, np.nan
    w[7, 4] = w[9, 2] = 1
    Psi[w == 0] = np.nan    # time passes, whatever the row is
    fleet = rlslab.Fleet("ud", 5, 3, outputs=2, forgetting=0.98, dtype=dtype, **options)
    plain, again = rlslab.Fleet("ud", 5, 3, forgetting=0.98, dtype=dtype, **options), fleet.copy()
    steps, path = fleet.update_many(Psi, Y, weights=w, steps=True, theta=True)
    assert again.update_many(Psi[:39], Y[:39], weights=w[:39]) == 4
    assert steps.shape == (40, 5, 2) and path.shape == (40, 5, 3, 2) and fleet.outputs == 2 and fleet.dtype == dtype
    last = again.update(Psi[39], Y[39], weights=w[39], steps=True)
    assert last.tobytes() == steps[39].tobytes() and again.state == fleet.state and repr(again) == repr(fleet)
    hold = np.where(np.isfinite(Y).all(2), Y[..., 0], np.nan)    # a missing output is all of its filter's
    ours = plain.update_many(Psi, hold, weights=w, steps=True)
    assert ours.tobytes() == np.ascontiguousarray(steps[..., 0]).tobytes()
    for i, j in np.ndindex(5, 2):
        alone = rlslab.Ud(3, forgetting=0.98, dtype=dtype, **options)
        for k in range(40):
            if (k, i) not in ((7, 4), (9, 2)):
                step = alone.update(Psi[k, i], Y[k, i, j], w[k, i])
                assert np.array_equal(list(step[:3]), list(steps[k, i, j])[:3], equal_nan=True)
                assert step.health == rlslab.HEALTHS[steps[k, i, j]["health"]]
            assert (alone.theta == path[k, i, :, j]).all()
        assert (alone.covariance == fleet.covariance[i]).all()
    other = pickle.loads(pickle.dumps(fleet))
    other.reset(1)
    assert (other.theta[1] == rlslab.Fleet("ud", 1, 3, outputs=2, dtype=dtype, **options).theta[0]).all()
    assert (other.theta[2] == fleet.theta[2]).all() and pickle.loads(pickle.dumps(fleet)).state == fleet.state


def test_fleets_that_are_refused():
    fleet = rlslab.Fleet("ud", 4, 3)
    before = fleet.state
    for Psi, y in [(np.zeros((3, 3)), np.zeros(3)), (np.zeros((4, 2)), np.zeros(4)), (np.zeros(3), 0.0), ("a", "b"),
                   (np.zeros((4, 3)), np.zeros(3)), (None, None), (np.zeros((4, 3), object), np.zeros(4))]:
        with pytest.raises((ValueError, TypeError)):
            fleet.update(Psi, y)
    for weights in (1, np.ones(3), np.ones((4, 1)), "abcd", np.ones(4) * 1j):
        with pytest.raises((ValueError, TypeError), match="weights"):
            fleet.update(np.zeros((4, 3)), np.zeros(4), weights=weights)
    for m in (4, -1, 10**9):
        with pytest.raises(IndexError):
            fleet.reset(m)
    for state in (b"", before[:-1], bytes(len(before)), rlslab.Fleet("ud", 5, 3).state):
        with pytest.raises(ValueError):
            fleet.restore(state)
    for bad in [("ud", 0, 3), ("ud", -1, 3), ("qr_block", 2, 2), ("udd", 2, 2), ("ud", "2", 2), ("ud", 2, 0),
                ("ud", 10**12, 1000)]:
        with pytest.raises((ValueError, TypeError, MemoryError)):
            rlslab.Fleet(*bad)
    assert fleet.state == before


@pytest.mark.parametrize(
    "options",
    [
        {"guard": "reset", "guard_options": {"innovation": 4}},
        {"window": 20, "dtype": "float32"},
        {"control": ("fortescue", 0.1, 50)},
        {"guard": "report", "window": 30, "certify": 2, "digits": 3},
    ],
)
def test_a_composed_fleet_is_its_filters(options):
    rng = np.random.default_rng(8)
    Psi, y = rng.standard_normal((80, 5, 3)), rng.standard_normal((80, 5))
    y[50, 2], y[60, 3] = 1e6, np.nan
    fleet = rlslab.Fleet("ud", 5, 3, forgetting=0.98, **options)
    steps = fleet.update_many(Psi, y, steps=True)
    assert (np.argwhere(np.isnan(steps["innovation"])) == [[60, 3]]).all()
    assert rlslab.SIGNALS[steps[60, 3]["signal"]] == ("unusable" if "guard" in options else "none")
    for i in range(5):
        alone = rlslab.Ud(3, forgetting=0.98, **options)
        for k in range(80):
            if (k, i) != (60, 3):
                step = alone.update(Psi[k, i], y[k, i])
                assert step.innovation == steps[k, i]["innovation"]
                assert step.signal == rlslab.SIGNALS[steps[k, i]["signal"]]
        assert (alone.theta == fleet.theta[i]).all() and (alone.covariance == fleet.covariance[i]).all()
    other = pickle.loads(pickle.dumps(fleet))
    copied = fleet.copy()
    for f in (fleet, other, copied):
        f.update(Psi[0], y[0])
    assert (other.theta == fleet.theta).all() and (copied.theta == fleet.theta).all() and other.state == fleet.state
    fleet.reset(2)
    assert (fleet.theta[2] == 0).all() and (fleet.theta[1] == other.theta[1]).all()


def test_what_no_fleet_can_be_is_refused():
    with pytest.raises(ValueError, match="takes rows back"):
        rlslab.Fleet("conventional", 2, 3, guard="rebuild", window=5, control="kulhavy")
    for variant, options, word in (("qr", {}, "one output"), ("ud", {"guard": "reset"}, "plain variant")):
        with pytest.raises(ValueError, match=word):
            rlslab.Fleet(variant, 2, 3, outputs=2, **options)
    for outputs in (0, -1, 10**12):
        with pytest.raises((ValueError, MemoryError)):
            rlslab.Fleet("ud", 2, 3, outputs=outputs)
    with pytest.raises(ValueError, match="real numbers"):
        rlslab.Fleet("ud", 2, 3, guard="reset", dtype="complex64")
    with pytest.raises(ValueError, match="filters >= 1"):
        rlslab.Fleet("ud", 0, 3, guard="reset")
