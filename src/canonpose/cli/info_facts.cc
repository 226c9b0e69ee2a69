#include "canonpose/cli/info_facts.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/cli/with_torch.h"
#include "canonpose/data/codecs/npz.h"
#include "canonpose/data/dataset.h"
#include "canonpose/model/model_file.h"
#include "canonpose/scene/scene.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// Null for the value that means "none".
template <typename Value>
Facts UnlessNone(const Value& value, const Value& none = {}) {
  return value == none ? Facts() : Facts(value);
}

Facts SkeletonFacts(const Skeleton& skeleton) {
  return {{"name", UnlessNone(skeleton.name)},
          {"joints", skeleton.joints},
          {"parents", skeleton.parents},
          {"root", skeleton.root}};
}

Facts SourceFacts(const DatasetSource& source) {
  if (source.format.empty()) return nullptr;
  return {{"format", source.format},
          {"layout", UnlessNone(source.layout)},
          {"confidence_scale", source.confidence_scale},
          {"mapping", source.mapping},
          {"morph", UnlessNone(source.morph)}};
}

/// Share of joints seen, in percent.
double SeenPercent(const CameraView& view) {
  if (view.confidence.empty()) return 0.0;
  const auto seen = std::count_if(view.confidence.begin(), view.confidence.end(), [](float c) { return c > 0.0F; });
  return 100.0 * static_cast<double>(seen) / static_cast<double>(view.confidence.size());
}

Facts CameraFacts(const CameraView& view) {
  return {{"name", view.name},
          {"image_size", view.image_size},
          {"seen_percent", SeenPercent(view)},
          {"truth", !view.truth.empty()},
          {"solved", !view.solved.empty()},
          {"tracks", view.tracks.size()},
          {"calibrated", !view.calibration.empty()}};
}

/// In which unit and world the solution is; nothing where there is none.
Facts SolvedFacts(const Sequence& sequence) {
  const auto solved = std::find_if(sequence.cameras.begin(), sequence.cameras.end(),
                                   [](const CameraView& view) { return !view.solved.empty(); });
  if (solved == sequence.cameras.end()) return nullptr;
  return {{"unit", ToString(solved->solved.unit)},
          {"up", UnlessNone(sequence.solved_world.up.source)},
          {"floor", UnlessNone(sequence.solved_world.floor.source)},
          {"scale", UnlessNone(sequence.solved_world.scale.source)}};
}

Facts SequenceFacts(const Sequence& sequence) {
  Facts cameras = Facts::array();
  for (const CameraView& view : sequence.cameras) cameras.push_back(CameraFacts(view));
  return {{"name", sequence.name},
          {"subject", sequence.subject},
          {"frames", sequence.frame_count},
          {"fps", UnlessNone(sequence.fps)},
          {"static_cameras", sequence.static_cameras},
          {"capture", sequence.capture},
          {"actions", sequence.actions},
          {"truth_kind", UnlessNone(sequence.truth_kind)},
          {"scene", UnlessNone(sequence.scene)},
          {"solved", SolvedFacts(sequence)},
          {"cameras", std::move(cameras)}};
}

void AddDataset(const Dataset& dataset, Facts& facts) {
  std::size_t frames = 0;
  Facts sequences = Facts::array();
  for (const Sequence& sequence : dataset.sequences) {
    frames += static_cast<std::size_t>(sequence.frame_count);
    sequences.push_back(SequenceFacts(sequence));
  }
  facts["frames"] = frames;
  facts["fingerprint"] = fmt::format("{:016x}", dataset.Fingerprint());
  facts["skeleton"] = SkeletonFacts(dataset.skeleton);
  facts["source"] = SourceFacts(dataset.source);
  facts["sequences"] = std::move(sequences);
}

Facts MirrorFacts(const MirrorDecision& mirror) {
  const bool is_measured = mirror.slope_error > 0.0;
  return {{"decision", mirror.decision},
          {"slope", is_measured ? Facts(mirror.slope) : Facts()},
          {"slope_error", is_measured ? Facts(mirror.slope_error) : Facts()}};
}

Facts TrapFacts(const TrapFinding& trap) {
  if (trap.verdict.empty()) return nullptr;
  return {{"verdict", trap.verdict},
          {"depth_ratio", trap.depth_ratio},
          {"angle_deg", trap.angle_deg},
          {"scatter_deg", trap.scatter_deg}};
}

