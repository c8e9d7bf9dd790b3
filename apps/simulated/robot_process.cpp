// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/robot_process.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <thread>

#include "apps/cli/program.hpp"

extern char** environ;

namespace tuina::app {
namespace {

using std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto guard_patience = 20s;
constexpr auto lock_step_patience = 6s;  // for a guard that may be dead; it may wait itself ...
constexpr auto gone_patience = 5ms;      // ... and for one that is
constexpr auto scan_patience = 300s;     // of arms that rest while the person is scanned again
constexpr std::uint64_t given_up_ticks = 3000;  // virtual time that nobody has said anything in

const char* name_of(link::Pace pace) {
  return pace == link::Pace::real ? "real" : "max";
}

auto wait_for_answer(link::Link& link, std::uint64_t tick, link::Link::Deadline deadline) {
  return link.wait_for(deadline, [&]() {
    const auto said = link.drive();
    return said && said->answers_tick == tick ? said : std::nullopt;
  });
}

/// Whether the session wants another guard, which has not come yet.
bool rests(const link::Link& link) {
  const auto stand = link.stand();
  const auto drive = link.drive();
  return link.maker_lives() && stand && stand->ends == 0 && drive && drive->guard != stand->guard;
}

/// While the person is scanned again, arms and time of this robot stand still, as they do for a
/// session that is one process.
void wait_for_guard(link::Link& link, const std::atomic<bool>& ends) {
  const auto deadline = steady_clock::now() + scan_patience;
  while (!ends && rests(link) && steady_clock::now() < deadline)
    link.wait(steady_clock::now() + 10ms);
}

}  // namespace

std::string truth_name(const std::string& link) {
  return "/tuina-" + link + "-truth";
}

void clear_left(const std::string& link) {
  link::Link::clear_left(link);
  link::SharedMemory::clear_left(truth_name(link));
}

void RobotReport::see(const sim::PlantTruth& truth) noexcept {
  double force_n = 0.0;
  for (const sim::ArmTruth& arm : truth.arms.of) force_n = std::max(force_n, arm.contact.force_n);
  max_force_n = std::max(max_force_n, force_n);
  over_60_n_s = force_n > 60.0 ? over_60_n_s + control_period_s : 0.0;
  max_over_60_n_s = std::max(max_over_60_n_s, over_60_n_s);
  ++ticks;
}

void tell_truth(SharedTruth& shared, std::uint64_t tick, const sim::PlantTruth& truth) noexcept {
  TruthPage::Bytes bytes{.tick = tick};
  // Its vectors have their numbers in themselves, so its bytes are all of it.
  std::memcpy(bytes.of.data(), static_cast<const void*>(&truth), sizeof(sim::PlantTruth));
  shared->ticks[tick % TruthPage::kept].write(bytes);
}

Result<RobotReport> keep_robot(link::Link& link, SharedTruth& truth, sim::World& world,
                               link::Pace pace, const std::atomic<bool>& ends) {
  const auto wish = link.wait_for(steady_clock::now() + guard_patience, [&]() {
    const auto frame = link.stand();
    return frame && frame->number > 0 ? frame : std::nullopt;
  });
  if (!wish) return fail(Fault::device, "no session has come to this robot");
  if (auto stands = world.robot().stand_ready(link::wire::from_frame(*wish)); !stands)
    return tl::unexpected(stands.error());
  const auto guard = link.wait_for(steady_clock::now() + guard_patience, [&]() {
    const auto frame = link.drive();
    return frame && frame->armed != 0 ? frame : std::nullopt;
  });
  if (!guard) return fail(Fault::device, "no guard has come to this robot");

  RobotReport report;
  std::uint64_t silent = 0;
  auto next = steady_clock::now();
  while (!ends && silent < given_up_ticks) {
    if (const auto stand = link.stand(); stand && stand->ends != 0) break;
    const auto reading = world.robot().read();
    if (!reading) continue;
    tell_truth(truth, reading->tick, world.truth());
    link::wire::SensorFrame frame = link::wire::to_frame(*reading);
    frame.stands = wish->number;
    frame.process = static_cast<std::uint64_t>(getpid());
    link.write(frame);
    report.see(world.truth());

    next += 1ms;
    const auto patience = steady_clock::now() + (silent == 0 ? lock_step_patience : gone_patience);
    auto answer = wait_for_answer(link, reading->tick, pace == link::Pace::real ? next : patience);
    if (!answer && rests(link)) {
      wait_for_guard(link, ends);
      next = steady_clock::now() + 1ms;
      answer = wait_for_answer(link, reading->tick, steady_clock::now() + lock_step_patience);
    }
    if (answer) world.robot().apply(link::wire::from_frame(*answer).command);
    silent = answer ? 0 : silent + 1;
    report.silent_ticks += answer ? 0 : 1;
    // A simulation that was held up goes on from now: its robot's clock stood still with it.
    if (pace == link::Pace::real) std::this_thread::sleep_until(next);
    next = std::max(next, steady_clock::now() - 1ms);
  }
  if (auto last = link.sensors()) {
    last->over = 1;
    link.write(*last);
  }
  return report;
}

void LinkedTruth::tell(const robot::RobotReading& reading) noexcept {
  const auto bytes = shared_->ticks[reading.tick % TruthPage::kept].read();
  const bool there = bytes && bytes->tick == reading.tick;
  missed_ += there ? 0 : 1;
  sim::PlantTruth truth;
  if (there) {
    std::memcpy(static_cast<void*>(&truth), bytes->of.data(), sizeof truth);
  } else if (!told_) {  // nothing is known yet but where the arms are
    truth.time_s = reading.time_s;
    for (const Arm arm : both_arms) {
      truth.arms[arm].q_rad = reading.arms[arm].q_rad;
      truth.arms[arm].dq_rad_per_s = reading.arms[arm].dq_rad_per_s;
    }
  }
  if (there || !told_) world_.tell_truth(truth);
  told_ = true;
}

Result<int> Processes::run(const std::vector<std::string>& arguments) {
  std::vector<char*> pointers;
  pointers.reserve(arguments.size());
  for (const std::string& argument : arguments)
    pointers.push_back(const_cast<char*>(argument.c_str()));
  pointers.push_back(nullptr);
  // A group of its own, which Ctrl-C at the terminal does not reach: arms that were asked to stop
  // are needed until they have left.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  pid_t child = 0;
  const int failed = posix_spawn(&child, program_beside("tuina").c_str(), nullptr, &attributes,
                                 pointers.data(), environ);
  posix_spawnattr_destroy(&attributes);
  if (failed != 0) return fail(Fault::device, "tuina {}: {}", arguments[1], std::strerror(failed));
  children_.push_back(child);
  return child;
}

// Two guards never speak at once: the one before is over when the next begins.
Result<void> Processes::start_guard(const link::Arming& arming,
                                    const std::vector<std::string>& arguments) {
  if (guard_ != 0) end(guard_);
  if (auto written = link::write_arming(arming_file_, arming); !written) return written;
  const auto started = run(arguments);
  if (!started) return tl::unexpected(started.error());
  guard_ = *started;
  return {};
}

void Processes::end(int child) {
  const auto deadline = steady_clock::now() + 5s;
  while (waitpid(child, nullptr, WNOHANG) == 0) {
    if (steady_clock::now() > deadline) kill(child, SIGKILL);
    std::this_thread::sleep_for(10ms);
  }
  std::erase(children_, child);
}

Result<std::unique_ptr<Processes>> Processes::start(const std::vector<std::string>& robot_arguments,
                                                    link::Pace pace, const std::string& link_name) {
  std::unique_ptr<Processes> made(new Processes);
  Processes& all = *made;
  all.link_name_ = link_name.empty() ? fmt::format("{}", getpid()) : link_name;
  all.arming_file_ =
      (std::filesystem::temp_directory_path() / fmt::format("tuina-{}.arming", all.link_name_))
          .string();
  auto link = link::Link::create(all.link_name_, link::Role::controller);
  if (!link) return tl::unexpected(link.error());
  auto truth = SharedTruth::map(truth_name(all.link_name_), link::SharedMemory::Use::make);
  if (!truth) return tl::unexpected(truth.error());
  all.truth_ = std::move(*truth);
  const std::vector<std::string> shared = {"--link", all.link_name_, "--pace", name_of(pace),
                                           "--quiet"};
  const auto with_link = [shared](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), shared.begin(), shared.end());
    return arguments;
  };
  const auto start_guard = [&all, with_link](const link::Arming& arming) {
    return all.start_guard(arming, with_link({"tuina", "guard", "--arm", all.arming_file_}));
  };
  // It tells much of a person's back, and is not left when this process is killed.
  const auto guard_began = [&all] {
    std::error_code ignored;
    std::filesystem::remove(all.arming_file_, ignored);
  };
  all.robot_ =
      std::make_unique<link::LinkedRobot>(std::move(*link), pace, start_guard, guard_began);
  std::vector<std::string> robot = {"tuina", "robot", "simulate"};
  robot.insert(robot.end(), robot_arguments.begin(), robot_arguments.end());
  if (auto started = all.run(with_link(std::move(robot))); !started)
    return tl::unexpected(started.error());
  return made;
}

// Both end by themselves when the session is over; a process that does not within its own patience
// is one that hangs.
Processes::~Processes() {
  robot_.reset();
  while (!children_.empty()) end(children_.back());
  std::error_code ignored;
  if (!arming_file_.empty()) std::filesystem::remove(arming_file_, ignored);
}

}  // namespace tuina::app
