// MediaPipe's landmarks as csv: a row per frame, or a row per landmark.
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/data/codecs/csv.h"
#include "canonpose/data/readers/mediapipe.h"
#include "canonpose/data/readers/mediapipe_layout.h"

namespace canonpose::mediapipe {
namespace {

namespace fs = std::filesystem;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kTableAdvice =
    "write a row per frame with columns frame, x0, y0, z0, v0, ..., x32, y32, z32, v32, or a row per landmark with "
    "columns "
    "frame, landmark, x, y, z, visibility";

enum class Axis { kX, kY, kConfidence, kOther };

std::optional<Axis> AxisOf(std::string_view text) {
  static constexpr std::array<std::pair<std::string_view, Axis>, 13> kNames{{{"x", Axis::kX},
                                                                             {"y", Axis::kY},
                                                                             {"z", Axis::kOther},
                                                                             {"v", Axis::kConfidence},
                                                                             {"vis", Axis::kConfidence},
                                                                             {"visibility", Axis::kConfidence},
                                                                             {"c", Axis::kConfidence},
                                                                             {"conf", Axis::kConfidence},
                                                                             {"confidence", Axis::kConfidence},
                                                                             {"score", Axis::kConfidence},
                                                                             {"p", Axis::kOther},
                                                                             {"pres", Axis::kOther},
                                                                             {"presence", Axis::kOther}}};
  for (const auto& [name, axis] : kNames) {
    if (SameName(name, text)) return axis;
  }
  return std::nullopt;
}

bool IsAny(std::string_view text, std::initializer_list<std::string_view> names) {
  return std::any_of(names.begin(), names.end(), [&](std::string_view name) { return SameName(name, text); });
}

bool IsFrameName(std::string_view name) {
  return IsAny(name, {"frame", "frame_id", "frame id", "frameid", "frame_number", "frame number", "frame_num",
                      "frame_no", "frame_idx", "frame_index", "frames", "image", "filename", "file", "file_name"});
}

/// Where the values of each landmark are.
struct LandmarkColumns {
  std::optional<std::size_t> x;
  std::optional<std::size_t> y;
  std::optional<std::size_t> confidence;
};
using Columns = std::array<LandmarkColumns, kMediapipePoints>;

/// A column's name as a landmark and an axis: "x12", "12_x", "NOSE_x", "landmark_0.visibility".
struct ColumnName {
  std::string landmark;
  Axis axis;
};

std::optional<ColumnName> ParseColumn(const std::string& name) {
  const std::size_t separator = name.find_last_of("_.- /:");
  if (separator != std::string::npos && separator > 0) {
    if (const std::optional<Axis> axis = AxisOf(std::string_view(name).substr(separator + 1)))
      return ColumnName{name.substr(0, separator), *axis};
  }
  // "x12", "vis_12", "x_nose"
  std::size_t end = 0;
  while (end < name.size() && std::isalpha(static_cast<unsigned char>(name[end])) != 0) ++end;
  const std::optional<Axis> axis = AxisOf(std::string_view(name).substr(0, end));
  if (!axis || end == name.size()) return std::nullopt;
  return ColumnName{name.substr(end), *axis};
}

/// A name with a number in it: "left_hand_12" is 12 of the set "lefthand".
struct NumberedName {
  std::string set;            ///< the letters and digits around the number, in lower case
  std::optional<int> number;  ///< nothing where it is beyond the landmarks of a body
};

/// Nothing where a name has no number.
std::optional<NumberedName> ParseNumber(std::string_view text) {
  const std::size_t last = text.find_last_of("0123456789");
  if (last == std::string_view::npos) return std::nullopt;
  std::size_t first = last;
  while (first > 0 && std::isdigit(static_cast<unsigned char>(text[first - 1])) != 0) --first;
  NumberedName name;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto letter = static_cast<unsigned char>(text[i]);
    const bool is_around = i < first || i > last;
    if (is_around && std::isalnum(letter) != 0) name.set += static_cast<char>(std::tolower(letter));
  }
  int number = 0;
  const auto result = std::from_chars(text.data() + first, text.data() + last + 1, number);
  if (result.ec == std::errc() && number <= static_cast<int>(kMediapipePoints)) name.number = number;
  return name;
}

bool Has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

/// The set that is the body's, of one name of each set: the only one, the one of a pose, or that of "landmarks".
/// Nothing where that can't be told.
std::optional<std::string> BodySet(const std::map<std::string, std::string>& names) {
  std::vector<std::string> sets;
  for (const auto& [set, name] : names) {
    if (!Has(set, "hand") && !Has(set, "face")) sets.push_back(set);
  }
  if (sets.size() == 1 && names.size() == 1) return sets.front();
  // World landmarks are metres.
  std::erase_if(sets, [](const std::string& set) { return Has(set, "world"); });
  for (const char* const part : {"pose", "landmark"}) {
    const auto has_part = [&](const std::string& set) { return Has(set, part); };
    const auto found = std::find_if(sets.begin(), sets.end(), has_part);
    if (found == sets.end()) continue;
    if (std::count_if(sets.begin(), sets.end(), has_part) > 1) return std::nullopt;
    return *found;
  }
  return std::nullopt;
}

/// What a text says of landmarks.
struct NamedLandmark {
  std::optional<int> index;      ///< from 0; nothing where it is none of the body's
  bool is_of_other_set = false;  ///< of a hand's or the face's
};

/// (texts) the landmark of each, by name or else by number; numbers may count from 1. Throws where it can't be told
/// which numbers are the body's.
std::vector<NamedLandmark> LandmarksOf(const std::vector<std::string>& texts, const std::string& file,
                                       const std::string& place) {
  std::vector<NamedLandmark> landmarks(texts.size());
  std::vector<std::optional<NumberedName>> numbers(texts.size());
  std::map<std::string, std::string> sets;
  bool has_names = false;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    landmarks[i].index = FindLandmark(texts[i]);
    has_names = has_names || landmarks[i].index;
    numbers[i] = ParseNumber(texts[i]);
    if (numbers[i]) sets.try_emplace(numbers[i]->set, texts[i]);
  }
  // Where the body's landmarks have names, numbers are those of something else.
  if (has_names || sets.empty()) return landmarks;
  const std::optional<std::string> body = BodySet(sets);
  if (!body) {
    std::vector<std::string> examples;
    for (const auto& [set, name] : sets) examples.push_back(fmt::format("\"{}\"", name.substr(0, 30)));
    if (examples.size() > 4) examples.resize(4);
    ThrowBadInput({file, place, "the numbered landmarks of one body", fmt::format("{}", fmt::join(examples, ", ")),
                   "name those of the body pose_0 to pose_32"});
  }
  int lowest = static_cast<int>(kMediapipePoints);
  int highest = 0;
  for (const std::optional<NumberedName>& name : numbers) {
    if (!name || name->set != *body || !name->number) continue;
    lowest = std::min(lowest, *name->number);
    highest = std::max(highest, *name->number);
  }
  const int first = lowest == 1 && highest == static_cast<int>(kMediapipePoints) ? 1 : 0;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    if (!numbers[i]) continue;
    landmarks[i].is_of_other_set = numbers[i]->set != *body;
    const int index = numbers[i]->number.value_or(-1) - first;
    if (!landmarks[i].is_of_other_set && index >= 0 && index < static_cast<int>(kMediapipePoints))
      landmarks[i].index = index;
  }
  return landmarks;
}

