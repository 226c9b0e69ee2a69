// A build without LibTorch has no networks: its functions say so.
#include "networks.h"
#include "python.h"

namespace canonpose::python {
namespace {

[[noreturn]] void ThrowWithoutTorch(const std::string& what) {
  ThrowInvalidArgument(
      "{} needs networks, and this canonpose was built without LibTorch; build it with CANONPOSE_WITH_TORCH=ON", what);
}

}  // namespace

EvaluationReport EvaluateModel(const std::filesystem::path&, const std::string&, const DatasetEvaluation&) {
  ThrowWithoutTorch("evaluating a model");
}

void AddNetworks(py::module_& module) {
  for (const char* const name : {"open_model", "lift", "train"}) {
    module.def(name, [name](const py::args&, const py::kwargs&) { ThrowWithoutTorch(name); });
  }
}

}  // namespace canonpose::python
