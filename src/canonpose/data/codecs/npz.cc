#include "canonpose/data/codecs/npz.h"

#include <algorithm>
#include <cerrno>
#include <list>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zip.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/data/codecs/npy.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kExtension = ".npy";

std::size_t CountOf(const std::vector<std::size_t>& shape) {
  std::size_t count = 1;
  for (const std::size_t size : shape) count *= size;
  return count;
}

template <typename T>
std::string DescrOf() {
  if constexpr (std::is_same_v<T, float>) return "<f4";
  if constexpr (std::is_same_v<T, double>) return "<f8";
  if constexpr (std::is_same_v<T, std::int32_t>) return "<i4";
  if constexpr (std::is_same_v<T, std::int64_t>) return "<i8";
}

}  // namespace

// ------------------------------------------------------------------------------------------------------------ reading

struct NpzReader::State {
  std::string file;
  zip_t* archive = nullptr;
  std::vector<std::string> names;
  ~State() {
    if (archive != nullptr) zip_discard(archive);
  }
};

NpzReader::NpzReader(const fs::path& path) : state_(std::make_unique<State>()) {
  state_->file = path.string();
  std::error_code code;
  if (!fs::exists(path, code)) {
    ThrowBadInput({path.string(), "", "a file", code ? code.message() : "nothing", "check the path"});
  }
  int error = 0;
  state_->archive = zip_open(path.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &error);
  if (state_->archive == nullptr) {
    ThrowBadInput({path.string(), "", "a NumPy .npz archive",
                   fs::is_directory(path, code) ? "a folder" : "another format, or one that is cut short or damaged",
                   "save it again with numpy.savez"});
  }
  for (zip_int64_t i = 0; i < zip_get_num_entries(state_->archive, 0); ++i) {
    const char* name = zip_get_name(state_->archive, static_cast<zip_uint64_t>(i), 0);
    if (name == nullptr || !std::string_view(name).ends_with(kExtension)) continue;
    state_->names.emplace_back(name, std::string_view(name).size() - kExtension.size());
  }
}

NpzReader::~NpzReader() = default;

const std::vector<std::string>& NpzReader::names() const { return state_->names; }

bool NpzReader::Has(const std::string& name) const {
  return std::find(state_->names.begin(), state_->names.end(), name) != state_->names.end();
}

std::string NpzReader::ReadBytes(const std::string& name) const {
  if (!Has(name)) {
    ThrowBadInput({state_->file, "", "an array " + name,
                   state_->names.empty() ? "no arrays" : fmt::format("{}", fmt::join(state_->names, ", ")), ""});
  }
  zip_file_t* entry = zip_fopen(state_->archive, (name + std::string(kExtension)).c_str(), 0);
  std::string bytes;
  zip_int64_t got = -1;
  if (entry != nullptr) {
    // Read in small pieces, so that a damaged size cannot request all memory at once.
    std::vector<char> buffer(1 << 16);
    while ((got = zip_fread(entry, buffer.data(), buffer.size())) > 0)
      bytes.append(buffer.data(), static_cast<std::size_t>(got));
    zip_fclose(entry);
  }
  if (got < 0) {
    ThrowBadInput({state_->file, "array " + name, "readable data", "damaged data",
                   "restore the file from a copy or create it again"});
  }
  return bytes;
}

NpyArray NpzReader::Read(const std::string& name) const { return npy::Parse(ReadBytes(name), state_->file, name); }

std::string NpzReader::ReadPickle(const std::string& name) const {
  return npy::ParsePickle(ReadBytes(name), state_->file, name);
}

std::vector<float> NpzReader::ReadFloats(const std::string& name, std::vector<std::size_t>* shape) const {
  const NpyArray array = Read(name);
  if (array.is_text()) ThrowBadInput({state_->file, "array " + name, "numbers", "text", ""});
  *shape = array.shape;
  return std::visit(
      [](const auto& values) -> std::vector<float> {
        std::vector<float> floats;
        using T = typename std::decay_t<decltype(values)>::value_type;
        if constexpr (!std::is_same_v<T, std::string>) {
          floats.reserve(values.size());
          for (const T value : values) floats.push_back(static_cast<float>(value));
        }
        return floats;
      },
      array.values);
}

