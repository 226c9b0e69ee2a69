// canonpose.Error and its kinds.
#include "python.h"

namespace canonpose::python {
namespace {

struct Kinds {
  PyObject* error;
  PyObject* invalid_argument;
  PyObject* bad_input;
  PyObject* computation;
  PyObject* stopped;
};
Kinds kinds;  // they live as long as the interpreter

PyObject* AddError(py::module_& module, const std::string& name, const char* doc, const py::object& bases) {
  PyObject* const error = PyErr_NewExceptionWithDoc(("canonpose." + name).c_str(), doc, bases.ptr(), nullptr);
  if (error == nullptr) throw py::error_already_set();
  module.attr(name.c_str()) = py::handle(error);
  return error;
}

PyObject* OfKind(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kInvalidArgument:
      return kinds.invalid_argument;
    case ErrorKind::kBadInput:
      return kinds.bad_input;
    case ErrorKind::kComputation:
      return kinds.computation;
    case ErrorKind::kStopped:
      return kinds.stopped;
  }
  return kinds.error;
}

}  // namespace

void AddErrors(py::module_& module) {
  const auto base = py::reinterpret_borrow<py::object>(PyExc_RuntimeError);
  kinds.error = AddError(module, "Error", "A failure that the caller can do something about, said in one line.", base);
  const auto error = py::reinterpret_borrow<py::object>(kinds.error);
  const py::tuple value_error = py::make_tuple(error, py::reinterpret_borrow<py::object>(PyExc_ValueError));
  kinds.invalid_argument =
      AddError(module, "InvalidArgument", "An argument, or several together, make no sense.", value_error);
  kinds.bad_input = AddError(module, "BadInput", "A file is not as it should be, or cannot be read or written.", error);
  kinds.computation =
      AddError(module, "ComputationFailed", "The computation failed: it diverged, there are too few views, ...", error);
  kinds.stopped = AddError(module, "Stopped", "Work that cannot be continued later was stopped.", error);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& e) {
      PyErr_SetString(OfKind(e.kind()), e.what());
    }
  });
}

void RequireShape(const py::array& array, const std::vector<py::ssize_t>& shape, const std::string& name) {
  bool fits = array.ndim() == static_cast<py::ssize_t>(shape.size());
  std::string expected;
  std::string found;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    if (fits && shape[i] >= 0 && array.shape(static_cast<py::ssize_t>(i)) != shape[i]) fits = false;
    expected += (i > 0 ? ", " : "") + (shape[i] < 0 ? "any" : std::to_string(shape[i]));
  }
  for (py::ssize_t i = 0; i < array.ndim(); ++i) found += (i > 0 ? ", " : "") + std::to_string(array.shape(i));
  if (!fits) ThrowInvalidArgument("`{}`: expected an array of shape ({}), found ({})", name, expected, found);
}

}  // namespace canonpose::python
