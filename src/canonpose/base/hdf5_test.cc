#include "canonpose/base/hdf5.h"

#include <cmath>
#include <csignal>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/resource.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"

namespace canonpose::h5 {
namespace {

using canonpose::testing::ErrorOf;
using canonpose::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

void WriteExample(const std::filesystem::path& path, std::size_t rows = 3) {
  File file = File::CreateAt(path);
  file.root().SetString("format", "example");
  file.root().SetInt("version", 1);
  Group group = file.root().Create("group");
  group.SetStrings("names", {"a", "bé", ""});
  group.SetInts("numbers", {1, -2});
  group.SetDouble("ratio", 0.5);
  group.SetStrings("no names", {});
  group.SetInts("no numbers", {});
  std::vector<float> values(rows * 2, 1.5F);
  group.Write<float>("values", values, {rows, 2});
  group.Write<float>("nothing", {}, {0, 2});
  group.Write<float>("scalar", std::vector<float>{2.5F}, {});
  file.Commit();
}

TEST(Hdf5, RoundTrip) {
  const TemporaryFolder folder;
  WriteExample(folder / "a.h5");
  File file = File::OpenForReading(folder / "a.h5");
  EXPECT_EQ(file.root().GetString("format"), "example");
  EXPECT_EQ(file.root().GetInt("version"), 1);
  EXPECT_THAT(file.root().Children(), ElementsAre("group"));
  const Group group = file.root().Open("group");
  EXPECT_THAT(group.GetStrings("names"), ElementsAre("a", "bé", ""));
  EXPECT_THAT(group.GetInts("numbers"), ElementsAre(1, -2));
  EXPECT_EQ(group.GetDouble("ratio"), 0.5);
  EXPECT_TRUE(group.GetStrings("no names").empty());
  EXPECT_TRUE(group.GetInts("no numbers").empty());
  const Array<double> values = group.Read<double>("values");
  EXPECT_THAT(values.shape, ElementsAre(3U, 2U));
  EXPECT_THAT(values.values, ElementsAre(1.5, 1.5, 1.5, 1.5, 1.5, 1.5));
  EXPECT_THAT(group.Shape("nothing"), ElementsAre(0U, 2U));
  EXPECT_THAT(group.Read<float>("scalar").values, ElementsAre(2.5F));
  EXPECT_TRUE(group.Shape("scalar").empty());
}

TEST(Hdf5, SameContentsSameBits) {
  const TemporaryFolder folder;
  WriteExample(folder / "a.h5");
  WriteExample(folder / "b.h5");
  EXPECT_EQ(ReadFile(folder / "a.h5"), ReadFile(folder / "b.h5"));
}

TEST(Hdf5, MissingThingsNameFileAndPlace) {
  const TemporaryFolder folder;
  WriteExample(folder / "a.h5");
  File file = File::OpenForReading(folder / "a.h5");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)file.root().Open("other"); }), HasSubstr("a.h5: /other"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)file.root().Open("group").Read<float>("x"); }),
              HasSubstr("/group/x: expected an array, found nothing"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)file.root().GetInt("format"); }),
              HasSubstr("attribute format"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)file.root().GetString("version"); }),
              HasSubstr("another type"));
}

/// An attribute as the library writes it from one value of a native type.
void WriteRaw(const std::filesystem::path& path, hid_t type, const void* value) {
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t space = H5Screate(H5S_SCALAR);
  const hid_t attribute = H5Acreate2(file, "x", type, space, H5P_DEFAULT, H5P_DEFAULT);
  EXPECT_GE(H5Awrite(attribute, type, value), 0);
  H5Aclose(attribute);
  H5Sclose(space);
  H5Fclose(file);
}

