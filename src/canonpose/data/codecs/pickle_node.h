// What a pickle's values are made of. For the pickle's own sources alone.
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
  char letter = 0;  ///< 'f', 'i', 'u', 'b', 'O', or another that is kept but cannot be read
  std::size_t bytes = 0;
  bool big_endian = false;
  /// "<f4"
  [[nodiscard]] std::string Name() const;
  /// 2, 4 or 8 bytes of float, 1 to 8 of whole numbers, bool.
  [[nodiscard]] bool IsNumber() const;
};

/// A value while and after it is made. The last kinds exist only while the machine runs.
struct Node {
  enum class Stage {
    kDone,
    kMark,      ///< a mark of the stack
    kGlobal,    ///< a name that may be called: `text` is "numpy.ndarray"
    kElements,  ///< a numpy.dtype
    kBlank      ///< an array that BUILD is to fill
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

/// All nodes, so that values that refer to each other cost nothing to keep and to throw away.
struct Storage {
  std::string file;
  std::string place;
  std::size_t file_bytes = 0;
  std::size_t copied_bytes = 0;  ///< by calls; what they copy may not exceed what the file has
  std::deque<Node> nodes;

  Node* New(Kind kind) {
    nodes.emplace_back();
    nodes.back().kind = kind;
    return &nodes.back();
  }
};

/// Where messages of the machine point.
struct Where {
  Storage& storage;
  std::size_t byte = 0;
  [[noreturn]] void Fail(const std::string& expected, const std::string& found, const std::string& advice = "") const;
  [[noreturn]] void FailDamaged(const std::string& what) const;
  [[noreturn]] void FailName(std::string_view name) const;
  /// Counts what calls copy: by the thousand on the same value they could fill the memory from a small file.
  void Copied(std::size_t bytes) const;
};

/// Walks through all that belongs to a value, so that whoever uses it can do so without care: refuses what contains
/// itself, is nested beyond reason, or was never finished.
void RefuseEndless(const Node* root, const Where& where);

/// Whether a name is one of those that NumPy's arrays and Python's bytes are written with.
bool IsKnownName(std::string_view name);

/// What calling `function` with `arguments` makes. Only calls that describe an array, its type, a number, or bytes have
/// a meaning here.
Node* Call(Storage& storage, const Node& function, const Node& arguments, const Where& where);

/// Fills an array or a type with the state that BUILD brings.
void Build(Node& target, const Node& state, const Where& where);

}  // namespace canonpose::pickle
