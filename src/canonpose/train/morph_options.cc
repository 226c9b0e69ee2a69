#include "canonpose/train/morph_options.h"

#include <tuple>

#include "canonpose/train/option_table.h"

namespace canonpose {
namespace {

constexpr std::tuple kMorphTable{
    Number("epochs", &MorphOptions::epochs, Range::AtLeast(1), "Passes through the poses"),
    Number("width", &MorphOptions::width, Range::Between(1, 65536), "Width of the network's layers"),
    Number("batch_poses", &MorphOptions::batch_poses, Range::AtLeast(1), "Poses per step"),
    Number("learning_rate", &MorphOptions::learning_rate, Range::MoreThan(0),
           "Learning rate at the start; it falls by half a cosine down to 0"),
    Number("validation", &MorphOptions::validation, Range::Between(0, 0.5),
           "Share of the poses that is held out, the last ones"),
    Number("seed", &MorphOptions::seed, Range::AtLeast(0), "Seed of all randomness"),
    NotInResults(Number("threads", &MorphOptions::threads, Range::AtLeast(0), "Threads. 0: one")),
    NotInResults(Text("device", &MorphOptions::device, "cpu, cuda", "Where the network is computed")),
    NotInResults(Number("checkpoint_seconds", &MorphOptions::checkpoint_seconds, Range::AtLeast(0),
                        "Time between checkpoints, seconds"))};
static_assert(CoversAllFields<MorphOptions>(kMorphTable));

}  // namespace

void MorphOptions::Validate() const { RequireRanges(kMorphTable, *this); }

std::string MorphOptions::ToJson() const { return WriteJson(kMorphTable, *this, /*only_what_changes_results=*/true); }

void MorphOptions::Set(const std::string& name, const std::string& value) { SetField(kMorphTable, name, value, *this); }

const std::vector<OptionDescription>& DescribeMorphOptions() {
  static const std::vector<OptionDescription> descriptions = DescribeTable<MorphOptions>(kMorphTable);
  return descriptions;
}

}  // namespace canonpose
