// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

#include "tuina/tissue/creep_estimator.hpp"
#include "tuina/tissue/press_record.hpp"

namespace tuina::tissue {

/// What `CreepEstimator` made of a record.
struct RecordEstimate {
  CreepEstimator estimator = CreepEstimator();  ///< as the last sample left it
  SensorNoise noise;                            ///< as known, else as the record shows it
};

/// Prior for a record that somebody else has made: its zero is the skin within a millimetre, and
/// nothing is known of the zero of a force that begins in contact.
[[nodiscard]] inline CreepEstimator::Options record_options() noexcept {
  return {.contact_sd_m = 1e-3, .untared_sd_n = 3.0};
}

/// Called after every sample.
using OnEstimate = std::function<void(double time_s, const TissueEstimate&)>;

/// Estimates the tissue from a record as it grows, sample by sample. What is not known of the noise
/// is looked for in what came so far, whenever that has doubled, and the estimator then sees it all
/// again: what it says at a time never depends on what comes later. The noise in `options` is not
/// used. `each` may be empty.
[[nodiscard]] RecordEstimate estimate_record(std::span<const TimedPress> record,
                                             CreepEstimator::Options options = record_options(),
                                             const KnownNoise& known = {},
                                             const OnEstimate& each = {});

}  // namespace tuina::tissue
