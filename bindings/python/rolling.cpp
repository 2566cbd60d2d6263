// rlslab._core.rolling: regressions over the last rows, of each row and group.
#include "bindings/python/objects.hpp"

#include <rlslab/catalogue/native/rolling.hpp>

#include <array>

namespace rlslab::python {
namespace {

struct Views {
    View X, y, group;
    std::array<View, 8> out;  // in the order of rlslab::Rolled
};
/// Whether it is n numbers of int64 one after another.
bool are_codes(View const& view, Py_ssize_t n) {
    Py_buffer const& b = view.buffer;
    char const* format = b.format ? b.format : "";
    if (*format == '@' || *format == '=' || *format == '<') ++format;
    return (*format == 'l' || *format == 'q') && format[1] == 0 && b.itemsize == Py_ssize_t(sizeof(std::int64_t)) &&
           b.ndim == 1 && b.shape[0] == n;
}
/// False with Python's error set.
bool fit(Views& v, PyObject* X, PyObject* y, PyObject* group, PyObject* out) {
    if (!v.X.of(X) || !v.y.of(y) || (group != Py_None && !v.group.of(group, PyBUF_FORMAT | PyBUF_C_CONTIGUOUS)))
        return false;
    Py_buffer const& rows = v.X.buffer;
    if (rows.ndim != 2 || !v.X.is_rows(rows.shape[1]) || v.X.kind() != v.y.kind() || !v.y.is_vector(rows.shape[0]) ||
        (group != Py_None && !are_codes(v.group, rows.shape[0]))) {
        PyErr_SetString(PyExc_ValueError, "X, y and groups do not fit together");
        return false;
    }
    for (std::size_t i = 0; i < v.out.size(); ++i) {
        PyObject* const array = PyTuple_GetItem(out, Py_ssize_t(i));
        if (!array) return false;
        if (array != Py_None && !view_of_output(v.out[i], array, rows.shape[0] * (i < 3 ? rows.shape[1] : 1)))
            return false;
    }
    return true;
}
template <class X>
void run(Views const& v, RollingOptions const& options) {
    Py_buffer const& b = v.X.buffer;
    auto const to = [&](std::size_t i) { return v.out[i].data<double>(); };
    native::rolling(RollingRows<X>{v.X.data<X const>(), v.y.data<X const>(), b.shape[0], b.shape[1], v.X.row_stride(),
                                   v.group.data<std::int64_t const>()},
                    options,
                    {.theta = to(0),
                     .t = to(1),
                     .error = to(2),
                     .residual = to(3),
                     .innovation = to(4),
                     .sigma = to(5),
                     .r2 = to(6),
                     .rows = to(7)});
}

}  // namespace

PyObject* rolling(PyObject*, PyObject* args) {
    PyObject *X, *y, *group, *out;
    RollingOptions options;
    Py_ssize_t window, min_periods;
    if (!PyArg_ParseTuple(args, "OOOndnO!", &X, &y, &group, &window, &options.forgetting, &min_periods, &PyTuple_Type,
                          &out))
        return nullptr;
    options.window = window;
    options.min_periods = min_periods;
    options.threads = native::threads();
    Views* const views = new (std::nothrow) Views;  // as in filter.cpp: never released without the lock
    if (!views) return PyErr_NoMemory();
    bool ok = fit(*views, X, y, group, out);
    if (ok) {
        std::exception_ptr thrown;
        PyThreadState* const thread = PyEval_SaveThread();
        try {
            if (views->X.kind() == 'd') run<double>(*views, options);
            else run<float>(*views, options);
        } catch (std::exception const&) {
            thrown = std::current_exception();
        }
        PyEval_RestoreThread(thread);
        if (thrown) raise(thrown);
        ok = !thrown;
    }
    delete views;
    return ok ? Py_NewRef(Py_None) : nullptr;
}

}  // namespace rlslab::python
