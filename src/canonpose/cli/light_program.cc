// The program `canonpose` itself. It loads neither LibTorch nor OpenCV, which takes several times as long as the rest
// of most commands. For the commands that need them it becomes `canonpose-networks`, the program with all commands.
#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

#include <unistd.h>

#include "canonpose/base/error.h"
#include "canonpose/cli/commands.h"
#include "canonpose/cli/with_torch.h"

namespace canonpose {
namespace {

constexpr std::array<std::string_view, 6> kLightCommands{"export", "import", "info", "simulate", "view", "--version"};

/// What main() got, with the null pointer at its end.
std::span<char*>& Arguments() {
  static std::span<char*> arguments;
  return arguments;
}

/// Beside this program, as built, or in the folder for programs that only programs start, as installed.
std::filesystem::path FindFullProgram() {
  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const std::array<std::filesystem::path, 2> places{folder / "canonpose-networks",
                                                    folder / CANONPOSE_LIBEXEC_FROM_BIN / "canonpose-networks"};
  const auto* const place =
      std::ranges::find_if(places, [](const auto& path) { return std::filesystem::exists(path); });
  if (place != places.end()) return *place;
  ThrowBadInput({places.front().string(), "", "the part of canonpose that has the networks", "no file",
                 "build or install canonpose again"});
}

/// To be called before anything was printed or written.
[[noreturn]] void BecomeFullProgram() {
  const std::filesystem::path program = FindFullProgram();
  execv(program.c_str(), Arguments().data());
  ThrowBadInput(
      {program.string(), "", "a program", std::system_category().message(errno), "build or install canonpose again"});
}

}  // namespace

void BeginWithNetworks(int argc, char** argv) {
  Arguments() = std::span(argv, static_cast<std::size_t>(argc) + 1);
  const auto given = Arguments().subspan(std::min<std::size_t>(1, argc), std::max(argc - 1, 0));
  const bool is_light = !given.empty() && std::ranges::find(kLightCommands, given.front()) != kLightCommands.end();
  // A morphing network is a network.
  const bool morphs =
      std::ranges::any_of(given, [](const char* word) { return std::string_view(word).starts_with("--morph"); });
  if (!is_light || morphs) BecomeFullProgram();
}

// The other program has them.
void AddDetectCommand(CLI::App&) {}
void AddEvaluateCommand(CLI::App&) {}
void AddLiftCommand(CLI::App&) {}
void AddRunCommand(CLI::App&) {}
void AddSolveCommand(CLI::App&) {}
void AddTrainCommand(CLI::App&) {}
void AddTrainMorphCommand(CLI::App&) {}

std::shared_ptr<const void> UseOneThread() { return nullptr; }

std::string DescribeLinearAlgebra() { BecomeFullProgram(); }

void ApplyMorph(const std::filesystem::path&, Dataset&, const std::string&) { BecomeFullProgram(); }

}  // namespace canonpose
