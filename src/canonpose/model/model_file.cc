#include "canonpose/model/model_file.h"

#include <optional>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/scene/skeleton_file.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormat = "canonpose-model";
constexpr std::int64_t kLatestVersion = 3;
constexpr std::int64_t kLargestWidth = 65536;

fs::path ModelPath(const fs::path& path) { return fs::is_directory(path) ? path / "model.cpm" : path; }

void RequireModel(const h5::Group& root) {
  if (!root.HasAttribute("format") || root.GetString("format") != kFormat) {
    root.Fail("attribute format", fmt::format("\"{}\"", kFormat),
              root.HasAttribute("format") ? fmt::format("\"{}\"", root.GetString("format")) : "nothing",
              "give a model made by `canonpose train`");
  }
  if (const std::int64_t version = root.GetInt("version"); version < 1 || version > kLatestVersion) {
    root.Fail("attribute version", fmt::format("1 to {}", kLatestVersion), fmt::format("{}", version),
              "it was made by another version of this program: use that one or train again");
  }
}

h5::File OpenModel(const fs::path& path) {
  const fs::path file_path = ModelPath(path);
  if (fs::is_directory(path) && !fs::exists(file_path)) {
    ThrowBadInput({path.string(), "", "the model.cpm of a finished training run", "none in this folder",
                   "finish the training with `resume`"});
  }
  h5::File file = h5::File::OpenForReading(file_path);
  RequireModel(file.root());
  return file;
}

/// The first version whose readers understand the model.
int VersionOf(const ModelInfo& info) {
  const bool sees_confidences = info.input.confidences == ConfidenceInput::kAll;
  if (info.network != NetworkKind::kCanonical || !sees_confidences || info.morph != nullptr) return 3;
  return info.rotation != RotationForm::kAxisAngle || info.input.ray != RayForm::kOff ? 2 : 1;
}

/// Leaves `value` at its default where the attribute is missing, as in files of version 1.
template <NamedEnum Enum>
void ReadEnum(const h5::Group& root, const char* name, Enum& value) {
  if (!root.HasAttribute(name)) return;
  const std::string word = root.GetString(name);
  const std::optional<Enum> parsed = ParseEnum<Enum>(word);
  if (!parsed) {
    root.Fail(fmt::format("attribute {}", name), fmt::format("one of {}", JoinEnumNames<Enum>()),
              fmt::format("\"{}\"", word),
              "it was made by another version of this program: use that one or train again");
  }
  value = *parsed;
}

}  // namespace

std::vector<std::string> DoubtsAbout(const ModelInfo& info) {
  std::vector<std::string> doubts;
  if (info.trap.verdict == "trapped") {
    doubts.push_back(fmt::format(
        "training ended in a degenerate solution with wrong depths (poses are {:.2f} times as deep as wide)",
        info.trap.depth_ratio));
  }
  if (info.mirror.decision == "undecided") {
    doubts.emplace_back("training could not decide which way round depth is, so that front and back may be exchanged");
  }
  return doubts;
}

void WriteModelInfo(h5::Group& root, const ModelInfo& info) {
  root.SetString("program_version", info.program_version);
  root.SetInt("width", info.width);
  root.SetString("preset", info.preset);
  root.SetString("options", info.options);
  root.SetInt("seed", static_cast<std::int64_t>(info.seed));
  root.SetInt("steps", info.steps);
  root.SetString("mirror_decision", info.mirror.decision);
  root.SetDouble("mirror_slope", info.mirror.slope);
  root.SetDouble("mirror_slope_error", info.mirror.slope_error);
  root.SetDouble("perspective", info.perspective);
  if (VersionOf(info) >= 2) {
    root.SetString("rotation", ToString(info.rotation));
    root.SetString("ray", ToString(info.input.ray));
    root.SetString("focal", ToString(info.input.focal));
  }
  if (VersionOf(info) >= 3) {
    root.SetString("network", ToString(info.network));
    root.SetString("confidences", ToString(info.input.confidences));
  }
  if (!info.trap.verdict.empty()) {
    root.SetString("trap_verdict", info.trap.verdict);
    root.SetDouble("trap_depth_ratio", info.trap.depth_ratio);
    root.SetDouble("trap_angle_deg", info.trap.angle_deg);
    root.SetDouble("trap_scatter_deg", info.trap.scatter_deg);
  }
  h5::Group skeleton = root.Create("skeleton");
  WriteSkeleton(skeleton, info.skeleton);
  h5::Group source = root.Create("source");
  source.SetString("format", info.source.format);
  source.SetString("layout", info.source.layout);
  source.SetDouble("confidence_scale", info.source.confidence_scale);
  source.SetStrings("mapping", info.source.mapping);
  if (!info.source.morph.empty()) source.SetString("morph", info.source.morph);
  h5::Group data = root.Create("data");
  data.SetStrings("files", info.data_files);
  data.SetStrings("fingerprints", info.data_fingerprints);
  if (info.morph == nullptr) return;
  h5::Group morph = root.Create("morph");
  WriteModelInfo(morph, info.morph->info);
  h5::Group parameters = morph.Create("parameters");
  WriteArrays(parameters, info.morph->parameters);
}

