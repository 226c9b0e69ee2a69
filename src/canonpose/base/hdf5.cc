#include "canonpose/base/hdf5.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <optional>
#include <system_error>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/hdf5_questions.h"

namespace canonpose::h5 {
namespace {

namespace fs = std::filesystem;

/// Owns one HDF5 identifier.
class Id {
 public:
  using Closer = herr_t (*)(hid_t);
  Id() = default;
  Id(hid_t id, Closer closer) : id_(id), closer_(closer) {}
  ~Id() { Close(); }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)), closer_(other.closer_) {}
  Id& operator=(Id&& other) noexcept {
    Close();
    id_ = std::exchange(other.id_, -1);
    closer_ = other.closer_;
    return *this;
  }
  operator hid_t() const { return id_; }  // NOLINT: the library's functions take it everywhere
  [[nodiscard]] bool valid() const { return id_ >= 0; }
  /// Gives up the identifier; the caller must close it.
  [[nodiscard]] hid_t Release() { return std::exchange(id_, -1); }
  herr_t Close() {
    if (id_ < 0) return 0;
    return closer_(std::exchange(id_, -1));
  }

 private:
  hid_t id_ = -1;
  Closer closer_ = nullptr;
};

/// HDF5 prints a stack trace on every error, where we report one line. And where a file could not be written, such as
/// on a full disk, it would try again at exit and crash.
void PrepareLibrary() {
  static std::once_flag once;
  std::call_once(once, [] {
    H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  });
}

template <typename T>
hid_t MemoryType() {
  if constexpr (std::is_same_v<T, float>) return H5T_NATIVE_FLOAT;
  if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
  if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_NATIVE_UINT8;
}

template <typename T>
constexpr Question kQuestionFor = Question::kIntegers;
template <>
constexpr Question kQuestionFor<float> = Question::kFloats;
template <>
constexpr Question kQuestionFor<double> = Question::kDoubles;

std::vector<std::size_t> ShapeOf(hid_t space) {
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank <= 0) return {};
  std::vector<hsize_t> dimensions(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space, dimensions.data(), nullptr);
  return {dimensions.begin(), dimensions.end()};
}

std::size_t CountOf(const std::vector<std::size_t>& shape) {
  std::size_t count = 1;
  for (const std::size_t size : shape) count *= size;
  return count;
}

/// Whether a type has one of the usual widths and uses all of its bits. Damaged files may have other types; for some of
/// these the library writes past its own buffers when it converts them.
bool IsOfUsualWidth(hid_t type) {
  const std::size_t bytes = H5Tget_size(type);
  const bool is_usual = bytes == 1 || bytes == 2 || bytes == 4 || bytes == 8;
  return is_usual && H5Tget_precision(type) == 8 * bytes && H5Tget_offset(type) == 0;
}

/// Whether sign, exponent and mantissa of a floating-point type are adjacent and fill it, as in IEEE 754.
bool IsUsualReal(hid_t type) {
  std::size_t sign = 0;
  std::size_t exponent = 0;
  std::size_t exponent_bits = 0;
  std::size_t mantissa = 0;
  std::size_t mantissa_bits = 0;
  if (H5Tget_fields(type, &sign, &exponent, &exponent_bits, &mantissa, &mantissa_bits) < 0) return false;
  return IsOfUsualWidth(type) && mantissa == 0 && exponent == mantissa_bits && sign == exponent + exponent_bits &&
         sign + 1 == 8 * H5Tget_size(type);
}

bool IsNumber(hid_t type) {
  const H5T_class_t type_class = H5Tget_class(type);
  if (type_class == H5T_FLOAT) return IsUsualReal(type);
  // h5py stores bool as an enumeration of int8.
  return type_class == H5T_ENUM || (type_class == H5T_INTEGER && IsOfUsualWidth(type));
}

std::string WithoutPadding(const char* text, std::size_t size) {
  std::string value(text, std::find(text, text + size, '\0'));
  return value;
}

