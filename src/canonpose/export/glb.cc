#include "canonpose/export/glb.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <tiny_gltf.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/median.h"
#include "canonpose/export/body_shapes.h"
#include "canonpose/export/glb_buffer.h"
#include "canonpose/motion/channels.h"

namespace canonpose {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Object = tinygltf::Value::Object;
using tinygltf::Value;

constexpr double kMetresPerMm = 0.001;
constexpr double kFrustumMm = 300.0;
constexpr double kNearPlane = 0.05;
constexpr double kFarPlane = 1000.0;  // tinygltf 2.7 writes an unknown one as 0, which is an error
constexpr double kFloorMarginMm = 1000.0;

Vector3d InFile(const Vector3d& mm) { return kMetresPerMm * YUpFromZUp(mm); }

std::vector<double> ToList(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
std::vector<double> ToList(const Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }

Value ToValue(const Eigen::MatrixXd& matrix) {
  Value::Array rows;
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    Value::Array row;
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) row.emplace_back(matrix(r, c));
    rows.emplace_back(row);
  }
  return Value(rows);
}

/// Of a colour as screens show it, 0xRRGGBB.
std::vector<double> LinearColour(unsigned rgb) {
  std::vector<double> linear;
  for (const int shift : {16, 8, 0}) {
    const double value = static_cast<double>((rgb >> shift) & 0xffU) / 255.0;
    linear.push_back(value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4));
  }
  linear.push_back(1.0);
  return linear;
}

class GlbWriter {
 public:
  explicit GlbWriter(const SceneMotion& motion) : motion_(motion), buffer_(model_) {}

  std::string Write(const std::string& scene_name) {
    model_.asset.generator = "canonpose";
    tinygltf::Scene scene;
    scene.name = scene_name;
    scene.extras = Value(Object{{"up", Value(motion_.up)}, {"scale", Value(motion_.scale)}});
    model_.scenes.push_back(scene);
    model_.defaultScene = 0;
    AddMaterials();
    std::vector<float> times(motion_.times_seconds.begin(), motion_.times_seconds.end());
    times_ = buffer_.AddFloats(times, TINYGLTF_TYPE_SCALAR, GlbBuffer::Use::kOther, true);
    animation_.name = scene_name.empty() ? "motion" : scene_name;
    for (const HierarchyFit& fit : motion_.people) AddPerson(fit);
    for (const SceneCamera& camera : motion_.cameras) AddCamera(camera);
    if (motion_.has_floor) AddFloor();
    model_.animations.push_back(animation_);
    std::ostringstream stream;
    const bool ok = tinygltf::TinyGLTF().WriteGltfSceneToStream(&model_, stream, false, true);
    CANONPOSE_CHECK(ok, "tinygltf could not write the scene");
    return stream.str();
  }

 private:
  enum Material { kLeftMaterial, kRightMaterial, kMiddleMaterial, kLineMaterial, kFloorMaterial };

  /// Blue and vermilion are of Okabe and Ito's colours, which the colour-blind tell apart.
  void AddMaterials() {
    struct Row {
      const char* name;
      unsigned rgb;
    };
    for (const Row& row : {Row{"left", 0x0072b2}, Row{"right", 0xd55e00}, Row{"middle", 0xb8b8b8},
                           Row{"camera", 0x404040}, Row{"floor", 0xe4e4e0}}) {
      tinygltf::Material material;
      material.name = row.name;
      material.pbrMetallicRoughness.baseColorFactor = LinearColour(row.rgb);
      material.pbrMetallicRoughness.metallicFactor = 0.0;
      material.pbrMetallicRoughness.roughnessFactor = 0.8;
      material.doubleSided = std::string(row.name) == "floor";
      model_.materials.push_back(material);
    }
  }

  int AddNode(tinygltf::Node node, bool is_top) {
    model_.nodes.push_back(std::move(node));
    const int index = static_cast<int>(model_.nodes.size()) - 1;
    if (is_top) model_.scenes.front().nodes.push_back(index);
    return index;
  }

  void AddChannel(int node, const std::string& path, const std::vector<float>& values, int type) {
    tinygltf::AnimationSampler sampler;
    sampler.input = times_;
    sampler.output = buffer_.AddFloats(values, type, GlbBuffer::Use::kOther);
    animation_.samplers.push_back(sampler);
    tinygltf::AnimationChannel channel;
    channel.sampler = static_cast<int>(animation_.samplers.size()) - 1;
    channel.target_node = node;
    channel.target_path = path;
    animation_.channels.push_back(channel);
  }

