// Filter._theta_path: many rows of a filter, and theta after each.
#include "bindings/python/objects.hpp"

#include <rlslab/catalogue/native/theta_path.hpp>

namespace rlslab::python {

PyObject* theta_path(PyObject* self, PyObject* const* args, Py_ssize_t n) {
    using native::Filter;
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

}  // namespace rlslab::python