/// Strings of variable length, which h5py returns as str; it returns those of fixed length as bytes.
Id StringType() {
  Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

/// Attributes share a header of at most 64 KiB; one that claims to be many times larger is damaged.
constexpr std::size_t kLargestAttributeBytes = std::size_t{1} << 28;

/// How many values an attribute has; nothing where the file is so damaged that this is unknown.
std::optional<std::size_t> AttributeCount(hid_t type, hid_t space) {
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  const std::size_t size = H5Tget_size(type);
  if (count < 0 || size == 0 || static_cast<std::size_t>(count) > kLargestAttributeBytes / size) return std::nullopt;
  return static_cast<std::size_t>(count);
}

}  // namespace

std::string FormatShape(const std::vector<std::size_t>& shape) { return fmt::format("({})", fmt::join(shape, ", ")); }

// ------------------------------------------------------------------------------------------------------------ Group

struct Group::State {
  std::string file;
  fs::path final_path;
  std::shared_ptr<Id> file_id;
  Id id;
  /// Reads the file, if it is one that another process reads; the two above then have no value.
  std::shared_ptr<FileInChild> child = nullptr;
};

const std::string& Group::file() const { return state_->file; }

void Group::Fail(const std::string& name, const std::string& expected, const std::string& found,
                 const std::string& advice) const {
  ThrowBadInput({state_->file, (path_ == "/" ? "" : path_) + "/" + name, expected, found, advice});
}

bool Group::Has(const std::string& name) const {
  if (state_->child) return state_->child->Ask<bool>(Question::kHas, path_, name);
  return H5Lexists(state_->id, name.c_str(), H5P_DEFAULT) > 0;
}

bool Group::HasAttribute(const std::string& name) const {
  if (state_->child) return state_->child->Ask<bool>(Question::kHasAttribute, path_, name);
  return H5Aexists(state_->id, name.c_str()) > 0;
}

std::vector<std::string> Group::Children() const {
  if (state_->child) return state_->child->Ask<std::vector<std::string>>(Question::kChildren, path_, "");
  std::vector<std::string> names;
  H5G_info_t info;
  if (H5Gget_info(state_->id, &info) < 0) Fail("", "a group that can be listed", "a damaged group", "");
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const ssize_t size = H5Lget_name_by_idx(state_->id, ".", H5_INDEX_NAME, H5_ITER_INC, i, nullptr, 0, H5P_DEFAULT);
    if (size < 0) Fail("", "a group that can be listed", "a damaged group", "");
    std::string name(static_cast<std::size_t>(size), '\0');
    H5Lget_name_by_idx(state_->id, ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size() + 1, H5P_DEFAULT);
    names.push_back(std::move(name));
  }
  return names;
}

Group Group::Open(const std::string& name) const {
  Group group;
  Id id;
  if (state_->child) {
    state_->child->Ask<bool>(Question::kOpen, path_, name);
  } else {
    id = Id(H5Gopen2(state_->id, name.c_str(), H5P_DEFAULT), H5Gclose);
    if (!id.valid()) Fail(name, "a group", Has(name) ? "something else" : "nothing", "");
  }
  group.state_ =
      std::make_shared<State>(State{state_->file, state_->final_path, state_->file_id, std::move(id), state_->child});
  group.path_ = (path_ == "/" ? "" : path_) + "/" + name;
  return group;
}

std::vector<std::string> Group::GetStrings(const std::string& name) const {
  if (state_->child) return state_->child->Ask<std::vector<std::string>>(Question::kStrings, path_, name);
  const std::string place = "attribute " + name;
  Id attribute(H5Aopen(state_->id, name.c_str(), H5P_DEFAULT), H5Aclose);
  if (!attribute.valid()) Fail(place, "text", "nothing", "");
  Id type(H5Aget_type(attribute), H5Tclose);
  Id space(H5Aget_space(attribute), H5Sclose);
  if (H5Tget_class(type) != H5T_STRING) Fail(place, "text", "another type", "");
  const std::optional<std::size_t> known_count = AttributeCount(type, space);
  if (!known_count) Fail(place, "text", "damaged data", "");
  const std::size_t count = *known_count;
  std::vector<std::string> values;
  if (H5Tis_variable_str(type) > 0) {
    std::vector<char*> pointers(count, nullptr);
    if (count > 0 && H5Aread(attribute, type, pointers.data()) < 0) Fail(place, "text", "damaged data", "");
    for (const char* pointer : pointers) values.emplace_back(pointer == nullptr ? "" : pointer);
    H5Dvlen_reclaim(type, space, H5P_DEFAULT, pointers.data());
  } else {
    const std::size_t size = H5Tget_size(type);
    std::vector<char> text(size * count);
    if (count > 0 && H5Aread(attribute, type, text.data()) < 0) Fail(place, "text", "damaged data", "");
    for (std::size_t i = 0; i < count; ++i) values.push_back(WithoutPadding(&text[i * size], size));
  }
  return values;
}

