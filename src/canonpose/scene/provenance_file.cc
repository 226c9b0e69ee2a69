#include "canonpose/scene/provenance_file.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

namespace canonpose {
namespace {

struct Attribute {
  Provenance WorldProvenance::*member;
  const char* source;
  const char* uncertainty;
};

constexpr std::array<Attribute, 3> kAttributes = {{{&WorldProvenance::up, "up", "up_uncertainty_degrees"},
                                                   {&WorldProvenance::floor, "floor", "floor_uncertainty"},
                                                   {&WorldProvenance::scale, "scale", "scale_uncertainty_percent"}}};

}  // namespace

WorldProvenance ReadWorldProvenance(const h5::Group& group, const std::string& prefix) {
  WorldProvenance world;
  for (const Attribute& attribute : kAttributes) {
    Provenance& known = world.*attribute.member;
    const std::string source = prefix + attribute.source;
    const std::string uncertainty = prefix + attribute.uncertainty;
    if (group.HasAttribute(source)) known.source = group.GetString(source);
    if (!known.is_known() || !group.HasAttribute(uncertainty)) continue;
    known.uncertainty = group.GetDouble(uncertainty);
    if (!(known.uncertainty >= 0.0) || std::isinf(known.uncertainty)) {
      group.Fail("attribute " + uncertainty, "0 or more", fmt::format("{}", known.uncertainty), "");
    }
  }
  return world;
}

void WriteWorldProvenance(h5::Group& group, const WorldProvenance& world, const std::string& prefix) {
  for (const Attribute& attribute : kAttributes) {
    const Provenance& known = world.*attribute.member;
    if (!known.is_known()) continue;
    group.SetString(prefix + attribute.source, known.source);
    if (std::isfinite(known.uncertainty)) group.SetDouble(prefix + attribute.uncertainty, known.uncertainty);
  }
}

}  // namespace canonpose
