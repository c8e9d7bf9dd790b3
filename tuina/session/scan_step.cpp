// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/scan_step.hpp"

#include "tuina/core/stopwatch.hpp"
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

Result<MappedPerson> scan_and_map(scanner::Camera& camera, scanner::Turntable& turntable,
                                  const Order& order, const Config& config, Observer& observer) {
  scanner::SweepOptions sweep = sweep_options(config);
  sweep.on_profile = [&](const scanner::LiveProfile& profile) { observer.on_profile(profile); };
  auto scan = scanner::scan_sweep(camera, turntable, order.calibration, sweep,
                                  [&](double share) { observer.on_progress(Stage::scan, share); });
  if (!scan) return tl::unexpected(scan.error());
  observer.on_scan(*scan);

  const Stopwatch watch;
  auto back = body::fit_back(scan->cloud_in_couch, {.position = order.position});
  if (!back) return tl::unexpected(back.error());
  auto located = body::locate_acupoints(*back, order.atlas, order.method);
  if (!located) return tl::unexpected(located.error());
  const double locate_ms = watch.ms();
  observer.on_progress(Stage::map, 1.0);
  observer.on_map(*located);
  return MappedPerson{std::move(*scan), std::move(*back), std::move(*located), locate_ms};
}

}  // namespace tuina::session