std::string Group::GetString(const std::string& name) const {
  std::vector<std::string> values = GetStrings(name);
  if (values.size() != 1) Fail("attribute " + name, "one text", fmt::format("{}", values.size()), "");
  return values.front();
}

namespace {
/// The values of an attribute of numbers; nothing where it has no numbers or cannot be read.
template <typename T>
std::optional<std::vector<T>> ReadNumbers(hid_t attribute, hid_t memory_type) {
  const Id type(H5Aget_type(attribute), H5Tclose);
  const Id space(H5Aget_space(attribute), H5Sclose);
  const std::optional<std::size_t> count = AttributeCount(type, space);
  if (!count || !IsNumber(type)) return std::nullopt;
  std::vector<T> values(*count);
  if (H5Tget_class(type) == H5T_ENUM) {
    std::vector<std::int8_t> raw(*count);
    if (H5Tget_size(type) != 1 || (!raw.empty() && H5Aread(attribute, type, raw.data()) < 0)) return std::nullopt;
    std::copy(raw.begin(), raw.end(), values.begin());
  } else if (!values.empty() && H5Aread(attribute, memory_type, values.data()) < 0) {
    return std::nullopt;
  }
  return values;
}

/// Above this, a double cannot represent every whole number.
constexpr double kLargestExactDouble = 9007199254740992.0;
}  // namespace

std::vector<std::int64_t> Group::GetInts(const std::string& name) const {
  if (state_->child) return state_->child->Ask<std::vector<std::int64_t>>(Question::kInts, path_, name);
  const std::string place = "attribute " + name;
  Id attribute(H5Aopen(state_->id, name.c_str(), H5P_DEFAULT), H5Aclose);
  if (!attribute.valid()) Fail(place, "whole numbers", "nothing", "");
  const Id type(H5Aget_type(attribute), H5Tclose);
  // The library would convert by truncating fractions and by clamping to the range of the type.
  std::vector<std::int64_t> values;
  if (H5Tget_class(type) == H5T_FLOAT) {
    const auto reals = ReadNumbers<double>(attribute, H5T_NATIVE_DOUBLE);
    if (!reals) Fail(place, "whole numbers", "damaged data", "");
    for (const double real : *reals) {
      if (!(std::abs(real) <= kLargestExactDouble) || real != std::trunc(real)) {
        Fail(place, "whole numbers", fmt::format("{}", real), "");
      }
      values.push_back(static_cast<std::int64_t>(real));
    }
  } else if (H5Tget_class(type) == H5T_INTEGER && H5Tget_sign(type) == H5T_SGN_NONE) {
    const auto naturals = ReadNumbers<std::uint64_t>(attribute, H5T_NATIVE_UINT64);
    if (!naturals || H5Tget_size(type) > sizeof(std::uint64_t)) Fail(place, "whole numbers", "another type", "");
    for (const std::uint64_t natural : *naturals) {
      if (natural > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
        Fail(place, "signed 64-bit whole numbers", fmt::format("{}", natural), "");
      }
      values.push_back(static_cast<std::int64_t>(natural));
    }
  } else {
    auto integers = ReadNumbers<std::int64_t>(attribute, H5T_NATIVE_INT64);
    if (!integers || H5Tget_size(type) > sizeof(std::int64_t)) Fail(place, "whole numbers", "another type", "");
    values = std::move(*integers);
  }
  return values;
}

