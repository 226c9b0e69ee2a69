// make_starter RUN MODEL CARD: trains the starter into the folder RUN and writes it with its card; see
// scripts/make-starter.
#include <cstdio>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/train/starter.h"

namespace {

int MakeStarter(const std::filesystem::path& run, const std::filesystem::path& model,
                const std::filesystem::path& card) {
  const canonpose::StarterRecipe recipe = canonpose::StarterRecipe::Default();
  canonpose::TrainStarter(recipe, run);
  const canonpose::ModelFile starter = canonpose::ReadModelFile(run);
  canonpose::WriteModelFile(model, starter);
  canonpose::WriteFileAtomically(card, canonpose::MakeStarterCard(recipe, starter).ToJson());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    fmt::print(stderr, "usage: make_starter RUN MODEL CARD (or scripts/make-starter)\n");
    return 2;
  }
  try {
    return MakeStarter(argv[1], argv[2], argv[3]);
  } catch (const canonpose::Error& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 3;
  }
}
