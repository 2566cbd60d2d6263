"""What a filter does: rows, answers, copies, states."""

import copy
import os
import pickle
import stat
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from data import rows, same

import rlslab

VARIANTS = rlslab.variants()
BOTH = pytest.mark.parametrize("dtype", ["float64", "float32"])
EACH = pytest.mark.parametrize("variant", VARIANTS)


def matrix(f):
    return f.covariance if hasattr(f, "covariance") else f.information


def test_the_classes_are_the_list():
    assert len(VARIANTS) == 18
    assert list(rlslab.CLASSES) == list(VARIANTS)
    for variant, made in rlslab.CLASSES.items():
        assert made.__name__ == "".join(word.capitalize() for word in variant.split("_"))
        assert getattr(rlslab, made.__name__) is made
        assert type(rlslab.filter(variant, 3)) is made
        assert made(3).variant == variant
    assert set(rlslab.__all__) <= set(dir(rlslab))


@EACH
@BOTH
def test_one_row_after_another_and_many_at_once_are_the_same_bits(variant, dtype):
    Psi, y = rows(dtype=dtype)
    one, many, stepped = (rlslab.filter(variant, 4, forgetting=0.99, dtype=dtype) for _ in range(3))
    steps = [one.update(psi, v) for psi, v in zip(Psi, y)]
    last = many.update_many(Psi, y)
    table = stepped.update_many(Psi, y, steps=True)
    assert [tuple(s)[:3] for s in steps] == [tuple(s)[:3] for s in table.tolist()]
    assert [s.health for s in steps] == [rlslab.HEALTHS[h] for h in table["health"]]
    assert same(one.theta, stepped.theta) and same(one.gain, stepped.gain) and same(matrix(one), matrix(stepped))
    assert one.theta.dtype == one.gain.dtype == matrix(one).dtype == one.dtype == np.dtype(dtype)
    if variant == "qr_block":    # by reflections on blocks: other roundings
        assert np.allclose(one.theta, many.theta, rtol=1e-3 if dtype == "float32" else 1e-10)
    else:
        assert last == steps[-1]
        assert same(one.theta, many.theta) and same(matrix(one), matrix(many))
    assert np.allclose(one.theta, [1, 2, 3, 4], atol=0.1)
    assert one.counts.rows == many.counts.rows == 200


@EACH
def test_theta_is_that_of_least_squares(variant):
    Psi, y = rows()
    f = rlslab.filter(variant, 4, prior_variance=100)
    f.update_many(Psi, y)
    information = Psi.T @ Psi + np.eye(4) / 100
    assert np.allclose(f.theta, np.linalg.solve(information, Psi.T @ y), rtol=1e-9)
    covariance = np.linalg.inv(information)
    assert np.allclose(matrix(f), covariance if hasattr(f, "covariance") else information, rtol=1e-9, atol=1e-12)


def test_a_step_is_a_named_tuple():
    step = rlslab.Ud(1, prior_variance=1).update([1.0], 2.0)
    assert step == (2.0, 1.0, 0.5, "sound", "none")
    innovation, residual, gamma, health, signal = step
    assert (step.innovation, step.residual, step.gamma, step.health, step.signal) == step
    assert step._fields == ("innovation", "residual", "gamma", "health", "signal")
    assert pickle.loads(pickle.dumps(step)) == step
    assert health is step.health


@pytest.mark.parametrize("variant", ["qr", "qr_block", "gentleman", "information"])
def test_without_prior_theta_is_undetermined_at_first(variant):
    f = rlslab.filter(variant, 2, prior_variance=None)
    first, second = f.update([1, 0], 3), f.update([1, 1], 5)
    assert first.health == second.health == "undetermined" and np.isnan(first.innovation)
    assert f.update([1, 2], 7).health == "sound"
    assert np.allclose(f.theta, [3, 2])


def test_who_needs_a_prior_says_so():
    with pytest.raises(ValueError, match="prior"):
        rlslab.Ud(2, prior_variance=None)


