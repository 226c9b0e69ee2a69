// The stack machine, with those instructions of protocols 0 to 5 that only create values.
#include "canonpose/data/codecs/pickle.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <string_view>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/data/codecs/pickle_node.h"
#include "canonpose/data/codecs/utf8.h"

namespace canonpose::pickle {
namespace {

constexpr int kHighestProtocol = 5;
/// Longer whole numbers do not fit into 64 bits.
constexpr std::size_t kLongestInteger = 8;

std::string DecodeEscapes(std::string_view text, bool raw_unicode, const Where& where) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const char next = c == '\\' && i + 1 < text.size() ? text[i + 1] : '\0';
    const std::size_t digits = next == 'U' ? 8 : next == 'u' ? 4 : 2;
    const bool is_code = raw_unicode ? next == 'u' || next == 'U' : next == 'x';
    if (is_code) {
      std::uint32_t code = 0;
      const char* const begin = text.data() + i + 2;
      const bool is_complete = i + 2 + digits <= text.size();
      if (!is_complete || std::from_chars(begin, begin + digits, code, 16).ptr != begin + digits || code > 0x10FFFF) {
        where.FailDamaged("text with a damaged escape sequence");
      }
      if (raw_unicode) AppendUtf8(code, plain);
      if (!raw_unicode) plain += static_cast<char>(code);
      i += 1 + digits;
    } else if (!raw_unicode && next != '\0') {
      static constexpr std::string_view kLetters = "ntr";
      static constexpr std::string_view kMeanings = "\n\t\r";
      const std::size_t letter = kLetters.find(next);
      plain += letter == std::string_view::npos ? next : kMeanings[letter];
      ++i;
    } else if (raw_unicode) {
      AppendUtf8(static_cast<unsigned char>(c), plain);
    } else {
      plain += c;
    }
  }
  return plain;
}

class Machine {
 public:
  Machine(Storage& storage, std::string_view bytes) : storage_(storage), bytes_(bytes) {}

  const Node* Run() {
    while (true) {
      operation_at_ = at_;
      const auto operation = static_cast<unsigned char>(Take(1)[0]);
      if (operation == '.') return Pop();
      const bool is_known = Number(operation) || Text(operation) || Collection(operation) || Memo(operation) ||
                            NameOrCall(operation) || Frame(operation);
      if (!is_known) Refuse(operation);
    }
  }

 private:
  [[nodiscard]] Where Here() const { return {storage_, operation_at_}; }
  [[noreturn]] void FailDamaged(const std::string& what) const { Here().FailDamaged(what); }

  std::string_view Take(std::uint64_t count) {
    if (count > bytes_.size() - at_) {
      FailDamaged(count == 1 ? "its end before the end of the pickle"
                             : fmt::format("{} bytes where {} remain", count, bytes_.size() - at_));
    }
    const std::string_view taken = bytes_.substr(at_, count);
    at_ += count;
    return taken;
  }

