// The sums of an epoch's losses, kept on the device: adding to them does not wait for it.
#pragma once

#include <torch/torch.h>

#include "canonpose/train/checkpoint.h"
#include "canonpose/train/losses.h"

namespace canonpose {

class LossSums {
 public:
  explicit LossSums(torch::Device device);

  /// Adds the losses of one step. Terms that are undefined count as 0.
  void Add(const Losses& losses);

  /// Waits for the device. A loss that was not finite makes its sum so.
  [[nodiscard]] EpochSums Read() const;
  void Set(const EpochSums& sums);

 private:
  torch::Tensor sums_;  // (4) double: total, reprojection, view, camera
  std::int64_t steps_ = 0;
};

}  // namespace canonpose
