// SPDX-License-Identifier: Apache-2.0
// The whole of tuina on one screen: scan a simulated person, find the acupoints, plan for two arms,
// and give the massage, a millisecond at a time. `.value()` ends the program where the world says
// no; a real one asks first.
#include <fmt/core.h>

#include "tuina/body/acupoints.hpp"
#include "tuina/motion/ready_plan.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/session/force_errors.hpp"
#include "tuina/session/massage_step.hpp"
#include "tuina/sim/person/tissue_map.hpp"
#include "tuina/sim/robot/plant.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"

using namespace tuina;

int main() {
  constexpr std::uint64_t seed = 1;
  const auto person = sim::parse_person("phantom:medium", Position::prone, seed).value();

  // Scan.
  sim::LaserScanner scanner(person.skin_in_couch, person.position, {}, seed);
  const auto calibration = sim::believed_calibration(scanner.true_calibration(), seed);
  const auto scan = scanner::scan_sweep(scanner, scanner, calibration).value();
  fmt::print("scan: {} points in {:.1f} s\n", scan.cloud_in_couch.size(), scan.sweep_s);

  // Map.
  const auto atlas = body::read_atlas(TUINA_MODELS "/atlas.tuina").value();
  const auto back = body::fit_back(scan.cloud_in_couch).value();
  const auto map = body::locate_acupoints(back, atlas).value();
  double error_m = 0.0;
  for (std::size_t i = 0; i < 7; ++i) {
    error_m += (map.acupoints[i].at_in_couch - person.acupoints[i].at_in_couch).norm() / 7.0;
  }
  fmt::print("map: seven acupoints, on average {:.1f} mm off\n", to_mm(error_m));

  // Plan.
  const auto programme = massage::load_programme("lower_back").value();
  const auto mount = robot::mount_for(back.position());
  const robot::ArmTable table = robot::thesis_arm();
  const PerArm<robot::ArmModel> arms = robot::both_models(table, mount);
  auto paths = massage::plan(back, map.acupoints, map.landmarks, programme).value();
  const auto plan =
      motion::make_ready(std::move(paths), back, mount, arms, mount.base_from_couch, 40_mm).value();
  fmt::print("plan: {} paths of two arms\n", plan.plan.paths.size());

  // Massage: the person's tissue differs from place to place, and no room of tuina knows it.
  sim::BackContact contact(person.skin_in_couch, sim::lay_tissue(person, seed));
  const auto robot =
      sim::Plant::make(mount, {.of = {table, table}},
                       {.q_rad = plan.ready_rad, .rail_m = plan.rail_m}, &contact, {.seed = seed})
          .value();
  session::MassageStep massage(plan.plan, plan.jobs, arms,
                               {.base_from_couch = mount.base_from_couch, .rail_m = plan.rail_m});
  session::ForceErrorSum sum;
  double time_s = 0.0;
  while (!massage.finished() && time_s < 2.0 * plan.plan.duration_s) {
    const robot::RobotReading reading = robot->read();
    robot->apply(massage.step(reading));
    time_s = reading.time_s;
    for (const Arm arm : both_arms) {
      const double target_n = massage.view()[arm].target_n;
      if (target_n > 0.0) sum.add(time_s, target_n, robot->truth().arms[arm].contact.force_n);
    }
  }
  const session::ForceErrors force = sum.errors();
  fmt::print("massage: {:.0f} s, force {:.2f} N RMS off, {:.1f} N at most, {} stops\n", time_s,
             force.rmse_n, force.peak_n, massage.stops().size());
  return massage.finished() && massage.stops().empty() ? 0 : 1;
}
