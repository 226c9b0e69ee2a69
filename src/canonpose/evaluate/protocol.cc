#include "canonpose/evaluate/protocol.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"

namespace canonpose {
namespace {

Protocol HumanProtocol(const std::string& name, const std::string& summary, Headline headline) {
  Protocol protocol;
  protocol.name = name;
  protocol.summary = summary;
  protocol.subjects = {"S9", "S11"};
  protocol.frame_step = 64;
  protocol.headline = headline;
  protocol.benchmark = "Human3.6M";
  protocol.formats = {"h36m", "canonpose-detections"};
  protocol.weighting = Weighting::kActions;
  protocol.merge_takes = true;
  return protocol;
}

Protocol InfProtocol() {
  Protocol protocol;
  protocol.name = "3dhp";
  protocol.summary = "MPI-INF-3DHP, for its test set: every frame with truth; PCK150 and AUC of 14 joints";
  protocol.headline = Headline::kPck;
  protocol.benchmark = "MPI-INF-3DHP";
  protocol.formats = {"3dhp-train", "3dhp-test"};
  protocol.truth_kind = "univ_annot3";
  protocol.pck.joints = {{"head_top", "headtop"}, {"neck", "thorax"}};
  for (const char* part : {"shoulder", "elbow", "wrist", "hip", "knee", "ankle"}) {
    for (const char* side : {"r", "l"}) protocol.pck.joints.push_back({fmt::format("{}{}", side, part)});
  }
  return protocol;
}

std::vector<Protocol> MakeProtocols() {
  Protocol all;
  all.name = kAllFrames;
  all.summary = "every frame of every subject, with equal weights for all poses";
  Protocol ski;
  ski.name = "skipose";
  ski.benchmark = "Ski-PosePTZ";
  ski.formats = {"skipose"};
  ski.summary = "Ski-PosePTZ, for the rows of its test part";
  return {all,
          HumanProtocol("h36m-1", "Human3.6M, subjects S9 and S11, every 64th frame, mean over actions: N-MPJPE",
                        Headline::kNMpjpe),
          HumanProtocol("h36m-2", "the same poses, after similarity alignment: PMPJPE", Headline::kPMpjpe),
          InfProtocol(), ski};
}

/// The names of the counted joints; empty if all are.
std::vector<std::string> PckJointNames(const Protocol& protocol) {
  std::vector<std::string> names;
  for (const std::vector<std::string>& joint : protocol.pck.joints) names.push_back(joint.front());
  return names;
}

std::string PckInWords(const Protocol& protocol) {
  const std::vector<std::string> joints = PckJointNames(protocol);
  if (joints.empty()) return fmt::format("PCK at {:.0f} mm over all joints", protocol.pck.threshold_mm);
  return fmt::format("PCK at {:.0f} mm, and AUC, over {}", protocol.pck.threshold_mm, fmt::join(joints, ", "));
}

}  // namespace

const std::vector<Protocol>& Protocols() {
  static const std::vector<Protocol> protocols = MakeProtocols();
  return protocols;
}

const Protocol& FindProtocol(const std::string& name) {
  for (const Protocol& protocol : Protocols()) {
    if (SameName(protocol.name, name)) return protocol;
  }
  std::vector<std::string> names;
  for (const Protocol& protocol : Protocols()) names.push_back(protocol.name);
  ThrowInvalidArgument("there is no `protocol` {}; the protocols are {}", name, fmt::join(names, ", "));
}

std::string HeadlineName(const Protocol& protocol) {
  switch (protocol.headline) {
    case Headline::kNMpjpe:
      return "N-MPJPE";
    case Headline::kPMpjpe:
      return "PMPJPE";
    case Headline::kPck:
      return fmt::format("PCK{:.0f}", protocol.pck.threshold_mm);
  }
  return "";
}

std::string HeadlineKey(const Protocol& protocol) {
  switch (protocol.headline) {
    case Headline::kNMpjpe:
      return "n_mpjpe_mm";
    case Headline::kPMpjpe:
      return "p_mpjpe_mm";
    case Headline::kPck:
      return PckKey(protocol);
  }
  return "";
}

std::string PckKey(const Protocol& protocol) { return fmt::format("pck{:.0f}_percent", protocol.pck.threshold_mm); }

std::string PosesInWords(const Protocol& protocol) {
  const std::string whose =
      protocol.subjects.empty() ? "" : fmt::format(" of {}", fmt::join(protocol.subjects, " and "));
  if (protocol.frame_step == 1 && protocol.first_frame == 0) return fmt::format("every frame of every view{}", whose);
  const int step = protocol.frame_step;
  const int first = protocol.first_frame;
  return fmt::format("frames {}, {}, {}, ... of every sequence and view{}", first, first + step, first + 2 * step,
                     whose);
}

std::string WeightingInWords(const Protocol& protocol) {
  switch (protocol.weighting) {
    case Weighting::kPoses:
      return "means over all poses";
    case Weighting::kSequences:
      return "means over sequences of the means over their poses";
    case Weighting::kActions:
      return protocol.merge_takes ? "means over actions (takes such as \"Walking 1\" belong to \"Walking\") of the "
                                    "means over their poses"
                                  : "means over actions of the means over their poses";
  }
  return "";
}

std::string ProtocolList() {
  std::string text;
  for (const Protocol& protocol : Protocols()) {
    text += fmt::format("{}: {}\n", protocol.name, protocol.summary);
    text += fmt::format("  poses     {}\n", PosesInWords(protocol));
    text += fmt::format("  truth     {}\n", protocol.truth_kind.empty() ? "any" : protocol.truth_kind);
    text +=
        "  errors    N-MPJPE, PCK, AUC after centring on the root and one scale factor per pose; PMPJPE, CPS after "
        "similarity alignment\n";
    text += fmt::format("  PCK       {}\n", PckInWords(protocol));
    text += fmt::format("  means     {}\n", WeightingInWords(protocol));
    text += fmt::format("  headline  {}\n", HeadlineName(protocol));
  }
  return text;
}

std::string ProtocolListAsJson() {
  using Json = nlohmann::ordered_json;
  Json protocols = Json::array();
  for (const Protocol& protocol : Protocols()) {
    protocols.push_back({{"name", protocol.name},
                         {"summary", protocol.summary},
                         {"poses", PosesInWords(protocol)},
                         {"truth_kind", protocol.truth_kind.empty() ? Json() : Json(protocol.truth_kind)},
                         {"pck", {{"threshold_mm", protocol.pck.threshold_mm}, {"joints", PckJointNames(protocol)}}},
                         {"means", WeightingInWords(protocol)},
                         {"headline", HeadlineKey(protocol)}});
  }
  Json list;
  list["protocols"] = std::move(protocols);
  return list.dump(2) + "\n";
}

std::string ActionOf(const Protocol& protocol, const std::string& action) {
  const std::size_t space = action.find_last_of(' ');
  if (!protocol.merge_takes || space == std::string::npos || space + 1 == action.size()) return action;
  const bool is_number = std::all_of(action.begin() + static_cast<std::ptrdiff_t>(space) + 1, action.end(),
                                     [](unsigned char c) { return std::isdigit(c) != 0; });
  return is_number ? action.substr(0, space) : action;
}

bool HasSubject(const Protocol& protocol, const std::string& subject) {
  return protocol.subjects.empty() || std::any_of(protocol.subjects.begin(), protocol.subjects.end(),
                                                  [&](const std::string& one) { return SameName(one, subject); });
}

}  // namespace canonpose