TEST(Hdf5, WholeNumbersAreNotClamped) {
  const TemporaryFolder folder;
  const auto read = [&] { return File::OpenForReading(folder / "a.h5").root().GetInt("x"); };
  for (const double value : {1.9, 1e300, -1e19, double{NAN}}) {
    WriteRaw(folder / "a.h5", H5T_NATIVE_DOUBLE, &value);
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, read), HasSubstr("attribute x: expected whole numbers, found")) << value;
  }
  const double whole = -3.0;
  WriteRaw(folder / "a.h5", H5T_NATIVE_DOUBLE, &whole);
  EXPECT_EQ(read(), -3);
  const std::uint64_t large = 1ULL << 63;
  WriteRaw(folder / "a.h5", H5T_NATIVE_UINT64, &large);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, read), HasSubstr("found 9223372036854775808"));
  const std::uint64_t small = 7;
  WriteRaw(folder / "a.h5", H5T_NATIVE_UINT64, &small);
  EXPECT_EQ(read(), 7);
  const std::int8_t negative = -7;
  WriteRaw(folder / "a.h5", H5T_NATIVE_INT8, &negative);
  EXPECT_EQ(read(), -7);
}

TEST(Hdf5, StringsAreWrittenWithVariableLengthAndBothKindsAreRead) {
  const TemporaryFolder folder;
  const std::string very_long(100000, 'x');
  {
    File file = File::CreateAt(folder / "a.h5");
    file.root().SetString("text", "Fuß");
    file.root().SetString("empty", "");
    file.root().SetStrings("texts", {"a", "", "bcd"});
    file.root().SetString("long", very_long);
    file.Commit();
  }
  const hid_t raw = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  for (const char* name : {"text", "empty", "texts", "long"}) {
    const hid_t attribute = H5Aopen(raw, name, H5P_DEFAULT);
    const hid_t type = H5Aget_type(attribute);
    EXPECT_GT(H5Tis_variable_str(type), 0) << name << ": h5py returns strings of fixed length as bytes";
    EXPECT_EQ(H5Tget_cset(type), H5T_CSET_UTF8) << name;
    H5Tclose(type);
    H5Aclose(attribute);
  }
  H5Fclose(raw);
  {
    File file = File::OpenForReading(folder / "a.h5");
    EXPECT_EQ(file.root().GetString("text"), "Fuß");
    EXPECT_EQ(file.root().GetString("empty"), "");
    EXPECT_THAT(file.root().GetStrings("texts"), ElementsAre("a", "", "bcd"));
    EXPECT_EQ(file.root().GetString("long"), very_long);
  }
  const hid_t fixed = H5Tcopy(H5T_C_S1);
  H5Tset_size(fixed, 20);
  const char text[20] = "of fixed length";
  WriteRaw(folder / "b.h5", fixed, text);
  H5Tclose(fixed);
  EXPECT_EQ(File::OpenForReading(folder / "b.h5").root().GetString("x"), "of fixed length");
}