void AddModel(const ModelInfo& info, const fs::path& path, Facts& facts) {
  facts["program_version"] = info.program_version;
  facts["preset"] = info.preset;
  facts["network"] = ToString(info.network);
  facts["width"] = info.width;
  facts["seed"] = info.seed;
  facts["steps"] = info.steps;
  facts["mirror"] = MirrorFacts(info.mirror);
  facts["trap"] = TrapFacts(info.trap);
  facts["morph"] = info.morph ? Facts{{"width", info.morph->info.width}} : Facts();
  facts["perspective"] = UnlessNone(info.perspective);
  facts["data"] = Facts::array();
  for (std::size_t i = 0; i < info.data_files.size(); ++i) {
    facts["data"].push_back({{"file", info.data_files[i]}, {"fingerprint", info.data_fingerprints[i]}});
  }
  facts["skeleton"] = SkeletonFacts(info.skeleton);
  facts["source"] = SourceFacts(info.source);
  facts["options"] = Facts::parse(info.options, nullptr, /*allow_exceptions=*/false);
  if (facts["options"].is_discarded()) {
    ThrowBadInput({path.string(), "attribute options", "the options of training as JSON", "damaged text",
                   "restore the file or train again"});
  }
}

void AddScene(const Scene& scene, Facts& facts) {
  facts["name"] = UnlessNone(scene.name);
  facts["unit"] = scene.people.empty() ? Facts() : Facts(ToString(scene.people.front().unit));
  for (const auto& [what, known] : {std::pair("up", &scene.up), {"floor", &scene.floor}, {"scale", &scene.scale}}) {
    facts[what] = UnlessNone(known->source);
  }
  facts["frames"] = scene.people.empty() ? 0 : scene.people.front().frame_count();
  facts["fps"] = scene.people.empty() ? Facts() : UnlessNone(scene.people.front().fps);
  facts["people"] = Facts::array();
  for (const PoseSequence& person : scene.people) {
    facts["people"].push_back({{"name", UnlessNone(person.name)}, {"joints", person.skeleton().joints}});
  }
  facts["cameras"] = Facts::array();
  for (const SceneCamera& camera : scene.cameras) {
    facts["cameras"].push_back({{"name", camera.name},
                                {"image_size", camera.image_size_px},
                                {"used", camera.used},
                                {"calibrated", !camera.calibration.empty()}});
  }
}

/// Of what `export` writes as .json (export/scene_json.h).
void AddSceneJson(const Facts& json, Facts& facts) {
  facts["kind"] = "scene";
  facts["name"] = json.at("name");
  facts["unit"] = json.at("unit");
  facts["up"] = json.at("up_from");
  facts["floor"] = nullptr;
  facts["scale"] = json.at("unit_from");
  facts["frames"] = json.at("time").size();
  facts["fps"] = json.at("fps");
  facts["people"] = Facts::array();
  for (const Facts& person : json.at("people")) {
    facts["people"].push_back({{"name", person.at("name")}, {"joints", person.at("joints")}});
  }
  facts["cameras"] = Facts::array();
  for (const Facts& camera : json.at("cameras")) {
    facts["cameras"].push_back({{"name", camera.at("name")},
                                {"image_size", camera.at("image_size")},
                                {"used", camera.at("used")},
                                {"calibrated", camera.contains("K") && !camera["K"].is_null()}});
  }
}

void AddArrays(const fs::path& path, Facts& facts) {
  const NpzReader file(path);
  facts["arrays"] = Facts::array();
  for (const std::string& name : file.names()) {
    const NpyArray array = file.Read(name);
    const bool is_single_text = array.is_text() && array.shape.empty();
    facts["arrays"].push_back(
        {{"name", name},
         {"shape", array.shape},
         {"text", is_single_text ? Facts(std::get<std::vector<std::string>>(array.values).front()) : Facts()}});
  }
}

/// The cells of a line of CSV as RFC 4180 has it.
std::vector<std::string> CellsOf(const std::string& line) {
  std::vector<std::string> cells(1);
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && is_quoted && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += line[i++];
    } else if (c == '"') {
      is_quoted = !is_quoted;
    } else if (c == ',' && !is_quoted) {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  return cells;
}