/// The columns of a header with all landmarks; nothing where it has none. Throws where it lacks some.
std::optional<Columns> WideColumns(const CsvRow& header, const std::string& file) {
  std::vector<std::string> texts;
  std::vector<std::pair<std::size_t, Axis>> places;
  for (std::size_t column = 0; column < header.cells.size(); ++column) {
    const std::optional<ColumnName> name = ParseColumn(header.cells[column]);
    if (!name) continue;
    texts.push_back(name->landmark);
    places.emplace_back(column, name->axis);
  }
  const std::vector<NamedLandmark> landmarks = LandmarksOf(texts, file, header.place());
  Columns columns;
  bool has_any = false;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!landmarks[i].index || places[i].second == Axis::kOther) continue;
    LandmarkColumns& landmark = columns[static_cast<std::size_t>(*landmarks[i].index)];
    std::optional<std::size_t>& place = places[i].second == Axis::kX   ? landmark.x
                                        : places[i].second == Axis::kY ? landmark.y
                                                                       : landmark.confidence;
    if (!place) place = places[i].first;
    has_any = true;
  }
  if (!has_any) return std::nullopt;
  for (std::size_t k = 0; k < kMediapipePoints; ++k) {
    if (columns[k].x && columns[k].y) continue;
    ThrowBadInput({file, header.place(), fmt::format("columns x and y of all {} landmarks", kMediapipePoints),
                   fmt::format("none of landmark {} ({})", k, MediapipeLayout().joints[k]), kTableAdvice});
  }
  return columns;
}

