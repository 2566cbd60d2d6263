// rlslab._core.Filter: one native filter as a Python object.
#include "bindings/python/asked.hpp"
#include "bindings/python/make.hpp"

#include <array>
#include <cstring>
#include <string>
#include <vector>

namespace rlslab::python {

PyObject* row_of = nullptr;
PyObject* output_of = nullptr;
PyObject* scalars = nullptr;
PyObject* ndarray = nullptr;

namespace {

using native::Filter;
using native::Step;
using Held = Holder<Filter>;

constexpr int healths = 4, signals = 6;
/// Interned once: a comparison with a word of the program is one of two addresses.
PyObject* health_words[healths];
PyObject* signal_words[signals];
PyTypeObject* step = nullptr;
PyTypeObject* counts = nullptr;

PyObject* word(PyObject* const* words, int n, std::int32_t which) {
    return Py_NewRef(words[which >= 0 && which < n ? which : 0]);
}
PyObject* as_tuple(Step const& s) {
    PyObject* const out = PyStructSequence_New(step);
    if (!out) return nullptr;
    PyStructSequence_SetItem(out, 0, PyFloat_FromDouble(s.innovation));
    PyStructSequence_SetItem(out, 1, PyFloat_FromDouble(s.residual));
    PyStructSequence_SetItem(out, 2, PyFloat_FromDouble(s.gamma));
    PyStructSequence_SetItem(out, 3, word(health_words, healths, s.health));
    PyStructSequence_SetItem(out, 4, word(signal_words, signals, s.signal));
    return out;
}

PyObject* make(PyTypeObject* type, PyObject* args, PyObject*) {
    return made<Filter>(type, args, [](Arguments const& given, Py_ssize_t) {
        return native::make(given.variant, given.arithmetic, given.options);
    });
}

/// Room for a row of doubles: on the stack up to 64 of them. Each call has its own, because converting a number may run
/// code that updates the same filter.
class Row {
    std::array<double, 64> few_;
    std::vector<double> many_;
    double* numbers_ = few_.data();

public:
    double* of(Py_ssize_t n) {
        if (n > Py_ssize_t(few_.size())) {
            many_.resize(std::size_t(n));
            numbers_ = many_.data();
        }
        return numbers_;
    }
};
/// One row of `take`: an array's numbers, whose distance in bytes is `stride`.
template <class X>
void copy(char const* from, Py_ssize_t stride, Py_ssize_t n, double* to) {
    for (Py_ssize_t i = 0; i < n; ++i) {
        X x;
        std::memcpy(&x, from + i * stride, sizeof x);
        to[i] = double(x);
    }
}
/// A real number of Python or numpy. False, with no error set, for anything else, whose error or number is row_of's and
/// output_of's, so that each is the same for one row and for many.
bool copy_number(PyObject* from, double& to) {
    if (!PyFloat_Check(from) && !PyLong_Check(from) && PyObject_IsInstance(from, scalars) != 1) {
        PyErr_Clear();
        return false;
    }
    to = PyFloat_AsDouble(from);
    if (to != -1.0 || !PyErr_Occurred()) return true;
    PyErr_Clear();  // too large
    return false;
}
bool copy_items(PyObject* items, Py_ssize_t n, double* to) {
    bool const list = PyList_CheckExact(items);
    for (Py_ssize_t i = 0; i < n; ++i) {
        PyObject* const item = list ? PyList_GetItem(items, i) : PyTuple_GetItem(items, i);
        if (!item) {  // converting one before took items away
            PyErr_Clear();
            return false;
        }
        Py_INCREF(item);
        bool const taken = copy_number(item, to[i]);
        Py_DECREF(item);
        if (!taken) return false;
    }
    return true;
}

/// weight: null where there is none.
template <class X>
PyObject* updated(PyObject* self, X const* psi, X y, double const* weight) {
    return with<Filter>(self,
                        [&](Filter& f) { return as_tuple(weight ? f.update(psi, y, X(*weight)) : f.update(psi, y)); });
}
/// The row in an array: in place where its numbers stand one after another.
PyObject* update_from(PyObject* self, View const& view, Py_ssize_t d, double y, double const* weight) {
    Py_buffer const& b = view.buffer;
    if (view.is_vector(d)) {
        if (view.kind() == 'd') return updated(self, view.data<double const>(), y, weight);
        // In a filter of binary32 y is rounded as it would be anyway; one of binary64 keeps all of it.
        if (Held::of(self)->native->arithmetic() == "float")
            return updated(self, view.data<float const>(), float(y), weight);
    }
    Row row;
    double* const numbers = row.of(d);
    if (view.kind() == 'd') copy<double>(view.data<char const>(), b.strides[0], d, numbers);
    else copy<float>(view.data<char const>(), b.strides[0], d, numbers);
    return updated(self, numbers, y, weight);
}
/// A number of a row; false with Python's error set. `of` says of y what is wrong.
bool number_of(PyObject* from, double& to) {
    if (copy_number(from, to)) return true;
    PyObject* const number = PyObject_CallFunctionObjArgs(output_of, from, nullptr);
    if (!number) return false;
    to = PyFloat_AsDouble(number);
    Py_DECREF(number);
    return true;
}

/// (psi, y), or (psi, y, weight), the last by its name, too.
PyObject* update(PyObject* self, PyObject* const* args, Py_ssize_t n, PyObject* names) try {
    Py_ssize_t const named = names ? PyTuple_Size(names) : 0;
    PyObject* const given_weight = n + named == 3 ? args[2] : Py_None;
    if (n + named != 2 && n + named != 3) {
        takes("update(psi, y)", 2, n + named);
        return nullptr;
    }
    if (named > 0 && (named > 1 || n != 2 || PyUnicode_CompareWithASCIIString(PyTuple_GetItem(names, 0), "weight"))) {
        PyErr_SetString(PyExc_TypeError, "update takes psi and y by their places, and weight");
        return nullptr;
    }
    Py_ssize_t const d = Held::of(self)->native->size();
    double y, w = 1;
    if (!number_of(args[1], y)) return nullptr;
    if (given_weight != Py_None && !copy_number(given_weight, w)) {
        PyErr_SetString(PyExc_TypeError, "weight is no real number");
        return nullptr;
    }
    double const* const weight = given_weight != Py_None ? &w : nullptr;
    PyObject* const psi = args[0];
    if ((PyList_CheckExact(psi) && PyList_Size(psi) == d) || (PyTuple_CheckExact(psi) && PyTuple_Size(psi) == d)) {
        Row row;
        double* const numbers = row.of(d);
        if (copy_items(psi, d, numbers)) return updated(self, numbers, y, weight);
    }
    if (reinterpret_cast<PyObject*>(Py_TYPE(psi)) == ndarray) {
        View view;
        if (view.of(psi)) {
            if (view.kind() && view.buffer.ndim == 1 && view.buffer.shape[0] == d)
                return update_from(self, view, d, y, weight);
        } else {
            PyErr_Clear();  // dates and records have no buffer: row_of says what is wrong
        }
    }
    PyObject* const row = PyObject_CallFunction(row_of, "On", psi, d);
    if (!row) return nullptr;
    PyObject* out = nullptr;
    {
        View view;
        if (view.of(row)) {
            if (view.kind() && view.buffer.ndim == 1 && view.buffer.shape[0] == d)
                out = update_from(self, view, d, y, weight);
            else PyErr_SetString(PyExc_ValueError, "psi is not a row of numbers");
        }
    }
    Py_DECREF(row);
    return out;
} catch (std::exception const&) {
    return raise(std::current_exception());
}

/// (Psi, y, steps or None, weights or None): arrays as rlslab._rows.block leaves them. Numbers of one type.
PyObject* update_many(PyObject* self, PyObject* const* args, Py_ssize_t n) {
    if (!takes("_update_many(Psi, y, steps, weights)", 4, n)) return nullptr;
    struct Views {
        View psi, y, steps, weights;
    };
    // Not an object of this scope: where the interpreter ends while the filter runs, it must not be released.
    Views* const views = new (std::nothrow) Views;
    if (!views) return PyErr_NoMemory();
    Py_buffer const &P = views->psi.buffer, &Y = views->y.buffer;
    Py_ssize_t const d = Held::of(self)->native->size();
    bool ok = views->psi.of(args[0]) && views->y.of(args[1]) &&
              (args[2] == Py_None || views->steps.of(args[2], PyBUF_WRITABLE | PyBUF_C_CONTIGUOUS)) &&
              (args[3] == Py_None || views->weights.of(args[3]));
    Step last{};
    Py_ssize_t rows = 0;
    if (ok) {
        char const kind = views->psi.kind();
        bool const fits =
            views->psi.is_rows(d) && kind == views->y.kind() && views->y.is_vector(P.shape[0]) &&
            (!views->steps.buffer.obj || views->steps.buffer.len == P.shape[0] * Py_ssize_t(sizeof last)) &&
            (!views->weights.buffer.obj || (views->weights.kind() == kind && views->weights.is_vector(P.shape[0])));
        if (!fits) PyErr_SetString(PyExc_ValueError, "Psi, y, steps and weights do not fit together");
        ok = fits && native_of<Filter>(self);
        rows = ok ? P.shape[0] : 0;
        Py_ssize_t const stride = ok ? views->psi.row_stride() : d;
        Step* const steps = static_cast<Step*>(views->steps.buffer.buf);
        auto const process = [&]<class X>(Filter& f, X const* psi) {
            last = f.update_many(psi, rows, stride, static_cast<X const*>(Y.buf),
                                 static_cast<X const*>(views->weights.buffer.buf), steps);
        };
        if (rows > 0)
            ok = without_lock<Filter>(self, [&](Filter& f) {
                if (kind == 'd') process(f, static_cast<double const*>(P.buf));
                else process(f, static_cast<float const*>(P.buf));
            });
    }
    delete views;
    if (!ok) return nullptr;
    return rows > 0 ? as_tuple(last) : Py_NewRef(Py_None);
}

PyObject* pass_time(PyObject* self, PyObject*) {
    return with<Filter>(self, [](Filter& f) { return as_tuple(f.pass_time()); });
}
PyObject* certificate(PyObject* self, PyObject*) {
    return with<Filter>(self, [](Filter& f) {
        native::Certificate const c = f.certificate();
        return Py_BuildValue("(dddN)", c.estimate, c.bound, c.theta, PyBool_FromLong(c.definite));
    });
}
/// Into an array of float64: of d numbers, or of d x d by columns.
template <void (Filter::*read)(double*) const, bool square>
PyObject* read_into(PyObject* self, PyObject* out) {
    return with<Filter>(self, [&](Filter& f) -> PyObject* {
        View view;
        Py_ssize_t const d = f.size();
        if (!view_of_output(view, out, square ? d * d : d)) return nullptr;
        (f.*read)(view.data<double>());
        return Py_NewRef(Py_None);
    });
}

PyObject* reports_covariance(PyObject* self, void*) {
    return with<Filter>(self, [](Filter& f) { return PyBool_FromLong(f.reports_covariance()); });
}
PyObject* health(PyObject* self, void*) {
    return with<Filter>(self, [](Filter& f) { return word(health_words, healths, f.health()); });
}
PyObject* signal(PyObject* self, void*) {
    return with<Filter>(self, [](Filter& f) { return word(signal_words, signals, f.signal()); });
}
PyObject* counts_of(PyObject* self, void*) {
    return with<Filter>(self, [](Filter& f) -> PyObject* {
        native::Counts const c = f.counts();
        PyObject* const out = PyStructSequence_New(counts);
        if (!out) return nullptr;
        Py_ssize_t i = 0;
        for (std::int64_t const n :
             {c.rows, c.unusable, c.outliers, c.changes, c.windups, c.breakdowns, c.refactored, c.since})
            PyStructSequence_SetItem(out, i++, PyLong_FromLongLong(n));
        return out;
    });
}

constexpr char update_text[] = R"doc(update($self, psi, y, /, weight=None)
--

Process one row: the regressor psi and the output y.

Parameters
----------
psi : array_like, shape (d,)
    In place where it is an array of float64 or float32. A filter of float32 rounds each number once.
y : float
weight : float, optional
    w, 1/v where the row's noise has v times the variance of the others: theta minimises sum lambda^(k-i) w_i (y_i -
    psi_i'theta)^2 and the prior's part. Any filter takes weights, and its `state` is that of one that took sqrt(w) psi
    and sqrt(w) y. 1: the bits of a row without one. 0, a missing output: time passes, whatever psi and y are, as by
    `pass_time`. Below 0, infinite or NaN: nothing changes, health is "nonfinite". Rounded once to the filter's dtype.

Returns
-------
Step
    ``innovation`` y - psi'theta(k-1) and ``residual`` y - psi'theta(k), in the unit of y; ``gamma`` =
    lambda / (lambda + psi'P psi) = residual / innovation; ``health`` (`rlslab.HEALTHS`); ``signal``
    (`rlslab.SIGNALS`), "none" without a guard. A breakdown is a result: health is then "indefinite" or
    "nonfinite". While a filter without prior has seen too few rows health is "undetermined", innovation
    and residual are NaN.

Raises
------
TypeError
    If psi or y are no real numbers.
ValueError
    If psi is not of shape (d,).

Examples
--------
>>> f = rlslab.Ud(2)
>>> step = f.update([1.0, 2.0], 5.0)
>>> step.innovation, step.health
(5.0, 'sound')
>>> f.update([1.0, 2.0], float("nan")).health
'nonfinite'
)doc";
constexpr char pass_time_text[] = R"doc(pass_time($self, /)
--

Let the time of one row pass without a row, where a sample is missing: P becomes P / forgetting.

Returns
-------
Step
    Its innovation and residual are 0.

Examples
--------
>>> f = rlslab.Ud(1, forgetting=0.5, prior_variance=1)
>>> _ = f.pass_time()
>>> f.covariance
array([[2.]])
)doc";
constexpr char reset_text[] = R"doc(reset($self, /)
--

Make the filter as it was made: theta and P are the prior's, the counts 0.

Examples
--------
>>> f = rlslab.Ud(1)
>>> _ = f.update([1.0], 3.0)
>>> f.reset()
>>> f.theta
array([0.])
)doc";

