#include "canonpose/export/scene_formats.h"

#include <algorithm>
#include <utility>

#include "canonpose/analyse/analysis.h"
#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/names.h"
#include "canonpose/export/angle_table.h"
#include "canonpose/export/bvh.h"
#include "canonpose/export/c3d.h"
#include "canonpose/export/glb.h"
#include "canonpose/export/scene_csv.h"
#include "canonpose/export/scene_json.h"
#include "canonpose/export/scene_npz.h"
#include "canonpose/export/trc.h"

namespace canonpose {
namespace {

FileSpace SpaceOf(const Scene& scene, const ExportOptions& options) { return {scene, options.up, options.unit}; }

void ExportTrc(const std::filesystem::path& path, const Scene& scene, const ExportOptions& options) {
  WriteFileAtomically(
      path, TrcText(scene.people.front(), SpaceOf(scene, options), path.filename().string(), options.processing));
}

void ExportC3d(const std::filesystem::path& path, const Scene& scene, const ExportOptions& options) {
  WriteFileAtomically(path, C3dBytes(scene, SpaceOf(scene, options), options.seen_by, options.processing));
}

/// The angles as they pose a model of OpenSim, which has no trunk's.
std::vector<TimeSeries> OpenSimAngles(const PoseSequence& person, bool up_is_known) {
  std::vector<TimeSeries> angles = Analyse(person, up_is_known).angles;
  if (!up_is_known) {
    LogWarning("angles against the floor are left out, since which way is up is unknown");
    return angles;
  }
  std::erase_if(angles, [](const TimeSeries& series) { return series.name.starts_with("trunk_"); });
  for (TimeSeries& pelvis : OpenSimPelvis(person)) {
    const auto same = std::ranges::find(angles, pelvis.name, &TimeSeries::name);
    (same == angles.end() ? angles.emplace_back() : *same) = std::move(pelvis);
  }
  return angles;
}

void ExportAngles(const std::filesystem::path& path, const Scene& scene, const ExportOptions& options) {
  const PoseSequence& person = scene.people.front();
  WriteFileAtomically(
      path, AngleTable(OpenSimAngles(person, scene.up.is_known()), person, path.stem().string(), options.processing));
}

void ExportCsv(const std::filesystem::path& path, const Scene& scene, const ExportOptions& options) {
  WriteFileAtomically(path, SceneCsv(scene, SpaceOf(scene, options), options.processing));
}

void ExportJson(const std::filesystem::path& path, const Scene& scene, const ExportOptions& options) {
  WriteFileAtomically(path, SceneJson(scene, SpaceOf(scene, options), options.processing));
}

void ExportNpz(const std::filesystem::path& path, const Scene& scene, const ExportOptions& options) {
  WriteSceneNpz(path, scene, SpaceOf(scene, options), options.processing);
}

void ExportBvh(const std::filesystem::path& path, const Scene& scene, const ExportOptions& options) {
  WriteSceneBvh(path, scene, {options.joint_names});
}

void ExportGlb(const std::filesystem::path& path, const Scene& scene, const ExportOptions& options) {
  WriteSceneGlb(path, scene, {options.joint_names});
}

}  // namespace

const std::vector<SceneFormat>& SceneFormats() {
  using enum UpAxis;
  using enum FileUnit;
  // extension, contents, up, unit, holds people, needs a frame rate, writer
  static const std::vector<SceneFormat> formats = {
      {".trc", "positions, for OpenSim", kY, kMetres, false, true, ExportTrc},
      {".c3d", "positions, for Visual3D, Mokka and other software of motion labs", kZ, kMillimetres, true, true,
       ExportC3d},
      {".mot", "joint angles, for OpenSim", kY, kMetres, false, true, ExportAngles, false},
      {".sto", "joint angles, for OpenSim", kY, kMetres, false, true, ExportAngles, false},
      {".csv", "positions, for spreadsheets and data frames", kZ, kMetres, true, false, ExportCsv},
      {".npz", "positions, uncertainty and cameras, for NumPy", kZ, kMetres, true, false, ExportNpz},
      {".json", "positions, uncertainty and cameras, for any program", kZ, kMetres, true, false, ExportJson},
      {".bvh", "hierarchies of bones, for Blender and other animation software", kY, kMetres, false, false, ExportBvh,
       false},
      {".glb", "hierarchies of bones with shapes and cameras, for viewers and game engines", kY, kMetres, true, false,
       ExportGlb, false},
  };
  return formats;
}

const SceneFormat* FindSceneFormat(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  for (const SceneFormat& format : SceneFormats()) {
    if (SameName(format.extension, extension)) return &format;
  }
  return nullptr;
}

std::string SceneFormatNames() {
  std::string names;
  for (const SceneFormat& format : SceneFormats()) {
    names += (names.empty() ? "" : ", ") + std::string(format.extension);
  }
  return names;
}

}  // namespace canonpose
