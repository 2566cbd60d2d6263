// rlslab._core.Fleet: many filters of one problem as a Python object.
#include "bindings/python/make.hpp"

namespace rlslab::python {
namespace {

using native::Fleet;
using Held = Holder<Fleet>;

PyObject* make(PyTypeObject* type, PyObject* args, PyObject*) {
    return made<Fleet>(type, args, [](Arguments const& given, Py_ssize_t filters) {
        return native::make_fleet(given.variant, given.arithmetic, filters, given.options);
    });
}

/// (Psi, y, room for the steps or None): arrays of float64 or float32, of shapes (M, d) and (M,), one after another in
/// memory. Returns how many rows were missing.
PyObject* update(PyObject* self, PyObject* const* args, Py_ssize_t n) {
    if (!takes("_update(Psi, y, steps)", 3, n)) return nullptr;
    struct Views {
        View psi, y, steps;
    };
    Views* const views = new (std::nothrow) Views;  // as in filter.cpp: never released without the lock
    if (!views) return PyErr_NoMemory();
    Fleet const& fleet = *Held::of(self)->native;
    Py_ssize_t const M = fleet.filters(), d = fleet.size();
    Py_buffer const& P = views->psi.buffer;
    bool ok = views->psi.of(args[0], PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) && views->y.of(args[1]) &&
              (args[2] == Py_None || views->steps.of(args[2], PyBUF_WRITABLE | PyBUF_C_CONTIGUOUS));
    native::Index missing = 0;
    if (ok) {
        char const kind = views->psi.kind();
        bool const fits = kind && kind == views->y.kind() && P.ndim == 2 && P.shape[0] == M && P.shape[1] == d &&
                          views->psi.aligned() && views->y.is_vector(M) &&
                          (!views->steps.buffer.obj || views->steps.buffer.len == M * Py_ssize_t(sizeof(native::Step)));
        if (!fits) PyErr_SetString(PyExc_ValueError, "Psi and y do not fit the fleet");
        ok = fits && native_of<Fleet>(self);
        void const* const y = views->y.buffer.buf;
        auto* const steps = static_cast<native::Step*>(views->steps.buffer.buf);
        if (ok)
            ok = without_lock<Fleet>(self, [&](Fleet& f) {
                missing = kind == 'd'
                              ? f.update(static_cast<double const*>(P.buf), static_cast<double const*>(y), steps)
                              : f.update(static_cast<float const*>(P.buf), static_cast<float const*>(y), steps);
            });
    }
    delete views;
    return ok ? PyLong_FromSsize_t(missing) : nullptr;
}

PyObject* theta(PyObject* self, PyObject* out) {
    return with<Fleet>(self, [&](Fleet& f) -> PyObject* {
        View view;
        if (!view_of_output(view, out, f.filters() * f.size())) return nullptr;
        for (native::Index m = 0; m < f.filters(); ++m) f.theta(m, view.data<double>() + m * f.size());
        return Py_NewRef(Py_None);
    });
}
/// Into an array of doubles: the code of each filter's health.
PyObject* health(PyObject* self, PyObject* out) {
    return with<Fleet>(self, [&](Fleet& f) -> PyObject* {
        View view;
        if (!view_of_output(view, out, f.filters())) return nullptr;
        for (native::Index m = 0; m < f.filters(); ++m) view.data<double>()[m] = double(f.health(m));
        return Py_NewRef(Py_None);
    });
}
/// Into an array of doubles, of M x d x d, each by columns: P of each, or P^-1. Returns whether it is P.
PyObject* matrices(PyObject* self, PyObject* out) {
    return with<Fleet>(self, [&](Fleet& f) -> PyObject* {
        View view;
        native::Index const numbers = f.size() * f.size();
        if (!view_of_output(view, out, f.filters() * numbers)) return nullptr;
        bool covariance = false;
        for (native::Index m = 0; m < f.filters(); ++m) covariance = f.matrix(m, view.data<double>() + m * numbers);
        return PyBool_FromLong(covariance);
    });
}
PyObject* reset(PyObject* self, PyObject* which) {
    Py_ssize_t const m = PyLong_AsSsize_t(which);
    if (m == -1 && PyErr_Occurred()) return nullptr;
    return with<Fleet>(self, [&](Fleet& f) -> PyObject* {
        if (m < 0 || m >= f.filters()) return PyErr_Format(PyExc_IndexError, "no filter %zd in this fleet", m);
        f.reset(m);
        return Py_NewRef(Py_None);
    });
}
PyObject* filters(PyObject* self, void*) { return PyLong_FromSsize_t(Held::of(self)->native->filters()); }

PyMethodDef methods[] = {{"_update", as_method(update), METH_FASTCALL, nullptr},
                         {"_theta", theta, METH_O, nullptr},
                         {"_health", health, METH_O, nullptr},
                         {"_matrices", matrices, METH_O, nullptr},
                         {"_reset", reset, METH_O, nullptr},
                         {"_state", state<Fleet>, METH_NOARGS, nullptr},
                         {"_load", load<Fleet>, METH_O, nullptr},
                         {"_clone", clone<Fleet>, METH_NOARGS, nullptr},
                         {nullptr, nullptr, 0, nullptr}};
PyGetSetDef members[] = {{"size", size<Fleet>, nullptr, "The number of parameters d of each filter.", nullptr},
                         {"filters", filters, nullptr, "The number of filters M.", nullptr},
                         {nullptr, nullptr, nullptr, nullptr, nullptr}};

}  // namespace

PyObject* fleet_type() { return type_of<Fleet>("rlslab._core.Fleet", make, methods, members); }

}  // namespace rlslab::python
