// What the sources of the Python module share.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "canonpose/base/error.h"

namespace canonpose::python {

namespace py = pybind11;

using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// An array over `values`, without a copy; `owner` lives as long as it. None where there are no values.
template <typename T>
py::object View(std::vector<T>& values, std::vector<py::ssize_t> shape, const py::object& owner) {
  if (values.empty()) return py::none();
  return py::array_t<T>(std::move(shape), values.data(), owner);
}

/// Throws Error(kInvalidArgument) where an array has another shape; -1 is any length.
void RequireShape(const py::array& array, const std::vector<py::ssize_t>& shape, const std::string& name);

template <typename T>
std::vector<T> Values(const py::array_t<T, py::array::c_style | py::array::forcecast>& array) {
  return {array.data(), array.data() + array.size()};
}

/// What a caller of long work may give.
struct Watcher {
  py::object progress;  ///< called with (label, done, total, detail); None: nothing
};

/// Runs `work` without the interpreter's lock. Messages go to the logger "canonpose", progress to the watcher; Ctrl-C
/// and what the watcher raises stop the work and are raised when it has ended.
void Run(const Watcher& watcher, const std::function<void()>& work);

template <typename Work>
auto Result(const Watcher& watcher, Work&& work) {
  std::optional<decltype(work())> result;
  Run(watcher, [&] { result.emplace(work()); });
  return std::move(*result);
}

void AddErrors(py::module_& module);
void AddData(py::module_& module);
void AddScenes(py::module_& module);
void AddJobs(py::module_& module);
void AddNetworks(py::module_& module);
void AddExport(py::module_& module);

}  // namespace canonpose::python
