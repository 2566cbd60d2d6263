// rlslab._core.Fleet: many filters of one problem as a Python object.
#include "bindings/python/make.hpp"

namespace rlslab::python {
namespace {

using native::Fleet;
using Held = Holder<Fleet>;

/// (options, outputs, complex)
PyObject* make(PyTypeObject* type, PyObject* args, PyObject*) {
    PyObject* options;
    Py_ssize_t outputs;
    int is_complex;
    if (!PyArg_ParseTuple(args, "O!np", &PyTuple_Type, &options, &outputs, &is_complex)) return nullptr;
    return made<Fleet>(type, options, [&](Arguments const& given, Py_ssize_t filters) {
        return is_complex ? native::make_complex(given.variant, given.arithmetic, filters, outputs, given.options)
                          : native::make_fleet(given.variant, given.arithmetic, filters, given.options, outputs);
    });
}

/// (rows, Psi, y, weights or None, room for the steps or None): float64 or float32, all of one, one after another in
/// memory; a complex number is two. Returns how many rows were missing.
PyObject* update(PyObject* self, PyObject* const* args, Py_ssize_t n) {
    if (!takes("_update(rows, Psi, y, weights, steps)", 5, n)) return nullptr;
    Py_ssize_t const rows = PyLong_AsSsize_t(args[0]);
    if (rows == -1 && PyErr_Occurred()) return nullptr;
    struct Views {
        View psi, y, weights, steps;
    };
    Views* const views = new (std::nothrow) Views;  // as in filter.cpp: never released without the lock
    if (!views) return PyErr_NoMemory();
    Fleet const& fleet = *Held::of(self)->native;
    auto& [psi, y, weights, steps] = *views;
    constexpr int in_order = PyBUF_C_CONTIGUOUS | PyBUF_FORMAT;
    bool ok = psi.of(args[1], in_order) && y.of(args[2], in_order) &&
              (args[3] == Py_None || weights.of(args[3], in_order)) &&
              (args[4] == Py_None || steps.of(args[4], PyBUF_WRITABLE | PyBUF_C_CONTIGUOUS));
    native::Index missing = 0;
    if (ok) {
        char const kind = psi.kind();
        Py_ssize_t const most = PY_SSIZE_T_MAX / 64 / fleet.filters() / (fleet.size() + fleet.outputs()),
                         M = (0 <= rows && rows <= most ? rows : 0) * fleet.filters(), m = M * fleet.outputs(),
                         unit = kind == 'f' ? 4 : 8, parts = fleet.is_complex() ? 2 : 1,
                         step = Py_ssize_t(parts == 2 ? sizeof(Fleet::ComplexStep) : sizeof(native::Step));
        auto const is = [&](View const& view, Py_ssize_t numbers) {
            return view.kind() == kind && view.aligned() && view.buffer.len == numbers * unit;
        };
        bool const fits = 0 <= rows && rows <= most && kind && is(psi, parts * M * fleet.size()) && is(y, parts * m) &&
                          (!weights.buffer.obj || is(weights, M)) &&
                          (!steps.buffer.obj || steps.buffer.len == m * step);
        if (!fits) PyErr_SetString(PyExc_ValueError, "Psi, y, weights and steps do not fit the fleet");
        ok = fits && native_of<Fleet>(self);
        Fleet::Rows given{.count = rows, .psi = psi.data<double const>(), .y = y.data<double const>()};
        given.weights = weights.data<double const>();
        if (kind == 'f')
            given.psi = psi.data<float const>(), given.y = y.data<float const>(),
            given.weights = weights.data<float const>();
        if (parts == 2) given.steps = steps.data<Fleet::ComplexStep>();
        else given.steps = steps.data<native::Step>();
        ok = ok && without_lock<Fleet>(self, [&](Fleet& f) { missing = f.update(given); });
    }
    delete views;
    return ok ? PyLong_FromSsize_t(missing) : nullptr;
}

/// Numbers of float64 for `count` of a filter's numbers of all: a complex one is two.
bool room_of_all(View& view, PyObject* out, Fleet const& f, native::Index& count) {
    count *= f.is_complex() ? 2 : 1;
    return view_of_output(view, out, f.filters() * count);
}
/// M x d x m numbers.
PyObject* theta(PyObject* self, PyObject* out) {
    return with<Fleet>(self, [&](Fleet& f) -> PyObject* {
        View view;
        native::Index count = f.size() * f.outputs();
        if (!room_of_all(view, out, f, count)) return nullptr;
        for (native::Index m = 0; m < f.filters(); ++m) f.theta(m, view.data<double>() + m * count);
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
/// M x d x d numbers, each by columns: P of each, or P^-1; None: nothing. Returns whether it is P.
PyObject* matrices(PyObject* self, PyObject* out) {
    return with<Fleet>(self, [&](Fleet& f) -> PyObject* {
        View view;
        native::Index count = f.size() * f.size();
        if (out != Py_None && !room_of_all(view, out, f, count)) return nullptr;
        for (native::Index m = 0; out != Py_None && m < f.filters(); ++m) f.matrix(m, view.data<double>() + m * count);
        return PyBool_FromLong(f.matrix(0, nullptr));
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
                         {"variant", text<Fleet, &Fleet::variant>, nullptr, "The variant's name.", nullptr},
                         {nullptr, nullptr, nullptr, nullptr, nullptr}};

}  // namespace

PyObject* fleet_type() { return type_of<Fleet>("rlslab._core.Fleet", make, methods, members); }

}  // namespace rlslab::python
