// Arguments that are files or datasets in memory.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "python.h"

#include "canonpose/data/dataset.h"

namespace canonpose::python {

using DataArgument = std::variant<std::shared_ptr<Dataset>, std::filesystem::path>;
/// One, or several.
using DataArguments = std::variant<DataArgument, std::vector<DataArgument>>;

std::vector<DataArgument> AsList(const DataArguments& data);

struct NamedDatasets {
  std::vector<Dataset> datasets;
  std::vector<std::string> files;  ///< their names, "dataset 1" for one in memory
};

/// Reads and copies them. Keeps only `frames`, "A-B", unless it is empty.
NamedDatasets ReadAll(const std::vector<DataArgument>& data, const std::string& frames);

/// json.loads(text).
py::object FromJson(const std::string& text);

}  // namespace canonpose::python