  std::string_view TakeLine() {
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos) FailDamaged("a line without an end");
    const std::string_view line = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    return line;
  }

  /// A little-endian number of 1 to 8 bytes.
  std::uint64_t Natural(std::size_t width) {
    std::uint64_t value = 0;
    const std::string_view bytes = Take(width);
    std::memcpy(&value, bytes.data(), width);
    return value;
  }

  std::int64_t TakeDecimal() {
    std::string_view line = TakeLine();
    if (line.ends_with('L')) line.remove_suffix(1);
    std::int64_t value = 0;
    const char* const end = line.data() + line.size();
    if (line.empty() || std::from_chars(line.data(), end, value).ptr != end) {
      FailDamaged(fmt::format("\"{}\" instead of a 64-bit whole number", line.substr(0, 40)));
    }
    return value;
  }

  void Push(Node* node) { stack_.push_back(node); }
  Node* PushNew(Kind kind) {
    Push(storage_.New(kind));
    return stack_.back();
  }
  void PushInteger(std::int64_t value) { PushNew(Kind::kInteger)->integer = value; }
  void PushBool(bool value) { PushNew(Kind::kBool)->integer = value ? 1 : 0; }
  void PushText(Kind kind, std::string_view text) { PushNew(kind)->text = text; }

  Node* Top() {
    if (stack_.empty() || stack_.back()->stage == Node::Stage::kMark) FailDamaged("an instruction without its values");
    return stack_.back();
  }
  Node* Pop() {
    Node* const node = Top();
    stack_.pop_back();
    return node;
  }
  std::vector<Node*> PopToMark() {
    const auto mark = std::find_if(stack_.rbegin(), stack_.rend(),
                                   [](const Node* node) { return node->stage == Node::Stage::kMark; });
    if (mark == stack_.rend()) FailDamaged("an instruction without its mark");
    std::vector<Node*> items(mark.base(), stack_.end());
    stack_.erase(mark.base() - 1, stack_.end());
    return items;
  }
  Node* TopOf(Kind kind) {
    Node* const node = Top();
    if (node->kind != kind || node->stage != Node::Stage::kDone)
      FailDamaged("an instruction for another kind of value");
    return node;
  }

  /// A whole number from its bytes, least significant first, in two's complement.
  void PushLong(std::uint64_t width) {
    if (width > kLongestInteger) {
      Take(width);
      FailDamaged(fmt::format("a whole number of {} bytes, more than 64 bits", width));
    }
    const auto bits = static_cast<unsigned>(8 * width);
    std::uint64_t value = width == 0 ? 0 : Natural(width);
    if (bits > 0 && bits < 64 && (value >> (bits - 1) & 1U) != 0) value |= ~std::uint64_t{0} << bits;
    PushInteger(static_cast<std::int64_t>(value));
  }

  bool Number(unsigned char operation) {
    switch (operation) {
      case 'N':
        PushNew(Kind::kNone);
        return true;
      case 0x88:
      case 0x89:
        PushBool(operation == 0x88);
        return true;
      case 'I':
        if (bytes_.substr(at_).starts_with("00\n") || bytes_.substr(at_).starts_with("01\n")) {
          PushBool(TakeLine() == "01");
        } else {
          PushInteger(TakeDecimal());
        }
        return true;
      case 'L':
        PushInteger(TakeDecimal());
        return true;
      case 'J':
        PushInteger(static_cast<std::int32_t>(Natural(4)));
        return true;
      case 'K':
        PushInteger(static_cast<std::int64_t>(Natural(1)));
        return true;
      case 'M':
        PushInteger(static_cast<std::int64_t>(Natural(2)));
        return true;
      case 0x8a:
        PushLong(Natural(1));
        return true;
      case 0x8b:
        PushLong(Natural(4));
        return true;
      default:
        return Real(operation);
    }
  }

  bool Real(unsigned char operation) {
    double value = 0.0;
    if (operation == 'F') {
      const std::string_view line = TakeLine();
      const char* const end = line.data() + line.size();
      if (line.empty() || std::from_chars(line.data(), end, value).ptr != end) FailDamaged("a damaged number");
    } else if (operation == 'G') {
      std::string big_endian(Take(8));
      std::reverse(big_endian.begin(), big_endian.end());
      std::memcpy(&value, big_endian.data(), 8);
    } else {
      return false;
    }
    PushNew(Kind::kReal)->real = value;
    return true;
  }

  bool Text(unsigned char operation) {
    switch (operation) {
      case 'X':
        PushText(Kind::kText, Take(Natural(4)));
        return true;
      case 0x8c:
        PushText(Kind::kText, Take(Natural(1)));
        return true;
      case 0x8d:
        PushText(Kind::kText, Take(Natural(8)));
        return true;
      case 'V':
        PushText(Kind::kText, DecodeEscapes(TakeLine(), true, Here()));
        return true;
      case 'S':
        PushQuoted(TakeLine());
        return true;
      case 'T':  // strings of Python 2, which are bytes
        PushText(Kind::kText, Take(Natural(4)));
        return true;
      case 'U':
        PushText(Kind::kText, Take(Natural(1)));
        return true;
      case 'B':
        PushText(Kind::kBytes, Take(Natural(4)));
        return true;
      case 'C':
        PushText(Kind::kBytes, Take(Natural(1)));
        return true;
      case 0x8e:
      case 0x96:  // a bytearray, which is treated as bytes
        PushText(Kind::kBytes, Take(Natural(8)));
        return true;
      default:
        return false;
    }
  }

  void PushQuoted(std::string_view line) {
    const bool is_quoted =
        line.size() >= 2 && (line.front() == '\'' || line.front() == '"') && line.back() == line.front();
    if (!is_quoted) FailDamaged("text without quotes");
    PushText(Kind::kText, DecodeEscapes(line.substr(1, line.size() - 2), false, Here()));
  }

  void PushTuple(std::vector<Node*> items) { PushNew(Kind::kTuple)->items = std::move(items); }

  void AddMembers(Node& dictionary, const std::vector<Node*>& items) {
    if (items.size() % 2 != 0) FailDamaged("a key without its value");
    for (std::size_t i = 0; i + 1 < items.size(); i += 2) dictionary.members.emplace_back(items[i], items[i + 1]);
  }

  bool Collection(unsigned char operation) {
    switch (operation) {
      case '(':
        PushNew(Kind::kNone)->stage = Node::Stage::kMark;
        return true;
      case ')':
        PushTuple({});
        return true;
      case 't':
        PushTuple(PopToMark());
        return true;
      case 0x85:
      case 0x86:
      case 0x87: {
        std::vector<Node*> items(operation - 0x84U);
        for (auto item = items.rbegin(); item != items.rend(); ++item) *item = Pop();
        PushTuple(std::move(items));
        return true;
      }
      case ']':
        PushNew(Kind::kList);
        return true;
      case 'l': {
        std::vector<Node*> items = PopToMark();
        PushNew(Kind::kList)->items = std::move(items);
        return true;
      }
      case '}':
        PushNew(Kind::kDictionary);
        return true;
      case 'd': {
        const std::vector<Node*> items = PopToMark();
        AddMembers(*PushNew(Kind::kDictionary), items);
        return true;
      }
      default:
        return Addition(operation);
    }
  }

  bool Addition(unsigned char operation) {
    switch (operation) {
      case 'a': {
        Node* const item = Pop();
        TopOf(Kind::kList)->items.push_back(item);
        return true;
      }
      case 'e': {
        const std::vector<Node*> items = PopToMark();
        std::vector<Node*>& list = TopOf(Kind::kList)->items;
        list.insert(list.end(), items.begin(), items.end());
        return true;
      }
      case 's': {
        Node* const value = Pop();
        Node* const key = Pop();
        TopOf(Kind::kDictionary)->members.emplace_back(key, value);
        return true;
      }
      case 'u': {
        const std::vector<Node*> items = PopToMark();
        AddMembers(*TopOf(Kind::kDictionary), items);
        return true;
      }
      default:
        return false;
    }
  }

  void Get(std::uint64_t key) {
    const auto kept = memo_.find(key);
    if (kept == memo_.end()) FailDamaged(fmt::format("value {} before it is stored", key));
    Push(kept->second);
  }

  bool Memo(unsigned char operation) {
    switch (operation) {
      case 'g':
        Get(static_cast<std::uint64_t>(TakeDecimal()));
        return true;
      case 'h':
        Get(Natural(1));
        return true;
      case 'j':
        Get(Natural(4));
        return true;
      case 'p':
        memo_[static_cast<std::uint64_t>(TakeDecimal())] = Top();
        return true;
      case 'q':
        memo_[Natural(1)] = Top();
        return true;
      case 'r':
        memo_[Natural(4)] = Top();
        return true;
      case 0x94:
        memo_[memo_.size()] = Top();
        return true;
      case '0':
        if (stack_.empty()) FailDamaged("an instruction without its values");
        stack_.pop_back();
        return true;
      case '1':
        PopToMark();
        return true;
      case '2':
        Push(Top());
        return true;
      default:
        return false;
    }
  }

  void PushName(std::string_view module, std::string_view name) {
    const std::string full = fmt::format("{}.{}", module, name);
    if (!IsKnownName(full)) Here().FailName(full);
    Node* const global = PushNew(Kind::kNone);
    global->stage = Node::Stage::kGlobal;
    global->text = full;
  }

  bool NameOrCall(unsigned char operation) {
    switch (operation) {
      case 'c': {
        const std::string_view module = TakeLine();
        PushName(module, TakeLine());
        return true;
      }
      case 0x93: {
        const Node* const name = Pop();
        const Node* const module = Pop();
        if (name->kind != Kind::kText || module->kind != Kind::kText) FailDamaged("a name that is not text");
        PushName(module->text, name->text);
        return true;
      }
      case 'i': {
        const std::string_view module = TakeLine();
        Here().FailName(fmt::format("{}.{}", module, TakeLine()));
      }
      case 'R': {
        const Node* const arguments = Pop();
        const Node* const function = Pop();
        if (function->stage != Node::Stage::kGlobal || arguments->kind != Kind::kTuple) {
          FailDamaged("a call of something that is not a function");
        }
        Push(Call(storage_, *function, *arguments, Here()));
        return true;
      }
      case 'b': {
        const Node* const state = Pop();
        Build(*Top(), *state, Here());
        return true;
      }
      default:
        return false;
    }
  }

  bool Frame(unsigned char operation) {
    if (operation == 0x95) {
      const std::uint64_t length = Natural(8);
      if (length > bytes_.size() - at_) {
        FailDamaged(fmt::format("a frame of {} bytes where {} remain", length, bytes_.size() - at_));
      }
      return true;
    }
    if (operation != 0x80) return false;
    const std::uint64_t protocol = Natural(1);
    if (protocol > kHighestProtocol) {
      Here().Fail(fmt::format("a pickle of protocol 0 to {}", kHighestProtocol), fmt::format("protocol {}", protocol),
                  fmt::format("save it with pickle.dump(data, file, protocol={})", kHighestProtocol));
    }
    return true;
  }

  [[noreturn]] void Refuse(unsigned char operation) const {
    static const std::unordered_map<unsigned char, const char*> names = {
        {'P', "a reference to what is outside the file"},
        {'Q', "a reference to what is outside the file"},
        {'o', "an object of a class"},
        {0x81, "an object of a class"},
        {0x92, "an object of a class"},
        {0x82, "a registered extension"},
        {0x83, "a registered extension"},
        {0x84, "a registered extension"},
        {0x8f, "a set"},
        {0x90, "a set"},
        {0x91, "a set"},
        {0x97, "a buffer outside the file"},
        {0x98, "a buffer outside the file"}};
    const auto known = names.find(operation);
    if (known == names.end()) FailDamaged(fmt::format("the unknown instruction 0x{:02x}", operation));
    Here().Fail("numbers, texts, lists, tuples, dictionaries and NumPy arrays", known->second,
                "save these alone with pickle.dump");
  }

  Storage& storage_;
  std::string_view bytes_;
  std::size_t at_ = 0;
  std::size_t operation_at_ = 0;
  std::vector<Node*> stack_;
  std::unordered_map<std::uint64_t, Node*> memo_;
};

}  // namespace

Value Decode(const std::string& bytes, const std::string& file, const std::string& place) {
  auto storage = std::make_shared<Storage>();
  storage->file = file;
  storage->place = place;
  storage->file_bytes = bytes.size();
  const Node* const root = Machine(*storage, bytes).Run();
  RefuseEndless(root, {*storage, bytes.size()});
  return {storage, root, ""};
}

Value Load(const std::filesystem::path& path) { return Decode(ReadFile(path), path.string()); }

}  // namespace canonpose::pickle