std::vector<std::string> NpzReader::ReadStrings(const std::string& name) const {
  NpyArray array = Read(name);
  if (!array.is_text()) ThrowBadInput({state_->file, "array " + name, "text", "numbers", ""});
  return std::get<std::vector<std::string>>(std::move(array.values));
}

// ------------------------------------------------------------------------------------------------------------ writing

struct NpzWriter::State {
  State(const fs::path& path, bool compress_entries) : file(path), compress(compress_entries) {}
  ~State() {
    if (archive != nullptr) zip_discard(archive);
  }

  [[noreturn]] void ThrowWriteFailed() {
    const int reason = archive == nullptr ? EIO : zip_error_code_system(zip_get_error(archive));
    ThrowCannotWrite(file.path(), reason == 0 ? EIO : reason);
  }

  void AddEntry(const std::string& name, std::string bytes) {
    // The library reads the buffers when the archive is closed.
    buffers.push_back(std::move(bytes));
    zip_source_t* source = zip_source_buffer(archive, buffers.back().data(), buffers.back().size(), 0);
    const zip_int64_t index =
        source == nullptr ? -1
                          : zip_file_add(archive, (name + std::string(kExtension)).c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
      zip_source_free(source);
      CANONPOSE_CHECK(zip_error_code_zip(zip_get_error(archive)) != ZIP_ER_EXISTS, "array {} is added twice", name);
      ThrowWriteFailed();
    }
    const auto entry = static_cast<zip_uint64_t>(index);
    zip_set_file_compression(archive, entry, compress ? ZIP_CM_DEFLATE : ZIP_CM_STORE, 0);
    // The earliest date of zip files, which NumPy writes too, so that the same arrays give the same bits.
    constexpr zip_uint16_t kFirstOfJanuary1980 = 1 << 5 | 1;
    zip_file_set_dostime(archive, entry, 0, kFirstOfJanuary1980, 0);
  }

  AtomicFile file;
  bool compress;
  zip_t* archive = nullptr;
  std::list<std::string> buffers;
};

NpzWriter::NpzWriter(const fs::path& path, bool compress) : state_(std::make_unique<State>(path, compress)) {
  int error = 0;
  state_->archive = zip_open(state_->file.temporary_path().c_str(), ZIP_CREATE | ZIP_TRUNCATE, &error);
  if (state_->archive == nullptr) ThrowCannotWrite(path, errno == 0 ? EIO : errno);
}

NpzWriter::~NpzWriter() = default;

template <typename T>
void NpzWriter::Add(const std::string& name, std::span<const T> values, const std::vector<std::size_t>& shape) {
  CANONPOSE_CHECK(values.size() == CountOf(shape), "{} values for shape ({})", values.size(), fmt::join(shape, ", "));
  std::string bytes = npy::MakeHeader(DescrOf<T>(), shape);
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  state_->AddEntry(name, std::move(bytes));
}
template void NpzWriter::Add<float>(const std::string&, std::span<const float>, const std::vector<std::size_t>&);
template void NpzWriter::Add<double>(const std::string&, std::span<const double>, const std::vector<std::size_t>&);
template void NpzWriter::Add<std::int32_t>(const std::string&, std::span<const std::int32_t>,
                                           const std::vector<std::size_t>&);
template void NpzWriter::Add<std::int64_t>(const std::string&, std::span<const std::int64_t>,
                                           const std::vector<std::size_t>&);

void NpzWriter::AddStrings(const std::string& name, const std::vector<std::string>& texts) {
  std::size_t width = 0;
  const std::string data = npy::EncodeTexts(texts, &width);
  state_->AddEntry(name, npy::MakeHeader(fmt::format("<U{}", width), {texts.size()}) + data);
}

void NpzWriter::AddString(const std::string& name, const std::string& text) {
  std::size_t width = 0;
  const std::string data = npy::EncodeTexts({text}, &width);
  state_->AddEntry(name, npy::MakeHeader(fmt::format("<U{}", width), {}) + data);
}

void NpzWriter::Commit() {
  CANONPOSE_CHECK(state_ != nullptr && state_->archive != nullptr, "the file has already been committed");
  CANONPOSE_CHECK(!state_->buffers.empty(), "an archive without arrays");
  if (zip_close(state_->archive) != 0) state_->ThrowWriteFailed();
  state_->archive = nullptr;
  state_->file.Commit();
}

}  // namespace canonpose
