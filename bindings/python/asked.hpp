// What a filter is asked for beside its rows: a removal, merging, variances, draws, its least excited direction, theta
// after each of many rows.
#pragma once

#include "bindings/python/objects.hpp"

#include <rlslab/catalogue/native/theta_path.hpp>

namespace rlslab::python {

/// rlslab._core.Filter.
inline PyTypeObject* filter_itself = nullptr;

namespace asked {
using native::Filter;

/// (psi, y, weight): d numbers of float64. Returns remaining and noise.
inline PyObject* remove(PyObject* self, PyObject* args) {
    PyObject* row;
    double y, weight;
    if (!PyArg_ParseTuple(args, "Odd", &row, &y, &weight)) return nullptr;
    return with<Filter>(self, [&](Filter& f) -> PyObject* {
        View view;
        if (!view.of(row)) return nullptr;
        if (view.kind() != 'd' || !view.is_vector(f.size())) {
            PyErr_SetString(PyExc_ValueError, "psi is not a row of numbers");
            return nullptr;
        }
        native::Removal const removal = f.remove(view.data<double const>(), y, weight);
        return Py_BuildValue("(dd)", removal.remaining, removal.noise);
    });
}
inline PyObject* merge(PyObject* self, PyObject* newer) {
    return merged<Filter>(self, newer, filter_itself, "merge takes a filter of one output");
}
/// (Psi, out): float64, Psi as rlslab._rows.block leaves it, a number of out for each row.
inline PyObject* variance(PyObject* self, PyObject* const* args, Py_ssize_t n) {
    if (!takes("_variance(Psi, out)", 2, n)) return nullptr;
    return with<Filter>(self, [&](Filter& f) -> PyObject* {
        View psi, out;
        if (!psi.of(args[0])) return nullptr;
        if (psi.kind() != 'd' || !psi.is_rows(f.size())) {
            PyErr_SetString(PyExc_ValueError, "Psi is not rows of numbers");
            return nullptr;
        }
        Py_ssize_t const rows = psi.buffer.shape[0];
        if (!view_of_output(out, args[1], rows)) return nullptr;
        f.variance(psi.data<double const>(), rows, psi.row_stride(), out.data<double>());
        return Py_NewRef(Py_None);
    });
}
/// (seed, n, scale, out): out of n d numbers.
inline PyObject* sample(PyObject* self, PyObject* args) {
    unsigned long long seed;
    Py_ssize_t n;
    double scale;
    PyObject* to;
    if (!PyArg_ParseTuple(args, "KndO", &seed, &n, &scale, &to)) return nullptr;
    return with<Filter>(self, [&](Filter& f) -> PyObject* {
        View out;
        Py_ssize_t const most = PY_SSIZE_T_MAX / 16 / f.size();
        if (!view_of_output(out, to, (0 <= n && n <= most ? n : most) * f.size())) return nullptr;
        f.sample(seed, n, scale, out.data<double>());
        return Py_NewRef(Py_None);
    });
}
/// (out): of d numbers. Returns deviation and ratio.
inline PyObject* least_excited(PyObject* self, PyObject* to) {
    return with<Filter>(self, [&](Filter& f) -> PyObject* {
        View out;
        if (!view_of_output(out, to, f.size())) return nullptr;
        native::Excitation const found = f.least_excited(out.data<double>());
        return Py_BuildValue("(dd)", found.deviation, found.ratio);
    });
}

/// (Psi, y, weights or None, room for the steps, room for theta after each row).
inline PyObject* theta_path(PyObject* self, PyObject* const* args, Py_ssize_t n) {
    if (!takes("_theta_path(Psi, y, weights, steps, theta)", 5, n)) return nullptr;
    struct Views {
        View psi, y, weights, steps, theta;
    };
    Views* const views = new (std::nothrow) Views;  // as in filter.cpp: never released without the lock
    if (!views) return PyErr_NoMemory();
    Py_buffer const& P = views->psi.buffer;
    Py_ssize_t const d = Holder<Filter>::of(self)->native->size();
    bool ok = views->psi.of(args[0]) && views->y.of(args[1]) && (args[2] == Py_None || views->weights.of(args[2])) &&
              views->steps.of(args[3], PyBUF_WRITABLE | PyBUF_C_CONTIGUOUS);
    bool const weighted = views->weights.buffer.obj;
    if (ok && ((weighted && (views->weights.kind() != views->y.kind() || !views->weights.is_vector(P.shape[0]))) ||
               !views->psi.is_rows(d) || views->psi.kind() != views->y.kind() || !views->y.is_vector(P.shape[0]) ||
               views->steps.buffer.len != P.shape[0] * Py_ssize_t(sizeof(native::Step)))) {
        PyErr_SetString(PyExc_ValueError, "Psi, y, weights and steps do not fit together");
        ok = false;
    }
    ok = ok && view_of_output(views->theta, args[4], P.shape[0] * d) && native_of<Filter>(self);
    if (ok && P.shape[0] > 0)
        ok = without_lock<Filter>(self, [&](Filter& f) {
            auto const run = [&]<class X>(X const* psi) {
                update_many(f, psi, P.shape[0], views->psi.row_stride(), views->y.data<X const>(),
                            weighted ? views->weights.data<X const>() : nullptr, views->steps.data<native::Step>(),
                            views->theta.data<double>());
            };
            if (views->psi.kind() == 'd') run(views->psi.data<double const>());
            else run(views->psi.data<float const>());
        });
    delete views;
    return ok ? Py_NewRef(Py_None) : nullptr;
}

}  // namespace asked
}  // namespace rlslab::python