/// The columns of a file without a header: 2, 3 or 4 values of each landmark, and the frame's number before them.
std::optional<std::pair<Columns, bool>> ColumnsByCount(std::size_t count) {
  for (const std::size_t width : {4U, 3U, 2U}) {
    const bool has_frame = count == width * kMediapipePoints + 1;
    if (!has_frame && count != width * kMediapipePoints) continue;
    Columns columns;
    for (std::size_t k = 0; k < kMediapipePoints; ++k) {
      const std::size_t first = width * k + (has_frame ? 1 : 0);
      columns[k] = {first, first + 1, std::nullopt};
      if (width == 4) columns[k].confidence = first + 3;
    }
    return std::pair(columns, has_frame);
  }
  return std::nullopt;
}

/// The frame that a cell names, by number or as an image; `number` where there is no such column.
DetectedFrame& FrameOf(CameraBuilder& builder, const CsvRow& row, std::optional<std::size_t> column,
                       std::int64_t number, const std::string& file, bool is_shared) {
  // The place serves as the frame's name, so that two rows with one number are noticed where there is one row a frame.
  const std::string name = is_shared ? "" : row.place();
  if (!column) return builder.Frame(number, name, file, row.place());
  if (*column < row.cells.size() && !IsCsvNumber(row.cells[*column]))
    return builder.Frame(fs::path(row.cells[*column]).filename().string(), file, row.place());
  const double value = CsvNumber(row, *column, file);
  if (std::isnan(value) || value != std::trunc(value)) {
    ThrowBadInput({file, fmt::format("{}, column {}", row.place(), *column + 1), "the number of a frame",
                   row.cells[*column].empty() ? "an empty cell" : row.cells[*column], "number the frames from 0"});
  }
  return builder.Frame(static_cast<std::int64_t>(value), name, file, row.place());
}

void AddPerson(DetectedFrame& frame, const std::vector<double>& triples, CameraBuilder& builder,
               const std::string& file, const std::string& place) {
  std::optional<DetectedPerson> person = PersonFromNamedTriples(triples);
  if (person) builder.Add(frame, std::move(*person), file, place);
}

void ReadWide(const std::vector<CsvRow>& rows, std::size_t first, const Columns& columns,
              std::optional<std::size_t> frame_column, CameraBuilder& builder, const std::string& file) {
  for (std::size_t i = first; i < rows.size(); ++i) {
    DetectedFrame& frame = FrameOf(builder, rows[i], frame_column, static_cast<std::int64_t>(i - first), file, false);
    std::vector<double> triples;
    for (const LandmarkColumns& landmark : columns) {
      const double confidence = landmark.confidence ? CsvNumber(rows[i], *landmark.confidence, file) : 1.0;
      triples.insert(triples.end(), {CsvNumber(rows[i], *landmark.x, file), CsvNumber(rows[i], *landmark.y, file),
                                     std::isnan(confidence) ? 0.0 : confidence});
    }
    AddPerson(frame, triples, builder, file, rows[i].place());
  }
}

/// The columns of a table with a row per landmark.
struct LongColumns {
  std::optional<std::size_t> frame;
  std::optional<std::size_t> person;
  std::optional<std::size_t> landmark;
  std::optional<std::size_t> x;
  std::optional<std::size_t> y;
  std::optional<std::size_t> confidence;
};

/// Nothing where the header is not such a table's.
std::optional<LongColumns> FindLongColumns(const CsvRow& header) {
  LongColumns columns;
  const auto set = [](std::optional<std::size_t>& place, std::size_t column) {
    if (!place) place = column;
  };
  for (std::size_t column = 0; column < header.cells.size(); ++column) {
    const std::string& name = header.cells[column];
    const std::optional<Axis> axis = AxisOf(name);
    if (axis == Axis::kX) set(columns.x, column);
    if (axis == Axis::kY) set(columns.y, column);
    if (axis == Axis::kConfidence) set(columns.confidence, column);
    if (IsFrameName(name)) set(columns.frame, column);
    if (IsAny(name, {"person", "person_id", "pose", "pose_id", "pose_index", "id_person"})) set(columns.person, column);
    if (IsAny(name,
              {"landmark", "landmark_id", "landmark_index", "landmark_idx", "landmark_name", "landmark id",
               "landmark name", "keypoint", "keypoint_id", "joint", "point", "point_id", "name", "index", "id"})) {
      set(columns.landmark, column);
    }
  }
  if (!columns.x || !columns.y || !columns.landmark) return std::nullopt;
  return columns;
}

/// Landmarks of one person in one frame, as rows bring them.
struct PersonRows {
  std::vector<double> triples = std::vector<double>(3 * kMediapipePoints, kMissing);
  std::vector<bool> is_set = std::vector<bool>(kMediapipePoints);
  std::string place;

