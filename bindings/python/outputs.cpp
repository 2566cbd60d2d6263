// rlslab._core.Outputs: several outputs with one regressor as a Python object.
#include "bindings/python/make.hpp"

#include <rlslab/catalogue/native/outputs.hpp>

namespace rlslab::python {
namespace {

using native::Outputs;
using Held = Holder<Outputs>;
PyTypeObject* own_type = nullptr;

PyObject* make(PyTypeObject* type, PyObject* args, PyObject*) {
    return made<Outputs>(type, args, [](Arguments const& given, Py_ssize_t outputs) {
        return native::make_outputs(given.variant, given.arithmetic, outputs, given.options);
    });
}

/// (psi, y, steps): d and m contiguous numbers of one type, room for m steps. Returns the code of the worst health.
PyObject* update(PyObject* self, PyObject* const* args, Py_ssize_t n) {
    if (!takes("_update(psi, y, steps)", 3, n)) return nullptr;
    return with<Outputs>(self, [&](Outputs& f) -> PyObject* {
        View psi, y, steps;
        if (!psi.of(args[0]) || !y.of(args[1]) || !steps.of(args[2], PyBUF_WRITABLE | PyBUF_C_CONTIGUOUS))
            return nullptr;
        if (!psi.is_vector(f.size()) || !y.is_vector(f.outputs()) || psi.kind() != y.kind() ||
            steps.buffer.len != f.outputs() * Py_ssize_t(sizeof(native::Step))) {
            PyErr_SetString(PyExc_ValueError, "psi, y and steps do not fit together");
            return nullptr;
        }
        auto* const to = steps.data<native::Step>();
        return PyLong_FromLong(psi.kind() == 'd' ? f.update(psi.data<double const>(), y.data<double const>(), to)
                                                 : f.update(psi.data<float const>(), y.data<float const>(), to));
    });
}
/// (X, Y, leave_out): arrays of one type, each row contiguous. Returns the code of the last block's health.
PyObject* update_many(PyObject* self, PyObject* const* args, Py_ssize_t n) {
    if (!takes("_update_many(X, Y, leave_out)", 3, n)) return nullptr;
    struct Views {
        View X, Y;
    };
    Views* const views = new (std::nothrow) Views;  // as in filter.cpp: never released without the lock
    if (!views) return PyErr_NoMemory();
    Outputs const& filter = *Held::of(self)->native;
    auto const& [X, Y] = *views;
    bool const leave_out = PyObject_IsTrue(args[2]) == 1;
    bool ok = views->X.of(args[0]) && views->Y.of(args[1]);
    std::int32_t health = 0;
    if (ok) {
        bool const fits = X.is_rows(filter.size()) && Y.is_rows(filter.outputs()) && X.kind() == Y.kind() &&
                          X.buffer.shape[0] == Y.buffer.shape[0];
        if (!fits) PyErr_SetString(PyExc_ValueError, "X and Y do not fit together");
        ok = fits && native_of<Outputs>(self);
        Outputs::Rows rows{
            .X = X.data<double const>(), .Y = Y.data<double const>(), .count = ok ? X.buffer.shape[0] : 0};
        if (ok && X.kind() == 'f') rows.X = X.data<float const>(), rows.Y = Y.data<float const>();
        if (ok) rows.X_stride = X.row_stride(), rows.Y_stride = Y.row_stride();
        ok = ok && without_lock<Outputs>(self, [&](Outputs& f) { health = f.update_many(rows, leave_out); });
    }
    delete views;
    return ok ? PyLong_FromLong(health) : nullptr;
}
PyObject* merge(PyObject* self, PyObject* newer) {
    return merged<Outputs>(self, newer, own_type, "merge takes what was made with outputs=");
}
PyObject* add_outputs(PyObject* self, PyObject* more) {
    Py_ssize_t const count = PyLong_AsSsize_t(more);
    if (count == -1 && PyErr_Occurred()) return nullptr;
    return with<Outputs>(self, [&](Outputs& f) {
        f.add_outputs(count);
        return Py_NewRef(Py_None);
    });
}
/// Into an array of float64.
template <void (Outputs::*read)(double*) const, bool square>
PyObject* read_into(PyObject* self, PyObject* out) {
    return with<Outputs>(self, [&](Outputs& f) -> PyObject* {
        View view;
        if (!view_of_output(view, out, f.size() * (square ? f.size() : f.outputs()))) return nullptr;
        (f.*read)(view.data<double>());
        return Py_NewRef(Py_None);
    });
}
template <auto member>
PyObject* number(PyObject* self, void*) {
    return with<Outputs>(self, [](Outputs& f) { return PyLong_FromLongLong((f.*member)()); });
}

PyMethodDef methods[] = {{"_update", as_method(update), METH_FASTCALL, nullptr},
                         {"_update_many", as_method(update_many), METH_FASTCALL, nullptr},
                         {"_merge", merge, METH_O, nullptr},
                         {"_add_outputs", add_outputs, METH_O, nullptr},
                         {"_reset", reset<Outputs>, METH_NOARGS, nullptr},
                         {"_theta", read_into<&Outputs::theta, false>, METH_O, nullptr},
                         {"_matrix", read_into<&Outputs::matrix, true>, METH_O, nullptr},
                         {"_factor", read_into<&Outputs::factor, true>, METH_O, nullptr},
                         {"_state", state<Outputs>, METH_NOARGS, nullptr},
                         {"_load", load<Outputs>, METH_O, nullptr},
                         {"_clone", clone<Outputs>, METH_NOARGS, nullptr},
                         {nullptr, nullptr, 0, nullptr}};
PyGetSetDef members[] = {
    {"size", number<&Outputs::size>, nullptr, "The number of parameters d of each output.", nullptr},
    {"outputs", number<&Outputs::outputs>, nullptr, "The number of outputs m.", nullptr},
    {"variant", text<Outputs, &Outputs::variant>, nullptr, "The variant's name, one of `rlslab.variants()`.", nullptr},
    {"left_out", number<&Outputs::left_out>, nullptr,
     "How many rows were left out, since it was made, reset or restored.", nullptr},
    {"_arithmetic", text<Outputs, &Outputs::arithmetic>, nullptr, nullptr, nullptr},
    {"_reports_covariance", number<&Outputs::reports_covariance>, nullptr, nullptr, nullptr},
    {"_health", number<&Outputs::health>, nullptr, nullptr, nullptr},
    {nullptr, nullptr, nullptr, nullptr, nullptr}};

}  // namespace

PyObject* outputs_type() {
    PyObject* const out = type_of<Outputs>("rlslab._core.Outputs", make, methods, members);
    own_type = reinterpret_cast<PyTypeObject*>(out);
    return out;
}

}  // namespace rlslab::python