/// A file with a table as PyTables writes it and texts as h5py does.
void WriteTable(const std::filesystem::path& path) {
  struct Row {
    std::int64_t index;
    float values[2];
    char name[4];
  };
  const Row rows[] = {{7, {1.5F, NAN}, "ab"}, {9, {2.5F, 3.5F}, "c"}};
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t two = 2;
  const hid_t pair = H5Tarray_create2(H5T_NATIVE_FLOAT, 1, &two);
  const hid_t fixed = H5Tcopy(H5T_C_S1);
  H5Tset_size(fixed, 4);
  const hid_t record = H5Tcreate(H5T_COMPOUND, sizeof(Row));
  H5Tinsert(record, "index", HOFFSET(Row, index), H5T_NATIVE_INT64);
  H5Tinsert(record, "values_block_0", HOFFSET(Row, values), pair);
  H5Tinsert(record, "name", HOFFSET(Row, name), fixed);
  const hid_t space = H5Screate_simple(1, &two, nullptr);
  const hid_t table = H5Dcreate2(file, "table", record, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(table, record, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows);
  const hid_t fixed_texts = H5Dcreate2(file, "fixed", fixed, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(fixed_texts, fixed, H5S_ALL, H5S_ALL, H5P_DEFAULT, "abcdx\0\0\0");
  const hid_t variable = H5Tcopy(H5T_C_S1);
  H5Tset_size(variable, H5T_VARIABLE);
  const char* const texts[] = {"left ear", "é"};
  const hid_t variable_texts = H5Dcreate2(file, "variable", variable, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(variable_texts, variable, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts);
  for (const hid_t dataset : {table, fixed_texts, variable_texts}) H5Dclose(dataset);
  for (const hid_t type : {pair, fixed, record, variable}) H5Tclose(type);
  H5Sclose(space);
  H5Fclose(file);
}

TEST(Hdf5, TextsAndColumnsOfTablesAreRead) {
  const TemporaryFolder folder;
  WriteTable(folder / "a.h5");
  const File file = File::OpenForReading(folder / "a.h5");
  EXPECT_THAT(file.root().ReadTexts("fixed"), ElementsAre("abcd", "x"));
  EXPECT_THAT(file.root().ReadTexts("variable"), ElementsAre("left ear", "é"));
  const Array<double> index = file.root().ReadField("table", "index");
  EXPECT_THAT(index.shape, ElementsAre(2U));
  EXPECT_THAT(index.values, ElementsAre(7.0, 9.0));
  const Array<double> values = file.root().ReadField("table", "values_block_0");
  EXPECT_THAT(values.shape, ElementsAre(2U, 2U));
  EXPECT_EQ(values.values[0], 1.5);
  EXPECT_TRUE(std::isnan(values.values[1]));
  EXPECT_EQ(values.values[3], 3.5);
  const auto error = [&](const char* name, const char* field) {
    return ErrorOf(ErrorKind::kBadInput, [&] { (void)file.root().ReadField(name, field); });
  };
  EXPECT_THAT(error("table", "other"), HasSubstr("expected a table with a column other, found none"));
  EXPECT_THAT(error("fixed", "index"), HasSubstr("expected a table with a column index"));
  EXPECT_THAT(error("table", "name"), HasSubstr("expected numbers in column name"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)file.root().ReadTexts("table"); }),
              HasSubstr("expected an array of texts"));
}

TEST(Hdf5, UnreadablePathsAreOneLine) {
  const std::filesystem::path path = "/tmp/" + std::string(300, 'x');
  EXPECT_FALSE(File::IsHdf5(path));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)File::OpenForReading(path); }),
              HasSubstr("File name too long"));
}

TEST(Hdf5, EveryTruncationIsNoticed) {
  const TemporaryFolder folder;
  WriteExample(folder / "a.h5", 1000);
  const std::string whole = ReadFile(folder / "a.h5");
  for (std::size_t size = 0; size < whole.size(); size += whole.size() / 23) {
    WriteFileAtomically(folder / "cut.h5", whole.substr(0, size));
    ErrorOf(ErrorKind::kBadInput, [&] { (void)File::OpenForReading(folder / "cut.h5"); });
  }
}

TEST(Hdf5, DamagedArrayIsNoticed) {
  const TemporaryFolder folder;
  WriteExample(folder / "a.h5", 1000);
  std::string bytes = ReadFile(folder / "a.h5");
  const std::size_t place = bytes.find(std::string("\0\0\xC0\x3F\0\0\xC0\x3F", 8));  // 1.5F, 1.5F
  ASSERT_NE(place, std::string::npos);
  bytes[place + 2] ^= 1;
  WriteFileAtomically(folder / "a.h5", bytes);
  File file = File::OpenForReading(folder / "a.h5");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)file.root().Open("group").Read<float>("values"); }),
              HasSubstr("damaged"));
}

