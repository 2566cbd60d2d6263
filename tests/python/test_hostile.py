"""Whatever is given: an error of one line before anything changes, or the numbers that plain rows give."""

import math
import pickle
import zlib

import numpy as np
import pytest

pytest.importorskip("hypothesis")
from hypothesis import given    # noqa: E402
from hypothesis import strategies as st    # noqa: E402
from hypothesis.extra import numpy as hnp    # noqa: E402

import rlslab    # noqa: E402

ERRORS = (TypeError, ValueError)
floats = st.floats(width=32) | st.floats() | st.integers(-5, 5).map(float)
sizes = st.integers(1, 5)
dtypes = st.sampled_from(["float64", "float32"])
variants = st.sampled_from(rlslab.variants())
any_dtype = st.one_of(
    hnp.floating_dtypes(endianness="?"), hnp.integer_dtypes(endianness="?"), hnp.boolean_dtypes(),
    hnp.complex_number_dtypes(), hnp.unicode_string_dtypes(max_len=3), hnp.datetime64_dtypes(), st.just(np.dtype("O")),
)  # fmt: skip
anything = st.recursive(
    st.none() | st.booleans() | floats | st.integers() | st.text(max_size=3) | st.binary(max_size=3)
    | st.complex_numbers(),
    lambda inner: st.lists(inner, max_size=5) | st.tuples(inner, inner) | st.dictionaries(st.text(max_size=2), inner),
    max_leaves=12,
)


@st.composite
def layouts(draw, array):
    """The same numbers, as they may lie in memory."""
    if array.ndim == 0 or array.size == 0:
        return array
    kind = draw(st.sampled_from(["as it is", "strided", "backward", "by columns", "read only", "unaligned", "spread"]))
    if kind == "strided":
        out = np.zeros((*array.shape[:-1], array.shape[-1] * 3), array.dtype)[..., ::3]
    elif kind == "backward":
        out = np.zeros_like(array)[::-1]
    elif kind == "by columns":
        out = np.zeros_like(array, order="F")
    elif kind == "unaligned":
        if array.dtype.hasobject:
            return array
        out = np.zeros(array.nbytes + 1, np.uint8)[1:].view(array.dtype).reshape(array.shape)
    elif kind == "spread":
        out = np.zeros((array.shape[0] * 2, *array.shape[1:]), array.dtype)[::2]
    else:
        out = array
    if out is not array:
        out[...] = array
    out.flags.writeable = kind != "read only"
    return out


@st.composite
def arrays(draw, shape):
    dtype = draw(any_dtype)
    elements = st.none() | floats | st.text(max_size=2) if dtype.hasobject else None
    return draw(layouts(draw(hnp.arrays(dtype, shape, elements=elements))))


def as_rows(given, shape):
    """Plain float64 of that shape, or None where an error is right."""
    try:
        array = np.asarray(given)
    except (ValueError, TypeError):
        return None
    if array.dtype.kind not in "fiub" or array.shape != shape:
        return None
    with np.errstate(all="ignore"):
        return array.astype(np.float64)


def same_state(f, g):
    return f.state == g.state


def one_line(error):
    assert "\n" not in str(error) and 0 < len(str(error)) < 300


@given(variants, sizes, dtypes, st.data())
def test_rows_of_any_type(variant, size, dtype, data):
    f, g = (rlslab.filter(variant, size, dtype=dtype) for _ in range(2))
    for _ in range(data.draw(st.integers(1, 3))):
        shape = data.draw(st.just((size,)) | hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=6))
        psi, y = data.draw(arrays(shape)), data.draw(floats)
        plain = as_rows(psi, (size,))
        try:
            f.update(psi, y)
        except ERRORS as error:
            one_line(error)
            assert plain is None
        else:
            g.update(plain, y)
        assert same_state(f, g)


@given(sizes, dtypes, anything, anything)
def test_objects_of_any_kind(size, dtype, psi, y):
    f = rlslab.Ud(size, dtype=dtype)
    before = f.state
    for call in (lambda: f.update(psi, y), lambda: f.update_many(psi, y),
                 lambda: f.update_many([psi], [y], steps=True)):
        try:
            call()
        except ERRORS as error:
            one_line(error)
            assert f.state == before
        else:
            before = f.state


@given(variants, sizes, dtypes, st.booleans(), st.data())
def test_many_rows_of_any_type(variant, size, dtype, steps, data):
    rows = data.draw(st.integers(0, 8))
    right = st.just((rows, size))
    shape = data.draw(right | right | hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=6))
    Psi = data.draw(arrays(shape))
    y = data.draw(arrays((rows,)) | arrays(hnp.array_shapes(min_dims=0, max_dims=2, min_side=0, max_side=6)))
    plain, outputs = as_rows(Psi, (rows, size)), as_rows(y, (rows,))
    f, g = (rlslab.filter(variant, size, dtype=dtype) for _ in range(2))
    try:
        out = f.update_many(Psi, y, steps=steps)
    except ERRORS as error:
        one_line(error)
        assert plain is None or outputs is None or Psi.shape != (rows, size) or y.shape != (rows,)
        assert same_state(f, g)
        return
    if plain is None or outputs is None:    # another shape that fits together
        assert Psi.ndim == 2 and Psi.shape[1] == size and y.shape == Psi.shape[:1]
        plain, outputs = Psi.astype(np.float64), y.astype(np.float64)
    g.update_many(plain, outputs, steps=steps)
    assert same_state(f, g)
    assert out is None or len(out) == (len(y) if steps else 5)