  void AnimateTranslation(int node, const std::vector<Vector3d>& metres) {
    std::vector<float> values;
    values.reserve(metres.size() * 3);
    for (const Vector3d& v : metres) {
      for (const double x : ToList(v)) values.push_back(static_cast<float>(x));
    }
    AddChannel(node, "translation", values, TINYGLTF_TYPE_VEC3);
  }

  /// Of the two quaternions for a rotation, that nearer to the previous frame's, since viewers interpolate.
  void AnimateRotation(int node, const std::vector<Quaterniond>& rotations) {
    std::vector<float> values;
    values.reserve(rotations.size() * 4);
    Quaterniond before = Quaterniond::Identity();
    for (Quaterniond q : rotations) {
      q.normalize();
      if (q.dot(before) < 0.0) q.coeffs() *= -1.0;
      for (const double x : ToList(q)) values.push_back(static_cast<float>(x));
      before = q;
    }
    AddChannel(node, "rotation", values, TINYGLTF_TYPE_VEC4);
  }

  /// In the rest pose, the person stands on z = 0 where they are in the first frame.
  [[nodiscard]] static Vector3d RestRoot(const ArticulatedMotion& motion) {
    double lowest = 0.0;
    for (const Vector3d& joint : RestPose(motion)) lowest = std::min(lowest, joint.z());
    const Vector3d& first = motion.root_position_mm.front();
    return {first.x(), first.y(), -lowest};
  }

  void AddPerson(const HierarchyFit& fit) {
    const ArticulatedMotion& motion = fit.motion;
    const Vector3d root_mm = RestRoot(motion);
    const std::vector<Vector3d> rest = RestPose(motion);
    tinygltf::Skin skin;
    skin.name = motion.name;
    std::vector<float> inverse_binds;
    // Joints of several people must not have the top of the scene in common: Blender would make one armature of them.
    tinygltf::Node person;
    person.name = motion.name;
    person.extras = ExtrasOf(fit);
    const int person_node = AddNode(person, true);
    const int first = person_node + 1;
    for (std::size_t j = 0; j < motion.joints.size(); ++j) {
      const MotionJoint& joint = motion.joints[j];
      tinygltf::Node node;
      node.name = joint.name;
      node.translation = ToList(InFile(joint.parent < 0 ? root_mm : joint.offset_mm));
      const int index = AddNode(node, false);
      const int parent = joint.parent < 0 ? person_node : first + joint.parent;
      model_.nodes[static_cast<std::size_t>(parent)].children.push_back(index);
      skin.joints.push_back(index);
      const Vector3d position = InFile(root_mm + rest[j]);
      // Column by column: the identity, then the translation.
      for (const double x : {1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -position.x(), -position.y(),
                             -position.z(), 1.0})
        inverse_binds.push_back(static_cast<float>(x));
    }
    skin.skeleton = first;
    skin.inverseBindMatrices = buffer_.AddFloats(inverse_binds, TINYGLTF_TYPE_MAT4, GlbBuffer::Use::kOther);
    model_.skins.push_back(skin);
    AnimatePerson(motion, first);
    AddBody(fit, root_mm);
  }

  static Value ExtrasOf(const HierarchyFit& fit) {
    return Value(Object{{"stature_mm", Value(fit.stature_mm)},
                        {"mean_error_mm", Value(fit.mean_error_mm)},
                        {"largest_error_mm", Value(fit.largest_error_mm)}});
  }

  void AnimatePerson(const ArticulatedMotion& motion, int first_node) {
    const std::size_t joints = motion.joints.size();
    std::vector<Vector3d> positions;
    for (const Vector3d& root : motion.root_position_mm) positions.push_back(InFile(root));
    AnimateTranslation(first_node, positions);
    for (std::size_t j = 0; j < joints; ++j) {
      std::vector<Quaterniond> rotations;
      bool turns = false;
      for (std::size_t t = 0; t < positions.size(); ++t) {
        const Quaterniond& rotation = motion.parent_from_joint[t * joints + j];
        turns |= rotation.vec().norm() > 1e-9;
        rotations.push_back(YUpFromZUp(rotation));
      }
      if (turns) AnimateRotation(first_node + static_cast<int>(j), rotations);
    }
  }

