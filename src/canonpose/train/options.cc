#include "canonpose/train/options.h"

#include <charconv>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

using Json = nlohmann::ordered_json;

/// Calls visit(name, field, changes_result) for every field, in order.
template <typename Options, typename Visit>
void VisitFields(Options& o, Visit&& visit) {
  visit("preset", o.preset, true);
  visit("epochs", o.epochs, true);
  visit("default_epochs", o.default_epochs, true);
  visit("min_steps", o.min_steps, true);
  visit("network", o.network, true);
  visit("width", o.width, true);
  visit("batch_frames", o.batch_frames, true);
  visit("learning_rate", o.learning_rate, true);
  visit("weight_decay", o.weight_decay, true);
  visit("schedule", o.schedule, true);
  visit("supervision", o.supervision, true);
  visit("bootstrap", o.bootstrap, true);
  visit("input_confidences", o.input_confidences, true);
  visit("loss_confidences", o.loss_confidences, true);
  visit("consistency", o.consistency, true);
  visit("ray", o.ray, true);
  visit("focal", o.focal, true);
  visit("rotation", o.rotation, true);
  visit("new_views", o.new_views, true);
  visit("flips", o.flips, true);
  visit("joint_dropout", o.joint_dropout, true);
  visit("uncertainty_weights", o.uncertainty_weights, true);
  visit("view_weight", o.view_weight, true);
  visit("camera_weight", o.camera_weight, true);
  visit("camera_consistency", o.camera_consistency, true);
  visit("camera_window_seconds", o.camera_window_seconds, true);
  visit("camera_window_end", o.camera_window_end, true);
  visit("rotation_spread", o.rotation_spread, true);
  visit("restarts", o.restarts, true);
  visit("restart_steps", o.restart_steps, true);
  visit("perspective", o.perspective, true);
  visit("perspective_warmup", o.perspective_warmup, true);
  visit("perspective_learning_rate", o.perspective_learning_rate, true);
  visit("mirror", o.mirror, true);
  visit("validation", o.validation, true);
  visit("seed", o.seed, true);
  visit("threads", o.threads, false);
  visit("device", o.device, false);
  visit("checkpoint_seconds", o.checkpoint_seconds, false);
}

template <typename Field>
void ParseField(const std::string& name, const std::string& text, Field& field) {
  if constexpr (std::is_same_v<Field, std::string>) {
    field = text;
  } else {
    Field value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) {
      ThrowInvalidArgument("`{}`: expected a {}, found \"{}\"", name,
                           std::is_integral_v<Field> ? "whole number" : "number", text);
    }
    field = value;
  }
}

void RequireOneOf(const char* name, const std::string& value, std::initializer_list<const char*> allowed) {
  std::string list;
  for (const char* word : allowed) {
    if (value == word) return;
    list += (list.empty() ? "" : ", ") + std::string(word);
  }
  ThrowInvalidArgument("{}: expected one of {}, found \"{}\"", name, list, value);
}

/// Options that only go together with some kind of supervision.
void ValidateSupervision(const TrainOptions& options) {
  if (options.supervision == "none") {
    if (options.network != "canonical") {
      ThrowInvalidArgument("network={} answers no rotation that views could share: it needs supervision",
                           options.network);
    }
    if (options.consistency == "equal_cameras" && options.camera_consistency == "off") {
      ThrowInvalidArgument("consistency=equal_cameras is a form of camera consistency: set camera_consistency, too");
    }
    if (options.new_views > 0 || options.flips > 0 || options.joint_dropout > 0) {
      ThrowInvalidArgument("new_views, flips and joint_dropout change a 3D pose to learn from: they need supervision");
    }
    if (options.ray != "off" && options.camera_consistency != "off") {
      ThrowInvalidArgument(
          "ray={} turns the camera with every pose, so that none stands still: camera_consistency must be off",
          options.ray);
    }
    return;
  }
  if (options.restarts > 1) {
    ThrowInvalidArgument("restarts: they are chosen by the loss of view mixing, which supervision={} has not",
                         options.supervision);
  }
  if (options.consistency != "mixing" || options.loss_confidences != "on") {
    ThrowInvalidArgument("consistency and loss_confidences belong to the losses of views, which supervision={} has not",
                         options.supervision);
  }
  if (options.network == "martinez" && (options.rotation != "axis_angle" || options.rotation_spread != 1.0)) {
    ThrowInvalidArgument("network=martinez answers no rotation: leave rotation and rotation_spread out");
  }
  if (options.mirror != "auto") {
    ThrowInvalidArgument("mirror: with supervision={} there is none to decide; leave it out", options.supervision);
  }
  if (options.perspective != "off" || options.camera_consistency != "off") {
    ThrowInvalidArgument("supervision={} uses no projection: perspective and camera_consistency must be off",
                         options.supervision);
  }
}

}  // namespace

