#include "canonpose/base/hdf5.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <mutex>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/hdf5_handles.h"
#include "canonpose/base/hdf5_questions.h"

namespace canonpose::h5 {
namespace {

namespace fs = std::filesystem;

/// HDF5 prints a stack trace on every error, where we report one line. And where a file could not be written, such as
/// on a full disk, it would try again at exit and crash.
void PrepareLibrary() {
  static std::once_flag once;
  std::call_once(once, [] {
    H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  });
}

/// Strings of variable length, which h5py returns as str; it returns those of fixed length as bytes.
Id StringType() {
  Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

}  // namespace

std::string FormatShape(const std::vector<std::size_t>& shape) { return fmt::format("({})", fmt::join(shape, ", ")); }

// ------------------------------------------------------------------------------------------------------------ Group

const std::string& Group::file() const { return state_->file; }

void Group::Fail(const std::string& name, const std::string& expected, const std::string& found,
                 const std::string& advice) const {
  ThrowBadInput({state_->file, (path_ == "/" ? "" : path_) + "/" + name, expected, found, advice});
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
