// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/record_estimate.hpp"

namespace tuina::tissue {

RecordEstimate estimate_record(std::span<const TimedPress> record, CreepEstimator::Options options,
                               const KnownNoise& known, const OnEstimate& each) {
  constexpr std::size_t first_look = 32, last_look = 4096;
  RecordEstimate made;
  const auto use = [&](const SensorNoise& noise) {
    made.noise = noise;
    options.force_noise_n = noise.force_n;
    options.position_noise_m = noise.position_m;
    made.estimator = CreepEstimator(options);
  };
  use(known.over({}));
  std::size_t look = first_look;
  for (std::size_t i = 0; i < record.size(); ++i) {
    if (i + 1 == look && look <= last_look) {
      look *= 2;
      use(known.over(estimate_noise(record.first(i + 1))));
      for (const auto& [time_s, press] : record.first(i)) made.estimator.update(time_s, press);
    }
    made.estimator.update(record[i].time_s, record[i].press);
    if (each) each(record[i].time_s, made.estimator.estimate());
  }
  return made;
}

}  // namespace tuina::tissue
