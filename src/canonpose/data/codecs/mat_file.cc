#include "canonpose/data/codecs/mat_file.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <matio.h>

#include "canonpose/base/bytes.h"
#include "canonpose/base/child_process.h"
#include "canonpose/base/error.h"
#include "canonpose/base/hdf5.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHeaderBytes = 128;
/// Matrices are decompressed and converted, and copied twice.
constexpr std::size_t kMemoryPerByte = 32;

std::string ReadHeader(const fs::path& path) {
  std::string header(kHeaderBytes, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(header.data(), static_cast<std::streamsize>(header.size()));
  header.resize(static_cast<std::size_t>(file.gcount()));
  return header;
}

/// Whether an array claims more elements than fit its bytes; the library would spend a long time on them. `file` is
/// positioned after the array's tag, at 16 bytes of flags, then the tag of the dimensions and the dimensions.
bool IsTooLarge(std::ifstream& file, std::uint32_t bytes) {
  std::array<std::uint32_t, 8> start{};
  if (!file.read(reinterpret_cast<char*>(start.data()), sizeof(start))) return true;
  constexpr std::size_t kRank2Bytes = 8;
  if (start[5] != kRank2Bytes) return start[5] < kRank2Bytes;
  const std::uint64_t elements = std::uint64_t{start[6]} * start[7];
  return elements > bytes;
}

/// Whether the file ends where its last element ends; otherwise, a truncation would go unnoticed in variables that are
/// not read. Each element starts with its type and its length, 4 bytes each.
bool IsSound(const fs::path& path) {
  constexpr std::uint32_t kMatrix = 14;
  std::error_code error;
  const std::uint64_t size = fs::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  std::uint64_t at = kHeaderBytes;
  while (at < size) {
    std::array<std::uint32_t, 2> tag{};
    file.seekg(static_cast<std::streamoff>(at));
    if (!file.read(reinterpret_cast<char*>(tag.data()), sizeof(tag))) return false;
    if (tag[0] == kMatrix && IsTooLarge(file, tag[1])) return false;
    at += sizeof(tag) + tag[1];
  }
  return at == size && size > kHeaderBytes;
}

template <typename T>
double ValueAt(const void* data, std::size_t index) {
  return static_cast<double>(static_cast<const T*>(data)[index]);
}

using Getter = double (*)(const void* data, std::size_t index);

struct Type {
  Getter get = nullptr;
  std::size_t bytes = 0;
};

/// How elements of a class are stored in memory once the library has read them.
Type TypeOf(matio_classes class_type) {
  switch (class_type) {
    case MAT_C_DOUBLE:
      return {ValueAt<double>, sizeof(double)};
    case MAT_C_SINGLE:
      return {ValueAt<float>, sizeof(float)};
    case MAT_C_INT8:
      return {ValueAt<std::int8_t>, 1};
    case MAT_C_UINT8:
      return {ValueAt<std::uint8_t>, 1};
    case MAT_C_INT16:
      return {ValueAt<std::int16_t>, 2};
    case MAT_C_UINT16:
      return {ValueAt<std::uint16_t>, 2};
    case MAT_C_INT32:
      return {ValueAt<std::int32_t>, 4};
    case MAT_C_UINT32:
      return {ValueAt<std::uint32_t>, 4};
    default:
      return {};
  }
}

std::optional<Matrix> ToMatrix(const matvar_t* variable) {
  if (variable == nullptr || variable->data == nullptr || variable->isComplex != 0 || variable->rank != 2) {
    return std::nullopt;
  }
  const Type type = TypeOf(variable->class_type);
  Matrix matrix;
  matrix.rows = variable->dims[0];
  matrix.columns = variable->dims[1];
  const bool is_whole = type.get != nullptr && matrix.columns > 0 &&
                        matrix.rows <= variable->nbytes / type.bytes / matrix.columns &&
                        variable->data_size == static_cast<int>(type.bytes);
  if (!is_whole) return std::nullopt;
  matrix.values.reserve(matrix.rows * matrix.columns);
  for (std::size_t r = 0; r < matrix.rows; ++r) {
    for (std::size_t c = 0; c < matrix.columns; ++c) {
      matrix.values.push_back(type.get(variable->data, c * matrix.rows + r));
    }
  }
  return matrix;
}

/// The size that an array claims, before its values are read; the largest possible number where it makes no sense.
std::uint64_t ClaimedValues(const matvar_t* variable) {
  constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();
  if (variable == nullptr || variable->rank != 2 || variable->dims == nullptr) return kNone;
  const std::uint64_t rows = variable->dims[0];
  const std::uint64_t columns = variable->dims[1];
  return rows > 0 && columns > kNone / rows ? kNone : rows * columns;
}

// ------------------------------------------------------------------------------------------------------ in the child

struct VariableCloser {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using Variable = std::unique_ptr<matvar_t, VariableCloser>;

/// A file that the library has open.
class OpenFile {
 public:
  OpenFile(std::string path, std::string advice)
      : path_(std::move(path)), advice_(std::move(advice)), file_(Mat_Open(path_.c_str(), MAT_ACC_RDONLY)) {
    if (file_ != nullptr) return;
    ThrowBadInput({path_, "", "a MATLAB file of version 5", "a damaged one", "copy the file again"});
  }
  ~OpenFile() {
    if (file_ != nullptr) Mat_Close(file_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  [[nodiscard]] std::vector<Matrix> ReadCells(const std::string& name, std::size_t count) const;

 private:
  [[noreturn]] void Fail(const std::string& place, const std::string& expected, const std::string& found,
                         const std::string& advice = "") const {
    ThrowBadInput({path_, place, expected, found, advice});
  }

  std::string path_;
  std::string advice_;
  mat_t* file_ = nullptr;
};

std::vector<Matrix> OpenFile::ReadCells(const std::string& name, std::size_t count) const {
  Mat_Rewind(file_);
  // First check what the variable claims to be, since reading allocates whatever a damaged size asks for.
  const Variable variable(Mat_VarReadInfo(file_, name.c_str()));
  if (variable == nullptr) Fail(name, "a variable of that name", "none that can be read", advice_);
  std::size_t cells = variable->class_type == MAT_C_CELL && variable->data != nullptr ? 1 : 0;
  for (int d = 0; d < variable->rank && cells > 0; ++d) cells *= variable->dims[d];
  if (cells != count || variable->nbytes < count * sizeof(matvar_t*)) {
    Fail(name, fmt::format("a cell array of {} matrices", count),
         variable->class_type == MAT_C_CELL ? fmt::format("{} cells", cells) : "no cell array", advice_);
  }
  const auto* const parts = static_cast<matvar_t* const*>(variable->data);
  constexpr std::uint64_t kBestCompression = 1100;  // deflate reaches 1032
  const std::uint64_t limit = kBestCompression * fs::file_size(path_);
  for (std::size_t i = 0; i < count; ++i) {
    if (ClaimedValues(parts[i]) <= limit) continue;
    Fail(fmt::format("{}{{{}}}", name, i + 1), "a matrix that the file can hold", "a larger one",
         "the file is damaged; copy it again");
  }
  if (Mat_VarReadDataAll(file_, variable.get()) != 0) {
    Fail(name, "readable data", "damaged data", "copy the file again");
  }
  std::vector<Matrix> matrices;
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<Matrix> matrix = ToMatrix(parts[i]);
    if (!matrix)
      Fail(fmt::format("{}{{{}}}", name, i + 1), "a matrix of real numbers", "something else, or damaged data");
    matrices.push_back(*matrix);
  }
  return matrices;
}

/// Answers "NAME COUNT" with the matrices of a cell array.
std::string Answer(const OpenFile& file, std::string_view question) {
  ByteReader reader(question);
  const std::string name = reader.Text();
  const auto count = reader.Number<std::uint64_t>();
  ByteWriter writer;
  for (const Matrix& matrix : file.ReadCells(name, count)) {
    writer.Number<std::uint64_t>(matrix.rows);
    writer.Number<std::uint64_t>(matrix.columns);
    writer.Numbers(matrix.values);
  }
  return writer.Take();
}

}  // namespace

struct MatFile::State {
  std::string path;
  std::string advice;
  std::unique_ptr<ChildProcess> child;  ///< has the file open
};

MatFile::MatFile(const fs::path& path, std::string advice) : state_(std::make_unique<State>()) {
  state_->path = path.string();
  state_->advice = std::move(advice);
  std::error_code error;
  if (!fs::exists(path, error))
    ThrowBadInput({path.string(), "", "a file", error ? error.message() : "nothing", "check the path"});
  const std::string expected = "a MATLAB file of version 5";
  if (h5::File::IsHdf5(path)) {
    ThrowBadInput({path.string(), "", expected, "one of version 7.3, which is HDF5", state_->advice});
  }
  const std::string header = ReadHeader(path);
  if (header.size() < kHeaderBytes || !header.starts_with("MATLAB 5.0") || header.substr(126) != "IM") {
    ThrowBadInput({path.string(), "", expected, "another format, or one that is cut short", state_->advice});
  }
  if (!IsSound(path)) {
    ThrowBadInput({path.string(), "", expected, "one that is cut short or damaged", "copy the file again"});
  }
  state_->child = std::make_unique<ChildProcess>(
      [file_path = state_->path, file_advice = state_->advice,
       file = std::shared_ptr<OpenFile>()](std::string_view question) mutable {
        if (file == nullptr) file = std::make_shared<OpenFile>(file_path, file_advice);
        return Answer(*file, question);
      },
      ChildProcess::Limits::ForFile(path, kMemoryPerByte));
}

MatFile::~MatFile() = default;

void MatFile::Fail(const std::string& place, const std::string& expected, const std::string& found,
                   const std::string& advice) const {
  ThrowBadInput({state_->path, place, expected, found, advice});
}

std::vector<Matrix> MatFile::ReadCells(const std::string& name, std::size_t count) const {
  ByteWriter question;
  question.Text(name);
  question.Number<std::uint64_t>(count);
  const std::optional<std::string> answer = state_->child->Ask(question.Take());
  if (!answer) {
    Fail(name, "readable data", fmt::format("damaged data (the library that reads it {})", state_->child->why_ended()),
         "copy the file again");
  }
  ByteReader reader(*answer);
  std::vector<Matrix> matrices(count);
  for (Matrix& matrix : matrices) {
    matrix.rows = reader.Number<std::uint64_t>();
    matrix.columns = reader.Number<std::uint64_t>();
    matrix.values = reader.Numbers<double>();
    // The library may have damaged the child's memory before it answered.
    const bool is_whole = reader.ok() && matrix.columns > 0 && matrix.values.size() % matrix.columns == 0 &&
                          matrix.values.size() / matrix.columns == matrix.rows;
    if (!is_whole) Fail(name, "readable data", "damaged data", "copy the file again");
  }
  return matrices;
}

}  // namespace canonpose