def test_priors():
    f = rlslab.Ud(2, prior_theta=[1, 2], prior_covariance=[[2, 1], [1, 2]])
    assert f.theta.tolist() == [1, 2]
    assert np.allclose(f.covariance, [[2, 1], [1, 2]])
    for bad in ([1], [[1, 2]], [1, np.nan], ["a", "b"], [1, 2, 3]):
        with pytest.raises((ValueError, TypeError)):
            rlslab.Ud(2, prior_theta=bad)
    for bad in ([[1, 2], [3, 4]], [[-1, 0], [0, 1]], [1, 2], np.full((2, 2), np.inf)):
        with pytest.raises(ValueError):
            rlslab.Ud(2, prior_covariance=bad)


def test_breakdown_is_a_result():
    f = rlslab.Ud(2)
    assert f.update([1, 2], float("nan")).health == "nonfinite"
    assert f.health == "nonfinite" and np.isnan(f.theta).any()
    table = f.update_many([[1.0, np.inf]], [1.0], steps=True)
    assert rlslab.HEALTHS[table["health"][0]] == "nonfinite"


def test_reset_and_time():
    f = rlslab.Ud(2, forgetting=0.5, prior_variance=1)
    start = f.state
    f.update([1, 2], 3)
    f.reset()
    assert f.state == start and f.counts.rows == 0
    f.pass_time()
    assert f.covariance.tolist() == [[2, 0], [0, 2]]


@EACH
@BOTH
def test_copies_and_pickles_go_on_with_the_same_bits(variant, dtype):
    Psi, y = rows(dtype=dtype)
    f = rlslab.filter(variant, 4, forgetting=0.99, dtype=dtype, prior_theta=[1, 1, 1, 1])
    f.update_many(Psi[:100], y[:100])
    others = [copy.copy(f), copy.deepcopy(f), f.copy()]
    others += [pickle.loads(pickle.dumps(f, protocol)) for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1)]
    f.update_many(Psi[100:], y[100:])
    for other in others:
        assert type(other) is type(f) and repr(other) == repr(f)
        assert not same(other.theta, f.theta)
        other.update_many(Psi[100:], y[100:])
        assert same(other.theta, f.theta) and other.state == f.state
    again = pickle.loads(pickle.dumps(f))
    again.reset()
    assert again.theta.tolist() == [1, 1, 1, 1]


@EACH
@BOTH
def test_a_state_in_a_file_is_loaded_with_and_without_its_filter(variant, dtype, tmp_path):
    Psi, y = rows(dtype=dtype)
    f = rlslab.filter(variant, 4, forgetting=0.99, dtype=dtype)
    f.update_many(Psi, y)
    f.save(tmp_path / "a.state")
    g = rlslab.load(tmp_path / "a.state")
    assert type(g) is type(f) and g.dtype == f.dtype and same(g.theta, f.theta)
    h = rlslab.filter(variant, 4, dtype=dtype)
    h.load(tmp_path / "a.state")
    for other in (g, h):
        assert other.update(Psi[0], y[0]) == f.copy().update(Psi[0], y[0])
    assert [p.name for p in tmp_path.iterdir()] == ["a.state"]


def test_states_that_are_refused_leave_the_filter_as_it_was(tmp_path):
    f = rlslab.Ud(2)
    f.update([1, 2], 3)
    before = f.state
    others = [rlslab.Qr(2).state, rlslab.Ud(3).state, rlslab.Ud(2, dtype="float32").state, b"", b"x" * 500]
    others += [before[:-1], before + b"\0"]
    others += [before[:i] + bytes([before[i] ^ 1]) + before[i + 1 :] for i in range(len(before))]
    for state in others:
        with pytest.raises(ValueError):
            f.restore(state)
        assert f.state == before
        (tmp_path / "bad").write_bytes(state)
        if state[:-1] != before and state not in others[:3]:
            with pytest.raises(ValueError):
                rlslab.load(tmp_path / "bad")
    with pytest.raises(ValueError, match=", of a fleet"):
        f.restore(rlslab.Fleet("ud", 3, 2).state)
    with pytest.raises(TypeError):
        f.restore("text")
    with pytest.raises(FileNotFoundError):
        rlslab.load(tmp_path / "none")
    with pytest.raises(FileNotFoundError):
        f.save(tmp_path / "no folder" / "a.state")


