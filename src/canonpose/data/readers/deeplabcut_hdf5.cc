// Tables that pandas wrote to HDF5 by way of PyTables: format="table" (one array of records, the columns' names in a
// pickled attribute) and format="fixed" (levels and codes of the columns' names, and a block of values).
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/hdf5.h"
#include "canonpose/data/codecs/pickle.h"
#include "canonpose/data/readers/deeplabcut.h"

namespace canonpose::deeplabcut {
namespace {

constexpr const char* kAdvice =
    "give the h5 file that DeepLabCut writes for a video, or its csv (DeepLabCut's save_as_csv)";

/// Values that are no numbers would not be in the first block.
constexpr const char* kSeveralBlocks = "several blocks of values: save it as csv";

/// (columns) the names of a table's columns, from the pickled [(1, [(scorer, body part, coordinate), ...])].
std::vector<std::vector<std::string>> PickledHeader(const h5::Group& group) {
  const std::string bytes = group.GetString("non_index_axes");
  const pickle::Value columns = pickle::Decode(bytes, group.file(), group.path() + " non_index_axes").At(0).At(1);
  std::vector<std::vector<std::string>> header;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const pickle::Value names = columns.At(i);
    header.emplace_back();
    for (std::size_t n = 0; n < names.size(); ++n) header.back().push_back(names.At(n).Text());
  }
  return header;
}

Table ReadTableForm(const h5::Group& group) {
  Table table;
  table.header = PickledHeader(group);
  const h5::Array<double> index = group.ReadField("table", "index");
  h5::Array<double> values = group.ReadField("table", "values_block_0");
  if (values.shape.size() != 2 || values.shape[1] != table.header.size()) {
    group.Fail("table", fmt::format("{} values in each row", table.header.size()), kSeveralBlocks, kAdvice);
  }
  for (const double number : index.values) {
    if (!(std::abs(number) < 1e15) || number != std::trunc(number))
      group.Fail("table", "whole numbers as index", fmt::format("{}", number), kAdvice);
    table.frames.push_back(fmt::format("{:.0f}", number));
  }
  table.values = std::move(values.values);
  return table;
}

/// (N) the texts of one level of an axis with several: LEVEL[LABEL[i]].
std::vector<std::string> LevelTexts(const h5::Group& group, const std::string& axis, int level) {
  const std::string name = fmt::format("{}_level{}", axis, level);
  const std::vector<std::string> names = group.ReadTexts(name);
  const std::string label = fmt::format("{}_label{}", axis, level);
  std::vector<std::string> texts;
  for (const std::int64_t code : group.Read<std::int64_t>(label).values) {
    if (code < 0 || code >= std::ssize(names)) {
      group.Fail(label, fmt::format("numbers of the {} names in {}", names.size(), name), fmt::format("{}", code),
                 "the file is damaged: make it again");
    }
    texts.push_back(names[static_cast<std::size_t>(code)]);
  }
  return texts;
}

/// The index of the rows: numbers, names of images, or folder, video and image in three levels.
std::vector<std::string> FixedIndex(const h5::Group& group) {
  if (group.HasAttribute("axis1_nlevels")) {
    return LevelTexts(group, "axis1",
                      static_cast<int>(std::clamp<std::int64_t>(group.GetInt("axis1_nlevels"), 1, 9)) - 1);
  }
  try {
    std::vector<std::string> frames;
    for (const std::int64_t number : group.Read<std::int64_t>("axis1").values)
      frames.push_back(fmt::format("{}", number));
    return frames;
  } catch (const Error&) {
    return group.ReadTexts("axis1");
  }
}

Table ReadFixedForm(const h5::Group& group) {
  constexpr int kMostLevels = 4;
  const std::int64_t levels = group.HasAttribute("axis0_nlevels") ? group.GetInt("axis0_nlevels") : 1;
  if (levels < 2 || levels > kMostLevels) {
    group.Fail("axis0", "columns named by scorer, body part and coordinate",
               fmt::format("{} level(s) of names", levels), kAdvice);
  }
  if (group.GetInt("nblocks") != 1) group.Fail("", "one block of values", kSeveralBlocks, kAdvice);
  Table table;
  for (int level = 0; level < levels; ++level) {
    const std::vector<std::string> texts = LevelTexts(group, "block0_items", level);
    if (level == 0) table.header.resize(texts.size());
    if (texts.size() != table.header.size()) {
      group.Fail(fmt::format("block0_items_label{}", level), fmt::format("{} values", table.header.size()),
                 fmt::format("{}", texts.size()), "the file is damaged: make it again");
    }
    for (std::size_t i = 0; i < texts.size(); ++i) table.header[i].push_back(texts[i]);
  }
  table.frames = FixedIndex(group);
  h5::Array<double> values = group.Read<double>("block0_values");
  if (values.shape != std::vector<std::size_t>{table.frames.size(), table.header.size()}) {
    group.Fail("block0_values", h5::FormatShape({table.frames.size(), table.header.size()}),
               h5::FormatShape(values.shape), "the file is damaged: make it again");
  }
  table.values = std::move(values.values);
  return table;
}

}  // namespace

Table ReadHdf5(const std::filesystem::path& path) {
  const h5::File file = h5::File::OpenForReading(path);
  const std::vector<std::string> groups = file.root().Children();
  const bool is_pandas = groups.size() == 1 && [&] {
    try {
      return file.root().Open(groups.front()).HasAttribute("pandas_type");
    } catch (const Error&) {
      return false;  // not a group
    }
  }();
  if (!is_pandas) {
    ThrowBadInput({path.string(), "", "DeepLabCut's table, as pandas writes it",
                   groups.empty() ? "an empty file" : fmt::format("{} and {} more", groups.front(), groups.size() - 1),
                   kAdvice});
  }
  const h5::Group group = file.root().Open(groups.front());
  Table table = group.Has("table") ? ReadTableForm(group) : ReadFixedForm(group);
  if (table.header.empty() || table.header.front().size() < 3) {
    group.Fail("", "columns named by scorer, body part and coordinate", "other columns", kAdvice);
  }
  const std::size_t levels = table.header.front().size();
  const bool is_even =
      std::all_of(table.header.begin(), table.header.end(), [&](const auto& names) { return names.size() == levels; });
  if (!is_even || levels > 4 || table.values.size() != table.frames.size() * table.header.size()) {
    group.Fail("", "the same levels of names for every column, and a value for each row and column", "others", kAdvice);
  }
  for (std::size_t row = 0; row < table.frames.size(); ++row) table.places.push_back(fmt::format("row {}", row));
  for (double& value : table.values) {
    if (!std::isfinite(value) || std::abs(value) > 1e9) value = NAN;
  }
  return table;
}

}  // namespace canonpose::deeplabcut
