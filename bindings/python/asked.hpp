// What a filter is asked for beside its rows: a removal, merging, variances, draws, its least excited direction.
#pragma once

#include "bindings/python/objects.hpp"

#include <rlslab/catalogue/native/filter.hpp>

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

}  // namespace asked
}  // namespace rlslab::python
