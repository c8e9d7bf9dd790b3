// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/session_order.hpp"

#include <fmt/ranges.h>

#include <filesystem>
#include <span>

#include "apps/simulated/atlas_source.hpp"
#include "apps/simulated/placed_arms.hpp"
#include "tuina/body/palpation.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/link/wire.hpp"
#include "tuina/robot/table/robot_table.hpp"
#include "tuina/session/lay_plan.hpp"

namespace tuina::app {
namespace {

/// The answers to the health questions, as they were given: a file, or those of the simulated
/// person.
Result<std::string> read_answers(const std::string& file, session::Consent& consent) {
  std::string answers = session::consent_form("the simulated person", "no");
  if (!file.empty()) {
    constexpr std::size_t max_bytes = 1 << 20;
    auto text = read_file(file, max_bytes);
    if (!text) return tl::unexpected(text.error());
    answers = std::move(*text);
  }
  const auto read = session::parse_consent(answers, file.empty() ? "the simulated person" : file);
  if (!read) return tl::unexpected(read.error());
  consent = *read;
  return answers;
}

/// Where the robot was measured to stand, with the arms that the order names.
Result<session::PlacedRobot> read_place(const SessionOrder& order) {
  auto placed = session::read_robot_pose(order.robot_pose);
  if (placed && placed->robot != order.robot) {
    return fail(Fault::usage, "{}: was measured with the arms of `{}`, and the robot is `{}`",
                order.robot_pose, placed->robot, order.robot);
  }
  return placed;
}

/// What is known before the person is seen.
Result<void> read_order(const SessionOrder& order, const session::Config& config,
                        session::Order& read) {
  auto programme = massage::load_programme(order.programme);
  if (!programme) return tl::unexpected(programme.error());
  auto options = session::plan_options(config, order.no_go);
  if (!options) return tl::unexpected(options.error());
  auto atlas = open_atlas(order.atlas);
  if (!atlas) return tl::unexpected(atlas.error());
  if (auto known = body::check_names(order.fixed, body::labels_of(*atlas)); !known) return known;
  read.programme = std::move(*programme);
  read.plan_options = std::move(*options);
  read.atlas = std::move(*atlas);
  read.method = order.method;
  read.position = order.position;
  auto model = robot::load_robot(order.robot);
  if (!model) return tl::unexpected(model.error());
  read.robot = std::move(*model);
  read.adaptive = order.adaptive;
  if (order.said) read.said = *order.said;
  read.fixed = order.fixed;
  read.intensity = order.intensity;
  if (order.known) read.known = *order.known;
  return {};
}

}  // namespace

sim::ScanFlaws scan_flaws(const session::Config& config) {
  const auto& simulation = config.simulation;
  return {.scatter_m = from_mm(simulation.scatter_mm),
          .dark_share = simulation.skin_dark_share,
          .moles_per_m2 = 100.0 * simulation.moles_per_dm2,
          .hair_share = simulation.hair_share,
          .sweat_share = simulation.sweat_share,
          .flicker_share = simulation.lamp_flicker_share,
          .readout_s = 1e-3 * simulation.rolling_shutter_ms};
}

sim::WorldOptions world_options(const session::Config& config) {
  const auto& simulation = config.simulation;
  return {.torso_n_per_m = 1e3 * simulation.torso_n_per_mm,
          .skin_friction = simulation.skin_friction,
          .living = {.fat_share = simulation.fat_share,
                     .relaxing_share = simulation.relaxing_share,
                     .damping_s_per_m = simulation.tissue_damping_s_per_m,
                     .torso_mass_kg = simulation.torso_mass_kg,
                     .first_press_stiffer = simulation.first_press_stiffer_share,
                     .tensing_share = simulation.tensing_share,
                     .tensing_probability = simulation.tensing_probability,
                     .grain_share = simulation.tissue_grain_share,
                     .place_share = simulation.tissue_place_share,
                     .skin_shear_n_per_m = 1e3 * simulation.skin_shear_n_per_mm},
          .breathing = {.amplitude_m = from_mm(simulation.breathing_mm),
                        .frequency_hz = simulation.breathing_hz,
                        .variation = simulation.breath_variation,
                        .sigh_share = simulation.sigh_share,
                        .speaking_share = simulation.speaking_share,
                        .coughs_per_h = simulation.coughs_per_h},
          .tissue_change_share = simulation.tissue_change_share,
          .shift_m = from_mm(simulation.shift_mm),
          .shift_at_s = simulation.shift_at_s,
          .room_light_dn = simulation.room_light_dn,
          .scan_flaws = scan_flaws(config),
          .arm_errors = {.friction_scale = simulation.friction,
                         .tool_mass_share = simulation.tool_weight_error_share},
          .devices = {.flaws = {.gear_softness = simulation.gear_softness,
                                .backlash_rad = from_deg(simulation.backlash_arcmin / 60.0),
                                .torque_ripple_share = simulation.torque_ripple_share,
                                .friction_drift_share = simulation.friction_drift_share,
                                .wrist_drift_n_per_s = simulation.wrist_drift_n_per_min / 60.0,
                                .wrist_hysteresis_share = simulation.wrist_hysteresis_share,
                                .wrist_crosstalk_share = simulation.wrist_crosstalk_share}}};
}

robot::ArmTable believed_gears(robot::ArmTable arm, const sim::DeviceFlaws& flaws) {
  if (flaws.gear_softness > 0.0) return arm;
  for (robot::Link& link : arm.links) link.gear_nm_per_rad = robot::rigid_gear_nm_per_rad;
  return arm;
}

Result<SimulatedRoom> make_room(const SessionOrder& order, const session::Config& config,
                                const CommonOptions& common, const sim::PlantOptions& devices) {
  SimulatedRoom room;
  auto answers = read_answers(order.consent, room.order.consent);
  if (!answers) return tl::unexpected(answers.error());
  room.consent_toml = std::move(*answers);
  const auto person = sim::parse_person(order.person, order.position, common.seed);
  if (!person) return tl::unexpected(person.error());
  if (auto read = read_order(order, config, room.order); !read) return tl::unexpected(read.error());

  sim::WorldOptions options = world_options(config);
  options.pace = order.pace;
  const sim::DeviceFlaws flaws = options.devices.flaws;
  options.devices = devices;
  options.devices.flaws = flaws;
  if (loop_of(config)) as_within_a_loop(options.devices);
  room.order.robot.arm = believed_gears(std::move(room.order.robot.arm), options.devices.flaws);
  auto world = sim::World::make(*person,
                                robot::place_robot(room.order.robot, person->position,
                                                   session::head_at_plus_y(person->acupoints)),
                                options, common.seed);
  if (!world) return tl::unexpected(world.error());
  room.world = std::move(*world);
  room.order.calibration = room.world->believed_calibration();
  room.order.placed = {order.robot, person->position, room.world->believed_base_from_couch()};
  if (!order.robot_pose.empty()) {
    const auto placed = read_place(order);
    if (!placed) return tl::unexpected(placed.error());
    if (placed->position != person->position) {
      return fail(Fault::config, "{}: the robot stands there for a person {}, and this one is {}",
                  order.robot_pose, name_of(placed->position), name_of(person->position));
    }
    room.order.placed = *placed;
  }
  return room;
}

Result<DeviceRoom> make_device_room(const SessionOrder& order, const session::Config& config) {
  const std::pair<const std::string&, const char*> needed[] = {
      {order.consent, "--consent FILE.toml, the person's answers to the health questions"},
      {order.calibration, "--calibration FILE.toml of the scanner, by `tuina calibrate`"},
      {order.robot_pose, "--robot-pose FILE.toml, by `tuina calibrate --robot`"}};
  for (const auto& [given, what] : needed) {
    if (given.empty())
      return fail(Fault::usage, "{}: a session with a scanner of one's own needs {}", order.device,
                  what);
  }
  DeviceRoom room;
  auto answers = read_answers(order.consent, room.order.consent);
  if (!answers) return tl::unexpected(answers.error());
  room.consent_toml = std::move(*answers);
  auto calibration = scanner::read_calibration(order.calibration);
  if (!calibration) return tl::unexpected(calibration.error());
  auto placed = read_place(order);
  if (!placed) return tl::unexpected(placed.error());
  if (auto read = read_order(order, config, room.order); !read) return tl::unexpected(read.error());
  room.order.calibration = std::move(*calibration);
  room.order.placed = std::move(*placed);
  room.placement = robot::place_robot(room.order.robot, room.order.placed.position);
  return room;
}

std::string world_name(const SessionOrder& order, const sim::World& world, std::uint64_t seed) {
  // Two files of one name may be two robots.
  std::string table = robot::to_toml(robot::RobotModel{.arm = world.robot_table()});
  for (const Transform& shoulder : world.mount().base_from_shoulder.of)
    table += fmt::format("{}", fmt::join(shoulder.matrix().reshaped(), " "));
  return fmt::format("{}, seed {}, robot {} (table {:08x})", world.person().name, seed,
                     std::filesystem::path(order.robot).stem().string(),
                     link::wire::crc_of(std::as_bytes(std::span(table)).data(), table.size()));
}

}  // namespace tuina::app
