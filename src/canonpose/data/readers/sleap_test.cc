#include "canonpose/data/readers/sleap.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "canonpose/base/hdf5.h"
#include "canonpose/data/readers/readers_testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::ReadCameras;
using testing::TemporaryFolder;
using testing::TestData;

using Shape = std::vector<std::size_t>;

/// A file as SLEAP writes it, of nodes "head" and "tail"; what is empty is not written.
struct Analysis {
  Shape shape{1, 2, 2, 3};  // tracks, x and y, nodes, frames
  std::vector<double> tracks{10, 11, NAN, 20, 21, NAN, 30, 31, NAN, 40, NAN, NAN};
  Shape scores_shape{1, 2, 3};
  std::vector<double> scores;
  std::vector<std::int64_t> edges{0, 1};
  std::vector<const char*> nodes{"head", "tail"};

  void Write(const std::filesystem::path& path) const {
    h5::File file = h5::File::CreateAt(path);
    if (!tracks.empty()) file.root().Write<double>("tracks", tracks, shape);
    if (!scores.empty()) file.root().Write<double>("point_scores", scores, scores_shape);
    if (!edges.empty()) file.root().Write<std::int64_t>("edge_inds", edges, {edges.size() / 2, 2});
    file.Commit();
    // Our own files have no arrays of texts.
    const hid_t opened = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t text = H5Tcopy(H5T_C_S1);
    H5Tset_size(text, H5T_VARIABLE);
    const hsize_t count = nodes.size();
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    const hid_t names = H5Dcreate2(opened, "node_names", text, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(names, text, H5S_ALL, H5S_ALL, H5P_DEFAULT, nodes.data());
    H5Dclose(names);
    H5Sclose(space);
    H5Tclose(text);
    H5Fclose(opened);
  }

  [[nodiscard]] DetectedCamera Read() const {
    const TemporaryFolder folder;
    Write(folder / "cam1.analysis.h5");
    return ReadCameras("sleap", folder / "cam1.analysis.h5").front();
  }
  [[nodiscard]] std::string Error() const {
    return ErrorOf(ErrorKind::kBadInput, [&] { (void)Read(); });
  }
};

TEST(Sleap, PointsGapsAndBones) {
  const DetectedCamera camera = Analysis().Read();
  EXPECT_EQ(camera.name, "cam1");
  EXPECT_THAT(camera.layout->joints, ElementsAre("head", "tail"));
  EXPECT_THAT(camera.layout->bones, ElementsAre(std::array<int, 2>{0, 1}));
  ASSERT_EQ(camera.frames.size(), 3U);
  EXPECT_THAT(camera.frames[0].people.at(0).keypoints, ElementsAre(10, 30, 20, 40));
  EXPECT_THAT(camera.frames[0].people.at(0).confidence, ElementsAre(1, 1)) << "without scores";
  EXPECT_EQ(camera.frames[1].people.at(0).confidence[1], 0.0F) << "y is missing";
  EXPECT_TRUE(camera.frames[2].people.empty());
}

TEST(Sleap, APointThatAPersonPlacedHasNoScore) {
  Analysis file;
  file.scores = {0.5, NAN, NAN, 0.25, 0, NAN};
  const DetectedCamera camera = file.Read();
  EXPECT_THAT(camera.frames[0].people.at(0).confidence, ElementsAre(0.5F, 0.25F));
  EXPECT_EQ(camera.frames[1].people.at(0).confidence[0], 1.0F);
}

TEST(Sleap, TheSampleHasTracksAndBones) {
  const std::vector<DetectedCamera> cameras = ReadCameras("sleap", TestData("detections/sleap"));
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[1].name, "cam2");
  EXPECT_EQ(cameras[0].layout->bones.size(), 16U);
  EXPECT_EQ(cameras[0].layout->joints[5], "left shoulder");
  EXPECT_EQ(cameras[0].frames[0].people[1].track_id, 1);
  EXPECT_TRUE(cameras[0].has_tracks);
}

TEST(Sleap, WrongFilesAreRefused) {
  Analysis file;
  file.shape = {1, 2, 3, 2};
  EXPECT_THAT(file.Error(),
              HasSubstr("expected (tracks, 2, 2, frames), as there are 2 node_names, found (1, 2, 3, 2)"));
  file = Analysis();
  file.tracks.clear();
  EXPECT_THAT(file.Error(), HasSubstr("expected SLEAP's tracks and node_names, found edge_inds, node_names"));
  file = Analysis();
  file.edges = {0, 7};
  EXPECT_THAT(file.Error(), AllOf(HasSubstr("/edge_inds"), HasSubstr("found 7")));
  file = Analysis();
  file.scores = {1, 1};
  file.scores_shape = {1, 2};
  EXPECT_THAT(file.Error(), HasSubstr("expected (1, 2, 3), found (1, 2)"));
  file = Analysis();
  file.nodes = {"head", "Head"};
  EXPECT_THAT(file.Error(), HasSubstr("\"Head\" twice"));
  file = Analysis();
  file.tracks.assign(12, NAN);
  EXPECT_THAT(file.Error(), HasSubstr("nobody in any of 3 frames"));
  EXPECT_THAT(testing::ReadTextError("sleap", "a.slp", "x"), HasSubstr("expected SLEAP's analysis HDF5 file"));
  const TemporaryFolder folder;
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadCameras("sleap", folder.path()); }),
              HasSubstr("expected an analysis h5 file of SLEAP for each camera"));
}

}  // namespace
}  // namespace canonpose