ModelInfo ReadModelInfo(const h5::Group& root) {
  ModelInfo info;
  info.program_version = root.GetString("program_version");
  const std::int64_t width = root.GetInt("width");
  if (width < 1 || width > kLargestWidth) {
    root.Fail("attribute width", fmt::format("1 to {}", kLargestWidth), fmt::format("{}", width),
              "the file is damaged: train again");
  }
  info.width = static_cast<int>(width);
  ReadEnum(root, "network", info.network);
  ReadEnum(root, "rotation", info.rotation);
  ReadEnum(root, "ray", info.input.ray);
  ReadEnum(root, "focal", info.input.focal);
  ReadEnum(root, "confidences", info.input.confidences);
  info.preset = root.GetString("preset");
  info.options = root.GetString("options");
  info.seed = static_cast<std::uint64_t>(root.GetInt("seed"));
  info.steps = root.GetInt("steps");
  info.mirror.decision = root.GetString("mirror_decision");
  info.mirror.slope = root.GetDouble("mirror_slope");
  info.mirror.slope_error = root.GetDouble("mirror_slope_error");
  info.perspective = root.GetDouble("perspective");
  if (root.HasAttribute("trap_verdict")) {
    info.trap = {root.GetString("trap_verdict"), root.GetDouble("trap_depth_ratio"), root.GetDouble("trap_angle_deg"),
                 root.GetDouble("trap_scatter_deg")};
  }
  info.skeleton = ReadSkeleton(root.Open("skeleton"));
  const h5::Group source = root.Open("source");
  info.source.format = source.GetString("format");
  info.source.layout = source.GetString("layout");
  info.source.confidence_scale = source.GetDouble("confidence_scale");
  info.source.mapping = source.GetStrings("mapping");
  if (source.HasAttribute("morph")) info.source.morph = source.GetString("morph");
  const h5::Group data = root.Open("data");
  info.data_files = data.GetStrings("files");
  info.data_fingerprints = data.GetStrings("fingerprints");
  if (info.data_files.size() != info.data_fingerprints.size()) {
    data.Fail("attribute fingerprints", fmt::format("{} of them", info.data_files.size()),
              fmt::format("{}", info.data_fingerprints.size()), "the file is damaged: train again");
  }
  if (root.Has("morph")) {
    // In a damaged file a group may hold itself.
    if (root.path().ends_with("/morph")) {
      root.Fail("morph", "no morphing network of a morphing network", "one", "the file is damaged: train again");
    }
    const h5::Group morph = root.Open("morph");
    info.morph =
        std::make_shared<const ModelFile>(ModelFile{ReadModelInfo(morph), ReadArrays(morph.Open("parameters"))});
  }
  return info;
}

void WriteArrays(h5::Group& group, const NamedArrays& arrays) {
  for (const auto& [name, array] : arrays) group.Write<float>(name, array.values, array.shape);
}

NamedArrays ReadArrays(const h5::Group& group) {
  NamedArrays arrays;
  for (const std::string& name : group.Children()) arrays[name] = group.Read<float>(name);
  return arrays;
}

void WriteModelFile(const fs::path& path, const ModelFile& model) {
  h5::File file = h5::File::CreateAt(path);
  file.root().SetString("format", kFormat);
  file.root().SetInt("version", VersionOf(model.info));
  WriteModelInfo(file.root(), model.info);
  {
    h5::Group parameters = file.root().Create("parameters");
    WriteArrays(parameters, model.parameters);
  }
  file.Commit();
}

namespace {

ModelFile ReadModel(h5::File file) { return {ReadModelInfo(file.root()), ReadArrays(file.root().Open("parameters"))}; }

}  // namespace

ModelFile ReadModelFile(const fs::path& path) { return ReadModel(OpenModel(path)); }

ModelFile ReadModelImage(std::string_view image, const std::string& name) {
  h5::File file = h5::File::OpenImage(image, name);
  RequireModel(file.root());
  return ReadModel(std::move(file));
}

ModelInfo ReadModelInfo(const fs::path& path) {
  h5::File file = OpenModel(path);
  return ReadModelInfo(file.root());
}

bool IsModel(const fs::path& path) {
  const fs::path file_path = ModelPath(path);
  if (!h5::File::IsHdf5(file_path)) return false;
  h5::File file = h5::File::OpenForReading(file_path);
  return file.root().HasAttribute("format") && file.root().GetString("format") == kFormat;
}

}  // namespace canonpose
