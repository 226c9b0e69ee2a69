#include "canonpose/data/readers/deeplabcut.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/hdf5.h"
#include "canonpose/base/log.h"
#include "canonpose/base/names.h"
#include "canonpose/data/codecs/csv.h"
#include "canonpose/data/readers/camera_files.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

using deeplabcut::Table;

constexpr const char* kDeepLabCutAdvice =
    "give the csv or h5 file that DeepLabCut writes for a video, with rows for scorer, bodyparts and coords at its top";

/// The first cell of each row of the header, in order. Row 2 is there where there are several animals.
constexpr const char* kIndividuals = "individuals";

bool IsHdf5Name(const fs::path& file) {
  const std::string extension = LowerCase(file.extension().string());
  return extension == ".h5" || extension == ".hdf5";
}

/// How many rows of the csv are its header; 0 where it has none.
std::size_t HeaderRows(const std::vector<CsvRow>& rows) {
  std::vector<std::string> names{"scorer", "bodyparts", "coords"};
  if (rows.size() > 1 && SameName(rows[1].cells.front(), kIndividuals)) names.insert(names.begin() + 1, kIndividuals);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i >= rows.size() || !SameName(rows[i].cells.front(), names[i])) return 0;
  }
  return names.size();
}

Table ReadTableOfText(const fs::path& path) {
  const std::string file = path.string();
  const std::vector<CsvRow> rows = ReadCsv(path);
  const std::size_t header_rows = HeaderRows(rows);
  if (header_rows == 0) {
    std::vector<std::string> cells = rows.front().cells;
    if (cells.size() > 4) cells.resize(4);
    ThrowBadInput({file, rows.front().place(), "DeepLabCut's header: scorer, bodyparts, coords",
                   "\"" + fmt::format("{}", fmt::join(cells, ",")).substr(0, 80) + "\"", kDeepLabCutAdvice});
  }
  // Labelled images have an index of three columns; only the first has a name.
  const CsvRow& coords = rows[header_rows - 1];
  std::size_t first = 1;
  while (first < coords.cells.size() && coords.cells[first].empty()) ++first;
  const std::size_t end = coords.cells.size();
  Table table;
  for (std::size_t column = first; column < end; ++column) {
    table.header.emplace_back();
    for (std::size_t i = 0; i < header_rows; ++i) {
      if (column >= rows[i].cells.size()) {
        ThrowBadInput({file, rows[i].place(), fmt::format("{} cells as in {}", end, coords.place()),
                       fmt::format("{}", rows[i].cells.size()), "the header is damaged; export the file again"});
      }
      table.header.back().push_back(rows[i].cells[column]);
    }
  }
  for (std::size_t i = header_rows; i < rows.size(); ++i) {
    if (rows[i].cells.size() != end) {
      ThrowBadInput({file, rows[i].place(), fmt::format("{} cells as in the header", end),
                     fmt::format("{}", rows[i].cells.size()), "the file is cut short or damaged; export it again"});
    }
    table.frames.push_back(rows[i].cells[first - 1]);
    table.places.push_back(rows[i].place());
    for (std::size_t column = first; column < end; ++column) table.values.push_back(CsvNumber(rows[i], column, file));
  }
  return table;
}

/// Where an individual's joint is in the table's columns.
struct JointColumns {
  std::optional<std::size_t> x;
  std::optional<std::size_t> y;
  std::optional<std::size_t> likelihood;
};

struct Individual {
  std::string name;
  std::vector<std::string> joints;
  std::vector<JointColumns> columns;
};

Individual& Named(std::vector<Individual>& individuals, const std::string& name) {
  const auto found = std::find_if(individuals.begin(), individuals.end(),
                                  [&](const Individual& individual) { return individual.name == name; });
  if (found != individuals.end()) return *found;
  individuals.push_back({name, {}, {}});
  return individuals.back();
}

std::vector<Individual> IndividualsOf(const Table& table, const std::string& file) {
  std::vector<Individual> individuals;
  std::map<std::pair<std::string, std::string>, std::size_t> places;
  for (std::size_t column = 0; column < table.header.size(); ++column) {
    const std::vector<std::string>& header = table.header[column];
    Individual& individual = Named(individuals, header.size() > 3 ? header[1] : "");
    const std::string& joint = header[header.size() - 2];
    const auto [place, is_new] = places.try_emplace({individual.name, joint}, individual.joints.size());
    if (is_new) {
      individual.joints.push_back(joint);
      individual.columns.emplace_back();
    }
    JointColumns& columns = individual.columns[place->second];
    std::optional<std::size_t>* const target = header.back() == "x"            ? &columns.x
                                               : header.back() == "y"          ? &columns.y
                                               : header.back() == "likelihood" ? &columns.likelihood
                                                                               : nullptr;
    if (target == nullptr || target->has_value()) {
      ThrowBadInput({file, fmt::format("column \"{}\"", fmt::join(header, ", ")),
                     "one x, y and likelihood of each body part",
                     target == nullptr ? "\"" + header.back() + "\"" : header.back() + " twice",
                     "3D results and other tables are not 2D keypoints"});
    }
    *target = column;
  }
  for (const Individual& individual : individuals) {
    for (std::size_t j = 0; j < individual.joints.size(); ++j) {
      if (individual.columns[j].x && individual.columns[j].y) continue;
      ThrowBadInput(
          {file, "", fmt::format("x and y of {}", individual.joints[j]), "only one of them", kDeepLabCutAdvice});
    }
  }
  return individuals;
}

