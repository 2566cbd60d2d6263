"""Bad input: an error of one line, before anything changes, or right numbers."""

import array
import ctypes
import decimal
import fractions
import itertools
import math

import numpy as np
import pytest

try:
    import pandas
except ImportError:
    pandas = None
from data import rows, same

import rlslab

PSI, Y = rows(6, 3)
ERRORS = (TypeError, ValueError)


def refuses(call, *errors, most=200):
    with pytest.raises(errors or ERRORS) as caught:
        call()
    message = str(caught.value)
    assert message and "\n" not in message and len(message) < most, message


def strided(a):
    out = np.zeros((*a.shape[:-1], 2 * a.shape[-1]), a.dtype)[..., ::2]
    out[...] = a
    return out


def unaligned(a):
    raw = np.zeros(a.nbytes + 1, np.uint8)[1:]
    out = raw.view(a.dtype).reshape(a.shape)
    out[...] = a
    return out


def read_only(a):
    out = a.copy()
    out.flags.writeable = False
    return out


#: Other layouts and types of the same numbers.
SAME = [
    np.array, strided, unaligned, read_only, np.asfortranarray, lambda a: a.tolist(), lambda a: a.astype(">f8"),
    lambda a: a.astype("<f8"), lambda a: a.astype(np.longdouble), lambda a: a[..., ::-1].copy()[..., ::-1],
    lambda a: a[::-1].copy()[::-1], lambda a: np.ma.masked_array(a).filled(), memoryview, lambda a: a.view(np.recarray),
]  # fmt: skip


@pytest.mark.parametrize("change", SAME)
@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_layouts_that_are_taken(change, dtype):
    one, many, plain = (rlslab.Ud(3, dtype=dtype) for _ in range(3))
    for psi, y in zip(PSI, Y):
        assert one.update(change(psi), y) == plain.update(psi, y)
    many.update_many(change(PSI), change(Y))
    assert same(one.theta, plain.theta) and same(many.theta, plain.theta)


def test_rows_from_elsewhere():
    psi, y = [1.0, 2.0, 3.0], 4.0
    theta = rlslab.Ud(3)
    theta.update(psi, y)
    for given, output in [
        (array.array("d", psi), 4), (array.array("f", psi), np.float32(4)), (array.array("i", [1, 2, 3]), True * 4),
        ((ctypes.c_double * 3)(*psi), np.array(4.0)), (tuple(psi), np.array([4.0])),
        ([True, np.float64(2), np.int8(3)], np.longdouble(4)), (np.array([1, 2, 3]), np.int8(4)),
        ([np.array(1.0), np.float16(2), np.longdouble(3)], np.bool_(True) * 4.0),
        (np.array(psi, np.float16), np.float16(4)), (range(1, 4), 4),
    ]:  # fmt: skip
        f = rlslab.Ud(3)
        f.update(given, output)
        assert same(f.theta, theta.theta)


def test_frames_of_true_and_false_and_of_nullable_columns():
    """Each column by itself; a missing value is NaN. What is no number is named, with what to do."""
    pd = pytest.importorskip("pandas")
    flags = PSI[:, 1] > 0
    whole = np.round(PSI[:, 2])
    X = np.column_stack([PSI[:, 0], flags, whole])
    plain = rlslab.Ud(3)
    plain.update_many(X, Y)
    kinds = [("float64", bool, "Int64"), ("Float64", "boolean", "int8"), ("float64", "boolean", "Int8")]
    for kind in kinds:
        frame = pd.DataFrame({name: pd.Series(x).astype(k) for name, x, k in zip("abc", X.T, kind)})
        f, g = rlslab.Ud(3), rlslab.Ud(3)
        f.update_many(frame, pd.Series(Y, dtype="Float64", name="y"))
        for k in range(len(Y)):
            g.update(frame.iloc[k].astype(float), pd.Series(Y, dtype="Float64").iloc[k])
        assert same(f.theta, plain.theta) and same(g.theta, plain.theta)
        frame.loc[2, "c"] = pd.NA if str(frame["c"].dtype).startswith("I") else np.nan
        there = np.arange(len(Y)) != 2
        f, g = rlslab.Ud(3, guard="reset"), rlslab.Ud(3, guard="reset")
        f.update_many(frame, Y)
        g.update_many(X[there], Y[there])
        assert f.counts.unusable == 1 and same(f.theta, g.theta)
    others = list("pqrstu"), pd.Categorical(list("ababab")), pd.date_range("2020", periods=6), [decimal.Decimal()] * 6
    for bad in others:
        frame = pd.DataFrame({"a": PSI[:, 0], "shift work": bad, "c": flags})
        with pytest.raises(TypeError, match=r"^Psi: column 'shift work' holds .*astype\(float\)$"):
            rlslab.Ud(3).update_many(frame, Y)
        with pytest.raises(TypeError, match=r"^y: column 'shift work'"):
            rlslab.Ud(3).update_many(PSI, frame["shift work"])
    with pytest.raises(TypeError, match=r"^y holds object"):
        rlslab.Ud(3).update_many(PSI, pd.Series(list("pqrstu")))