void TrainOptions::Validate() const {
  const auto require = [](bool ok, const char* name, const char* expected, double found) {
    if (!ok) ThrowInvalidArgument("{}: expected {}, found {}", name, expected, found);
  };
  require(epochs >= 0, "epochs", "1 or more", epochs);
  require(default_epochs >= 1, "default_epochs", "1 or more", default_epochs);
  require(min_steps >= 0, "min_steps", "0 or more", min_steps);
  require(width >= 1 && width <= 65536, "width", "1 to 65536", width);
  require(batch_frames >= 1, "batch_frames", "1 or more", batch_frames);
  require(learning_rate > 0, "learning_rate", "more than 0", learning_rate);
  require(weight_decay >= 0, "weight_decay", "0 or more", weight_decay);
  require(view_weight >= 0, "view_weight", "0 or more", view_weight);
  require(camera_weight >= 0, "camera_weight", "0 or more", camera_weight);
  require(camera_window_seconds > 0, "camera_window_seconds", "more than 0", camera_window_seconds);
  require(camera_window_end > 0 && camera_window_end <= 1, "camera_window_end", "more than 0, up to 1",
          camera_window_end);
  require(rotation_spread > 0, "rotation_spread", "more than 0", rotation_spread);
  require(restarts >= 1 && restarts <= 1000, "restarts", "1 to 1000", restarts);
  require(restart_steps >= 1, "restart_steps", "1 or more", restart_steps);
  require(perspective_warmup >= 0 && perspective_warmup <= 1, "perspective_warmup", "0 to 1", perspective_warmup);
  require(perspective_learning_rate > 0, "perspective_learning_rate", "more than 0", perspective_learning_rate);
  require(validation >= 0 && validation <= 0.5, "validation", "0 to 0.5", validation);
  require(threads >= 0, "threads", "0 or more", threads);
  require(checkpoint_seconds >= 0, "checkpoint_seconds", "0 or more", checkpoint_seconds);
  RequireOneOf("camera_consistency", camera_consistency, {"off", "static", "window"});
  RequireOneOf("perspective", perspective, {"off", "learned"});
  RequireOneOf("bootstrap", bootstrap, {"auto", "starter", "method", "factorisation"});
  RequireOneOf("mirror", mirror, {"auto", "keep", "flip"});
  require(new_views >= 0 && new_views <= 1, "new_views", "0 to 1", new_views);
  require(flips >= 0 && flips <= 1, "flips", "0 to 1", flips);
  require(joint_dropout >= 0 && joint_dropout <= 1, "joint_dropout", "0 to 1", joint_dropout);
  RequireOneOf("schedule", schedule, {"steps", "cosine"});
  RequireOneOf("supervision", supervision, {"none", "truth", "solved", "triangulated"});
  RequireOneOf("network", network, {"canonical", "martinez"});
  RequireOneOf("input_confidences", input_confidences, {"on", "missing", "off"});
  RequireOneOf("loss_confidences", loss_confidences, {"on", "off"});
  RequireOneOf("consistency", consistency, {"mixing", "equal_poses", "equal_cameras"});
  RequireOneOf("ray", ray, {"off", "root"});
  RequireOneOf("focal", focal, {"guess", "known"});
  RequireOneOf("rotation", rotation, {"axis_angle", "6d"});
  RequireOneOf("uncertainty_weights", uncertainty_weights, {"off", "on"});
  ValidateSupervision(*this);
}

