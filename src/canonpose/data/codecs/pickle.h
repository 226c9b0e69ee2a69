// Reads Python's pickles without executing anything: numbers, texts, lists, tuples, dictionaries and NumPy arrays.
//
// A pickle is a program for a small stack machine, and some of its instructions call any function that the file names.
// Here they only create the values above; every other name is refused, and so is damaged data. Protocols 0 to 5 are
// supported, as described at https://docs.python.org/3/library/pickletools.html.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace canonpose::pickle {

enum class Kind { kNone, kBool, kInteger, kReal, kText, kBytes, kList, kTuple, kDictionary, kArray };

/// Numbers of an array, row-major.
struct Numbers {
  std::vector<std::size_t> shape;
  std::vector<double> values;
};

struct Node;
struct Storage;

/// A value of a pickle with its place, `["S1"]["Walking"][0]`. Cheap to copy; keeps the whole pickle alive. Accessors
/// throw Error(kBadInput) that names file, place, what was expected and what was found.
class Value {
 public:
  Value(std::shared_ptr<const Storage> storage, const Node* node, std::string place);

  [[nodiscard]] Kind kind() const;
  [[nodiscard]] const std::string& place() const { return place_; }
  /// "a list of 4 values", "an array (100, 17, 2) of '<f4'", ...
  [[nodiscard]] std::string Describe() const;
  /// Throws Error(kBadInput) at this place; `found` is Describe() where empty.
  [[noreturn]] void Fail(const std::string& expected, const std::string& advice = "",
                         const std::string& found = "") const;

  /// The member of a dictionary by its key, a text or a whole number written as text.
  [[nodiscard]] Value operator[](const std::string& key) const;
  [[nodiscard]] std::optional<Value> Find(const std::string& key) const;
  /// Keys of a dictionary, in the file's order; whole numbers are written as text.
  [[nodiscard]] std::vector<std::string> Keys() const;

  /// The number of elements of a list, a tuple or an array's first dimension.
  [[nodiscard]] std::size_t size() const;
  /// An element of a list, a tuple or a one-dimensional array of objects.
  [[nodiscard]] Value At(std::size_t index) const;
  /// The content of an array of objects without dimensions, in which numpy.save() wraps anything that is not an array;
  /// otherwise this value.
  [[nodiscard]] Value Unwrapped() const;

  [[nodiscard]] std::string Text() const;
  [[nodiscard]] std::int64_t Integer() const;
  /// Whether this is an array whose elements are numbers.
  [[nodiscard]] bool IsNumbers() const;
  /// Size of each dimension of any array.
  [[nodiscard]] std::vector<std::size_t> Shape() const;
  /// The numbers of an array, or of a list or tuple of numbers.
  [[nodiscard]] Numbers ToNumbers() const;
  /// Whole numbers of a one-dimensional array, list or tuple.
  [[nodiscard]] std::vector<std::int64_t> Integers() const;

 private:
  std::shared_ptr<const Storage> storage_;
  const Node* node_;
  std::string place_;
};

/// The value of a pickle in memory; `file` and `place` ("array positions_3d") are for messages. Throws Error(kBadInput)
/// for a pickle that is damaged, refers to itself, is nested too deeply, or names anything other than what NumPy's
/// arrays need; the message then contains that name, such as "os.system". Memory use is proportional to the size of
/// `bytes`, whatever lengths it claims.
Value Decode(const std::string& bytes, const std::string& file, const std::string& place = "");

/// The same of a file.
Value Load(const std::filesystem::path& path);

}  // namespace canonpose::pickle