  void Add(std::size_t landmark, double x, double y, double confidence, const CsvRow& row, const std::string& file) {
    if (is_set[landmark]) {
      ThrowBadInput({file, row.place(), "each landmark once in a frame",
                     fmt::format("landmark {} again", MediapipeLayout().joints[landmark]),
                     "add a column person where there are several people"});
    }
    if (place.empty()) place = row.place();
    is_set[landmark] = true;
    triples[3 * landmark] = x;
    triples[3 * landmark + 1] = y;
    triples[3 * landmark + 2] = std::isnan(confidence) ? 0.0 : confidence;
  }
};

std::string CellOr(const CsvRow& row, std::optional<std::size_t> column) {
  return column && *column < row.cells.size() ? row.cells[*column] : "";
}

/// Numbers the frames of rows that don't: one begins where a person's first landmark returns.
class FrameCounter {
 public:
  /// The frame of the next row.
  std::int64_t Next(int landmark, const std::string& person) {
    const int first = first_landmarks_.try_emplace(person, landmark).first->second;
    if (landmark == first && !people_.insert(person).second) {
      ++number_;
      people_ = {person};
    }
    return number_;
  }
  [[nodiscard]] std::int64_t number() const { return number_; }

 private:
  std::int64_t number_ = 0;
  std::map<std::string, int> first_landmarks_;
  std::set<std::string> people_;  ///< in this frame
};

void ReadLong(const std::vector<CsvRow>& rows, const LongColumns& columns, CameraBuilder& builder,
              const std::string& file) {
  std::vector<std::string> texts;
  for (std::size_t i = 1; i < rows.size(); ++i) texts.push_back(CellOr(rows[i], columns.landmark));
  const std::vector<NamedLandmark> landmarks =
      LandmarksOf(texts, file, fmt::format("column {}", *columns.landmark + 1));
  std::map<DetectedFrame*, std::map<std::string, PersonRows>> people;
  FrameCounter counter;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const CsvRow& row = rows[i];
    const std::optional<int> landmark = landmarks[i - 1].index;
    const std::string person = CellOr(row, columns.person);
    const std::int64_t number = landmark ? counter.Next(*landmark, person) : counter.number();
    DetectedFrame& frame = FrameOf(builder, row, columns.frame, number, file, true);
    if (landmarks[i - 1].is_of_other_set) continue;
    const double x = CsvNumber(row, *columns.x, file);
    const double y = CsvNumber(row, *columns.y, file);
    if (!landmark) {
      if (texts[i - 1].empty() && std::isnan(x)) continue;  // a frame without a person
      ThrowBadInput({file, fmt::format("{}, column {}", row.place(), *columns.landmark + 1),
                     "a landmark of MediaPipe, by number or name", "\"" + texts[i - 1].substr(0, 40) + "\"",
                     kTableAdvice});
    }
    const double confidence = columns.confidence ? CsvNumber(row, *columns.confidence, file) : 1.0;
    people[&frame][person].Add(static_cast<std::size_t>(*landmark), x, y, confidence, row, file);
  }
  for (auto& [frame, by_name] : people) {
    for (auto& [name, person] : by_name) AddPerson(*frame, person.triples, builder, file, person.place);
  }
}

}  // namespace

void ReadText(const fs::path& path, CameraBuilder& builder) {
  const std::string file = path.string();
  const std::vector<CsvRow> rows = ReadCsv(path);
  const CsvRow& header = rows.front();
  // A column without a name is an index.
  const bool has_header = !std::all_of(header.cells.begin(), header.cells.end(), IsCsvNumber);
  if (!has_header) {
    const auto columns = ColumnsByCount(header.cells.size());
    if (!columns) {
      ThrowBadInput({file, header.place(), fmt::format("2, 3 or 4 values of {} landmarks", kMediapipePoints),
                     fmt::format("{} values", header.cells.size()), kTableAdvice});
    }
    return ReadWide(rows, 0, columns->first, columns->second ? std::optional<std::size_t>(0) : std::nullopt, builder,
                    file);
  }
  if (const std::optional<LongColumns> columns = FindLongColumns(header))
    return ReadLong(rows, *columns, builder, file);
  const std::optional<Columns> columns = WideColumns(header, file);
  if (!columns) {
    std::vector<std::string> names = header.cells;
    if (names.size() > 6) names.resize(6);
    ThrowBadInput({file, header.place(), "columns of MediaPipe's landmarks",
                   "\"" + fmt::format("{}", fmt::join(names, ",")).substr(0, 80) + "\"", kTableAdvice});
  }
  std::optional<std::size_t> frame_column;
  for (std::size_t column = 0; column < header.cells.size() && !frame_column; ++column) {
    if (IsFrameName(header.cells[column])) frame_column = column;
  }
  ReadWide(rows, 1, *columns, frame_column, builder, file);
}

}  // namespace canonpose::mediapipe
