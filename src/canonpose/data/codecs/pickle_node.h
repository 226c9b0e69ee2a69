// The representation of a pickle's values. Only for the sources of pickle.h.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canonpose/data/codecs/pickle.h"

namespace canonpose::pickle {

/// The type of an array's elements, little-endian.
struct ElementType {
  char letter = 0;  ///< 'f', 'i', 'u', 'b', 'O', or another that is stored but cannot be read
  std::size_t bytes = 0;
  bool big_endian = false;
  /// "<f4"
  [[nodiscard]] std::string Name() const;
  /// Whether elements are numbers: float of 2, 4 or 8 bytes, whole numbers of 1 to 8 bytes, or bool.
  [[nodiscard]] bool IsNumber() const;
};

/// A value, finished or in the making. All stages but kDone exist only while the machine runs.
struct Node {
  enum class Stage {
    kDone,
    kMark,      ///< a mark of the stack
    kGlobal,    ///< a name that may be called: `text` is "numpy.ndarray"
    kElements,  ///< a numpy.dtype
    kBlank      ///< an array that BUILD will fill
  };
  Kind kind = Kind::kNone;
  Stage stage = Stage::kDone;
  std::int64_t integer = 0;  ///< of kInteger and kBool
  double real = 0.0;
  std::string text;                              ///< of kText and kBytes
  std::vector<Node*> items;                      ///< of lists, tuples and arrays of objects, row-major
  std::vector<std::pair<Node*, Node*>> members;  ///< of dictionaries
  ElementType type;                              ///< of arrays
  std::vector<std::size_t> shape;
  bool column_major = false;
  const std::string* data = nullptr;  ///< of arrays of numbers: the text of another node, or `text`
};

/// Owns all nodes, so that values can refer to each other freely.
struct Storage {
  std::string file;
  std::string place;
  std::size_t file_bytes = 0;
  std::size_t copied_bytes = 0;  ///< copied by calls; may not exceed the size of the file
  std::deque<Node> nodes;

  Node* New(Kind kind) {
    nodes.emplace_back();
    nodes.back().kind = kind;
    return &nodes.back();
  }
};

/// The position of the machine, for messages.
struct Where {
  Storage& storage;
  std::size_t byte = 0;
  [[noreturn]] void Fail(const std::string& expected, const std::string& found, const std::string& advice = "") const;
  [[noreturn]] void FailDamaged(const std::string& what) const;
  [[noreturn]] void FailName(std::string_view name) const;
  /// Counts what calls copy, since thousands of calls on the same value in a small file could fill the memory.
  void Copied(std::size_t bytes) const;
};

/// Walks through a whole value and throws where it contains itself, is nested too deeply, or was never finished, so
/// that users of the value need not care.
void RefuseEndless(const Node* root, const Where& where);

/// Whether a name is one that is used to pickle NumPy's arrays and Python's bytes.
bool IsKnownName(std::string_view name);

/// The result of calling `function` with `arguments`. Only calls that create an array, its type, a number, or bytes are
/// supported.
Node* Call(Storage& storage, const Node& function, const Node& arguments, const Where& where);

/// Fills an array or a type with the state that BUILD brings.
void Build(Node& target, const Node& state, const Where& where);

}  // namespace canonpose::pickle