/// The file's text of 8 MB claims to be of one byte; the library writes all 8 MB to the memory that it takes for it.
TEST(Hdf5, AFileThatCrashesTheLibraryIsDamaged) {
  const TemporaryFolder folder;
  {
    File file = File::CreateAt(folder / "a.h5");
    file.root().SetString("text", std::string(0x7A1200, 'x'));
    file.root().SetInt("number", 7);
    file.Commit();
  }
  std::string bytes = ReadFile(folder / "a.h5");
  constexpr std::size_t kLengthBytes = 4;
  int changed = 0;
  for (std::size_t at = 0; (at = bytes.find(std::string("\x00\x12\x7A\x00", kLengthBytes), at)) != std::string::npos;
       at += kLengthBytes) {
    // In the heap the same length takes eight bytes.
    if (bytes.substr(at + kLengthBytes, 4) == std::string(4, '\0')) continue;
    bytes.replace(at, kLengthBytes, std::string("\x01\x00\x00\x00", kLengthBytes));
    ++changed;
  }
  ASSERT_EQ(changed, 1);
  WriteFileAtomically(folder / "a.h5", bytes);
  File file = File::OpenForReading(folder / "a.h5");
  EXPECT_EQ(file.root().GetInt("number"), 7);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)file.root().GetString("text"); }),
              AllOf(HasSubstr("a.h5: /text: expected a readable HDF5 file, found a damaged one (the library that reads "
                              "it crashes)"),
                    HasSubstr("copy or create it again")));
  // The child is lost, which other files do not notice.
  ErrorOf(ErrorKind::kBadInput, [&] { (void)file.root().GetInt("number"); });
  WriteExample(folder / "b.h5");
  EXPECT_EQ(File::OpenForReading(folder / "b.h5").root().GetInt("version"), 1);
}

TEST(Hdf5, ASizeThatTheFileCannotHoldIsDamaged) {
  const TemporaryFolder folder;
  const hid_t file = H5Fcreate((folder / "a.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t size[2] = {3'000'000'000, 3};
  const hsize_t chunk[2] = {1000, 3};
  const hid_t space = H5Screate_simple(2, size, nullptr);
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(properties, 2, chunk);  // of which none is written
  H5Dclose(H5Dcreate2(file, "values", H5T_NATIVE_FLOAT, space, H5P_DEFAULT, properties, H5P_DEFAULT));
  H5Pclose(properties);
  const hid_t outside = H5Pcreate(H5P_DATASET_CREATE);
  const hsize_t three = 3;
  const hid_t small = H5Screate_simple(1, &three, nullptr);
  H5Pset_external(outside, "/etc/hostname", 0, 12);
  H5Dclose(H5Dcreate2(file, "outside", H5T_NATIVE_FLOAT, small, H5P_DEFAULT, outside, H5P_DEFAULT));
  H5Pclose(outside);
  H5Sclose(small);
  H5Sclose(space);
  H5Fclose(file);
  const File damaged = File::OpenForReading(folder / "a.h5");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)damaged.root().Shape("values"); }),
              HasSubstr("/values: expected an array that the file can hold, found (3000000000, 3)"));
  ErrorOf(ErrorKind::kBadInput, [&] { (void)damaged.root().Read<float>("values"); });
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)damaged.root().Read<float>("outside"); }),
              HasSubstr("/outside: expected an array in this file"));
}

TEST(Hdf5, FullDiskKeepsTheOldFileAtEveryMoment) {
  const TemporaryFolder folder;
  WriteExample(folder / "a.h5", 2000);
  const std::string old = ReadFile(folder / "a.h5");
  ASSERT_NE(std::signal(SIGXFSZ, SIG_IGN), SIG_ERR);
  rlimit unlimited{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &unlimited), 0);
  for (rlim_t size = 0; size < old.size(); size += 1024) {
    const rlimit limit{size, unlimited.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
    const std::string message = ErrorOf(ErrorKind::kBadInput, [&] { WriteExample(folder / "a.h5", 2000); });
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &unlimited), 0);
    EXPECT_THAT(message, HasSubstr("a.h5")) << size;
    ASSERT_EQ(ReadFile(folder / "a.h5"), old) << size;
    ASSERT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1) << size;
  }
  WriteExample(folder / "a.h5", 2000);
  EXPECT_EQ(ReadFile(folder / "a.h5"), old);
}

}  // namespace
}  // namespace canonpose::h5
