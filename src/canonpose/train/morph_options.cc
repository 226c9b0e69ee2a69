#include "canonpose/train/morph_options.h"

#include <tuple>

#include "canonpose/train/option_table.h"

namespace canonpose {
namespace {

using O = MorphOptions;

constexpr std::tuple kTable{
    Number("epochs", &O::epochs, Range::AtLeast(1), "Passes through the poses"),
    Number("width", &O::width, Range::Between(1, 65536), "Width of the network's layers"),
    Number("batch_poses", &O::batch_poses, Range::AtLeast(1), "Poses per step"),
    Number("learning_rate", &O::learning_rate, Range::MoreThan(0),
           "Learning rate at the start; it falls by half a cosine down to 0"),
    Number("validation", &O::validation, Range::Between(0, 0.5), "Share of the poses that is held out, the last ones"),
    Number("seed", &O::seed, Range::AtLeast(0), "Seed of all randomness"),
    NotInResults(Number("threads", &O::threads, Range::AtLeast(0), "Threads. 0: one")),
    NotInResults(Text("device", &O::device, "cpu, cuda", "Where the network is computed")),
    NotInResults(
        Number("checkpoint_seconds", &O::checkpoint_seconds, Range::AtLeast(0), "Time between checkpoints, seconds"))};
static_assert(CoversAllFields<MorphOptions>(kTable));

}  // namespace

void MorphOptions::Validate() const { RequireRanges(kTable, *this); }

std::string MorphOptions::ToJson() const { return WriteJson(kTable, *this, /*only_what_changes_results=*/true); }

void MorphOptions::Set(const std::string& name, const std::string& value) { SetField(kTable, name, value, *this); }

const std::vector<OptionDescription>& DescribeMorphOptions() {
  static const std::vector<OptionDescription> descriptions = DescribeTable<MorphOptions>(kTable);
  return descriptions;
}

}  // namespace canonpose
