// Scenes and what is computed from them, as Python objects.
#include <array>
#include <memory>

#include "python.h"
#include <fmt/format.h>
#include <pybind11/eigen.h>

#include "canonpose/analyse/analysis.h"
#include "canonpose/analyse/filter.h"
#include "canonpose/data/read_scenes.h"
#include "canonpose/data/solved_scene.h"
#include "canonpose/scene/scene.h"

namespace canonpose::python {
namespace {

using Ref = py::return_value_policy;

/// A tuple of references to elements, which keep `owner` alive.
template <typename Element>
py::tuple Elements(std::vector<Element>& elements, const py::object& owner) {
  py::tuple tuple(elements.size());
  for (std::size_t i = 0; i < elements.size(); ++i) {
    tuple[i] = py::cast(&elements[i], Ref::reference_internal, owner);
  }
  return tuple;
}

py::dict AsArrays(const std::vector<TimeSeries>& series) {
  py::dict arrays;
  for (const TimeSeries& one : series) {
    arrays[py::str(one.name)] = py::array_t<double>(static_cast<py::ssize_t>(one.values.size()), one.values.data());
  }
  return arrays;
}

void AddAnalysis(py::module_& module) {
  py::class_<FootContact>(module, "FootContact", "When a foot stands on the floor; both frames are part of it.")
      .def_readonly("is_left", &FootContact::is_left)
      .def_readonly("first_frame", &FootContact::first_frame)
      .def_readonly("last_frame", &FootContact::last_frame)
      .def("__repr__", [](const FootContact& c) {
        return fmt::format("<canonpose.FootContact {} {}-{}>", c.is_left ? "left" : "right", c.first_frame,
                           c.last_frame);
      });
  py::class_<Analysis>(module, "Analysis", "Joint angles, segment lengths, symmetry and foot contacts over time.")
      .def_property_readonly(
          "angles", [](const Analysis& a) { return AsArrays(a.angles); },
          "Degrees by name, (T) each, NaN where unknown: 'knee_angle_r', ...")
      .def_property_readonly(
          "segment_lengths", [](const Analysis& a) { return AsArrays(a.segment_lengths); }, "In the unit of the poses.")
      .def_property_readonly(
          "symmetry", [](const Analysis& a) { return AsArrays(a.symmetry); },
          "(left - right) / mean of lengths, left - right of angles.")
      .def_property_readonly("contacts", [](const Analysis& a) { return a.contacts; });
  module.def(
      "analyse", [](const PoseSequence& person, bool up_is_known) { return Analyse(person, up_is_known); },
      py::arg("person"), py::arg("up_is_known") = false,
      "What movement scientists compute from poses; docs/analysis.md has the definitions. With `up_is_known`, z must "
      "point up.");
  module.def(
      "filtered",
      [](const PoseSequence& person, double cutoff_hz, double longest_gap_seconds) {
        PoseSequence result = person;
        Filter(result, {cutoff_hz, longest_gap_seconds});
        return result;
      },
      py::arg("person"), py::arg("cutoff_hz") = 0.0, py::arg("longest_gap_seconds") = 0.0,
      "Poses with gaps filled and low-pass filtered (Butterworth, 4th order, zero phase); 0: not.");
}

/// What Scene::Validate() demands, as mistakes of the caller.
void RequireOneWorld(const Scene& scene) {
  for (const PoseSequence& person : scene.people) {
    const PoseSequence& first = scene.people.front();
    if (person.frame_count() != first.frame_count() || person.unit != first.unit || person.fps != first.fps) {
      ThrowInvalidArgument("`people`: expected poses of the same frames, frame rate and unit");
    }
  }
  const std::size_t frames = scene.people.empty() ? 0 : static_cast<std::size_t>(scene.people.front().frame_count());
  for (const SceneCamera& camera : scene.cameras) {
    if (camera.calibration.size() > 1 && camera.calibration.size() != frames) {
      ThrowInvalidArgument("`calibration` of {}: expected one camera, or one for each of {} frames, found {}",
                           camera.name, frames, camera.calibration.size());
    }
  }
}

void AddSceneTypes(py::module_& module) {
  py::class_<SceneCamera>(module, "SceneCamera", "A camera of a scene.")
      .def(py::init([](const std::string& name, const std::vector<Camera>& calibration, std::array<int, 2> image_size) {
             SceneCamera camera;
             camera.name = name;
             camera.calibration = calibration;
             camera.image_size_px = image_size;
             return camera;
           }),
           py::arg("name"), py::arg("calibration"), py::arg("image_size") = std::array<int, 2>{0, 0})
      .def_readonly("name", &SceneCamera::name)
      .def_readonly("image_size", &SceneCamera::image_size_px)
      .def_readonly("calibration", &SceneCamera::calibration, "One Camera, or one per frame; empty where unknown.")
      .def_readonly("used", &SceneCamera::used)
      .def_readonly("why_not_used", &SceneCamera::why_not_used)
      .def_readonly("time_offset_seconds", &SceneCamera::time_offset_seconds);
  py::class_<Scene>(module, "Scene", "People and cameras in one world.")
      .def(py::init([](const std::vector<PoseSequence>& people, const std::vector<SceneCamera>& cameras,
                       const std::string& name, const std::string& up, const std::string& floor,
                       const std::string& scale) {
             Scene scene;
             scene.name = name;
             scene.people = people;
             scene.cameras = cameras;
             scene.up.source = up;
             scene.floor.source = floor;
             scene.scale.source = scale;
             RequireOneWorld(scene);
             return scene;
           }),
           py::arg("people"), py::arg("cameras") = std::vector<SceneCamera>(), py::arg("name") = "", py::arg("up") = "",
           py::arg("floor") = "", py::arg("scale") = "",
           "`up`, `floor` and `scale` say what they are known from; '': unknown. People and cameras are copied.")
      .def_readonly("name", &Scene::name)
      .def_property_readonly("people", [](const py::object& s) { return Elements(s.cast<Scene&>().people, s); })
      .def_property_readonly("cameras", [](const py::object& s) { return Elements(s.cast<Scene&>().cameras, s); })
      .def_property_readonly(
          "up", [](const Scene& s) { return s.up.source; }, "What up is known from; '': unknown.")
      .def_property_readonly(
          "floor", [](const Scene& s) { return s.floor.source; }, "What the floor, z = 0, is known from; '': unknown.")
      .def_property_readonly("scale", [](const Scene& s) { return s.scale.source; })
      .def(
          "write",
          [](const Scene& scene, const std::filesystem::path& path) {
            Run({py::none()}, [&] { WriteScene(path, scene); });
          },
          py::arg("path"), "Writes a scene file (.h5).")
      .def("__repr__", [](const Scene& s) {
        return fmt::format("<canonpose.Scene {} of {} people and {} cameras>", s.name, s.people.size(),
                           s.cameras.size());
      });
}

std::vector<Scene> ScenesOf(const Dataset& dataset) { return ScenesOfSolved(dataset, "the dataset"); }

}  // namespace

void AddScenes(py::module_& module) {
  AddAnalysis(module);
  AddSceneTypes(module);
  module.def(
      "read_scenes",
      [](const std::filesystem::path& path) { return Result({py::none()}, [&] { return ReadScenes(path); }); },
      py::arg("path"), "The scenes of a file: a scene file, or a solved dataset.");
  module.def("scenes_of", &ScenesOf, py::arg("dataset"),
             "The scenes of a solved dataset: one for each sequence, but one of several people where they were filmed "
             "together.");
}

}  // namespace canonpose::python