  void AddBody(const HierarchyFit& fit, const Vector3d& root_mm) {
    tinygltf::Mesh mesh;
    mesh.name = fit.motion.name + " body";
    const std::array<BodyMesh, 3> sides = MakeBodyShapes(fit);
    for (std::size_t side = 0; side < sides.size(); ++side) {
      const BodyMesh& shape = sides[side];
      std::vector<Vector3d> positions;
      for (const Vector3d& p : shape.positions_mm) positions.push_back(InFile(root_mm + p));
      std::vector<Vector3d> normals;
      for (const Vector3d& n : shape.normals) normals.push_back(YUpFromZUp(n));
      std::vector<std::array<std::uint8_t, 4>> joints;
      for (const int joint : shape.joints) joints.push_back({static_cast<std::uint8_t>(joint), 0, 0, 0});
      tinygltf::Primitive primitive = MakePrimitive(positions, normals, shape.indices);
      primitive.attributes["JOINTS_0"] = buffer_.AddBytes(joints, false);
      primitive.attributes["WEIGHTS_0"] =
          buffer_.AddBytes(std::vector<std::array<std::uint8_t, 4>>(joints.size(), {255, 0, 0, 0}), true);
      primitive.material = static_cast<int>(side);  // in the order of BodySide
      mesh.primitives.push_back(primitive);
    }
    model_.meshes.push_back(mesh);
    tinygltf::Node node;
    node.name = mesh.name;
    node.mesh = static_cast<int>(model_.meshes.size()) - 1;
    node.skin = static_cast<int>(model_.skins.size()) - 1;
    AddNode(node, true);
  }

  /// Triangles, or lines where there are no normals.
  tinygltf::Primitive MakePrimitive(const std::vector<Vector3d>& positions, const std::vector<Vector3d>& normals,
                                    const std::vector<std::uint32_t>& indices) {
    const auto flat = [](const std::vector<Vector3d>& points) {
      std::vector<float> values;
      for (const Vector3d& p : points) {
        for (const double x : ToList(p)) values.push_back(static_cast<float>(x));
      }
      return values;
    };
    tinygltf::Primitive primitive;
    primitive.mode = normals.empty() ? TINYGLTF_MODE_LINE : TINYGLTF_MODE_TRIANGLES;
    primitive.attributes["POSITION"] =
        buffer_.AddFloats(flat(positions), TINYGLTF_TYPE_VEC3, GlbBuffer::Use::kVertices, true);
    if (!normals.empty()) {
      primitive.attributes["NORMAL"] = buffer_.AddFloats(flat(normals), TINYGLTF_TYPE_VEC3, GlbBuffer::Use::kVertices);
    }
    primitive.indices = buffer_.AddIndices(indices);
    return primitive;
  }

  int AddMesh(const std::string& name, tinygltf::Primitive primitive, Material material) {
    primitive.material = material;
    tinygltf::Mesh mesh;
    mesh.name = name;
    mesh.primitives.push_back(std::move(primitive));
    model_.meshes.push_back(mesh);
    return static_cast<int>(model_.meshes.size()) - 1;
  }

  // In glTF, a camera looks along -z with y up; ours looks along z with y down.
  static Quaterniond RotationInFile(const Camera& camera) {
    const Quaterniond ours(Eigen::Matrix3d(camera.camera_from_world_rotation.transpose()));
    return YUpFromZUpAxes() * ours * Quaterniond(0.0, 1.0, 0.0, 0.0);
  }
  static Quaterniond YUpFromZUpAxes() { return RotationAbout(0, -0.5 * std::numbers::pi); }
  static Vector3d PositionInFile(const Camera& camera) {
    return InFile(-camera.camera_from_world_rotation.transpose() * camera.camera_from_world_translation);
  }

