#include "canonpose/base/hdf5_questions.h"

#include <memory>
#include <optional>
#include <system_error>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/bytes.h"
#include "canonpose/base/error.h"

namespace canonpose::h5 {
namespace {

/// Arrays are decompressed and converted, and the child has them twice.
constexpr std::size_t kMemoryPerByte = 16;

void Put(ByteWriter& writer, bool value) { writer.Number<std::uint8_t>(value ? 1 : 0); }
void Put(ByteWriter& writer, double value) { writer.Number(value); }
void Put(ByteWriter& writer, const std::vector<std::string>& values) { writer.Texts(values); }
template <typename T>
void Put(ByteWriter& writer, const std::vector<T>& values) {
  writer.Numbers(values);
}
template <typename T>
void Put(ByteWriter& writer, const Array<T>& array) {
  writer.Numbers(array.shape);
  writer.Numbers(array.values);
}

void Get(ByteReader& reader, bool* value) { *value = reader.Number<std::uint8_t>() != 0; }
void Get(ByteReader& reader, double* value) { *value = reader.Number<double>(); }
void Get(ByteReader& reader, std::vector<std::string>* values) { *values = reader.Texts(); }
template <typename T>
void Get(ByteReader& reader, std::vector<T>* values) {
  *values = reader.Numbers<T>();
}
template <typename T>
void Get(ByteReader& reader, Array<T>* array) {
  array->shape = reader.Numbers<std::size_t>();
  array->values = reader.Numbers<T>();
}

template <typename Result>
bool IsWhole(const Result& /*result*/) {
  return true;
}
template <typename T>
bool IsWhole(const Array<T>& array) {
  std::size_t left = array.values.size();
  for (const std::size_t size : array.shape) {
    if (size == 0) return left == 0;
    if (left % size != 0) return false;
    left /= size;
  }
  return left == 1;
}

// ------------------------------------------------------------------------------------------------------ in the child

Group GroupAt(const File& file, const std::string& path) {
  const Group& root = file.root();
  return path == root.path() ? root : root.Open(path.substr(1));
}

std::string Answer(File& file, Question question, const std::string& path, const std::string& name,
                   const std::string& detail) {
  ByteWriter writer;
  const Group group = GroupAt(file, path);
  switch (question) {
    case Question::kOpenFile:
      Put(writer, true);
      break;
    case Question::kHas:
      Put(writer, group.Has(name));
      break;
    case Question::kHasAttribute:
      Put(writer, group.HasAttribute(name));
      break;
    case Question::kChildren:
      Put(writer, group.Children());
      break;
    case Question::kOpen:
      (void)group.Open(name);
      Put(writer, true);
      break;
    case Question::kStrings:
      Put(writer, group.GetStrings(name));
      break;
    case Question::kInts:
      Put(writer, group.GetInts(name));
      break;
    case Question::kDouble:
      Put(writer, group.GetDouble(name));
      break;
    case Question::kShape:
      Put(writer, group.Shape(name));
      break;
    case Question::kFloats:
      Put(writer, group.Read<float>(name));
      break;
    case Question::kDoubles:
      Put(writer, group.Read<double>(name));
      break;
    case Question::kIntegers:
      Put(writer, group.Read<std::int64_t>(name));
      break;
    case Question::kTexts:
      Put(writer, group.ReadTexts(name));
      break;
    case Question::kField:
      Put(writer, group.ReadField(name, detail));
      break;
  }
  return writer.Take();
}

ChildProcess::Answer Answerer(std::function<File()> open) {
  return [open = std::move(open), file = std::make_shared<std::optional<File>>()](std::string_view bytes) {
    ByteReader reader(bytes);
    const auto question = static_cast<Question>(reader.Number<std::uint8_t>());
    const std::string group = reader.Text();
    const std::string name = reader.Text();
    const std::string detail = reader.Text();
    if (!file->has_value()) file->emplace(open());
    return Answer(**file, question, group, name, detail);
  };
}

}  // namespace

FileInChild::FileInChild(const std::filesystem::path& path, std::function<File()> open)
    : path_(path.string()), child_(Answerer(std::move(open)), ChildProcess::Limits::ForFile(path, kMemoryPerByte)) {
  Ask<bool>(Question::kOpenFile, "/", "");
}

template <typename Result>
Result FileInChild::Ask(Question question, const std::string& group, const std::string& name,
                        const std::string& detail) {
  ByteWriter writer;
  writer.Number(static_cast<std::uint8_t>(question));
  writer.Text(group);
  writer.Text(name);
  writer.Text(detail);
  const std::optional<std::string> answer = child_.Ask(writer.Take());
  Result result{};
  if (answer) {
    ByteReader reader(*answer);
    Get(reader, &result);
    if (reader.ok() && reader.at_end() && IsWhole(result)) return result;
  }
  // An answer may also be wrong, since the library may have damaged the child's memory.
  ThrowBadInput({path_, (group == "/" ? "" : group) + (name.empty() ? "" : "/" + name), "a readable HDF5 file",
                 fmt::format("a damaged one (the library that reads it {})", answer ? "fails" : child_.why_ended()),
                 "copy or create it again"});
}
template bool FileInChild::Ask(Question, const std::string&, const std::string&, const std::string&);
template double FileInChild::Ask(Question, const std::string&, const std::string&, const std::string&);
template std::vector<std::string> FileInChild::Ask(Question, const std::string&, const std::string&,
                                                   const std::string&);
template std::vector<std::int64_t> FileInChild::Ask(Question, const std::string&, const std::string&,
                                                    const std::string&);
template std::vector<std::size_t> FileInChild::Ask(Question, const std::string&, const std::string&,
                                                   const std::string&);
template Array<float> FileInChild::Ask(Question, const std::string&, const std::string&, const std::string&);
template Array<double> FileInChild::Ask(Question, const std::string&, const std::string&, const std::string&);
template Array<std::int64_t> FileInChild::Ask(Question, const std::string&, const std::string&, const std::string&);

}  // namespace canonpose::h5
