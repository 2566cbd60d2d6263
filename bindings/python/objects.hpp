// What the extension's types share: arrays by the buffer protocol, errors of C++ as Python's, an object that holds a
// native one. Python's limited interface of 3.11; numpy's headers are not needed.
#pragma once

#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <string_view>

namespace rlslab::python {

/// A view of an object's memory, released at the end of its scope. The interpreter's lock must be held then: not across
/// `without_lock`.
struct View {
    Py_buffer buffer{};

    View() = default;
    View(View const&) = delete;
    View& operator=(View const&) = delete;
    ~View() { release(); }
    void release() {
        if (buffer.obj) PyBuffer_Release(&buffer);
    }
    /// False, with Python's error set, where the object has no such view.
    bool of(PyObject* object, int flags = PyBUF_RECORDS_RO) { return PyObject_GetBuffer(object, &buffer, flags) == 0; }

    /// 'd' or 'f' for numbers of binary64 or binary32 in this machine's order of bytes, else 0.
    char kind() const {
        char const* format = buffer.format;
        if (!format) return 0;
        char const own = std::endian::native == std::endian::little ? '<' : '>';
        if (*format == '@' || *format == '=' || *format == own) ++format;
        return (*format == 'd' || *format == 'f') && format[1] == 0 ? *format : char(0);
    }
    bool aligned() const {
        auto const unit = std::uintptr_t(buffer.itemsize);
        bool out = reinterpret_cast<std::uintptr_t>(buffer.buf) % unit == 0;
        for (int i = 0; i < buffer.ndim; ++i) out = out && buffer.strides[i] % buffer.itemsize == 0;
        return out;
    }
    /// Whether it is n numbers one after another.
    bool is_vector(Py_ssize_t n) const {
        return kind() && buffer.ndim == 1 && buffer.shape[0] == n && aligned() &&
               (n < 2 || buffer.strides[0] == buffer.itemsize);
    }
    /// Whether it is rows of n numbers, each one after another, and the rows in order.
    bool is_rows(Py_ssize_t n) const {
        return kind() && buffer.ndim == 2 && buffer.shape[1] == n && aligned() &&
               (n < 2 || buffer.strides[1] == buffer.itemsize) &&
               (buffer.shape[0] < 2 || buffer.strides[0] >= n * buffer.itemsize);
    }
    /// Numbers from one of them to the next.
    Py_ssize_t row_stride() const {
        return buffer.shape[0] > 1 ? buffer.strides[0] / buffer.itemsize : buffer.shape[1];
    }
    template <class X>
    X* data() const {
        return static_cast<X*>(buffer.buf);
    }
};

/// Room for n doubles that a function writes into; false with Python's error set for anything else.
inline bool view_of_output(View& view, PyObject* object, Py_ssize_t n) {
    if (!view.of(object, PyBUF_CONTIG | PyBUF_FORMAT)) return false;
    if (view.kind() == 'd' && view.buffer.len == n * Py_ssize_t(sizeof(double))) return true;
    PyErr_Format(PyExc_ValueError, "expected room for %zd numbers of float64", n);
    return false;
}

/// Sets Python's error for an exception of C++. Returns null. Callers catch std::exception and nothing else: where the
/// interpreter ends, other threads are unwound by what must not be caught.
inline PyObject* raise(std::exception_ptr const& thrown) {
    try {
        std::rethrow_exception(thrown);
    } catch (std::invalid_argument const& e) {
        PyErr_SetString(PyExc_ValueError, e.what());
    } catch (std::bad_alloc const&) {
        PyErr_SetString(PyExc_MemoryError, "not enough memory for a filter of this size");
    } catch (std::length_error const&) {
        PyErr_SetString(PyExc_MemoryError, "not enough memory for a filter of this size");
    } catch (std::exception const& e) {
        PyErr_SetString(PyExc_RuntimeError, e.what());
    }
    return nullptr;
}

/// A Python object that owns a native one. `busy`: a call without the interpreter's lock is using it. In a child of
/// `fork` it may stay so: an error, where waiting would be for ever.
template <class Native>
struct Holder {
    PyObject head;
    Native* native;
    bool busy;