  void AddCamera(const SceneCamera& camera) {
    std::vector<double> fx;
    std::vector<double> fy;
    for (const Camera& calibration : camera.calibration) {
      fx.push_back(calibration.K(0, 0));
      fy.push_back(calibration.K(1, 1));
    }
    Camera middle = camera.calibration[camera.calibration.size() / 2];
    middle.K(0, 0) = Median(std::move(fx));
    middle.K(1, 1) = Median(std::move(fy));
    // Where the size of the image is unknown, its centre is the axis.
    const double width = camera.image_size_px[0] > 0 ? camera.image_size_px[0] : 2.0 * middle.K(0, 2);
    const double height = camera.image_size_px[1] > 0 ? camera.image_size_px[1] : 2.0 * middle.K(1, 2);
    tinygltf::Camera lens;
    lens.name = camera.name;
    lens.type = "perspective";
    lens.perspective.yfov = 2.0 * std::atan(0.5 * height / middle.K(1, 1));
    lens.perspective.aspectRatio = (width / middle.K(0, 0)) / (height / middle.K(1, 1));
    lens.perspective.znear = kNearPlane;
    lens.perspective.zfar = kFarPlane;
    model_.cameras.push_back(lens);
    const int frustum = AddMesh(camera.name + " frustum", FrustumOf(middle, width, height), kLineMaterial);
    tinygltf::Node shape;
    shape.name = camera.name + " frustum";
    shape.mesh = frustum;
    tinygltf::Node node;
    node.name = camera.name;
    node.camera = static_cast<int>(model_.cameras.size()) - 1;
    node.translation = ToList(PositionInFile(camera.At(0)));
    node.rotation = ToList(RotationInFile(camera.At(0)));
    node.children = {AddNode(shape, false)};
    node.extras = ExtrasOf(camera, middle);
    const int index = AddNode(node, true);
    if (camera.calibration.size() > 1) AnimateCamera(camera, index);
  }

  static Value ExtrasOf(const SceneCamera& camera, const Camera& middle) {
    Value::Array distortion;
    for (const double d : middle.distortion) distortion.emplace_back(d);
    return Value(Object{{"K", ToValue(middle.K)},
                        {"distortion", Value(distortion)},
                        {"width", Value(camera.image_size_px[0])},
                        {"height", Value(camera.image_size_px[1])},
                        {"used", Value(camera.used)}});
  }

  void AnimateCamera(const SceneCamera& camera, int node) {
    std::vector<Vector3d> positions;
    std::vector<Quaterniond> rotations;
    for (const Camera& calibration : camera.calibration) {
      positions.push_back(PositionInFile(calibration));
      rotations.push_back(RotationInFile(calibration));
    }
    AnimateTranslation(node, positions);
    AnimateRotation(node, rotations);
  }

  /// The pyramid that the camera sees, and a triangle above the image.
  tinygltf::Primitive FrustumOf(const Camera& camera, double width, double height) {
    const auto corner = [&](double x, double y) {
      const Vector3d ray((x - camera.K(0, 2)) / camera.K(0, 0), (y - camera.K(1, 2)) / camera.K(1, 1), 1.0);
      return Vector3d(kMetresPerMm * kFrustumMm * Vector3d(ray.x(), -ray.y(), -1.0));
    };
    const std::vector<Vector3d> points = {Vector3d::Zero(),
                                          corner(0.0, 0.0),
                                          corner(width, 0.0),
                                          corner(width, height),
                                          corner(0.0, height),
                                          corner(0.35 * width, -0.05 * height),
                                          corner(0.65 * width, -0.05 * height),
                                          corner(0.5 * width, -0.25 * height)};
    return MakePrimitive(points, {}, {0, 1, 0, 2, 0, 3, 0, 4, 1, 2, 2, 3, 3, 4, 4, 1, 5, 6, 6, 7, 7, 5});
  }

  /// A square below all people, with a margin.
  void AddFloor() {
    Eigen::AlignedBox3d box;
    for (const HierarchyFit& fit : motion_.people) {
      for (const Vector3d& root : fit.motion.root_position_mm) box.extend(root);
    }
    const Vector3d centre = box.center();
    const double half = 0.5 * std::max(box.sizes().x(), box.sizes().y()) + kFloorMarginMm;
    std::vector<Vector3d> corners;
    for (const auto& [x, y] : {std::pair(-1.0, -1.0), {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}})
      corners.push_back(InFile({centre.x() + x * half, centre.y() + y * half, 0.0}));
    const std::vector<Vector3d> normals(corners.size(), Vector3d::UnitY());
    tinygltf::Node node;
    node.name = "floor";
    node.mesh = AddMesh("floor", MakePrimitive(corners, normals, {0, 1, 2, 0, 2, 3}), kFloorMaterial);
    AddNode(node, true);
  }

  const SceneMotion& motion_;
  tinygltf::Model model_;
  GlbBuffer buffer_;
  tinygltf::Animation animation_;
  int times_ = -1;
};

}  // namespace

void WriteSceneGlb(const std::filesystem::path& path, const Scene& scene, const MotionExportOptions& options) {
  const SceneMotion motion = MakeSceneMotion(scene, options);
  WriteFileAtomically(path, GlbWriter(motion).Write(scene.name));
}

}  // namespace canonpose
