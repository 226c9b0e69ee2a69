// Reads JSON files made by other programs: every value knows its place, so that every error names the file, the place,
// what was expected and what was found.
//
// For readers only: it exposes nlohmann::json, which users of the data module do not need.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace canonpose {

/// A value of a parsed JSON file with its place, "people[0].pose_keypoints_2d". Cheap to copy; keeps the file alive.
class JsonValue {
 public:
  /// Reads and parses a file. NaN, which JSON does not allow but Python writes, is read as null. Throws
  /// Error(kBadInput) where the file cannot be read, is cut off, or contains something else that JSON does not allow.
  /// Infinity and numbers too large for a double get their own message, and so do videos, images and other files of a
  /// known kind.
  static JsonValue Load(const std::filesystem::path& path);

  [[nodiscard]] const std::string& file() const { return document_->file; }
  [[nodiscard]] const std::string& place() const { return place_; }
  [[nodiscard]] const nlohmann::json& json() const { return *value_; }

  /// The member of an object; throws Error(kBadInput) where this is not an object or has no such member.
  [[nodiscard]] JsonValue operator[](const std::string& key) const;
  /// The member, if this is an object that has it and it is not null.
  [[nodiscard]] std::optional<JsonValue> Find(const std::string& key) const;
  [[nodiscard]] bool Has(const std::string& key) const { return Find(key).has_value(); }
  /// Whether this is an object with that member, even if it is null.
  [[nodiscard]] bool Contains(const std::string& key) const { return value_->is_object() && value_->contains(key); }
  [[nodiscard]] bool IsNull() const { return value_->is_null(); }
  /// Number of elements; throws Error(kBadInput) unless this is an array.
  [[nodiscard]] std::size_t ArraySize() const;
  /// An element of an array; it must exist.
  [[nodiscard]] JsonValue At(std::size_t index) const;
  /// Names of an object's members; throws Error(kBadInput) unless this is an object.
  [[nodiscard]] std::vector<std::string> Keys() const;

  /// A finite number that is small enough to be a coordinate and to fit a float; throws Error(kBadInput) otherwise.
  [[nodiscard]] double Number() const;
  [[nodiscard]] std::int64_t Integer() const;
  /// An array of such numbers.
  [[nodiscard]] std::vector<double> Numbers() const;
  /// The same, where null and NaN (also as a string) are allowed and become NaN.
  [[nodiscard]] std::vector<double> NumbersOrNaN() const;
  [[nodiscard]] std::string String() const;

  /// "null", "the string "abc"", "an array of 74 values", ...
  [[nodiscard]] std::string Describe() const;
  /// The same with the keys of an object, or of the objects in an array: "an array of 12 objects with image_id, bbox".
  [[nodiscard]] std::string DescribeStructure() const;
  /// Throws Error(kBadInput) at this place; `found` is Describe() where empty.
  [[noreturn]] void Fail(const std::string& expected, const std::string& advice = "",
                         const std::string& found = "") const;

 private:
  // The library's move only asserts; it does not throw.
  struct Document {  // NOLINT(bugprone-exception-escape)
    std::string file;
    nlohmann::json root;
    bool has_nan = false;  // some null was NaN in the file
  };
  JsonValue(std::shared_ptr<const Document> document, const nlohmann::json* value, std::string place);

  std::shared_ptr<const Document> document_;
  const nlohmann::json* value_;
  std::string place_;
};

/// The first character of a file that is not white space; 0 where there is none. Throws Error(kBadInput) where the file
/// cannot be read.
char FirstCharacter(const std::filesystem::path& path);

}  // namespace canonpose
