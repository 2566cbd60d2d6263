// The options of a filter or a fleet from the arguments that the package passes on.
#pragma once

#include <rlslab/catalogue/native/filter.hpp>

#include "bindings/python/objects.hpp"

namespace rlslab::python {

/// Options with the arrays that they point into.
struct Arguments {
    native::Options options;
    char const* variant = nullptr;
    char const* arithmetic = nullptr;
    View theta, covariance, control_numbers, guard_numbers;

    /// (variant, arithmetic, size, forgetting, prior_variance, prior_theta, prior_covariance, window, guard, control,
    /// control_numbers, guard_numbers, noise_memory, rebuild_rows, certify, digits, filters): arrays of float64, or
    /// None. `filters`: or outputs; no meaning for one filter. False with Python's error set.
    bool parse(PyObject* args, Py_ssize_t& filters) {
        PyObject *theta0, *P0, *numbers, *of_guard;
        char const *guard, *control;
        Py_ssize_t size, window, memory, rows, certify, digits;
        if (!PyArg_ParseTuple(args, "ssnddOOnssOOnnnnn", &variant, &arithmetic, &size, &options.forgetting,
                              &options.prior_variance, &theta0, &P0, &window, &guard, &control, &numbers, &of_guard,
                              &memory, &rows, &certify, &digits, &filters))
            return false;
        options.size = size;
        options.window = window;
        options.guard = guard;
        options.control = control;
        options.noise_memory = memory;
        options.rebuild_rows = rows;
        options.certify = certify;
        options.digits = digits;
        if (!optional(theta, theta0, size) || !optional(covariance, P0, -1) ||
            !optional(control_numbers, numbers, -1) || !optional(guard_numbers, of_guard, 4))
            return false;
        if (covariance.buffer.obj &&
            (covariance.buffer.ndim != 2 || covariance.buffer.shape[0] != size || covariance.buffer.shape[1] != size)) {
            PyErr_SetString(PyExc_ValueError, "prior_covariance is not of size x size");
            return false;
        }
        options.prior_theta = theta.data<double const>();
        options.prior_covariance = covariance.data<double const>();
        if (control_numbers.buffer.obj)
            options.control_numbers = {control_numbers.data<double const>(),
                                       std::size_t(control_numbers.buffer.len) / sizeof(double)};
        if (guard_numbers.buffer.obj) {
            double const* const x = guard_numbers.data<double const>();
            options.largest_variance = x[0];
            options.innovation = x[1];
            options.least_noise = x[2];
            options.asymmetry = x[3];
        }
        return true;
    }

private:
    /// n < 0: any number of them.
    static bool optional(View& view, PyObject* object, Py_ssize_t n) {
        if (object == Py_None) return true;
        if (!view.of(object, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT)) return false;
        if (view.kind() == 'd' && (n < 0 || view.buffer.len == n * Py_ssize_t(sizeof(double)))) return true;
        PyErr_SetString(PyExc_ValueError, "expected float64 numbers, as many as the filter has parameters");
        return false;
    }
};

/// A new object of what create(given, filters) makes of the arguments; null with Python's error set.
template <class Native, class Create>
PyObject* made(PyTypeObject* type, PyObject* args, Create create) {
    Arguments given;
    Py_ssize_t filters;
    if (!given.parse(args, filters)) return nullptr;
    try {
        return Holder<Native>::make(type, create(given, filters));
    } catch (std::exception const&) {
        return raise(std::current_exception());
    }
}

}  // namespace rlslab::python
