#include "canonpose/data/readers/camera_files.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

const CameraFiles kFiles{{".b", ".a"},
                         "files of the format",
                         [](const fs::path& file) { return ReadFile(file) == "ours"; },
                         [](const fs::path& file) { return file.stem().string(); }};

std::vector<std::string> Found(const fs::path& path) {
  std::vector<std::string> found;
  for (const CameraInput& camera : FindCameraFiles(path, kFiles))
    found.push_back(camera.name + " " + camera.path.filename().string());
  return found;
}

TEST(CameraFiles, AreFilesOfAFolderOrOneInEachSubFolder) {
  const TemporaryFolder folder;
  const auto add = [&](const std::string& name, const char* text = "ours") {
    fs::create_directories((folder / name).parent_path());
    WriteFileAtomically(folder / name, text);
  };
  add("x/1/v.a");
  add("x/2/v.a");
  EXPECT_THAT(Found(folder / "x"), ElementsAre("1 v.a", "2 v.a"));
  EXPECT_THAT(Found(folder / "x/1"), ElementsAre("v v.a"));
  EXPECT_THAT(Found(folder / "x/1/v.a"), ElementsAre("v v.a"));
  add("x/2/w.a");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Found(folder / "x"); }),
              HasSubstr("expected one camera in each sub-folder, found 2 files"));
  add("y/l.a");
  add("y/l.b");
  add("y/r.a");
  add("y/other.a", "theirs");
  add("y/.hidden.a");
  EXPECT_THAT(Found(folder / "y"), ElementsAre("l l.b", "r r.a"));
  add("z/other.a", "theirs");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Found(folder / "z"); }),
              HasSubstr("expected files of the format, found other.a, which are not"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Found(folder / "nothing"); }), HasSubstr("No such file"));
}

TEST(FractionsToPixels, NeedTheSizeOfTheImage) {
  DetectedCamera camera;
  camera.name = "left";
  camera.frames.resize(2);
  camera.frames[1].people.push_back({{0.5F, -0.25F, NAN, NAN}, {1.0F, 0.0F}, std::nullopt, 0.0});
  EXPECT_EQ(LargestCoordinate(camera), 0.5F);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput,
                      [&] {
                        FractionsToPixels(camera, {0, 0});
                      }),
              HasSubstr("give `image_size`"));
  FractionsToPixels(camera, {200, 100});
  EXPECT_EQ(camera.frames[1].people[0].keypoints[0], 100.0F);
  EXPECT_EQ(camera.frames[1].people[0].keypoints[1], -25.0F);
  EXPECT_TRUE(std::isnan(camera.frames[1].people[0].keypoints[2]));
}

}  // namespace
}  // namespace canonpose
