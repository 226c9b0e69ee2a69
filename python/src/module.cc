// canonpose._core: what the package canonpose consists of.
#include "python.h"

#include "canonpose/base/version.h"

PYBIND11_MODULE(_core, module) {
  module.doc() = "3D human pose from several uncalibrated cameras.";
  module.attr("__version__") = canonpose::ProgramVersion();
  canonpose::python::AddErrors(module);
  canonpose::python::AddData(module);
  canonpose::python::AddScenes(module);
  canonpose::python::AddJobs(module);
  canonpose::python::AddNetworks(module);
  canonpose::python::AddExport(module);
}