std::int64_t Group::GetInt(const std::string& name) const {
  const std::vector<std::int64_t> values = GetInts(name);
  if (values.size() != 1) Fail("attribute " + name, "one whole number", fmt::format("{}", values.size()), "");
  return values.front();
}

double Group::GetDouble(const std::string& name) const {
  if (state_->child) return state_->child->Ask<double>(Question::kDouble, path_, name);
  Id attribute(H5Aopen(state_->id, name.c_str(), H5P_DEFAULT), H5Aclose);
  if (!attribute.valid()) Fail("attribute " + name, "a number", "nothing", "");
  const auto values = ReadNumbers<double>(attribute, H5T_NATIVE_DOUBLE);
  if (!values || values->size() != 1) Fail("attribute " + name, "one number", "something else", "");
  return values->front();
}

namespace {
/// Throws where an array claims more than its file can hold, which nobody could allocate, or is kept in another file.
void RequireInFile(const Group& group, const std::string& name, hid_t dataset, const std::vector<std::size_t>& shape) {
  constexpr std::size_t kBestCompression = 1100;  // deflate reaches 1032
  const Id file(H5Iget_file_id(dataset), H5Fclose);
  hsize_t file_bytes = 0;
  H5Fget_filesize(file, &file_bytes);
  const Id properties(H5Dget_create_plist(dataset), H5Pclose);
  if (H5Pget_external_count(properties) > 0) group.Fail(name, "an array in this file", "one in another file", "");
  const Id type(H5Dget_type(dataset), H5Tclose);
  std::size_t room = kBestCompression * file_bytes / std::max<std::size_t>(1, H5Tget_size(type));
  const auto take = [&](std::size_t size) {
    if (size > room) {
      group.Fail(name, "an array that the file can hold", FormatShape(shape), "the file is damaged: make it again");
    }
    if (size > 0) room /= size;
  };
  for (const std::size_t size : shape) take(size);
}
}  // namespace

