// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/scan_step.hpp"

#include "tuina/core/units.hpp"

namespace tuina::session {

scanner::SweepOptions sweep_options(const Config& config) {
  scanner::SweepOptions options;
  options.from_rad = from_deg(-0.5 * config.scan.sweep_deg);
  options.to_rad = -options.from_rad;
  options.speed_rad_per_s = from_deg(config.scan.sweep_deg) / config.scan.sweep_s;
  options.method = scanner::line_method(config.scan.method).value_or(options.method);
  return options;
}

}  // namespace tuina::session