names = st.sampled_from(["ud", "qr", "x", "", "reset", "kulhavy", "fortescue", "rebuild", "float32", "float64"])
options = st.fixed_dictionaries(
    {},
    optional={
        "size": st.integers(-2, 6) | anything, "forgetting": floats | anything, "prior_variance": floats | anything,
        "prior_theta": arrays((2,)) | anything, "prior_covariance": arrays((2, 2)) | anything,
        "dtype": names | anything, "window": st.integers(-2, 20) | anything, "guard": names | anything,
        "guard_options": st.dictionaries(st.sampled_from(["innovation", "noise_memory", "x"]), floats | anything)
        | anything, "control": names | st.tuples(names, floats, floats) | anything,
    },
)  # fmt: skip


@given(st.sampled_from(["ud", "qr", "conventional", "kalman", "joseph"]), options)
def test_options_of_any_kind(variant, options):
    try:
        f = rlslab.filter(variant, **{"size": 2, **options})
    except (*ERRORS, MemoryError) as error:
        one_line(error)
        return
    assert f.update(np.ones(f.size), 1.0).health in rlslab.HEALTHS
    again = pickle.loads(pickle.dumps(f))
    assert same_state(f, again)


changes = st.lists(st.tuples(st.integers(0, 10**6), st.integers(1, 255)), max_size=4)


@given(variants, dtypes, changes, st.integers(-9, 9))
def test_damaged_states_and_pickles(variant, dtype, flips, cut):
    f = rlslab.filter(variant, 2, dtype=dtype)
    f.update([1.0, 2.0], 3.0)
    before = f.state
    for whole, load in ((before, f.restore), (pickle.dumps(before), pickle.loads)):
        damaged = bytearray(whole)
        for place, change in flips:
            damaged[place % len(damaged)] ^= change
        damaged = bytes(damaged[:cut] if cut < 0 else damaged + b"\0" * cut)
        if load is f.restore:
            try:
                load(damaged)
            except ValueError as error:
                one_line(error)
                assert damaged != whole
            else:
                assert damaged == whole
            assert f.state == before
    remade, (version, made_of, options, state) = f.__reduce__()
    size = math.isqrt(len(damaged))
    for given in [(version, made_of, options, damaged), (version, made_of, {"size": size}, state),
                  (version, made_of, {**options, "dtype": damaged}, state)]:
        try:
            remade(*given)
        except (*ERRORS, MemoryError) as error:
            one_line(error)


composed = st.sampled_from([
    {}, {"guard": "reset", "window": 9}, {"control": ("kulhavy", 0.9), "guard": "report"},
    {"guard": "rebuild", "guard_options": {"rebuild_rows": 3, "innovation": 4.5}}, {"control": "ridge"},
])    # fmt: skip


@given(st.sampled_from(["ud", "qr", "carlson"]), dtypes, composed, changes, st.integers(-9, 9), st.booleans())
def test_damaged_states_of_no_filter_yet(variant, dtype, options, flips, cut, forged):
    """A line, or a filter with that state; also where the checksum was made right."""
    try:
        f = rlslab.filter(variant, 2, dtype=dtype, **options)
    except ValueError:
        return
    f.update_many(np.ones((4, 2)), np.ones(4))
    whole = f.state
    damaged = bytearray(whole)
    for place, change in flips:
        damaged[place % len(damaged)] ^= change
    damaged = damaged[:cut] if cut < 0 else damaged + b"\0" * cut
    if forged:
        damaged[32:40] = len(damaged).to_bytes(8, "little")
        damaged[-4:] = zlib.crc32(damaged[:-4]).to_bytes(4, "little")
    try:
        found = rlslab.from_state(bytes(damaged))
    except ERRORS as error:
        one_line(error)
        assert damaged != whole
    else:
        assert rlslab.from_state(found.state).state == found.state
        assert forged or found.state == damaged == whole    # counts that are forged are not looked at
        assert found.update([1.0, 2.0], 3.0).health in rlslab.HEALTHS
        assert type(found)(**found.options).dtype == found.dtype


@given(st.binary(max_size=300) | st.binary(max_size=300).map(lambda b: b"\x89RLS\r\n\x1a\n" + b) | anything)
def test_no_states(given):
    with pytest.raises((*ERRORS, BufferError)) as caught:
        rlslab.from_state(given)
    one_line(caught.value)


@given(sizes, dtypes, st.lists(st.tuples(st.integers(0, 8), floats), max_size=25), st.booleans())
def test_calls_in_any_order(size, dtype, calls, guarded):
    f = rlslab.Qr(size, dtype=dtype, forgetting=0.9, guard="reset" if guarded else None)
    kept = f.state
    for which, x in calls:
        psi = np.full(size, x)
        if which == 0:
            assert f.update(psi, x).health in rlslab.HEALTHS
        elif which == 1:
            assert len(f.update_many(np.tile(psi, (3, 1)), [x] * 3, steps=True)) == 3
        elif which == 2:
            f.update_many(np.tile(psi, (70, 1)), [x] * 70)
        elif which == 3:
            f.reset()
        elif which == 4:
            kept = f.state
        elif which == 5:
            f.restore(kept)
        elif which == 6:
            f = f.copy()
        elif which == 7:
            f = pickle.loads(pickle.dumps(f))
        else:
            f.pass_time()
        assert f.theta.shape == f.gain.shape == (size,) and f.information.shape == (size, size)
        assert all(n >= 0 for n in f.counts)