std::vector<std::size_t> Group::Shape(const std::string& name) const {
  if (state_->child) return state_->child->Ask<std::vector<std::size_t>>(Question::kShape, path_, name);
  Id dataset(H5Dopen2(state_->id, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset.valid()) Fail(name, "an array", Has(name) ? "something else" : "nothing", "");
  Id space(H5Dget_space(dataset), H5Sclose);
  std::vector<std::size_t> shape = ShapeOf(space);
  RequireInFile(*this, name, dataset, shape);
  return shape;
}

template <typename T>
Array<T> Group::Read(const std::string& name) const {
  if (state_->child) return state_->child->Ask<Array<T>>(kQuestionFor<T>, path_, name);
  Array<T> array;
  array.shape = Shape(name);
  Id dataset(H5Dopen2(state_->id, name.c_str(), H5P_DEFAULT), H5Dclose);
  Id type(H5Dget_type(dataset), H5Tclose);
  if (!IsNumber(type)) Fail(name, "an array of numbers", "another type", "");
  array.values.resize(CountOf(array.shape));
  if (H5Dread(dataset, MemoryType<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, array.values.data()) < 0) {
    Fail(name, "readable data", "damaged data", "restore the file from a copy or make it again");
  }
  return array;
}
template Array<float> Group::Read<float>(const std::string&) const;
template Array<double> Group::Read<double>(const std::string&) const;
template Array<std::int64_t> Group::Read<std::int64_t>(const std::string&) const;

namespace {
/// The system's reason for the failure of the last call, as noted by HDF5; 0 if there is none. errno itself may have
/// been overwritten by the library's clean-up.
int ReasonOfFailure() {
  int reason = 0;
  const auto find = [](unsigned, const H5E_error2_t* error, void* found) -> herr_t {
    constexpr std::string_view kMark = "errno = ";
    const std::string_view text = error->desc == nullptr ? "" : error->desc;
    const std::size_t place = text.find(kMark);
    if (place != std::string_view::npos) *static_cast<int*>(found) = std::atoi(text.data() + place + kMark.size());
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, find, &reason);
  return reason;
}

[[noreturn]] void ThrowWriteFailed(const fs::path& path) {
  const int reason = ReasonOfFailure();
  ThrowCannotWrite(path, reason == 0 ? EIO : reason);
}

void WriteAttribute(hid_t owner, const fs::path& path, const std::string& name, hid_t file_type, hid_t memory_type,
                    hid_t space, const void* data) {
  Id attribute(H5Acreate2(owner, name.c_str(), file_type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const bool is_empty = H5Sget_simple_extent_npoints(space) == 0;  // which H5Awrite refuses
  if (!attribute.valid() || (!is_empty && H5Awrite(attribute, memory_type, data) < 0)) ThrowWriteFailed(path);
}

Id SpaceFor(std::size_t count) {
  const hsize_t size = count;
  return {H5Screate_simple(1, &size, nullptr), H5Sclose};
}
}  // namespace

Group Group::Create(const std::string& name) {
  Id id(H5Gcreate2(state_->id, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  if (!id.valid()) ThrowWriteFailed(state_->final_path);
  id.Close();
  return Open(name);
}

void Group::SetString(const std::string& name, const std::string& value) {
  const Id type = StringType();
  const Id space(H5Screate(H5S_SCALAR), H5Sclose);
  const char* pointer = value.c_str();
  WriteAttribute(state_->id, state_->final_path, name, type, type, space, &pointer);
}

void Group::SetStrings(const std::string& name, const std::vector<std::string>& values) {
  const Id type = StringType();
  const Id space = SpaceFor(values.size());
  std::vector<const char*> pointers;
  for (const std::string& value : values) pointers.push_back(value.c_str());
  WriteAttribute(state_->id, state_->final_path, name, type, type, space, pointers.data());
}

void Group::SetInt(const std::string& name, std::int64_t value) {
  const Id space(H5Screate(H5S_SCALAR), H5Sclose);
  WriteAttribute(state_->id, state_->final_path, name, H5T_STD_I64LE, H5T_NATIVE_INT64, space, &value);
}

void Group::SetInts(const std::string& name, const std::vector<std::int64_t>& values) {
  const Id space = SpaceFor(values.size());
  WriteAttribute(state_->id, state_->final_path, name, H5T_STD_I64LE, H5T_NATIVE_INT64, space, values.data());
}

void Group::SetDouble(const std::string& name, double value) {
  const Id space(H5Screate(H5S_SCALAR), H5Sclose);
  WriteAttribute(state_->id, state_->final_path, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, space, &value);
}

template <typename T>
void Group::Write(const std::string& name, std::span<const T> values, const std::vector<std::size_t>& shape) {
  CANONPOSE_CHECK(values.size() == CountOf(shape), "{} values for shape {}", values.size(), FormatShape(shape));
  constexpr std::size_t kChunkBytes = 1 << 20;
  const std::vector<hsize_t> dimensions(shape.begin(), shape.end());
  const Id space(shape.empty() ? H5Screate(H5S_SCALAR)
                               : H5Screate_simple(static_cast<int>(dimensions.size()), dimensions.data(), nullptr),
                 H5Sclose);
  const Id properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  // Without this the file contains the time of writing, and the same result has different bits every time.
  H5Pset_obj_track_times(properties, 0);
  if (!values.empty() && !shape.empty()) {
    std::vector<hsize_t> chunk = dimensions;
    const std::size_t row_bytes = values.size_bytes() / shape.front();
    chunk.front() = std::clamp<hsize_t>(kChunkBytes / std::max<std::size_t>(1, row_bytes), 1, dimensions.front());
    H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data());
    H5Pset_fletcher32(properties);
  }
  const Id dataset(H5Dcreate2(state_->id, name.c_str(), MemoryType<T>(), space, H5P_DEFAULT, properties, H5P_DEFAULT),
                   H5Dclose);
  if (!dataset.valid() || H5Dwrite(dataset, MemoryType<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    ThrowWriteFailed(state_->final_path);
  }
}
template void Group::Write<float>(const std::string&, std::span<const float>, const std::vector<std::size_t>&);
template void Group::Write<double>(const std::string&, std::span<const double>, const std::vector<std::size_t>&);
template void Group::Write<std::uint8_t>(const std::string&, std::span<const std::uint8_t>,
                                         const std::vector<std::size_t>&);
template void Group::Write<std::int64_t>(const std::string&, std::span<const std::int64_t>,
                                         const std::vector<std::size_t>&);

// ------------------------------------------------------------------------------------------------------------- File

struct File::Pending {
  explicit Pending(const fs::path& path) : file(path) {}
  AtomicFile file;
};

File::File() = default;
File::File(File&&) noexcept = default;
File::~File() = default;

bool File::IsHdf5(const fs::path& path) {
  PrepareLibrary();
  std::error_code error;
  return fs::is_regular_file(path, error) && H5Fis_hdf5(path.c_str()) > 0;
}

File File::OpenForReading(const fs::path& path) {
  PrepareLibrary();
  std::error_code error;
  if (!fs::exists(path, error)) {
    ThrowBadInput({path.string(), "", "a file", error ? error.message() : "nothing", "check the path"});
  }
  File file;
  file.root_.state_ = std::make_shared<Group::State>(Group::State{path.string(), path, nullptr, Id()});
  file.root_.state_->child = std::make_shared<FileInChild>(path, [path] { return OpenHere(path); });
  file.root_.path_ = "/";
  return file;
}

File File::OpenHere(const fs::path& path) {
  std::error_code error;
  Id id(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!id.valid()) {
    const bool is_damaged = IsHdf5(path);
    std::string found = fs::is_directory(path, error) ? "a folder" : "another format";
    if (is_damaged) found = "one that is cut short or damaged";
    ThrowBadInput({path.string(), "", "a readable HDF5 file", found,
                   is_damaged ? "copy or create it again"
                              : "give a file made by canonpose, such as by its import of keypoint files"});
  }
  return OfHandle(id.Release(), path.string());
}

File File::OpenImage(std::string_view image, const std::string& name) {
  PrepareLibrary();
  Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  constexpr std::size_t kIncrement = 64 * 1024;  // only used by a file that grows
  H5Pset_fapl_core(access, kIncrement, /*backing_store=*/0);
  // The library's parameter is not const, but it copies what it points to.
  H5Pset_file_image(access, const_cast<char*>(image.data()), image.size());  // NOLINT
  Id id(H5Fopen(name.c_str(), H5F_ACC_RDONLY, access), H5Fclose);
  if (!id.valid()) ThrowBadInput({name, "", "an HDF5 file", "damaged data", "install the program again"});
  return OfHandle(id.Release(), name);
}

File File::OfHandle(std::int64_t handle, const std::string& name) {
  File file;
  auto shared = std::make_shared<Id>(handle, H5Fclose);
  Id root(H5Gopen2(*shared, "/", H5P_DEFAULT), H5Gclose);
  file.root_.state_ = std::make_shared<Group::State>(Group::State{name, name, std::move(shared), std::move(root)});
  file.root_.path_ = "/";
  return file;
}

File File::CreateAt(const fs::path& path) {
  PrepareLibrary();
  auto pending = std::make_unique<Pending>(path);
  Id id(H5Fcreate(pending->file.temporary_path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  if (!id.valid()) ThrowWriteFailed(path);
  File file = OfHandle(id.Release(), path.string());
  file.pending_ = std::move(pending);
  return file;
}

void File::Commit() {
  CANONPOSE_CHECK(pending_ != nullptr, "only a file made by CreateAt() can be committed, and only once");
  const fs::path path = pending_->file.path();
  const bool flushed = H5Fflush(*root_.state_->file_id, H5F_SCOPE_GLOBAL) >= 0;
  if (!flushed) ThrowWriteFailed(path);
  root_.state_->id.Close();
  if (root_.state_->file_id->Close() < 0) ThrowWriteFailed(path);
  pending_->file.Commit();
  pending_.reset();
}

}  // namespace canonpose::h5
