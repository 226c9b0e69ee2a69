#include "canonpose/data/codecs/npz.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/codecs/npy.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

using Shape = std::vector<std::size_t>;

void WriteSample(const std::filesystem::path& path, bool compress) {
  NpzWriter writer(path, compress);
  writer.Add("pose3d", std::vector<float>{1.5F, -2.0F, NAN, 4.0F, 5.0F, 6.0F}, {1, 2, 3});
  writer.Add("wide", std::vector<double>{0.1}, {1});
  writer.Add("frames", std::vector<std::int64_t>{1, -5000000000}, {2});
  writer.Add("small", std::vector<std::int32_t>{7}, {});
  writer.Add("empty", std::vector<float>{}, {0, 17, 3});
  writer.AddStrings("joints", {"Hip", "Gelenk-Fuß", ""});
  writer.AddString("units", "mm");
  writer.Commit();
}

TEST(NpzTest, RoundTrip) {
  const TemporaryFolder folder;
  for (const bool compress : {false, true}) {
    WriteSample(folder / "a.npz", compress);
    const NpzReader reader(folder / "a.npz");
    EXPECT_THAT(reader.names(), ElementsAre("pose3d", "wide", "frames", "small", "empty", "joints", "units"));
    Shape shape;
    const std::vector<float> pose = reader.ReadFloats("pose3d", &shape);
    EXPECT_EQ(shape, (Shape{1, 2, 3}));
    EXPECT_EQ(pose[1], -2.0F);
    EXPECT_TRUE(std::isnan(pose[2]));
    EXPECT_EQ(std::get<std::vector<double>>(reader.Read("wide").values).front(), 0.1);
    EXPECT_EQ(std::get<std::vector<std::int64_t>>(reader.Read("frames").values).back(), -5000000000);
    EXPECT_TRUE(reader.Read("small").shape.empty());
    EXPECT_EQ(reader.Read("empty").shape, (Shape{0, 17, 3}));
    EXPECT_THAT(reader.ReadStrings("joints"), ElementsAre("Hip", "Gelenk-Fuß", ""));
    EXPECT_THAT(reader.ReadStrings("units"), ElementsAre("mm"));
  }
}

TEST(NpzTest, SameArraysSameBits) {
  const TemporaryFolder folder;
  WriteSample(folder / "a.npz", true);
  WriteSample(folder / "b.npz", true);
  EXPECT_EQ(ReadFile(folder / "a.npz"), ReadFile(folder / "b.npz"));
}

TEST(NpzTest, NothingAppearsWithoutCommit) {
  const TemporaryFolder folder;
  {
    NpzWriter writer(folder / "a.npz");
    writer.Add("a", std::vector<float>{1.0F}, {1});
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { NpzWriter(folder / "no" / "a.npz"); }), HasSubstr("a.npz"));
}

TEST(NpzTest, ReadsWhatNumPyWrites) {
  for (const char* name : {"npz/numpy.npz", "npz/numpy_compressed.npz"}) {
    const NpzReader reader(testing::TestData(name));
    Shape shape;
    for (const char* array : {"f4", "f8", "i4", "i8", "fortran"}) {
      EXPECT_EQ(reader.ReadFloats(array, &shape), (std::vector<float>{0, 1, 2, 3, 4, 5})) << array;
      EXPECT_EQ(shape, (Shape{2, 3})) << array;
    }
    EXPECT_THAT(reader.ReadStrings("text"), ElementsAre("Hip", "Fuß"));
    EXPECT_THAT(reader.ReadStrings("bytes"), ElementsAre("Hip", "Foot"));
    EXPECT_THAT(reader.ReadStrings("scalar"), ElementsAre("mm"));
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)reader.Read("objects"); }),
                AllOf(HasSubstr("array objects"), HasSubstr("pickled")));
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)reader.Read("big_endian"); }), HasSubstr("'>f4'"));
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)reader.Read("half"); }), HasSubstr("astype"));
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)reader.Read("records"); }), HasSubstr("records"));
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)reader.Read("nothing"); }), HasSubstr("f4, f8"));
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)reader.ReadFloats("text", &shape); }), HasSubstr("text"));
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)reader.ReadStrings("f4"); }), HasSubstr("numbers"));
  }
}

TEST(NpzTest, TextsOfZeroWidthAreCountedByTheShape) {
  const auto count = [](const std::vector<std::size_t>& shape) {
    const NpyArray array = npy::Parse(npy::MakeHeader("<U0", shape), "a.npz", "a");
    return std::get<std::vector<std::string>>(array.values).size();
  };
  EXPECT_EQ(count({}), 1U);
  EXPECT_EQ(count({3}), 3U);
  EXPECT_EQ(count({2, 3}), 6U);
  EXPECT_EQ(count({0}), 0U);
  EXPECT_EQ(count({5, 0}), 0U);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput,
                      [&] {
                        count({std::size_t{1} << 40, std::size_t{1} << 40});
                      }),
              HasSubstr("array a: expected a NumPy array, found a damaged header"));
}

TEST(NpzTest, DamagedFilesAreRefusedInOneLine) {
  const TemporaryFolder folder;
  WriteSample(folder / "a.npz", true);
  const std::string whole = ReadFile(folder / "a.npz");
  const auto read_all = [&] {
    const NpzReader reader(folder / "bad.npz");
    for (const std::string& name : reader.names()) (void)reader.Read(name);
  };
  for (std::size_t size = 0; size < whole.size(); size += 41) {
    WriteFileAtomically(folder / "bad.npz", std::string_view(whole).substr(0, size));
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, read_all), HasSubstr("bad.npz")) << size;
  }
  std::string flipped = whole;
  flipped[45] = static_cast<char>(flipped[45] ^ 0x55);  // within the data of the first array
  WriteFileAtomically(folder / "bad.npz", flipped);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, read_all), HasSubstr("bad.npz"));
  WriteFileAtomically(folder / "bad.npz", "no archive at all");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, read_all), HasSubstr("npz"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { NpzReader(folder / "none.npz"); }), HasSubstr("check the path"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { NpzReader(folder / std::string(300, 'x')); }),
              HasSubstr("File name too long"));
}

}  // namespace
}  // namespace canonpose
