// rlslab._reference: the certified solution. An extension of its own, for it needs FLINT, Arb, MPFR and Boost, which
// rlslab._core must not. What people call is bindings/python/rlslab/_certified.py.
#include "bindings/python/objects.hpp"

#include <rlslab/reference/enclosure.hpp>

#include <chrono>

namespace rlslab::python {
namespace {

using Held = Holder<CertifiedSolution>;
PyTypeObject* solution_type = nullptr;

/// n numbers of float64 that stand one after another, as a vector or as a matrix by rows; None: nothing. False with
/// Python's error set otherwise.
bool numbers(PyObject* object, Py_ssize_t n, Vector<double>& out) {
    if (object == Py_None) return true;
    View view;
    if (!view.of(object, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT)) return false;
    if (view.kind() != 'd' || view.buffer.len != n * Py_ssize_t(sizeof(double))) {
        PyErr_Format(PyExc_ValueError, "expected %zd numbers of float64", n);
        return false;
    }
    out = Eigen::Map<Vector<double> const>(view.data<double const>(), n);
    return true;
}

/// Without the interpreter's lock: about every 50 ms it is taken for a moment, so that a signal's handler runs. Throws
/// where one raised; Python's error is then set.
class Signals {
    using Clock = std::chrono::steady_clock;
    PyThreadState*& thread_;
    Clock::time_point next_ = Clock::now();

public:
    struct Raised : std::exception {};
    explicit Signals(PyThreadState*& thread) : thread_(thread) {}
    void look() {
        if (Clock::now() < next_) return;
        PyEval_RestoreThread(thread_);
        bool const raised = PyErr_CheckSignals() != 0;
        thread_ = PyEval_SaveThread();
        if (raised) throw Raised();
        next_ = Clock::now() + std::chrono::milliseconds(50);
    }
};

/// certified(Psi, y, n, d, forgetting, variance, theta0, P0, digits). variance 0: no prior; theta0, P0: or None.
PyObject* certified_of(PyObject*, PyObject* args) {
    PyObject *Psi, *y, *theta0, *P0;
    Py_ssize_t n, d;
    double forgetting, variance;
    int digits;
    if (!PyArg_ParseTuple(args, "OOnnddOOi", &Psi, &y, &n, &d, &forgetting, &variance, &theta0, &P0, &digits))
        return nullptr;
    std::unique_ptr<CertifiedSolution> found;
    std::exception_ptr thrown;
    try {
        Vector<double> rows, prior_theta, prior_covariance;
        Records data;
        if (!numbers(Psi, n * d, rows) || !numbers(y, n, data.y) || !numbers(theta0, d, prior_theta) ||
            !numbers(P0, d * d, prior_covariance))
            return nullptr;
        data.psi = Eigen::Map<Matrix<double> const>(rows.data(), d, n);
        Problem<double> problem{.size = d, .forgetting = forgetting, .prior = std::nullopt};
        if (variance > 0 || P0 != Py_None) {
            problem.prior = Prior<double>{};
            if (variance > 0) problem.prior->variance = variance;
            if (theta0 != Py_None) problem.prior->theta = prior_theta;
            if (P0 != Py_None)
                problem.prior->covariance = Eigen::Map<Matrix<double> const>(prior_covariance.data(), d, d);
        }
        // The numbers are copied: nothing of Python's is touched without its lock.
        PyThreadState* thread = PyEval_SaveThread();
        Signals signals(thread);
        bool raised = false;
        try {
            found = std::make_unique<CertifiedSolution>(
                certified(problem, data, {n}, digits, [&] { signals.look(); }).front());
        } catch (Signals::Raised const&) {
            raised = true;
        } catch (std::exception const&) {
            thrown = std::current_exception();
        }
        PyEval_RestoreThread(thread);
        if (raised) return nullptr;
    } catch (std::exception const&) {
        return raise(std::current_exception());
    }
    return thrown ? raise(thrown) : Held::make(solution_type, std::move(found));
}

/// x 2^exponent as (x, exponent), exactly.
PyObject* midpoint_of(arb_srcptr ball) {
    balls::Integer x, exponent;
    arf_get_fmpz_2exp(x, exponent, arb_midref(ball));
    std::unique_ptr<char, void (*)(void*)> const text(fmpz_get_str(nullptr, 16, x), flint_free);
    PyObject* const whole = PyLong_FromString(text.get(), nullptr, 16);
    return whole ? Py_BuildValue("(Nl)", whole, fmpz_get_si(exponent)) : nullptr;
}
template <balls::BallMatrix CertifiedSolution::Enclosure::*matrix>
PyObject* midpoints(PyObject* self, PyObject*) {
    return with<CertifiedSolution>(self, [](CertifiedSolution& solution) -> PyObject* {
        PyObject* const out = PyList_New(0);
        if (!out || !solution.enclosure()) return out;
        balls::BallMatrix const& A = solution.enclosure()->*matrix;
        for (Index i = 0; i < A.rows(); ++i)
            for (Index j = 0; j < A.cols(); ++j) {
                PyObject* const one = midpoint_of(A(i, j));
                bool const kept = one && PyList_Append(out, one) == 0;
                Py_XDECREF(one);
                if (kept) continue;
                Py_DECREF(out);
                return nullptr;
            }
        return out;
    });
}
PyObject* strings(PyObject* self, PyObject* digits) {
    int const wanted = int(PyLong_AsLong(digits));
    if (PyErr_Occurred()) return nullptr;
    return with<CertifiedSolution>(self, [&](CertifiedSolution& solution) -> PyObject* {
        std::vector<std::string> const texts = solution.theta_strings(wanted);
        PyObject* const out = PyTuple_New(Py_ssize_t(texts.size()));
        for (std::size_t i = 0; out && i < texts.size(); ++i)
            PyTuple_SetItem(out, Py_ssize_t(i), PyUnicode_FromString(texts[i].c_str()));
        return out;
    });
}
/// (digits in norm, digits of the worst component) of an estimate in float64.
PyObject* digits(PyObject* self, PyObject* estimate) {
    return with<CertifiedSolution>(self, [&](CertifiedSolution& solution) -> PyObject* {
        Vector<double> theta;
        if (!numbers(estimate, solution.size(), theta)) return nullptr;
        Vector<Reference> const exact = theta.cast<Reference>();
        return Py_BuildValue("(dd)", solution.theta_digits(exact), solution.theta_digits_worst(exact));
    });
}
/// (status, rank, bits, radius, radius of P).
PyObject* proven(PyObject* self, PyObject*) {
    return with<CertifiedSolution>(self, [](CertifiedSolution& solution) {
        return Py_BuildValue("(snidd)", name_of(solution.status()).data(), Py_ssize_t(solution.rank()), solution.bits(),
                             solution.radius(), solution.covariance_radius());
    });
}

PyMethodDef methods[] = {{"theta", midpoints<&CertifiedSolution::Enclosure::theta>, METH_NOARGS, nullptr},
                         {"covariance", midpoints<&CertifiedSolution::Enclosure::covariance>, METH_NOARGS, nullptr},
                         {"strings", strings, METH_O, nullptr},
                         {"digits", digits, METH_O, nullptr},
                         {"proven", proven, METH_NOARGS, nullptr},
                         {nullptr, nullptr, 0, nullptr}};
PyType_Slot slots[] = {{Py_tp_dealloc, reinterpret_cast<void*>(Held::drop)}, {Py_tp_methods, methods}, {0, nullptr}};
PyType_Spec spec{"rlslab._reference.Solution", sizeof(Held), 0, Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION,
                 slots};

PyMethodDef functions[] = {{"certified", certified_of, METH_VARARGS, nullptr}, {nullptr, nullptr, 0, nullptr}};
PyModuleDef definition{
    PyModuleDef_HEAD_INIT, "rlslab._reference", nullptr, -1, functions, nullptr, nullptr, nullptr, nullptr};

}  // namespace
}  // namespace rlslab::python

extern "C" [[gnu::visibility("default")]] PyObject* PyInit__reference();

PyObject* PyInit__reference() {
    using namespace rlslab::python;
    PyObject* const module = PyModule_Create(&definition);
    PyObject* const type = PyType_FromSpec(&spec);  // kept for ever: one reference is the extension's
    solution_type = reinterpret_cast<PyTypeObject*>(type);
    if (module && type && PyModule_AddObjectRef(module, "Solution", type) == 0) return module;
    Py_XDECREF(module);
    return nullptr;
}