PyMethodDef methods[] = {{"update", as_method(update), METH_FASTCALL | METH_KEYWORDS, update_text},
                         {"_update_many", as_method(update_many), METH_FASTCALL, nullptr},
                         {"_theta_path", as_method(asked::theta_path), METH_FASTCALL, nullptr},
                         {"pass_time", pass_time, METH_NOARGS, pass_time_text},
                         {"reset", reset<Filter>, METH_NOARGS, reset_text},
                         {"_remove", asked::remove, METH_VARARGS, nullptr},
                         {"_merge", asked::merge, METH_O, nullptr},
                         {"_variance", as_method(asked::variance), METH_FASTCALL, nullptr},
                         {"_sample", asked::sample, METH_VARARGS, nullptr},
                         {"_least_excited", asked::least_excited, METH_O, nullptr},
                         {"_factor", read_into<&Filter::factor, true>, METH_O, nullptr},
                         {"_theta", read_into<&Filter::theta, false>, METH_O, nullptr},
                         {"_gain", read_into<&Filter::gain, false>, METH_O, nullptr},
                         {"_covariance", read_into<&Filter::covariance, true>, METH_O, nullptr},
                         {"_information", read_into<&Filter::information, true>, METH_O, nullptr},
                         {"_certificate", certificate, METH_NOARGS, nullptr},
                         {"_state", state<Filter>, METH_NOARGS, nullptr},
                         {"_load", load<Filter>, METH_O, nullptr},
                         {"_clone", clone<Filter>, METH_NOARGS, nullptr},
                         {nullptr, nullptr, 0, nullptr}};
