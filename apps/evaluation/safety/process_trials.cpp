// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/safety/process_trials.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>

#include "apps/cli/program.hpp"
#include "apps/simulated/robot_process.hpp"

extern char** environ;

namespace tuina::app {
namespace {

using std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr double pressing_n = 8.0;
constexpr std::uint64_t pressing_ticks = 300;
constexpr double let_go_n = 0.5;
constexpr double max_release_ms = 600.0, max_force_n = 90.0;
constexpr std::uint64_t watched_ticks = 1500;  // after the blow
constexpr auto patience = 120s;                // for the scan, the plan and the first contact
constexpr auto session_patience = 600s;        // for a whole one

/// A process that is killed with the one that has started it.
class Child {
 public:
  explicit Child(const std::vector<std::string>& arguments) {
    std::vector<char*> pointers;
    pointers.reserve(arguments.size());
    for (const std::string& argument : arguments)
      pointers.push_back(const_cast<char*>(argument.c_str()));
    pointers.push_back(nullptr);
    if (posix_spawn(&process_, program_beside("tuina").c_str(), nullptr, nullptr, pointers.data(),
                    environ) != 0)
      process_ = 0;
  }
  ~Child() {
    if (process_ == 0) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  [[nodiscard]] pid_t process() const { return process_; }
  [[nodiscard]] bool ended() {
    if (process_ != 0 && waitpid(process_, &status_, WNOHANG) == process_) process_ = 0;
    return process_ == 0;
  }
  /// True when it has ended by itself and has said that something is wrong.
  [[nodiscard]] bool complained() const {
    return process_ == 0 && WIFEXITED(status_) && WEXITSTATUS(status_) != 0;
  }

 private:
  pid_t process_ = 0;
  int status_ = 0;
};

/// Looks at the true force of the newest millisecond that can be seen.
class Onlooker {
 public:
  Onlooker(link::Link link, SharedTruth truth) : link_(std::move(link)), truth_(std::move(truth)) {}

  struct Sight {
    std::uint64_t tick = 0;
    double force_n = 0.0;
  };
  /// The next millisecond, or nothing when none comes within twenty seconds.
  [[nodiscard]] std::optional<Sight> next() {
    const auto deadline = steady_clock::now() + 20s;
    while (steady_clock::now() < deadline) {
      const auto sensed = link_.sensors();
      if (sensed && sensed->stands > 0 && (!seen_ || sensed->tick != *seen_)) {
        const auto bytes = truth_->ticks[sensed->tick % TruthPage::kept].read();
        if (bytes && bytes->tick == sensed->tick) {
          seen_ = sensed->tick;
          robot_ = static_cast<pid_t>(sensed->process);
          sim::PlantTruth truth;
          std::memcpy(static_cast<void*>(&truth), bytes->of.data(), sizeof truth);
          Sight sight{.tick = sensed->tick};
          for (const sim::ArmTruth& arm : truth.arms.of)
            sight.force_n = std::max(sight.force_n, arm.contact.force_n);
          return sight;
        }
      }
      std::this_thread::sleep_for(50us);
    }
    return std::nullopt;
  }
  [[nodiscard]] pid_t guard() const {
    const auto frame = link_.drive();
    return frame ? static_cast<pid_t>(frame->armed) : 0;
  }
  /// The millisecond of the last word of a process that says nothing any more.
  [[nodiscard]] std::uint64_t last_word(Victim victim) const {
    const auto proposal = link_.proposal();
    const auto drive = link_.drive();
    if (victim == Victim::controller) return proposal ? proposal->answers_tick : 0;
    return drive ? drive->answers_tick : 0;
  }
  [[nodiscard]] pid_t robot() const { return robot_; }
  [[nodiscard]] bool guard_acts() const {
    const auto frame = link_.drive();
    if (!frame) return false;
    const safety::RobotVerdict verdict = link::wire::from_frame(*frame);
    return std::any_of(verdict.arms.of.begin(), verdict.arms.of.end(),
                       [](const auto& one) { return one.action >= safety::Action::freeze; });
  }

 private:
  link::Link link_;
  SharedTruth truth_;
  std::optional<std::uint64_t> seen_;
  pid_t robot_ = 0;
};

std::optional<Onlooker> look_at(const std::string& name) {
  auto link = link::Link::open(name, link::Role::onlooker);
  auto truth = SharedTruth::map(truth_name(name), link::SharedMemory::Use::read);
  if (!link || !truth) return std::nullopt;
  return Onlooker(std::move(*link), std::move(*truth));
}

/// Busy processes, as long as it lives.
class Hogs {
 public:
  explicit Hogs(unsigned count) {
    for (unsigned i = 0; i < count; ++i) {
      const pid_t hog = fork();
      if (hog == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        for (volatile unsigned turns = 0;;) turns = turns + 1;
      }
      if (hog > 0) hogs_.push_back(hog);
    }
  }
  ~Hogs() {
    for (const pid_t hog : hogs_) {
      kill(hog, SIGKILL);
      waitpid(hog, nullptr, 0);
    }
  }
  Hogs(const Hogs&) = delete;
  Hogs& operator=(const Hogs&) = delete;

