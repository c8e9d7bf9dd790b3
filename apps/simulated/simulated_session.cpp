// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/simulated_session.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/simulated/devices/device_arms.hpp"
#include "apps/simulated/devices/device_session.hpp"
#include "apps/simulated/placed_arms.hpp"
#include "apps/simulated/robot_process.hpp"
#include "apps/simulated/truth_recorder.hpp"
#include "apps/simulated/watched_session.hpp"

namespace tuina::app {
namespace {

/// The processes that an order asks for; null when all is to happen in this one.
Result<std::unique_ptr<Processes>> processes_of(const SessionOrder& order,
                                                const CommonOptions& common) {
  if (!order.processes) return std::unique_ptr<Processes>();
  std::vector<std::string> same = {"--person",  order.person, "--robot",
                                   order.robot, "--seed",     fmt::format("{}", common.seed)};
  if (order.position) same.insert(same.end(), {"--position", name_of(*order.position)});
  if (!common.config_file.empty()) same.insert(same.end(), {"--config", common.config_file});
  for (const std::string& setting : common.settings) same.insert(same.end(), {"--set", setting});
  return Processes::start(same, order.pace ? link::Pace::real : link::Pace::max, order.link);
}

/// A robot that is no part of this program; null and empty where all is to happen in this one.
struct FarRobot {
  std::unique_ptr<Processes> processes = {};
  std::unique_ptr<DeviceArms> arms = {};
  robot::Robot* robot = nullptr;
  link::Supervisor* supervisor = nullptr;
  const SharedTruth* truth = nullptr;
};

Result<FarRobot> far_robot(const SessionOrder& order, const session::Config& config,
                           const CommonOptions& common, const sim::World& world) {
  FarRobot far;
  if (loop_of(config) && (order.processes || !order.device.empty()))
    return fail(Fault::usage,
                "simulation.arms = {}: only arms that are simulated in this program take places",
                config.simulation.arms);
  if (!order.device.empty()) {
    auto arms = DeviceArms::open(order.device, {.arm = world.robot_table(), .mount = world.mount()},
                                 world_name(order, world, common.seed));
    if (!arms) return tl::unexpected(arms.error());
    far.arms = std::move(*arms);
    far.robot = &far.arms->robot();
    far.supervisor = far.arms.get();
    far.truth = &far.arms->truth();
    return far;
  }
  auto processes = processes_of(order, common);
  if (!processes) return tl::unexpected(processes.error());
  if (!*processes) return far;
  far.processes = std::move(*processes);
  far.robot = &far.processes->robot();
  far.supervisor = &far.processes->robot();
  far.truth = &far.processes->truth();
  return far;
}

}  // namespace

std::optional<double> tool_to_acupoint_m(const SessionResult& result, std::size_t performed) {
  const session::Session& session = result.session;
  const auto& path =
      session.ready.plan.paths[static_cast<std::size_t>(session.performed[performed].path)].path;
  const Touched& touched = result.truth.touched[performed];
  if (path.technique != Technique::press || touched.peak_n <= 0.0) return std::nullopt;
  for (const Acupoint& truth : result.person.acupoints) {
    if (truth.name == path.acupoints.front())
      return (touched.at_in_couch - truth.at_in_couch).norm();
  }
  return std::nullopt;
}

double scan_to_touch_s(const SessionResult& result) {
  const session::Session& session = result.session;
  double first_s = session.massage_s;
  for (const session::Performed& done : session.performed)
    first_s = std::min(first_s, done.begin_s);
  const double compute_ms = session.scan.compute_ms + session.locate_ms + session.plan_ms;
  return session.scan.sweep_s + 1e-3 * compute_ms + first_s;
}

Result<SessionResult> run_simulated_session(const SessionOrder& order,
                                            const session::Config& config,
                                            const CommonOptions& common,
                                            const std::filesystem::path& record_file,
                                            const Attendant& attendant) {
  auto room = make_room(order, config, common);
  if (!room) return tl::unexpected(room.error());
  sim::World& world = *room->world;
  TruthRecorder truth(world);
  SessionResult result{.person = world.person(),
                       .consent = room->order.consent,
                       .consent_toml = room->consent_toml,
                       .realism = config.simulation.realism};
  auto far = far_robot(order, config, common, world);
  if (!far) return tl::unexpected(far.error());
  std::vector<session::Observer*> judges = {&truth};
  std::optional<LinkedTruth> told;
  if (far->truth != nullptr) {
    told.emplace(*far->truth, world);
    judges.insert(judges.begin(), &*told);
  }
  std::optional<PlacedArms> placed;
  const auto loop = loop_of(config);
  if (loop)
    placed.emplace(world.robot(), robot::both_models(world.robot_table(), world.mount()), *loop,
                   common.seed);
  robot::Robot& robot = placed                  ? placed->robot
                        : far->robot != nullptr ? *far->robot
                                                : world.robot();
  const auto done = run_watched({world.camera(), world.turntable(), robot, far->supervisor,
                                 loop ? believed_lag_s(*loop, common.seed) : 0.0},
                                {.given = order,
                                 .read = room->order,
                                 .consent_toml = room->consent_toml,
                                 .config = config,
                                 .common = common,
                                 .record_file = record_file,
                                 .attendant = attendant,
                                 .real_pace = order.pace || (far->arms && !far->arms->lock_step())},
                                judges, result);
  if (!done) return tl::unexpected(done.error());
  if (far->arms) result.devices = far->arms->record(told->missed());
  result.truth = truth.finish();
  return result;
}

Result<SessionResult> run_session(const SessionOrder& order, const session::Config& config,
                                  const CommonOptions& common,
                                  const std::filesystem::path& record_file,
                                  const Attendant& attendant) {
  if (order.device.empty())
    return run_simulated_session(order, config, common, record_file, attendant);
  const auto file = read_arms(order.device);
  if (!file) return tl::unexpected(file.error());
  return file->camera || file->turntable
             ? run_device_session(order, config, common, record_file, attendant)
             : run_simulated_session(order, config, common, record_file, attendant);
}

}  // namespace tuina::app