[[noreturn]] void ThrowNotOurs(const fs::path& path, const std::string& found) {
  ThrowBadInput({path.string(), "", "a file that canonpose wrote", found,
                 "keypoints of a detector are read by `canonpose import` and `canonpose lift`"});
}

/// Poses of `lift`, whose header is "frame,time [s],Hip_x [mm],Hip_y [mm],...", or errors of `evaluate`.
void AddTable(const fs::path& path, Facts& facts) {
  const std::string text = ReadFile(path);
  const std::vector<std::string> header = CellsOf(text.substr(0, text.find('\n')));
  const auto lines = std::count(text.begin(), text.end(), '\n') + (text.empty() || text.back() == '\n' ? 0 : 1);
  if (std::ranges::count(header, "n_mpjpe_mm") == 1) {
    facts["kind"] = "errors";
    facts["poses"] = lines - 1;
    facts["columns"] = header;
    return;
  }
  Facts joints = Facts::array();
  Facts units;
  for (const std::string& cell : header) {
    const std::size_t mark = cell.rfind("_x [");
    if (mark == std::string::npos || !cell.ends_with(']')) continue;
    joints.push_back(cell.substr(0, mark));
    units = cell.substr(mark + 4, cell.size() - mark - 5);
  }
  if (header.front() != "frame" || joints.empty()) ThrowNotOurs(path, "another table");
  facts["kind"] = "poses";
  facts["written_by"] = std::ranges::count(header, "up") == 1 ? "export" : "lift";
  facts["frames"] = lines - 1;
  facts["units"] = units;
  facts["joints"] = joints;
}

/// Poses of `lift`, or a report.
void AddJson(const fs::path& path, Facts& facts) {
  const Facts json = Facts::parse(ReadFile(path), nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded()) ThrowNotOurs(path, "text that is not JSON");
  const auto has = [&](const char* key) { return json.is_object() && json.contains(key); };
  if (has("format") && json["format"] == "canonpose-scene-json") {
    AddSceneJson(json, facts);
  } else if (has("pose3d") && has("joints") && has("units")) {
    facts["kind"] = "poses";
    facts["written_by"] = "lift";
    facts["frames"] = json["pose3d"].size();
    facts["units"] = json["units"];
    facts["joints"] = json["joints"];
  } else if (has("protocol") && has("n_mpjpe_mm") && has("p_mpjpe_mm")) {
    facts["kind"] = "evaluation";
    for (const char* key : {"protocol", "frames", "n_mpjpe_mm", "p_mpjpe_mm"}) facts[key] = json[key];
  } else if (has("captures") && json["captures"].is_array()) {
    facts["kind"] = "solve report";
    facts["captures"] = json["captures"].size();
  } else if (has("protocols") && json["protocols"].is_array()) {
    facts["kind"] = "protocols";
    facts["protocols"] = json["protocols"].size();
  } else if (has("cameras") && json["cameras"].is_object() && !has("format")) {
    facts["kind"] = "calibration";
    facts["cameras"] = Facts::array();
    for (const auto& [name, camera] : json["cameras"].items()) facts["cameras"].push_back(name);
  } else {
    ThrowNotOurs(path, "other JSON");
  }
}

}  // namespace

Facts FactsOf(const fs::path& path) {
  if (!fs::exists(path)) ThrowBadInput({path.string(), "", "a file", "nothing", "check the path"});
  Facts facts = {{"file", path.string()}, {"kind", ""}};
  const fs::path checkpoint = fs::is_directory(path) ? path / "checkpoint.h5" : path;
  if (IsModel(path)) {
    facts["kind"] = "model";
    AddModel(ReadModelInfo(path), path, facts);
  } else if (const std::optional<ModelInfo> info = CheckpointInfo(checkpoint)) {
    facts["kind"] = "checkpoint";
    AddModel(*info, checkpoint, facts);
  } else if (path.extension() == ".npz") {
    facts["kind"] = "npz";
    AddArrays(path, facts);
  } else if (path.extension() == ".csv") {
    AddTable(path, facts);
  } else if (path.extension() == ".json") {
    AddJson(path, facts);
  } else if (IsSceneFile(path)) {
    facts["kind"] = "scene";
    AddScene(ReadScene(path), facts);
  } else {
    facts["kind"] = "dataset";
    AddDataset(ReadDataset(path, TracksInDataset::kAllowed), facts);
  }
  return facts;
}

}  // namespace canonpose