PyGetSetDef members[] = {
    {"size", size<Filter>, nullptr, "The number of parameters d.", nullptr},
    {"variant", text<Filter, &Filter::variant>, nullptr, "The variant's name, one of `rlslab.variants()`.", nullptr},
    {"_arithmetic", text<Filter, &Filter::arithmetic>, nullptr, nullptr, nullptr},
    {"_reports_covariance", reports_covariance, nullptr, nullptr, nullptr},
    {"health", health, nullptr, "The health of the last row, one of `rlslab.HEALTHS`.", nullptr},
    {"signal", signal, nullptr, "What the guard saw of the last row, one of `rlslab.SIGNALS`.", nullptr},
    {"counts", counts_of, nullptr,
     "What happened so far, a `Counts`: rows; as a guard counts them unusable, "
     "outliers, changes, windups, breakdowns; of a window refactored and since.",
     nullptr},
    {nullptr, nullptr, nullptr, nullptr, nullptr}};

/// A named tuple; with `_fields`, by which pandas knows one.
PyObject* tuple_type(char const* name, char const* doc, PyStructSequence_Field* fields, int n) {
    PyStructSequence_Desc description{name, doc, fields, n};
    PyObject* const type = reinterpret_cast<PyObject*>(PyStructSequence_NewType(&description));
    PyObject* const names = PyTuple_New(n);
    if (!type || !names) return nullptr;
    for (int i = 0; i < n; ++i) PyTuple_SetItem(names, i, PyUnicode_FromString(fields[i].name));
    if (PyObject_SetAttrString(type, "_fields", names) < 0) return nullptr;
    Py_DECREF(names);
    return type;
}

}  // namespace

