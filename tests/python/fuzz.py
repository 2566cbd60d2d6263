"""fuzz.py [CASES [SEED]]: random calls with random arguments.

By hand under the address sanitizer, for a package that was built with it (`./lab dev`):
LD_PRELOAD="$(g++ -print-file-name=libasan.so) libstdc++.so.6" ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1
PYTHONPATH=build/dev/python /usr/bin/python3 -W ignore tests/python/fuzz.py

Each case is an error of one line that leaves the filter as it was, or the state that plain float64 rows give.
"""

import pickle
import random
import sys

import numpy as np

import rlslab

ODD = [None, "a", b"ab", 1j, object(), [], {}, (), "1", [None], [[1], [2, 3]], np.ma.masked_array([1.0, 2.0], [0, 1]),
       np.array("x"), np.zeros((0, 3)), Ellipsis, 10**400, float("nan"), -1, 2.5, True]    # fmt: skip
DTYPES = ["f8", "f4", "f2", ">f8", ">f4", "i8", "u1", "?", "c16", "O", "U2", "M8[s]", "g", "V8"]


def array(r, shape):
    """Numbers of a random type in a random layout, now and then not finite."""
    dtype = np.dtype(r.choice(DTYPES[:5] * 3 + DTYPES))
    a = np.array([r.choice([0.0, 1.0, -2.5, r.gauss(0, 1), 3e38 if r.random() < 0.1 else 1.0])
                  for _ in range(int(np.prod(shape)))]).reshape(shape)    # fmt: skip
    if dtype.kind in "fg" and a.size and r.random() < 0.05:
        a.flat[r.randrange(a.size)] = r.choice([np.nan, np.inf, -np.inf])
    with np.errstate(all="ignore"):
        if dtype.kind == "V":
            a = a.view("V8")
        elif dtype.kind in "Mu":
            a = np.abs(a).astype("u1").astype(dtype)
        else:
            a = a.astype(dtype)
    layout = r.randrange(7)
    if a.ndim and layout == 1:
        out = np.zeros((*a.shape[:-1], 2 * a.shape[-1]), a.dtype)[..., ::2]
        out[...] = a
        return out
    if a.ndim and layout == 2:
        return a[::-1].copy()[::-1]
    if layout == 3:
        return np.asfortranarray(a)
    if layout == 4 and not a.dtype.hasobject:
        out = np.zeros(a.nbytes + 1, np.uint8)[1:].view(a.dtype).reshape(a.shape)
        out[...] = a
        return out
    if layout == 5:
        return a.tolist()
    a = np.asarray(a)
    a.flags.writeable = layout != 6
    return a


def plain(given, shape):
    try:
        a = np.asarray(given)
    except (ValueError, TypeError):
        return None
    if a.dtype.kind not in "fiub" or a.shape != shape or isinstance(given, np.ma.MaskedArray):
        return None
    with np.errstate(all="ignore"):
        return a.astype(np.float64)


def case(r):
    d = r.randint(1, 6)
    options = {"forgetting": r.choice([1, 0.9]), "dtype": r.choice(["float64", "float32"])}
    if r.random() < 0.1:
        options["guard"] = r.choice(["reset", "rebuild", "report"])
    if r.random() < 0.1:
        options[r.choice(["forgetting", "prior_variance", "prior_theta", "prior_covariance", "dtype", "window", "guard",
                          "guard_options", "control"])] = r.choice(ODD)    # fmt: skip
    try:
        f = rlslab.filter(r.choice(rlslab.variants()), d, **options)
    except (ValueError, TypeError, MemoryError) as e:
        assert "\n" not in str(e)
        return
    g = f.copy()
    for _ in range(3):
        what = r.randrange(6)
        n = r.randint(0, 9)
        psi = array(r, r.choice([(d,), (d,), (n, d), (n, d), (d + 1,), (n, d + 1), (), (1, n, d)]))
        y = array(r, r.choice([(n,), (n,), (n,), (), (n + 1,), (n, 1)]))
        if r.random() < 0.1:
            psi, y = r.choice([(r.choice(ODD), y), (psi, r.choice(ODD))])
        before = f.state
        try:
            if what == 0:
                f.update(psi, 1.5)
            elif what < 3:
                f.update_many(psi, y, steps=what == 1)
            elif what == 3:
                state = bytearray(before)
                state[r.randrange(len(state))] ^= 1 << r.randrange(8)
                damaged = bytes(state[: r.choice([len(state), r.randrange(len(state))])])
                r.choice([f.restore, rlslab.from_state])(damaged)
                raise AssertionError("a damaged state was taken")
            elif what == 4:
                f = pickle.loads(pickle.dumps(f)) if r.random() < 0.5 else rlslab.from_state(before)
            else:
                f.pass_time(), g.pass_time()
        except (ValueError, TypeError, OverflowError) as e:
            assert "\n" not in str(e) and f.state == before
        else:
            if what == 0:
                g.update(plain(psi, (d,)), 1.5)
            elif what < 3:
                rows = np.asarray(psi).shape[0]
                g.update_many(plain(psi, (rows, d)), plain(y, (rows,)), steps=what == 1)
        assert f.state == g.state
        assert f.theta.shape == f.gain.shape == (d,) and f.health in rlslab.HEALTHS


def main(cases=100000, seed=1):
    for k in range(cases):
        try:
            case(random.Random(seed * 10**9 + k))
        except BaseException:
            print(f"case {k} of seed {seed}")
            raise
    print(f"{cases} cases of seed {seed}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