 private:
  std::vector<pid_t> hogs_;
};

/// A blow to a process; hogs live as long as what is given back.
std::unique_ptr<Hogs> strike(Blow blow, pid_t victim) {
  constexpr rlimit nothing = {.rlim_cur = 0, .rlim_max = 0};
  switch (blow) {
    case Blow::kill:
      kill(victim, SIGKILL);
      return nullptr;
    case Blow::stop:
      kill(victim, SIGSTOP);
      return nullptr;
    case Blow::crash:
      kill(victim, SIGSEGV);
      return nullptr;
    case Blow::no_memory:
      prlimit(victim, RLIMIT_AS, &nothing, nullptr);
      return nullptr;
    case Blow::disk_full:
      prlimit(victim, RLIMIT_FSIZE, &nothing, nullptr);
      return nullptr;
    case Blow::hogs:
      return std::make_unique<Hogs>(2 * std::thread::hardware_concurrency());
  }
  return nullptr;
}

/// Whether the controller cannot go on after a blow, so that the guard has to let go.
bool ends_controller(const ProcessTrial& trial) {
  return trial.victim == Victim::controller && trial.blow <= Blow::crash;
}

/// Waits until a tool has pressed for some time; the force then.
std::optional<Onlooker::Sight> wait_for_contact(Onlooker& onlooker) {
  std::uint64_t light_tick = 0;  // the last in which no tool pressed
  while (auto sight = onlooker.next()) {
    if (sight->force_n < pressing_n) light_tick = sight->tick;
    if (sight->tick - light_tick >= pressing_ticks) return sight;
  }
  return std::nullopt;
}

void watch(Onlooker& onlooker, const Onlooker::Sight& blow, ProcessOutcome& outcome) {
  // What drives do without a guard is their own affair: no frame tells of it.
  const bool guard_is_gone = outcome.trial.victim == Victim::guard;
  std::uint64_t last_tick = blow.tick, pressed_tick = blow.tick;
  while (auto sight = onlooker.next()) {
    if (sight->tick < blow.tick) continue;
    const auto after_ms = static_cast<double>(sight->tick - blow.tick);
    outcome.max_force_n = std::max(outcome.max_force_n, sight->force_n);
    if (!guard_is_gone && outcome.first_action_ms < 0.0 && onlooker.guard_acts())
      outcome.first_action_ms = after_ms;
    if (sight->force_n > let_go_n) pressed_tick = sight->tick;
    outcome.left_n = sight->force_n;
    last_tick = sight->tick;
    if (last_tick - blow.tick >= watched_ticks) break;
  }
  if (last_tick > pressed_tick)
    outcome.released_ms = static_cast<double>(pressed_tick + 1 - blow.tick);
}

}  // namespace

const char* name_of(Blow blow) {
  constexpr std::array names = {"kill -9",   "SIGSTOP",   "segmentation fault",
                                "no memory", "disk full", "processors hogged"};
  return names[static_cast<std::size_t>(blow)];
}

const char* name_of(Victim victim) {
  constexpr std::array names = {"controller", "guard", "machine"};
  return names[static_cast<std::size_t>(victim)];
}

const std::vector<ProcessBlow>& process_blows() {
  static const std::vector<ProcessBlow> all = {
      {Victim::controller, Blow::kill},      {Victim::controller, Blow::stop},
      {Victim::controller, Blow::crash},     {Victim::controller, Blow::no_memory},
      {Victim::controller, Blow::disk_full}, {Victim::guard, Blow::kill},
      {Victim::guard, Blow::stop},           {Victim::guard, Blow::crash},
      {Victim::guard, Blow::no_memory},      {Victim::machine, Blow::hogs}};
  return all;
}

Result<ProcessOutcome> run_process_trial(const ProcessTrial& trial) {
  const std::string name = fmt::format("trial-{}-{}", getpid(), trial.seed);
  const std::string out = (std::filesystem::temp_directory_path() / ("tuina-" + name)).string();
  // A process whose files may not grow is told so by its writes, not by a signal that ends it.
  std::signal(SIGXFSZ, SIG_IGN);
  Child session({"tuina", "massage", "--quiet", "--processes", "--link", name, "--programme",
                 "lower_back", "--pace", trial.real_pace ? "real" : "max", "--seed",
                 fmt::format("{}", trial.seed), "--out", out});
  std::optional<Onlooker> onlooker;
  const auto deadline = steady_clock::now() + patience;
  while (!onlooker && !session.ended() && steady_clock::now() < deadline) {
    std::this_thread::sleep_for(20ms);
    onlooker = look_at(name);
  }
  std::optional<Onlooker::Sight> contact;
  while (onlooker && !contact && !session.ended() && steady_clock::now() < deadline)
    contact = wait_for_contact(*onlooker);
  if (!contact) return fail(Fault::device, "{}: the session never pressed", name);

  ProcessOutcome outcome{.trial = trial, .before_n = contact->force_n};
  const pid_t guard = onlooker->guard();
  const auto hogs = strike(trial.blow, trial.victim == Victim::guard ? guard : session.process());
  // On a busy machine the robot has gone on before the blow falls: time counts from the last
  // word, and the others wait two seconds for the next.
  if (trial.blow <= Blow::crash) {
    std::this_thread::sleep_for(300ms);
    contact->tick = std::max(contact->tick, onlooker->last_word(trial.victim));
  }
  watch(*onlooker, *contact, outcome);
  const bool released = outcome.released_ms >= 0.0 && outcome.released_ms <= max_release_ms;
  // Drives without a guard do not know the way out: the tool stays, held by nothing but brakes.
  outcome.held = outcome.max_force_n <= max_force_n && (released || !ends_controller(trial));
  if (trial.blow == Blow::disk_full) {
    const auto end = steady_clock::now() + session_patience;
    while (!session.ended() && steady_clock::now() < end) std::this_thread::sleep_for(20ms);
    outcome.held = outcome.held && session.complained();
  }
  for (const pid_t left : {guard, onlooker->robot()})
    if (left > 0) kill(left, SIGKILL);
  std::error_code ignored;
  std::filesystem::remove_all(out, ignored);
  for (const char* part : {"drives", "controller", "guard", "bells", "truth"})
    shm_unlink(fmt::format("/tuina-{}-{}", name, part).c_str());
  return outcome;
}

}  // namespace tuina::app