std::string TrainOptions::ToJson(bool only_what_changes_results) const {
  Json json;
  VisitFields(*this, [&](const char* name, const auto& field, bool changes_result) {
    if (changes_result || !only_what_changes_results) json[name] = field;
  });
  return json.dump();
}

TrainOptions TrainOptions::FromJson(const std::string& text, const std::string& file) {
  try {
    TrainOptions options;
    const Json json = Json::parse(text);
    VisitFields(options, [&](const char* name, auto& field, bool) {
      if (json.contains(name)) json[name].get_to(field);
    });
    return options;
  } catch (const Json::exception&) {
    ThrowBadInput({file, "attribute options", "the options of training as JSON", "damaged text",
                   "restore the file or train again"});
  }
}

bool TrainOptions::Has(const std::string& name) {
  bool found = false;
  const TrainOptions options;
  VisitFields(options, [&](const char* field_name, const auto&, bool) { found = found || name == field_name; });
  return found;
}

void TrainOptions::Set(const std::string& name, const std::string& value) {
  if (name == "preset")
    ThrowInvalidArgument("`preset` is not one of the options to be set one by one: choose it as `preset` {}", value);
  bool found = false;
  std::string known;
  VisitFields(*this, [&](const char* field_name, auto& field, bool) {
    known += (known.empty() ? "" : ", ") + std::string(field_name);
    if (name != field_name) return;
    ParseField(name, value, field);
    found = true;
  });
  if (!found) ThrowInvalidArgument("there is no option \"{}\"; there are {}", name, known);
}

std::string TrainOptions::Get(const std::string& name) const {
  std::string value;
  VisitFields(*this, [&](const char* field_name, const auto& field, bool) {
    if (name == field_name) value = fmt::format("{}", field);
  });
  return value;
}

std::vector<std::string> TrainOptions::Differences(const TrainOptions& other) const {
  std::vector<std::string> names;
  VisitFields(*this, [&](const char* name, const auto&, bool changes_result) {
    if (changes_result && Get(name) != other.Get(name)) names.emplace_back(name);
  });
  return names;
}

std::string PresetNames() { return "paper, paper+c, plus, supervised, martinez, epipolar, best"; }

TrainOptions PresetOptions(const std::string& preset) {
  TrainOptions options;
  options.preset = preset;
  options.min_steps = 3000;
  if (preset == "paper") return options;
  if (preset == "supervised" || preset == "martinez" || preset == "epipolar") {
    options.supervision = preset == "epipolar" ? "triangulated" : "truth";
    if (preset != "martinez") return options;
    options.network = "martinez";
    options.learning_rate = 1e-3;  // the authors'
    options.weight_decay = 0.0;
    return options;
  }
  if (preset == "best") {
    options.supervision = "solved";
    options.width = 256;
    options.learning_rate = 1e-3;
    options.schedule = "cosine";
    options.ray = "root";
    options.input_confidences = "missing";
    options.new_views = 0.8;
    options.flips = 0.5;
    options.joint_dropout = 0.15;
    // Unsure joints are the hard ones: weighing them less costs more than their errors (docs/results.md).
    return options;
  }
  options.camera_consistency = "static";
  if (preset == "paper+c") return options;
  if (preset == "plus") {
    options.perspective = "learned";
    // A quarter of the width costs little accuracy (docs/results.md) and makes small recordings a matter of a minute.
    options.width = 256;
    options.learning_rate = 1e-3;
    return options;
  }
  ThrowInvalidArgument("`preset`: expected one of {}, found \"{}\"", PresetNames(), preset);
}

}  // namespace canonpose
