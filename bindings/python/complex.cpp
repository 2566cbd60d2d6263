// rlslab._core.Complex: filters of complex numbers as a Python object. Complex numbers come as pairs of floats.
#include "bindings/python/make.hpp"

#include <rlslab/catalogue/native/complex.hpp>

namespace rlslab::python {
namespace {

using native::ComplexFleet;
using Held = Holder<ComplexFleet>;

/// (options as of Fleet, outputs)
PyObject* make(PyTypeObject* type, PyObject* args, PyObject*) {
    PyObject* options;
    Py_ssize_t outputs;
    if (!PyArg_ParseTuple(args, "O!n", &PyTuple_Type, &options, &outputs)) return nullptr;
    return made<ComplexFleet>(type, options, [&](Arguments const& given, Py_ssize_t filters) {
        return native::make_complex(given.variant, given.arithmetic, filters, outputs, given.options);
    });
}

/// (rows, psi, y, innovation, residual, gamma, health): contiguous, psi and y of one type. Returns how many rows were
/// missing.
PyObject* update(PyObject* self, PyObject* const* args, Py_ssize_t n) {
    if (!takes("_update(rows, psi, y, innovation, residual, gamma, health)", 7, n)) return nullptr;
    Py_ssize_t const rows = PyLong_AsSsize_t(args[0]);
    if (rows == -1 && PyErr_Occurred()) return nullptr;
    struct Views {
        View psi, y, innovation, residual, gamma, health;
    };
    Views* const views = new (std::nothrow) Views;  // as in filter.cpp: never released without the lock
    if (!views) return PyErr_NoMemory();
    ComplexFleet const& f = *Held::of(self)->native;
    View* const of[] = {&views->psi, &views->y, &views->innovation, &views->residual, &views->gamma, &views->health};
    bool ok = true;
    for (int i = 0; i < 6; ++i)
        ok = ok && of[i]->of(args[i + 1], PyBUF_C_CONTIGUOUS | PyBUF_FORMAT | (i < 2 ? 0 : PyBUF_WRITABLE));
    native::Index missing = 0;
    if (ok) {
        char const kind = views->psi.kind();
        Py_ssize_t const most = PY_SSIZE_T_MAX / 64 / f.filters() / (f.size() + f.outputs());
        Py_ssize_t const M = (0 <= rows && rows <= most ? rows : 0) * f.filters(), m = M * f.outputs(),
                         unit = kind == 'f' ? 4 : 8;
        bool const fits = 0 <= rows && rows <= most && kind && kind == views->y.kind() && views->psi.aligned() &&
                          views->y.aligned() && views->psi.buffer.len == 2 * M * f.size() * unit &&
                          views->y.buffer.len == 2 * m * unit && views->innovation.buffer.len == 16 * m &&
                          views->residual.buffer.len == 16 * m && views->gamma.buffer.len == 8 * M &&
                          views->health.buffer.len == 4 * M;
        if (!fits) PyErr_SetString(PyExc_ValueError, "psi, y and steps do not fit together");
        ok = fits && native_of<ComplexFleet>(self);
        ComplexFleet::Steps const to{views->innovation.data<double>(), views->residual.data<double>(),
                                     views->gamma.data<double>(), views->health.data<std::int32_t>()};
        ok = ok && without_lock<ComplexFleet>(self, [&](ComplexFleet& filter) {
                 missing = kind == 'd'
                               ? filter.update(rows, views->psi.data<double const>(), views->y.data<double const>(), to)
                               : filter.update(rows, views->psi.data<float const>(), views->y.data<float const>(), to);
             });
    }
    delete views;
    return ok ? PyLong_FromSsize_t(missing) : nullptr;
}
/// Into an array of float64: M x d x m pairs.
PyObject* theta(PyObject* self, PyObject* out) {
    return with<ComplexFleet>(self, [&](ComplexFleet& f) -> PyObject* {
        View view;
        if (!view_of_output(view, out, 2 * f.filters() * f.size() * f.outputs())) return nullptr;
        f.theta(view.data<double>());
        return Py_NewRef(Py_None);
    });
}
/// M matrices of d x d pairs, each by columns.
PyObject* matrix(PyObject* self, PyObject* out) {
    return with<ComplexFleet>(self, [&](ComplexFleet& f) -> PyObject* {
        View view;
        native::Index const of_each = 2 * f.size() * f.size();
        if (!view_of_output(view, out, f.filters() * of_each)) return nullptr;
        for (native::Index i = 0; i < f.filters(); ++i) f.matrix(i, view.data<double>() + i * of_each);
        return Py_NewRef(Py_None);
    });
}
PyObject* health(PyObject* self, PyObject* out) {
    return with<ComplexFleet>(self, [&](ComplexFleet& f) -> PyObject* {
        View view;
        if (!view_of_output(view, out, f.filters())) return nullptr;
        for (native::Index i = 0; i < f.filters(); ++i) view.data<double>()[i] = double(f.health(i));
        return Py_NewRef(Py_None);
    });
}
PyObject* reports_covariance(PyObject* self, void*) {
    return with<ComplexFleet>(self, [](ComplexFleet& f) { return PyBool_FromLong(f.reports_covariance()); });
}

PyMethodDef methods[] = {{"_update", as_method(update), METH_FASTCALL, nullptr},
                         {"_theta", theta, METH_O, nullptr},
                         {"_matrix", matrix, METH_O, nullptr},
                         {"_health", health, METH_O, nullptr},
                         {"_reset", reset<ComplexFleet>, METH_NOARGS, nullptr},
                         {"_state", state<ComplexFleet>, METH_NOARGS, nullptr},
                         {"_load", load<ComplexFleet>, METH_O, nullptr},
                         {"_clone", clone<ComplexFleet>, METH_NOARGS, nullptr},
                         {nullptr, nullptr, 0, nullptr}};
PyGetSetDef members[] = {
    {"size", size<ComplexFleet>, nullptr, "The number of parameters d.", nullptr},
    {"variant", text<ComplexFleet, &ComplexFleet::variant>, nullptr, "The variant's name.", nullptr},
    {"_reports_covariance", reports_covariance, nullptr, nullptr, nullptr},
    {nullptr, nullptr, nullptr, nullptr, nullptr}};

}  // namespace

PyObject* complex_type() { return type_of<ComplexFleet>("rlslab._core.Complex", make, methods, members); }

}  // namespace rlslab::python