def test_what_stands_at_the_path_is_treated_as_cpp_treats_it(tmp_path):
    """save is core/files.cpp: a node, a pipe and a link stay, a name as long as names may be is one, "" is none."""
    f = rlslab.Ud(2)
    f.update([1, 2], 3)
    (tmp_path / "file").write_bytes(b"old")
    (tmp_path / "link").symlink_to("file")
    f.save(tmp_path / "link")
    assert (tmp_path / "link").is_symlink() and (tmp_path / "file").read_bytes() == f.state
    (tmp_path / "dangling").symlink_to("new")
    f.save(tmp_path / "dangling")
    assert (tmp_path / "dangling").is_symlink() and (tmp_path / "new").read_bytes() == f.state
    os.mkfifo(tmp_path / "pipe")
    with ThreadPoolExecutor(1) as pool:
        read = pool.submit((tmp_path / "pipe").read_bytes)
        f.save(tmp_path / "pipe")
        assert read.result(60) == f.state and (tmp_path / "pipe").is_fifo()
    try:
        os.mknod(tmp_path / "null", stat.S_IFCHR | 0o666, os.makedev(1, 3))
        (tmp_path / "null").write_bytes(b"")    # some file systems have no nodes
    except OSError:
        pass
    else:
        f.save(tmp_path / "null")
        assert (tmp_path / "null").is_char_device()
    for name in ("a" * 255, "\N{SNOWMAN}" * 85, os.fsencode(tmp_path) + b"/\xff.state"):
        f.save(os.path.join(tmp_path, name) if isinstance(name, str) else name)
        assert rlslab.load(os.path.join(os.fsencode(tmp_path), os.fsencode(name))).state == f.state
    left = {"file", "link", "dangling", "new", "pipe", "null", "a" * 255, "\N{SNOWMAN}" * 85, "\udcff.state"}
    assert {p.name for p in tmp_path.iterdir()} <= left
    os.chdir(tmp_path)
    for path, error in (("", FileNotFoundError), (tmp_path, IsADirectoryError), ("a" * 256, OSError),
                        ("a\0b", ValueError), (3, TypeError), (tmp_path / "file" / "x", NotADirectoryError)):
        with pytest.raises(error):
            f.save(path)
    assert {p.name for p in tmp_path.iterdir()} <= left
    mask = os.umask(0o027)
    try:
        f.save("private")
        assert stat.S_IMODE(os.stat("private").st_mode) == 0o640
    finally:
        os.umask(mask)


def test_pickles_of_another_version_or_damaged():
    f = rlslab.Ud(2)
    remade, (version, made_of, options, state) = f.__reduce__()
    assert remade(version, made_of, options, state).state == f.state
    for bad in [(2, made_of, options, state), (None, made_of, options, state), (version, int, options, state),
                (version, "Ud", options, state), (version, made_of, None, state),
                (version, made_of, {"size": 3}, state), (version, made_of, {"size": "2"}, state),
                (version, made_of, {"colour": 2}, state), (version, made_of, options, state[:50]),
                (version, made_of, options, "state"), (version, rlslab.Filter, options, state)]:
        with pytest.raises((ValueError, TypeError)):
            remade(*bad)


def test_a_subclass_keeps_its_type():
    class Mine(rlslab.Ud):
        def predicted(self, psi):
            return float(np.dot(psi, self.theta))

    f = Mine(2, forgetting=0.9)
    f.update([1, 0], 4)
    assert f.copy().predicted([1, 0]) == f.predicted([1, 0]) != 0


def test_what_it_was_made_with():
    f = rlslab.Ud(3, forgetting=0.5, dtype=np.float32, prior_theta=[1, 2, 3])
    g = type(f)(**f.options)
    assert g.state == f.state and repr(rlslab.Ud(3, forgetting=1.0)) == "Ud(3)"
    assert repr(rlslab.Qr(3, prior_variance=None)) == "Qr(3, prior_variance=None)"


def test_what_a_variant_does_not_report_is_no_attribute():
    with pytest.raises(AttributeError, match="ud reports covariance, not information"):
        rlslab.Ud(2).information
    with pytest.raises(AttributeError, match="qr reports information, not covariance"):
        rlslab.Qr(2).covariance
    with pytest.raises(AttributeError):
        rlslab.Ud(2).thetta = 1
