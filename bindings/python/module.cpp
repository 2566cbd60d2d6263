// rlslab._core: the module of the extension. What people call is the package around it (bindings/python/rlslab).
#include "bindings/python/make.hpp"

#include <rlslab/catalogue/native/outputs.hpp>
#include <rlslab/core/files.hpp>

#include <cerrno>

namespace rlslab::python {
namespace {

PyObject* names(std::span<std::string_view const> list) {
    PyObject* const out = PyTuple_New(Py_ssize_t(list.size()));
    for (std::size_t i = 0; out && i < list.size(); ++i)
        PyTuple_SetItem(out, Py_ssize_t(i), PyUnicode_FromStringAndSize(list[i].data(), Py_ssize_t(list[i].size())));
    return out;
}
template <std::span<std::string_view const> (*list)()>
PyObject* names_of(PyObject*, PyObject*) {
    return names(list());
}
template <std::string_view (*name)(std::int32_t), int n>
PyObject* words(PyObject*, PyObject*) {
    std::string_view list[n];
    for (int i = 0; i < n; ++i) list[i] = name(i);
    return names(list);
}
/// (numpy.ndarray, scalars, row_of, output_of): what the package brings.
PyObject* use(PyObject*, PyObject* args) {
    PyObject** const kept[] = {&ndarray, &scalars, &row_of, &output_of};
    PyObject* given[4];
    if (!PyArg_ParseTuple(args, "OOOO", &given[0], &given[1], &given[2], &given[3])) return nullptr;
    for (int i = 0; i < 4; ++i) *kept[i] = Py_NewRef(given[i]);
    Py_RETURN_NONE;
}
/// (path, bytes): as C++ saves a state. OSError where it cannot.
PyObject* save(PyObject*, PyObject* args) {
    PyObject *path, *name = nullptr;
    char const* text;
    Py_ssize_t size;
    if (!PyArg_ParseTuple(args, "Oy#", &path, &text, &size) || !PyUnicode_FSConverter(path, &name)) return nullptr;
    int error = 0;
    PyThreadState* const thread = PyEval_SaveThread();  // a pipe waits for its reader
    try {
        replace_file(PyBytes_AsString(name), {text, std::size_t(size)});
    } catch (FileError const& e) {
        error = e.error;
    } catch (std::exception const&) {
        error = ENOMEM;
    }
    PyEval_RestoreThread(thread);
    Py_DECREF(name);
    if (!error) Py_RETURN_NONE;
    errno = error;
    return PyErr_SetFromErrnoWithFilenameObject(PyExc_OSError, path);
}
/// (variant, arithmetic, size, window, guard, control, its numbers, the guard's four numbers, noise_memory,
/// rebuild_rows, certify, outputs or 0) of the filter that a state is of; NaN: a default.
PyObject* saved(PyObject*, PyObject* bytes) {
    View view;
    if (!view.of(bytes, PyBUF_SIMPLE)) return nullptr;
    native::Saved found;
    try {
        found = native::saved({view.data<std::byte const>(), std::size_t(view.buffer.len)});
    } catch (std::exception const&) {
        return raise(std::current_exception());
    }
    auto const text = [](std::string_view name) {
        return PyUnicode_FromStringAndSize(name.data(), Py_ssize_t(name.size()));
    };
    native::Options const& o = found.options;
    PyObject* const numbers = PyTuple_New(Py_ssize_t(found.control_numbers.size()));
    for (std::size_t i = 0; numbers && i < found.control_numbers.size(); ++i)
        PyTuple_SetItem(numbers, Py_ssize_t(i), PyFloat_FromDouble(found.control_numbers[i]));
    return Py_BuildValue("(NNnnNNN(dddd)nnnn)", text(found.variant), text(found.arithmetic), o.size, o.window,
                         text(o.guard), text(o.control), numbers, o.largest_variance, o.innovation, o.least_noise,
                         o.asymmetry, o.noise_memory, o.rebuild_rows, o.certify, found.outputs);
}
PyObject* use_threads(PyObject*, PyObject* number) {
    Py_ssize_t const threads = PyLong_AsSsize_t(number);
    if (threads == -1 && PyErr_Occurred()) return nullptr;
    try {
        native::use_threads(threads);
    } catch (std::exception const&) {
        return raise(std::current_exception());
    }
    Py_RETURN_NONE;
}

PyMethodDef functions[] = {
    {"variants", names_of<native::variants>, METH_NOARGS,
     "variants()\n--\n\nThe names of the dense variants, in the order of the library's list.\n\n"
     ">>> len(rlslab.variants())\n18"},
    {"arithmetics", names_of<native::arithmetics>, METH_NOARGS, nullptr},
    {"guards", names_of<native::guards>, METH_NOARGS,
     "guards()\n--\n\nThe policies of guards, for `guard=`.\n\n>>> \"reset\" in rlslab.guards()\nTrue"},
    {"controls", names_of<native::controls>, METH_NOARGS,
     "controls()\n--\n\nThe rules of forgetting, for `control=`.\n\n>>> \"fortescue\" in rlslab.controls()\nTrue"},
    {"healths", words<native::name_of_health, 4>, METH_NOARGS, nullptr},
    {"signals", words<native::name_of_signal, 6>, METH_NOARGS, nullptr},
    {"saved", saved, METH_O, nullptr},
    {"save", save, METH_VARARGS, nullptr},
    {"use_threads", use_threads, METH_O,
     "use_threads(threads, /)\n--\n\nFrom now on so many threads, 1 to 1024, share the work on a block of rows of "
     "`rlslab.Outputs`, in all of\nthem, and the groups and windows of `rolling`; 1 at the start. The bits are the "
     "same. A block at work keeps its\nthreads.\n\n"
     ">>> rlslab.use_threads(1)"},
    {"use", use, METH_VARARGS, nullptr},
    {"rolling", rolling, METH_VARARGS, nullptr},
    {nullptr, nullptr, 0, nullptr}};
PyModuleDef definition{
    PyModuleDef_HEAD_INIT, "rlslab._core", nullptr, -1, functions, nullptr, nullptr, nullptr, nullptr};

}  // namespace
}  // namespace rlslab::python

extern "C" [[gnu::visibility("default")]] PyObject* PyInit__core();

PyObject* PyInit__core() {
    using namespace rlslab::python;
    PyObject* const module = PyModule_Create(&definition);
    if (!module) return nullptr;
    bool ok = true;
    struct Type {
        char const* name;
        PyObject* (*make)();
    };
    for (Type const type : {Type{"Filter", filter_type},
                            {"Fleet", fleet_type},
                            {"Outputs", outputs_type},
                            {"Step", step_type},
                            {"Counts", counts_type}}) {
        PyObject* const made = type.make();  // kept for ever: one reference is the extension's
        ok = ok && made && PyModule_AddObjectRef(module, type.name, made) == 0;
    }
    if (ok) return module;
    Py_DECREF(module);
    return nullptr;
}
