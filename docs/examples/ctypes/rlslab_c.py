"""rlslab.h by Python's ctypes: what a script needs where the package `rlslab` is not installed."""
import ctypes as c
import os

_library = c.CDLL(os.environ.get("RLSLAB_LIBRARY", "librlslab.so.1"))
VARIANTS, ARITHMETICS, GUARDS, CONTROLS, HEALTHS, SIGNALS = range(6)
_ABILITY = 6


class Step(c.Structure):
    _fields_ = [("innovation", c.c_double), ("residual", c.c_double), ("gamma", c.c_double),
                ("health", c.c_int32), ("signal", c.c_int32)]


class Options(c.Structure):
    _fields_ = [("bytes", c.c_size_t), ("size", c.c_size_t), ("forgetting", c.c_double),
                ("prior_variance", c.c_double), ("prior_theta", c.c_void_p), ("prior_covariance", c.c_void_p),
                ("window", c.c_size_t), ("guard", c.c_char_p), ("control", c.c_char_p),
                ("control_numbers", c.c_void_p), ("control_count", c.c_size_t), ("largest_variance", c.c_double),
                ("innovation", c.c_double), ("least_noise", c.c_double), ("asymmetry", c.c_double),
                ("noise_memory", c.c_size_t), ("rebuild_rows", c.c_size_t)]


class Counts(c.Structure):
    _fields_ = [(name, c.c_int64) for name in ("rows", "unusable", "outliers", "changes", "windups", "breakdowns",
                                               "refactored", "since", "handed_over")]


def _function(name, result, *arguments):
    function = getattr(_library, "rlslab_" + name)
    function.restype, function.argtypes = result, arguments
    return function


_pointer = c.c_void_p
_message = _function("message", c.c_char_p)
_name = _function("name", c.c_char_p, c.c_int, c.c_size_t)
_defaults = _function("defaults", c.c_int, _pointer, c.c_size_t)
_new = _function("new", c.c_int, c.c_char_p, c.c_char_p, _pointer, _pointer)
_free = _function("free", None, _pointer)
_update = _function("update", c.c_int, _pointer, _pointer, c.c_double, _pointer)
_numbers = {name: _function(name, c.c_int, _pointer, _pointer) for name in
            ("theta", "gain", "covariance", "information")}
_count = _function("count", c.c_int, _pointer, _pointer, c.c_size_t)
_state_size = _function("state_size", c.c_size_t, _pointer)
_save = _function("save", c.c_int, _pointer, _pointer, c.c_size_t)
_load = _function("load", c.c_int, _pointer, c.c_char_p, c.c_size_t)


def _require(status):
    if status:
        raise ValueError(_message().decode())


def names(of):
    out = []
    while (name := _name(of, len(out))) is not None:
        out.append(name.decode())
    return out


class Filter:
    def __init__(self, variant, arithmetic, size, **options):
        self._filter, self._row, self.size = _pointer(), (c.c_double * size)(), size
        o, kept = Options(), []
        _require(_defaults(c.byref(o), c.sizeof(o)))
        o.size = size
        for name, value in options.items():
            if name not in dict(Options._fields_):
                raise TypeError(f"no option {name}")
            if isinstance(value, (list, tuple)):
                kept.append((c.c_double * len(value))(*value))
                if name == "control_numbers":
                    o.control_count = len(value)
                value = c.addressof(kept[-1])
            setattr(o, name, value.encode() if isinstance(value, str) else value)
        _require(_new(variant.encode(), arithmetic.encode(), c.byref(o), c.byref(self._filter)))

    def __del__(self):
        _free(self._filter)

    def update(self, psi, y):
        step = Step()
        self._row[:] = psi
        _require(_update(self._filter, self._row, y, c.byref(step)))
        return step

    def numbers(self, what, count):
        out = (c.c_double * count)()
        _require(_numbers[what](self._filter, out))
        return list(out)

    def theta(self):
        return self.numbers("theta", self.size)

    def gain(self):
        return self.numbers("gain", self.size)

    def matrix(self):
        """P by columns, or P^-1 where the variant reports that."""
        out = (c.c_double * self.size ** 2)()
        status = _numbers["covariance"](self._filter, out)
        if status == _ABILITY:
            status = _numbers["information"](self._filter, out)
        _require(status)
        return list(out)

    def counts(self):
        out = Counts()
        _require(_count(self._filter, c.byref(out), c.sizeof(out)))
        return out

    def save(self):
        out = c.create_string_buffer(_state_size(self._filter))
        _require(_save(self._filter, out, len(out)))
        return out.raw

    def load(self, state):
        _require(_load(self._filter, state, len(state)))