    static Holder* of(PyObject* self) { return reinterpret_cast<Holder*>(self); }
    /// A new object of the type, which takes the native one; null with Python's error set.
    static PyObject* make(PyTypeObject* type, std::unique_ptr<Native> native) {
        PyObject* const self = PyType_GenericAlloc(type, 0);
        if (self) of(self)->native = native.release();
        return self;
    }
    static void drop(PyObject* self) {
        PyTypeObject* const type = Py_TYPE(self);
        delete of(self)->native;
        reinterpret_cast<freefunc>(PyType_GetSlot(type, Py_tp_free))(self);
        Py_DECREF(type);
    }
};
/// The native object of self; null with Python's error set while another thread uses it.
template <class Native>
Native* native_of(PyObject* self) {
    auto* const holder = Holder<Native>::of(self);
    if (!holder->busy) return holder->native;
    PyErr_SetString(PyExc_RuntimeError, "in use by another thread: threads take turns at one filter, or copy it");
    return nullptr;
}
/// call(native), whose exceptions become Python's errors. Returns what it returns, a PyObject*.
template <class Native, class Call>
PyObject* with(PyObject* self, Call&& call) {
    Native* const native = native_of<Native>(self);
    if (!native) return nullptr;
    try {
        return call(*native);
    } catch (std::exception const&) {
        return raise(std::current_exception());
    }
}
/// Methods of a filter and of a fleet: the state as bytes, from bytes, a copy of the object.
template <class Native>
PyObject* state(PyObject* self, PyObject*) {
    return with<Native>(self, [](Native& native) -> PyObject* {
        std::size_t const size = native.state_size();
        PyObject* const out = PyBytes_FromStringAndSize(nullptr, Py_ssize_t(size));
        if (!out) return nullptr;
        try {
            native.save({reinterpret_cast<std::byte*>(PyBytes_AsString(out)), size});
        } catch (std::exception const&) {
            Py_DECREF(out);
            throw;
        }
        return out;
    });
}
template <class Native>
PyObject* load(PyObject* self, PyObject* bytes) {
    View view;
    if (!view.of(bytes, PyBUF_SIMPLE)) return nullptr;
    return with<Native>(self, [&](Native& native) {
        native.load({view.data<std::byte const>(), std::size_t(view.buffer.len)});
        return Py_NewRef(Py_None);
    });
}
template <class Native>
PyObject* clone(PyObject* self, PyObject*) {
    return with<Native>(self, [&](Native& native) { return Holder<Native>::make(Py_TYPE(self), native.clone()); });
}
/// Of a filter and of several outputs: as it was made. Of all: a number, and a name.
template <class Native>
PyObject* reset(PyObject* self, PyObject*) {
    return with<Native>(self, [](Native& native) {
        native.reset();
        return Py_NewRef(Py_None);
    });
}
template <class Native>
PyObject* size(PyObject* self, void*) {
    return PyLong_FromSsize_t(Holder<Native>::of(self)->native->size());
}
template <class Native, auto name>
PyObject* text(PyObject* self, void*) {
    std::string_view const out = (Holder<Native>::of(self)->native->*name)();
    return PyUnicode_FromStringAndSize(out.data(), Py_ssize_t(out.size()));
}
/// call(native) without the interpreter's lock; false with Python's error set where it threw. Where the interpreter
/// ends meanwhile, this does not return: the thread is unwound, so that nothing with a destructor that needs the lock
/// may stand in the caller.
template <class Native, class Call>
bool without_lock(PyObject* self, Call&& call) {
    auto* const holder = Holder<Native>::of(self);
    std::exception_ptr thrown;
    holder->busy = true;
    PyThreadState* const thread = PyEval_SaveThread();
    try {
        call(*holder->native);
    } catch (std::exception const&) {
        thrown = std::current_exception();
    }
    PyEval_RestoreThread(thread);
    holder->busy = false;
    if (thrown) raise(thrown);
    return !thrown;
}

/// A function of positional arguments as Python's table of methods has it.
template <class Function>
PyCFunction as_method(Function* function) {
    return reinterpret_cast<PyCFunction>(reinterpret_cast<void*>(function));
}
/// False with Python's error set unless there are n arguments.
inline bool takes(char const* what, Py_ssize_t n, Py_ssize_t given) {
    if (given == n) return true;
    PyErr_Format(PyExc_TypeError, "%s takes %zd arguments, not %zd", what, n, given);
    return false;
}

/// A type of the module whose objects hold a Native; null with Python's error set.
template <class Native>
PyObject* type_of(char const* name, newfunc make, PyMethodDef* methods, PyGetSetDef* members) {
    PyType_Slot slots[] = {{Py_tp_new, reinterpret_cast<void*>(make)},
                           {Py_tp_dealloc, reinterpret_cast<void*>(Holder<Native>::drop)},
                           {Py_tp_methods, methods},
                           {Py_tp_getset, members},
                           {0, nullptr}};
    PyType_Spec spec{name, sizeof(Holder<Native>), 0, Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE, slots};
    return PyType_FromSpec(&spec);
}
/// The rows of `newer`, an object of `type`, behind those of self, without the lock; `otherwise`: what is said of
/// another object.
template <class Native>
PyObject* merged(PyObject* self, PyObject* newer, PyTypeObject* type, char const* otherwise) {
    if (!PyObject_TypeCheck(newer, type)) {
        PyErr_SetString(PyExc_TypeError, otherwise);
        return nullptr;
    }
    if (!native_of<Native>(self) || !native_of<Native>(newer)) return nullptr;
    auto* const part = Holder<Native>::of(newer);
    part->busy = true;
    bool const ok = without_lock<Native>(self, [&](Native& native) { native.merge(*part->native); });
    part->busy = false;
    return ok ? Py_NewRef(Py_None) : nullptr;
}

/// The types of the module; each returns a new reference, or null with Python's error set.
PyObject* filter_type();
PyObject* fleet_type();
PyObject* outputs_type();
PyObject* step_type();
PyObject* counts_type();
/// (X, y, groups or None, window, forgetting, min_periods, arrays or None in the order of rlslab::Rolled).
PyObject* rolling(PyObject*, PyObject* args);
/// Whoever makes rows of what is not an array or a list: called with (psi, d), returns an array of d numbers.
extern PyObject* row_of;
/// Likewise of what is not one of these types: called with y, returns a float.
extern PyObject* output_of;
/// numpy's real scalars, a tuple.
extern PyObject* scalars;
/// numpy.ndarray.
extern PyObject* ndarray;

}  // namespace rlslab::python
