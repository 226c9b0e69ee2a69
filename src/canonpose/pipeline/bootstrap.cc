#include "canonpose/pipeline/bootstrap.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/data/choice.h"
#include "canonpose/pipeline/lifter_start.h"
#include "canonpose/solve/factorisation.h"

namespace canonpose {

StartPoses Bootstrap(const Dataset& dataset, const std::string& file, const BootstrapOptions& options) {
  RequireTwoCameras(dataset, file);
  if (!options.model.empty()) return StartFromModel(dataset, file, options);
  const bool knows = StarterCanStart(dataset.skeleton);
  const bool stands = std::ranges::all_of(dataset.sequences, &Sequence::static_cameras);
  if (options.kind == "starter" && !knows) {
    ThrowBadInput({file, "/skeleton", "a person's joints, by the names of a built-in skeleton",
                   fmt::format("{}", fmt::join(dataset.skeleton.joints, ", ")),
                   "choose another `bootstrap`, or name a `model` that was trained on such data"});
  }
  if (options.kind == "factorisation" || (options.kind == "auto" && !knows && stands)) {
    return FactorisedStart(dataset, file);
  }
  if (options.kind == "method" || !knows) return StartFromMethod(dataset, file, options);
  return StartFromStarter(dataset, options.device);
}

}  // namespace canonpose
