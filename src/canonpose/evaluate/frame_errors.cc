#include "canonpose/evaluate/frame_errors.h"

#include <algorithm>

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/data/codecs/npz.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// A cell as in RFC 4180: quoted if it contains a comma, a quote or a line end.
std::string CsvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

template <typename T, typename Rows, typename ValueOf>
std::vector<T> Column(const Rows& rows, ValueOf value_of) {
  std::vector<T> column;
  column.reserve(rows.size());
  for (const auto& row : rows) column.push_back(value_of(row));
  return column;
}

}  // namespace

void FrameErrors::RequireFormat(const fs::path& path) {
  if (path.extension() == ".csv" || path.extension() == ".npz") return;
  ThrowInvalidArgument("`frame_errors` {}: the name must end in .csv or .npz", path.string());
}

void FrameErrors::Add(const PoseSource& source, const PoseErrors& errors, bool mirrored) {
  rows_.push_back({source, MeansOf(errors), mirrored});
  for (const double error : errors.scaled_mm) scaled_mm_.push_back(static_cast<float>(error));
  for (const double error : errors.aligned_mm) aligned_mm_.push_back(static_cast<float>(error));
}

void FrameErrors::Write(const fs::path& path, const std::vector<std::string>& joints) const {
  RequireFormat(path);
  if (path.extension() == ".npz") {
    WriteNpz(path, joints);
  } else {
    WriteFileAtomically(path, AsCsv());
  }
}

std::string FrameErrors::AsCsv() const {
  std::string text = "sequence,camera,frame,action,n_mpjpe_mm,p_mpjpe_mm,largest_aligned_mm,mirrored\n";
  for (const Row& row : rows_) {
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{:.4f},{:.4f},{:.4f},{}\n", CsvField(row.source.sequence),
                   CsvField(row.source.camera), row.source.frame, CsvField(row.source.action), row.means.n_mpjpe_mm,
                   row.means.p_mpjpe_mm, row.means.largest_aligned_mm, row.mirrored ? 1 : 0);
  }
  return text;
}

void FrameErrors::WriteNpz(const fs::path& path, const std::vector<std::string>& joints) const {
  const std::size_t count = rows_.size();
  NpzWriter writer(path);
  writer.AddStrings("sequence", Column<std::string>(rows_, [](const Row& row) { return row.source.sequence; }));
  writer.AddStrings("camera", Column<std::string>(rows_, [](const Row& row) { return row.source.camera; }));
  writer.Add("frame", Column<std::int64_t>(rows_, [](const Row& row) { return row.source.frame; }), {count});
  writer.AddStrings("action", Column<std::string>(rows_, [](const Row& row) { return row.source.action; }));
  writer.Add("n_mpjpe_mm", Column<double>(rows_, [](const Row& row) { return row.means.n_mpjpe_mm; }), {count});
  writer.Add("p_mpjpe_mm", Column<double>(rows_, [](const Row& row) { return row.means.p_mpjpe_mm; }), {count});
  writer.Add("largest_aligned_mm", Column<double>(rows_, [](const Row& row) { return row.means.largest_aligned_mm; }),
             {count});
  writer.Add("mirrored", Column<std::int32_t>(rows_, [](const Row& row) { return row.mirrored ? 1 : 0; }), {count});
  writer.AddStrings("joints", joints);
  writer.Add("n_error_mm", scaled_mm_, {count, joints.size()});
  writer.Add("p_error_mm", aligned_mm_, {count, joints.size()});
  writer.Commit();
}

}  // namespace canonpose
