// Scenes as files of other programs.
#include <optional>
#include <variant>

#include "python.h"

#include "canonpose/analyse/filter.h"
#include "canonpose/data/read_scenes.h"
#include "canonpose/export/scene_formats.h"

namespace canonpose::python {
namespace {

namespace fs = std::filesystem;

ExportOptions OptionsFor(const SceneFormat& format, const std::optional<std::string>& up,
                         const std::optional<std::string>& unit, const std::string& processing) {
  ExportOptions options{format.up, format.unit};
  if (up) {
    if (*up != "y" && *up != "z") ThrowInvalidArgument("`up`: expected y or z, found {}", *up);
    options.up = *up == "y" ? UpAxis::kY : UpAxis::kZ;
  }
  if (unit) {
    if (*unit != "mm" && *unit != "m") ThrowInvalidArgument("`unit`: expected mm or m, found {}", *unit);
    options.unit = *unit == "mm" ? FileUnit::kMillimetres : FileUnit::kMetres;
  }
  options.processing = processing;
  return options;
}

void Export(const Scene& scene, const fs::path& output, const SceneFormat& format, const ExportOptions& options) {
  if (scene.people.empty()) ThrowInvalidArgument("{}: expected a scene with people", output.string());
  if (!format.holds_people && scene.people.size() > 1) {
    ThrowInvalidArgument("{} holds one person, and the scene has {}: export a Scene of each", format.extension,
                         scene.people.size());
  }
  if (format.needs_frame_rate && !(FrameRateOf(scene.people.front()) > 0.0)) {
    ThrowInvalidArgument("{} needs the frame rate, which is unknown: set `fps` of the person", format.extension);
  }
  format.write(output, scene, options);
}

}  // namespace

void AddExport(py::module_& module) {
  module.def(
      "export",
      [](const std::variant<const Scene*, fs::path>& scene, const fs::path& output,
         const std::optional<std::string>& up, const std::optional<std::string>& unit, const std::string& processing) {
        const SceneFormat* format = FindSceneFormat(output);
        if (format == nullptr) {
          ThrowInvalidArgument("{}: expected one of {}", output.string(), SceneFormatNames());
        }
        const ExportOptions options = OptionsFor(*format, up, unit, processing);
        Run({py::none()}, [&] {
          if (const auto* given = std::get_if<const Scene*>(&scene)) return Export(**given, output, *format, options);
          const auto& path = std::get<fs::path>(scene);
          const std::vector<Scene> scenes = ReadScenes(path);
          if (scenes.size() != 1) {
            ThrowInvalidArgument("{} has {} scenes: export one of read_scenes()", path.string(), scenes.size());
          }
          Export(scenes.front(), output, *format, options);
        });
      },
      py::arg("scene"), py::arg("output"), py::kw_only(), py::arg("up") = py::none(), py::arg("unit") = py::none(),
      py::arg("processing") = "",
      "Writes a scene, or the only one of a file, in the format of the extension: .trc, .c3d, .mot, .csv, ... `up` is "
      "'y' "
      "or 'z' and `unit` 'mm' or 'm', if not the format's own; `processing` says in the file what was done to the "
      "positions. See docs/export.md.");
}

}  // namespace canonpose::python