def test_float_rows_are_rounded_once():
    for dtype in ("float64", "float32"):
        wide, narrow = rlslab.Ud(3, dtype=dtype), rlslab.Ud(3, dtype=dtype)
        psi = PSI[0].astype(np.float32)
        assert narrow.update(psi, 0.1) == wide.update(psi.astype(float), 0.1)
    f, g = rlslab.Ud(3), rlslab.Ud(3)
    f.update_many(PSI.astype(np.float32), Y)    # of two types: both as float64
    g.update_many(PSI.astype(np.float32).astype(float), Y)
    assert same(f.theta, g.theta)


pd_na = getattr(pandas, "NA", None)
BAD_ROWS = [
    np.zeros(2), np.zeros(4), np.zeros((1, 3)), np.zeros((3, 1)), np.zeros((2, 3)), np.zeros(()), np.zeros(0), [],
    [1, 2], [1, 2, 3, 4], [[1, 2, 3]], ["a", "b", "c"], ["1", "2", "3"], "abc", b"abc", None, [None, 1, 2],
    [1, 2, 1j], 3, 3.0, np.zeros(3, complex), np.array(["1", "2", "3"]), np.array([1, None, 3]),
    np.zeros(3, "M8[s]"), np.zeros(3, "m8[s]"), np.zeros(3, "V8"), np.zeros(3, [("a", "f8")]),
    np.ma.masked_array(np.zeros(3), [0, 1, 0]), {1, 2, 3}, {"a": 1}, iter([1, 2, 3]), object(),
    [1, np.complex128(2), 3], (np.complex64(1j), 1, 2), [decimal.Decimal(1), 2, 3], 
    [1, fractions.Fraction(2), 3],
    [1, np.ma.masked, 2], [1.0, 10**400, 2], (-(10**400), 1, 2), [1, pd_na, 2], np.zeros(3, np.complex64),
    np.array([1, 2, 3], object), Ellipsis, [[1], [2, 3], 4], slice(3), int, math,
]  # fmt: skip


@pytest.mark.parametrize("bad", BAD_ROWS, ids=lambda x: type(x).__name__)
@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_rows_that_are_refused(bad, dtype):
    f = rlslab.Ud(3, dtype=dtype)
    f.update(PSI[0], Y[0])
    before = f.state
    refuses(lambda: f.update(bad, 1.0))
    refuses(lambda: f.update_many(bad, 1.0))
    if not (isinstance(bad, np.ndarray) and bad.shape == (2, 3)):
        refuses(lambda: f.update_many(bad, [1.0, 2.0]))
    refuses(lambda: f.update_many([bad, bad], [1.0, 2.0]))
    assert f.state == before and f.counts.rows == 1


@pytest.mark.parametrize("bad", [
    "a", "1", b"1", None, 1j, [1.0], np.zeros(3), object(), {}, [[1]], np.complex128(1 + 2j), np.complex64(1),
    decimal.Decimal(1), fractions.Fraction(1), np.ma.masked, np.ma.masked_array(1.0, True), 10**400, -(10**400), pd_na,
    np.array(1j), np.str_("1"), np.datetime64("2020-01-01"), np.timedelta64(1),
], ids=repr)    # fmt: skip
def test_outputs_that_are_refused(bad):
    f = rlslab.Ud(3)
    before = f.state
    refuses(lambda: f.update(PSI[0], bad))
    refuses(lambda: f.update_many(PSI, bad))
    refuses(lambda: f.update_many(PSI[:2], [1.0, bad]))
    assert f.state == before


def test_an_object_that_says_what_number_it_is_is_none():
    """Its code would run while the row is read."""
    f = rlslab.Ud(3)

    class Asked:
        def __float__(self):
            raise AssertionError("asked")

    for psi, y in ([1.0, Asked(), 2.0], 1.0), (PSI[0], Asked()):
        refuses(lambda: f.update(psi, y), TypeError)
        refuses(lambda: f.update_many([psi], [y]), TypeError)
    assert f.counts.rows == 0


def test_numbers_of_arguments():
    f = rlslab.Ud(3)
    for call in (lambda: f.update(), lambda: f.update(PSI[0]), lambda: f.update(PSI[0], 1, 2, 3),
                 lambda: f.update_many(PSI), lambda: f.update(psi=PSI[0], y=1), lambda: f.pass_time(1),
                 lambda: rlslab.Ud(), lambda: rlslab.Ud(2, 3),
                 lambda: rlslab.Ud(2, colour=3), lambda: f._theta(), lambda: f._update_many(PSI, Y)):
        refuses(call, TypeError)


