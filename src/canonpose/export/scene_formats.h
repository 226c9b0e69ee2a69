// The files that a Scene is exported to, by extension. A new format is a writer and a row of the table in
// scene_formats.cc; docs/export.md describes each.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "canonpose/export/file_space.h"
#include "canonpose/motion/hierarchy_template.h"
#include "canonpose/scene/scene.h"

namespace canonpose {

struct ExportOptions {
  UpAxis up = UpAxis::kZ;
  FileUnit unit = FileUnit::kMetres;
  /// Of each person (T, J): bit c is set where camera c of the scene saw the joint; empty where that is unknown.
  std::vector<std::vector<std::uint8_t>> seen_by{};
  /// What was done to the positions, such as a filter, for the files to say; empty: nothing.
  std::string processing{};
  JointNames joint_names = JointNames::kOurs;  ///< in hierarchies
};

struct SceneFormat {
  std::string_view extension;  ///< ".trc"
  std::string_view contents;   ///< for lists of the formats: "positions, for OpenSim"
  UpAxis up;                   ///< unless another is asked for
  FileUnit unit;
  bool holds_people;      ///< several people in one file; otherwise a scene given to `write` has one
  bool needs_frame_rate;  ///< FrameRateOf() must be known (analyse/filter.h)
  /// Writes a scene, atomically. Throws Error(kBadInput) where the file cannot be written, and Error(kInvalidArgument)
  /// where the format cannot hold the scene.
  void (*write)(const std::filesystem::path& path, const Scene& scene, const ExportOptions& options);
  /// Whether positions are as FileSpace has them. Otherwise the writer says by LogWarning() what it does where up or
  /// scale is unknown.
  bool uses_file_space = true;
};

/// In the order shown to users.
const std::vector<SceneFormat>& SceneFormats();

/// By the extension of `path`, ignoring case; null where there is none.
const SceneFormat* FindSceneFormat(const std::filesystem::path& path);

/// ".trc, .c3d, ..." for messages.
std::string SceneFormatNames();

}  // namespace canonpose
