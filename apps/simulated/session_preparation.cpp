// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/session_preparation.hpp"

#include <algorithm>
#include <limits>

#include "apps/cli/stopwatch.hpp"
#include "apps/simulated/atlas_source.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/session/scan_step.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"

namespace tuina::app {
namespace {

std::vector<double> errors_of(const std::vector<Acupoint>& found, const sim::Person& person) {
  std::vector<double> errors_m;
  for (const Acupoint& acupoint : found) {
    double error_m = std::numeric_limits<double>::quiet_NaN();
    for (const Acupoint& truth : person.acupoints) {
      if (truth.name == acupoint.name) error_m = (truth.at_in_couch - acupoint.at_in_couch).norm();
    }
    errors_m.push_back(error_m);
  }
  return errors_m;
}

/// Takes out of a plan what was done before; a name may stand for several paths.
void drop_done(massage::Plan& plan, std::vector<std::string> done) {
  std::erase_if(plan.paths, [&](const massage::PlannedPath& planned) {
    const auto found = std::find(done.begin(), done.end(), planned.path.name);
    if (found == done.end()) return false;
    done.erase(found);
    return true;
  });
}

}  // namespace

bool head_at_plus_y(std::span<const Acupoint> acupoints) {
  double shoulders_y = 0.0, loins_y = 0.0;
  for (const Acupoint& point : acupoints) {
    if (point.name.starts_with("SI11")) shoulders_y += 0.5 * point.at_in_couch.y();
    if (point.name == "GV4") loins_y = point.at_in_couch.y();
  }
  return shoulders_y > loins_y;
}

Transform believed_base_from_couch(const SessionSetting& setting, const robot::RobotMount& mount) {
  if (setting.robot) return setting.robot->base_from_couch;
  constexpr double place_sd_m = 2_mm, turn_sd_rad = 0.3_deg;
  Random random = make_random(setting.common.seed, "scanner to robot");
  const auto drawn = [&](double sd) {
    const double each = sd / std::sqrt(3.0);
    const double x = gaussian(random, each), y = gaussian(random, each), z = gaussian(random, each);
    return Vector3(x, y, z);
  };
  const Vector3 turn = drawn(turn_sd_rad);
  const Vector3 shift = drawn(place_sd_m);
  Transform error = Transform::Identity();
  error.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  error.translation() = shift;
  return error * mount.base_from_couch;
}

Result<massage::PlanOptions> plan_options(const session::Config& config,
                                          const std::string& no_go_file) {
  massage::PlanOptions options{.force_scale = config.massage.force_scale,
                               .force_ceiling_n = config.safety.force_ceiling_n,
                               .transfers = {.standoff_m = from_mm(config.massage.standoff_mm)}};
  if (no_go_file.empty()) return options;
  auto no_go = massage::read_no_go(no_go_file);
  if (!no_go) return tl::unexpected(no_go.error());
  options.no_go = std::move(*no_go);
  return options;
}

Result<SessionSetting> read_setting(const SessionOrder& order, const session::Config& config,
                                    const CommonOptions& common) {
  auto programme = massage::load_programme(order.programme);
  if (!programme) return tl::unexpected(programme.error());
  auto options = plan_options(config, order.no_go);
  if (!options) return tl::unexpected(options.error());
  auto atlas = open_atlas(order.atlas);
  if (!atlas) return tl::unexpected(atlas.error());
  std::optional<session::PlacedRobot> robot;
  if (!order.robot_pose.empty()) {
    const auto read = session::read_robot_pose(order.robot_pose);
    if (!read) return tl::unexpected(read.error());
    if (read->robot != order.robot) {
      return fail(Fault::usage, "{}: was measured with the arms of `{}`, and the robot is `{}`",
                  order.robot_pose, read->robot, order.robot);
    }
    robot = *read;
  }
  auto model = robot::load_robot(order.robot);
  if (!model) return tl::unexpected(model.error());
  return SessionSetting{order,
                        config,
                        common,
                        std::move(*programme),
                        std::move(*options),
                        std::move(*atlas),
                        robot,
                        std::move(*model)};
}

Result<Preparation> prepare(const SessionSetting& setting, const sim::Person& person,
                            const std::optional<Resumed>& resumed) {
  Preparation result;
  const session::Config& config = setting.config;
  const std::uint64_t seed = setting.common.seed;
  sim::LaserScanner scanner(person.skin_in_couch, person.position,
                            {.amplitude_m = from_mm(config.simulation.breathing_mm),
                             .frequency_hz = config.simulation.breathing_hz},
                            seed, {.room_light_dn = config.simulation.room_light_dn});
  const auto calibration = sim::believed_calibration(scanner.true_calibration(), seed);
  auto scan = scanner::scan_sweep(scanner, scanner, calibration, session::sweep_options(config),
                                  progress_bar(setting.common, "scan"));
  if (!scan) return tl::unexpected(scan.error());
  result.scan = std::move(*scan);
  result.scan_error_m =
      sim::compare_with_truth(result.scan.cloud_in_couch, person.skin_in_couch).rms_error_m;

  const Progress map_bar = progress_bar(setting.common, "map");
  const Stopwatch map_watch;
  const auto back =
      body::fit_back(result.scan.cloud_in_couch, {.position = setting.order.position});
  if (!back) return tl::unexpected(back.error());
  auto located = body::locate_acupoints(*back, setting.atlas, setting.order.method);
  if (!located) return tl::unexpected(located.error());
  result.located = std::move(*located);
  result.locate_ms = map_watch.ms();
  if (map_bar) map_bar(1.0);
  result.acupoint_errors_m = errors_of(result.located.acupoints, person);

  const Stopwatch plan_watch;
  auto plan = massage::plan(*back, result.located.acupoints, result.located.landmarks,
                            setting.programme, setting.plan_options);
  if (!plan) return tl::unexpected(plan.error());
  if (resumed) drop_done(*plan, resumed->done);
  if (setting.robot && setting.robot->position != back->position()) {
    return fail(Fault::config, "{}: the robot stands there for a person {}, and this one is {}",
                setting.order.robot_pose, name_of(setting.robot->position),
                name_of(back->position()));
  }
  result.placement =
      robot::place_robot(setting.model, back->position(), head_at_plus_y(result.located.acupoints));
  const robot::RobotMount& mount = result.placement.mount;
  result.base_from_couch = believed_base_from_couch(setting, mount);
  auto ready = motion::make_ready(std::move(*plan), *back, mount,
                                  robot::both_models(result.placement.arm, mount),
                                  result.base_from_couch, from_mm(config.massage.standoff_mm),
                                  resumed ? std::optional(resumed->rail_m) : std::nullopt);
  if (!ready) return tl::unexpected(ready.error());
  result.ready = std::move(*ready);
  result.plan_ms = plan_watch.ms();
  return result;
}

}  // namespace tuina::app