def test_many_rows_that_do_not_fit():
    f = rlslab.Ud(3)
    for Psi, y in [(PSI, Y[:-1]), (PSI[:, :2], Y), (PSI.T, Y[:3]), (PSI, Y[:, None]), (PSI[None], Y), (PSI, 3.0),
                   (PSI[:, 0], Y), ([], []), (PSI, None), (PSI.astype(complex), Y), (PSI, Y.astype("U"))]:
        refuses(lambda: f.update_many(Psi, y))
    assert f.counts.rows == 0
    assert f.update_many(np.zeros((0, 3)), []) is None
    assert len(f.update_many(np.zeros((0, 3)), [], steps=True)) == 0


def test_rows_in_place_and_in_any_order():
    base = np.arange(60.0).reshape(10, 6) % 7
    y = np.arange(10.0)
    for psi, v in [(base[:, :3], y), (base[:, ::2], y), (base[::-1, :3], y[::-1]), (base[::2, 1:4], y[::2]),
                   (np.broadcast_to(base[0, :3], (4, 3)), y[:4]), (base[:, 2::-1], np.broadcast_to(2.0, 10)),
                   (np.lib.stride_tricks.sliding_window_view(np.arange(12.0) ** 1.5, 3), y)]:
        f, g = rlslab.Ud(3), rlslab.Ud(3)
        f.update_many(psi, v)
        g.update_many(psi.copy(), v.copy())
        assert same(f.theta, g.theta)
    f = rlslab.Ud(1)
    f.update_many(np.arange(6.0).reshape(6, 1)[::2], [0, 2, 4])
    assert f.theta.round(3) == 1


def test_direct_calls_of_the_extension():
    f = rlslab.Ud(3)
    good = np.zeros((2, 3)), np.zeros(2), np.zeros(2, rlslab.STEP)
    unfit = [1, "a", np.zeros(1), np.zeros((3, 3)), np.zeros((2, 3), int), np.zeros(3), np.zeros(2, np.float32),
             np.zeros(4)[::2]]
    for i, bad in itertools.product(range(3), unfit):
        given = list(good)
        given[i] = bad
        refuses(lambda: f._update_many(*given), TypeError, ValueError, BufferError)
    for bad in (None, np.zeros(2), np.zeros(3, int), np.zeros(6)[::2], read_only(np.zeros(3)), b"abc"):
        refuses(lambda: f._theta(bad), TypeError, ValueError, BufferError)
    for call in (lambda: rlslab._core.Filter(), lambda: rlslab._core.Filter("ud"), lambda: object.__new__(rlslab.Ud),
                 lambda: rlslab.Filter(2), lambda: rlslab._core.Fleet(1)):
        refuses(call, TypeError)


BAD_OPTIONS = [
    {"size": 0}, {"size": -1}, {"size": 2.0}, {"size": "2"}, {"size": None}, {"size": 10**30}, {"forgetting": 0},
    {"forgetting": np.complex128(0.9 + 1j)}, {"prior_variance": np.ma.masked},
    {"forgetting": 1.1}, {"forgetting": math.nan}, {"forgetting": "0.9"}, {"forgetting": None}, {"forgetting": 1j},
    {"prior_variance": 0}, {"prior_variance": -1}, {"prior_variance": math.nan}, {"prior_variance": "1"},
    {"dtype": "float"}, {"dtype": "float16"}, {"dtype": int}, {"dtype": "double precision"}, {"dtype": 3},
    {"dtype": "f8,f8"}, {"window": -1}, {"window": 2.5}, {"window": "all"}, {"guard": "resett"}, {"guard": 1},
    {"guard_options": {"innovation": 3}}, {"guard": "reset", "guard_options": {"inovation": 3}},
    {"guard": "rebuild", "guard_options": {"rebuild_rows": 2**61}},
    {"guard": "reset", "guard_options": [1]}, {"guard": "reset", "guard_options": {"innovation": "3"}},
    {"guard": "reset", "guard_options": {"noise_memory": 2.5}}, {"guard": "reset\0"}, {"guard": ""},
    {"control": "fortesque"}, {"control": ("fortescue", "a")}, {"control": 3}, {"control": ()}, {"control": ""},
    {"control": ("fortescue", -1)}, {"control": ("fortescue", 1, 2, 3, 4, 5, 6, 7)}, {"control": (3, "fortescue")},
]  # fmt: skip


@pytest.mark.parametrize("bad", BAD_OPTIONS, ids=repr)
def test_options_that_are_refused(bad):
    refuses(lambda: rlslab.Ud(**{"size": 2, **bad}))


def test_names_that_are_none():
    for name in ("uD", "u", "", "qr_sparse", "ud\0", "\ud800", "ü"):
        refuses(lambda: rlslab.filter(name, 2), ValueError, most=260)  # names the eighteen
    refuses(lambda: rlslab.filter(None, 2), TypeError)
    with pytest.raises(ValueError, match='did you mean "potter"'):
        rlslab.filter("poter", 2)


@pytest.mark.parametrize("size", [2**31, 2**40, 2**61])
def test_sizes_beyond_memory(size):
    refuses(lambda: rlslab.Ud(size), MemoryError, ValueError)