PyObject* filter_type() {
    for (int i = 0; i < healths; ++i)
        health_words[i] = PyUnicode_InternFromString(std::string(native::name_of_health(i)).c_str());
    for (int i = 0; i < signals; ++i)
        signal_words[i] = PyUnicode_InternFromString(std::string(native::name_of_signal(i)).c_str());
    PyObject* const out = type_of<Filter>("rlslab._core.Filter", make, methods, members);
    filter_itself = reinterpret_cast<PyTypeObject*>(out);
    return out;
}
PyObject* step_type() {
    static PyStructSequence_Field fields[] = {{"innovation", "y - psi'theta(k-1), in the unit of y"},
                                              {"residual", "y - psi'theta(k), in the unit of y"},
                                              {"gamma", "lambda / (lambda + psi'P psi), in (0, 1]"},
                                              {"health", "one of rlslab.HEALTHS"},
                                              {"signal", "one of rlslab.SIGNALS"},
                                              {nullptr, nullptr}};
    PyObject* const out = tuple_type("rlslab.Step", "What one row did to a filter.", fields, 5);
    step = reinterpret_cast<PyTypeObject*>(out);
    return out;
}
PyObject* counts_type() {
    static PyStructSequence_Field fields[] = {{"rows", "since the filter was made, reset or loaded"},
                                              {"unusable", "rows that were not finite, or out of range: skipped"},
                                              {"outliers", "rows that failed the innovation test"},
                                              {"changes", "times that 5 of 6 rows were outliers"},
                                              {"windups", "times that a variance was beyond the largest"},
                                              {"breakdowns", "times that P was not positive definite"},
                                              {"refactored", "times that the window's rows were factored anew"},
                                              {"since", "rows since then, or since the start"},
                                              {nullptr, nullptr}};
    PyObject* const out = tuple_type("rlslab.Counts", "What happened to a filter so far.", fields, 8);
    counts = reinterpret_cast<PyTypeObject*>(out);
    return out;
}

}  // namespace rlslab::python
