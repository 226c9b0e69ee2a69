// Reading attributes and arrays.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/hdf5.h"
#include "canonpose/base/hdf5_handles.h"
#include "canonpose/base/hdf5_questions.h"

namespace canonpose::h5 {
namespace {

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

/// Attributes share a header of at most 64 KiB; one that claims to be many times larger is damaged.
constexpr std::size_t kLargestAttributeBytes = std::size_t{1} << 28;

/// How many values an attribute has; nothing where the file is so damaged that this is unknown.
std::optional<std::size_t> AttributeCount(hid_t type, hid_t space) {
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  const std::size_t size = H5Tget_size(type);
  if (count < 0 || size == 0 || static_cast<std::size_t>(count) > kLargestAttributeBytes / size) return std::nullopt;
  return static_cast<std::size_t>(count);
}

/// The texts that `read` brings into memory; nothing where that fails.
template <typename Reader>
std::optional<std::vector<std::string>> TextsBy(hid_t type, hid_t space, std::size_t count, Reader&& read) {
  std::vector<std::string> values;
  if (H5Tis_variable_str(type) > 0) {
    std::vector<char*> pointers(count, nullptr);
    if (count > 0 && read(static_cast<void*>(pointers.data())) < 0) return std::nullopt;
    for (const char* pointer : pointers) values.emplace_back(pointer == nullptr ? "" : pointer);
    H5Dvlen_reclaim(type, space, H5P_DEFAULT, pointers.data());
    return values;
  }
  const std::size_t size = H5Tget_size(type);
  std::vector<char> text(size * count);
  if (count > 0 && read(static_cast<void*>(text.data())) < 0) return std::nullopt;
  for (std::size_t i = 0; i < count; ++i) values.push_back(WithoutPadding(&text[i * size], size));
  return values;
}
}  // namespace

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
  auto values = TextsBy(type, space, *known_count, [&](void* memory) { return H5Aread(attribute, type, memory); });
  if (!values) Fail(place, "text", "damaged data", "");
  return std::move(*values);
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

std::vector<std::string> Group::ReadTexts(const std::string& name) const {
  if (state_->child) return state_->child->Ask<std::vector<std::string>>(Question::kTexts, path_, name);
  const std::size_t count = CountOf(Shape(name));
  const Id dataset(H5Dopen2(state_->id, name.c_str(), H5P_DEFAULT), H5Dclose);
  const Id type(H5Dget_type(dataset), H5Tclose);
  const Id space(H5Dget_space(dataset), H5Sclose);
  if (H5Tget_class(type) != H5T_STRING) Fail(name, "an array of texts", "another type", "");
  auto values = TextsBy(type, space, count,
                        [&](void* memory) { return H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, memory); });
  if (!values) Fail(name, "readable data", "damaged data", "restore the file from a copy or make it again");
  return std::move(*values);
}

Array<double> Group::ReadField(const std::string& name, const std::string& field) const {
  if (state_->child) return state_->child->Ask<Array<double>>(Question::kField, path_, name, field);
  Array<double> array;
  array.shape = Shape(name);
  const Id dataset(H5Dopen2(state_->id, name.c_str(), H5P_DEFAULT), H5Dclose);
  const Id record(H5Dget_type(dataset), H5Tclose);
  const int member = H5Tget_class(record) == H5T_COMPOUND ? H5Tget_member_index(record, field.c_str()) : -1;
  if (member < 0) Fail(name, "a table with a column " + field, "none", "");
  const Id stored(H5Tget_member_type(record, static_cast<unsigned>(member)), H5Tclose);
  const bool is_array = H5Tget_class(stored) == H5T_ARRAY;
  const Id element(is_array ? H5Tget_super(stored) : H5Tcopy(stored), H5Tclose);
  if (!IsNumber(element)) Fail(name, "numbers in column " + field, "another type", "");
  std::vector<hsize_t> sizes(is_array ? static_cast<std::size_t>(std::max(0, H5Tget_array_ndims(stored))) : 0);
  if (!sizes.empty()) H5Tget_array_dims2(stored, sizes.data());
  array.shape.insert(array.shape.end(), sizes.begin(), sizes.end());
  // The sizes of a field are no larger than its bytes, which Shape() has compared with the file's.
  std::size_t bytes = sizeof(double);
  for (const hsize_t size : sizes) bytes *= size;
  if (bytes > sizeof(double) * H5Tget_size(stored)) Fail(name, "readable data", "damaged data", "make the file again");
  const Id values(is_array ? H5Tarray_create2(H5T_NATIVE_DOUBLE, static_cast<unsigned>(sizes.size()), sizes.data())
                           : H5Tcopy(H5T_NATIVE_DOUBLE),
                  H5Tclose);
  const Id memory(H5Tcreate(H5T_COMPOUND, std::max<std::size_t>(bytes, 1)), H5Tclose);
  array.values.resize(CountOf(array.shape));
  if (H5Tinsert(memory, field.c_str(), 0, values) < 0 ||
      H5Dread(dataset, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.values.data()) < 0) {
    Fail(name, "readable data", "damaged data", "restore the file from a copy or make it again");
  }
  return array;
}

}  // namespace canonpose::h5
