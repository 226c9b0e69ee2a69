// For builds without LibTorch: there is no lifter to start from.
#include "canonpose/base/error.h"
#include "canonpose/pipeline/lifter_start.h"

namespace canonpose {
namespace {

[[noreturn]] void ThrowNoLifter() {
  ThrowInvalidArgument(
      "this build has no LibTorch and therefore no lifter to start from; choose `bootstrap=factorisation` (static "
      "cameras)");
}

}  // namespace

bool StarterCanStart(const Skeleton&) { return false; }

StartPoses StartFromModel(const Dataset&, const std::string&, const BootstrapOptions&) { ThrowNoLifter(); }

StartPoses StartFromStarter(const Dataset&, const std::string&) { ThrowNoLifter(); }

StartPoses StartFromMethod(const Dataset&, const std::string&, const BootstrapOptions&) { ThrowNoLifter(); }

}  // namespace canonpose
