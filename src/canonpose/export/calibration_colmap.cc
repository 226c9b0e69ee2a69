#include <Eigen/Geometry>
#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/export/calibration_text.h"

namespace canonpose {
namespace {

/// COLMAP counts pixels from the corner of the first one, OpenCV and we from its centre.
constexpr double kPixelCentre = 0.5;

/// MODEL WIDTH HEIGHT PARAMETERS of a camera.
std::string ColmapLens(const Camera& camera, const std::array<int, 2>& size, const std::string& name) {
  if (camera.K(0, 1) != 0.0) ThrowInvalidArgument("camera {} has skew, which no camera of COLMAP has", name);
  const auto [k1, k2, p1, p2, k3] = camera.distortion;
  const std::string pinhole =
      FloatList({camera.K(0, 0), camera.K(1, 1), camera.K(0, 2) + kPixelCentre, camera.K(1, 2) + kPixelCentre});
  std::string parameters = pinhole + ", " + FloatList({k1, k2, p1, p2});
  if (k3 != 0.0) parameters += ", " + FloatList({k3, 0.0, 0.0, 0.0});
  std::erase(parameters, ',');
  return fmt::format("{} {} {} {}", k3 == 0.0 ? "OPENCV" : "FULL_OPENCV", size[0], size[1], parameters);
}

/// Names of images have no spaces, at which a line is split.
std::string ColmapName(std::string name) {
  for (char& c : name) {
    if (static_cast<unsigned char>(c) <= 0x20 || c == '/' || c == '\\') c = '_';
  }
  return name;
}

struct ColmapTexts {
  std::string cameras = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n";
  std::string images =
      "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME (camera from world)\n# POINTS2D[] as X Y POINT3D_ID\n";
  std::string points = "# POINT3D_ID X Y Z R G B ERROR TRACK[] as IMAGE_ID POINT2D_IDX\n";
};

ColmapTexts ColmapFiles(const Scene& scene, const FileSpace& space) {
  ColmapTexts texts;
  const std::string note = fmt::format("# unit: {}, up: {}\n", space.unit(), space.up());
  texts.images = note + texts.images;
  texts.points = note + texts.points;
  int cameras = 0;
  int images = 0;
  for (const SceneCamera& camera : scene.cameras) {
    const bool moves = camera.calibration.size() > 1;
    std::string last_lens;
    for (std::size_t t = 0; t < camera.calibration.size(); ++t) {
      const Camera in_file = space.InFile(camera.calibration[t]);
      // A zoom is another camera.
      const std::string lens = ColmapLens(in_file, camera.image_size_px, camera.name);
      if (lens != last_lens) texts.cameras += fmt::format("{} {}\n", ++cameras, lens);
      last_lens = lens;
      const Eigen::Quaterniond q = Eigen::Quaterniond(in_file.camera_from_world_rotation).normalized();
      const Eigen::Vector3d& position = in_file.camera_from_world_translation;
      std::string pose = FloatList({q.w(), q.x(), q.y(), q.z(), position.x(), position.y(), position.z()});
      std::erase(pose, ',');
      const std::string name = ColmapName(camera.name) + (moves ? fmt::format("/{:06}", t) : "");
      // The second line would list points of the image.
      texts.images += fmt::format("{} {} {} {}.png\n\n", ++images, pose, cameras, name);
    }
  }
  return texts;
}

}  // namespace

void WriteColmapFolder(const std::filesystem::path& path, const Scene& scene, const FileSpace& space) {
  const ColmapTexts texts = ColmapFiles(scene, space);
  AtomicFolder folder(path);
  WriteFileAtomically(folder.temporary_path() / "cameras.txt", texts.cameras);
  WriteFileAtomically(folder.temporary_path() / "images.txt", texts.images);
  WriteFileAtomically(folder.temporary_path() / "points3D.txt", texts.points);
  folder.Commit();
}

}  // namespace canonpose