/// Leaves out individuals that do not have the body parts of the first one that has several.
void KeepOneKind(std::vector<Individual>& individuals, const std::string& camera) {
  const auto first =
      std::max_element(individuals.begin(), individuals.end(),
                       [](const Individual& a, const Individual& b) { return a.joints.size() < b.joints.size(); });
  const std::vector<std::string> joints = first->joints;
  std::vector<std::string> left_out;
  for (const Individual& individual : individuals) {
    if (individual.joints != joints)
      left_out.push_back(fmt::format("{} ({})", individual.name, fmt::join(individual.joints, ", ")));
  }
  std::erase_if(individuals, [&](const Individual& individual) { return individual.joints != joints; });
  if (left_out.empty()) return;
  LogInfo("{}: individuals with other body parts are left out: {}", camera, fmt::join(left_out, "; "));
}

/// The frame of a row: its number, or the number in the name of its image.
DetectedFrame& FrameOf(CameraBuilder& builder, const Table& table, std::size_t row, const std::string& file) {
  const std::string& frame = table.frames[row];
  const std::string& place = table.places[row];
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(frame.data(), frame.data() + frame.size(), number);
  // The place serves as the frame's name, so that two rows with one number are noticed.
  if (error == std::errc() && end == frame.data() + frame.size()) return builder.Frame(number, place, file, place);
  return builder.Frame(fs::path(frame).filename().string(), file, place);
}

void AddRow(const Table& table, std::size_t row, const std::vector<Individual>& individuals, CameraBuilder& builder,
            const std::string& file) {
  DetectedFrame& frame = FrameOf(builder, table, row, file);
  const double* const values = table.values.data() + row * table.header.size();
  for (std::size_t i = 0; i < individuals.size(); ++i) {
    std::vector<double> triples;
    for (const JointColumns& columns : individuals[i].columns) {
      const double likelihood = columns.likelihood ? values[*columns.likelihood] : 1.0;
      triples.insert(triples.end(), {values[*columns.x], values[*columns.y], likelihood});
    }
    std::optional<DetectedPerson> person = PersonFromNamedTriples(triples);
    if (!person) continue;
    if (individuals.size() > 1) person->track_id = static_cast<std::int64_t>(i);
    builder.Add(frame, std::move(*person), file, table.places[row]);
  }
}

/// "cam1" for "cam1DLC_resnet50_reachMay1shuffle1_100000_filtered.csv".
std::string DeepLabCutVideo(const fs::path& file) {
  const std::string name = CameraNameOf(file);
  for (const char* const mark : {"DLC_", "DeepCut_"}) {
    const std::size_t at = name.find(mark);
    if (at != std::string::npos && at > 0) return name.substr(0, name[at - 1] == '_' && at > 1 ? at - 1 : at);
  }
  return name;
}

}  // namespace

bool IsDeepLabCutFile(const fs::path& file) {
  if (h5::File::IsHdf5(file)) {
    try {
      const h5::File opened = h5::File::OpenForReading(file);
      const std::vector<std::string> groups = opened.root().Children();
      return groups.size() == 1 && opened.root().Open(groups.front()).HasAttribute("pandas_type");
    } catch (const Error&) {
      return false;
    }
  }
  std::ifstream stream(file, std::ios::binary);
  std::string first(32, '\0');
  stream.read(first.data(), static_cast<std::streamsize>(first.size()));
  first = LowerCase(first);
  return first.find("scorer") < 5 && !IsHdf5Name(file);
}

std::vector<CameraInput> FindDeepLabCutCameras(const fs::path& path) {
  return FindCameraFiles(
      path,
      {{".h5", ".hdf5", ".csv"}, "a csv or h5 file of DeepLabCut for each camera", IsDeepLabCutFile, DeepLabCutVideo});
}

DetectedCamera ReadDeepLabCut(const CameraInput& input) {
  const std::string file = input.path.string();
  const bool is_hdf5 = IsHdf5Name(input.path) || h5::File::IsHdf5(input.path);
  const Table table = is_hdf5 ? deeplabcut::ReadHdf5(input.path) : ReadTableOfText(input.path);
  std::vector<Individual> individuals = IndividualsOf(table, file);
  if (individuals.empty()) ThrowBadInput({file, "", "columns of body parts", "none", kDeepLabCutAdvice});
  KeepOneKind(individuals, input.name);
  CameraBuilder builder(input);
  if (individuals.size() > 1) builder.NoteTracks();
  builder.SetLayout({"deeplabcut", individuals.front().joints, {}}, file, "bodyparts");
  for (std::size_t row = 0; row < table.frames.size(); ++row) AddRow(table, row, individuals, builder, file);
  // Frames without anybody have rows, too.
  return builder.Finish(false);
}

}  // namespace canonpose
