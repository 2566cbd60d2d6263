"""The certificate of a filter: what its probes show, in pickles, copies, states and compositions."""

import copy
import math
import pickle

import numpy as np
import pytest

import rlslab


def rows(n, d, seed=1):
    draws = np.random.default_rng(seed)
    Psi = draws.standard_normal((n, d)).astype(np.float32)
    return Psi, Psi @ np.arange(1, d + 1, dtype=np.float32)


def exact(Psi, forgetting, c2=16384.0):
    """P^-1 of exact arithmetic, but for float64."""
    X = np.eye(Psi.shape[1]) / c2
    for psi in Psi.astype(np.float64):
        X = float(np.float32(forgetting)) * X + np.outer(psi, psi)
    return X


def test_it_shows_the_error_of_p():
    Psi, y = rows(60, 4)
    near = 0
    for c in (c for c in rlslab.CLASSES.values() if c._variant in ("ud", "carlson", "conventional", "joseph")):
        f = c(4, forgetting=0.9, dtype="float32", certify=6)
        f.update_many(Psi, y)
        found, E = f.certificate(), f.covariance.astype(np.float64) @ exact(Psi, 0.9) - np.eye(4)
        truth = np.linalg.norm(E)    # one unit for all parameters
        assert truth < found.bound and found.estimate < found.bound and found.definite == (found.bound < 1)
        near += truth / 2 < found.estimate < 2 * truth
    assert near >= 3


def test_true_is_three_probes():
    assert rlslab.Ud(2, certify=True).state == rlslab.Ud(2, certify=3).state != rlslab.Ud(2, certify=1).state


def test_the_filters_bits_are_as_without():
    Psi, y = rows(50, 3)
    for dtype in ("float32", "float64"):
        f, g = (rlslab.Ud(3, forgetting=0.95, dtype=dtype, certify=s) for s in (0, 3))
        assert (f.update_many(Psi, y, steps=True) == g.update_many(Psi, y, steps=True)).all()
        assert f.theta.tobytes() == g.theta.tobytes()


def test_it_is_in_pickles_copies_and_states():
    Psi, y = rows(80, 3)
    f = rlslab.Qr(3, forgetting=0.98, dtype="float32", guard="reset", window=20, certify=2)
    f.update_many(Psi, y)
    found, state = f.certificate(), f.state
    assert f.certificate() == found and f.state == state, "looking changes nothing"
    assert pickle.loads(pickle.dumps(found)) == found
    for other in (pickle.loads(pickle.dumps(f)), copy.copy(f), rlslab.from_state(state)):
        assert other.certificate() == found
        assert other.options["certify"] == 2
        assert other.state == state
    assert eval(repr(f), vars(rlslab)).options == f.options
    f.reset()
    assert f.certificate().bound < 1e-4


def test_without_a_prior_nothing_is_known_at_first():
    Psi, y = rows(20, 3)
    f = rlslab.Qr(3, prior_variance=None, certify=3)
    assert math.isinf(f.certificate().bound) and not f.certificate().definite
    f.update_many(Psi, y)
    assert f.certificate().bound < 1e-10


def test_a_rule_that_adds_to_p_ends_it():
    Psi, y = rows(20, 3)
    f = rlslab.Ud(3, control=("kulhavy", 0.9), certify=3)
    f.update_many(Psi, y)
    assert math.isinf(f.certificate().bound) and math.isinf(f.certificate().theta)


@pytest.mark.parametrize("variant", ["kalman", "extended_qr", "qr_block"])
def test_forms_without_one_say_so(variant):
    with pytest.raises(ValueError, match="probes"):
        rlslab.filter(variant, 3, certify=3)


def test_a_guard_asks_for_digits():
    Psi, y = rows(2000, 5)
    made = dict(forgetting=0.95, dtype="float32", certify=3, guard="rebuild")
    f, g = (rlslab.Conventional(5, digits=n, **made) for n in (0, 3))
    for filter in (f, g):
        filter.update_many(Psi, y)
    assert g.counts.breakdowns > f.counts.breakdowns
    assert pickle.loads(pickle.dumps(g)).options["digits"] == 3
    assert eval(repr(g), vars(rlslab)).options == g.options
    with pytest.raises(ValueError, match="digits <= 6"):
        rlslab.Ud(3, digits=7, **made)
    with pytest.raises(ValueError, match="probes and a guard beside digits"):
        rlslab.Ud(3, digits=4)
    with pytest.raises(TypeError):
        rlslab.Ud(3, digits=4.0, **made)


def test_what_is_refused():
    with pytest.raises(ValueError, match="without probes"):
        rlslab.Ud(3).certificate()
    for wrong in (-1, 7):
        with pytest.raises(ValueError, match="probes"):
            rlslab.Ud(3, certify=wrong)
    for wrong in (2.0, "3", None):
        with pytest.raises(TypeError):
            rlslab.Ud(3, certify=wrong)
    f = rlslab.Ud(3, certify=2)
    with pytest.raises(ValueError, match="other options"):
        f.restore(rlslab.Ud(3, certify=3).state)
