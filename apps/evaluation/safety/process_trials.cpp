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

/// Looks at the true force, millisecond after millisecond.
class Onlooker {
 public:
  Onlooker(link::Link link, SharedTruth truth) : link_(std::move(link)), truth_(std::move(truth)) {}

  struct Sight {
    std::uint64_t tick = 0;
    double force_n = 0.0;
    bool guard_acts = false;
  };
  /// The next millisecond, or the newest where that one can no longer be seen; nothing when none
  /// comes within twenty seconds.
  [[nodiscard]] std::optional<Sight> next() {
    const auto deadline = steady_clock::now() + 20s;
    while (steady_clock::now() < deadline) {
      const auto sensed = link_.sensors();
      if (sensed && sensed->stands > 0 && (!seen_ || sensed->tick != *seen_)) {
        const bool next_is_kept = seen_ && sensed->tick - *seen_ < TruthPage::kept;
        const std::uint64_t tick = next_is_kept ? *seen_ + 1 : sensed->tick;
        const auto bytes = truth_->ticks[tick % TruthPage::kept].read();
        if (bytes && bytes->tick == tick) {
          seen_ = tick;
          robot_ = static_cast<pid_t>(sensed->process);
          sim::PlantTruth truth;
          std::memcpy(static_cast<void*>(&truth), bytes->of.data(), sizeof truth);
          Sight sight{.tick = tick, .force_n = 0.0, .guard_acts = guard_acts()};
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

 private:
  [[nodiscard]] bool guard_acts() const {
    const auto frame = link_.drive();
    if (!frame) return false;
    const safety::RobotVerdict verdict = link::wire::from_frame(*frame);
    return std::any_of(verdict.arms.of.begin(), verdict.arms.of.end(),
                       [](const auto& one) { return one.action >= safety::Action::freeze; });
  }

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
  if (blow == Blow::hogs) return std::make_unique<Hogs>(2 * std::thread::hardware_concurrency());
  if (blow == Blow::kill) kill(victim, SIGKILL);
  if (blow == Blow::stop) kill(victim, SIGSTOP);
  if (blow == Blow::crash) kill(victim, SIGSEGV);
  if (blow == Blow::no_memory) prlimit(victim, RLIMIT_AS, &nothing, nullptr);
  if (blow == Blow::disk_full) prlimit(victim, RLIMIT_FSIZE, &nothing, nullptr);
  return nullptr;
}

/// Whether the controller cannot go on after a blow, so that the guard has to let go.
bool ends_controller(const ProcessTrial& trial) {
  return trial.victim == Victim::controller && trial.blow <= Blow::crash;
}

/// What a session leaves behind, taken away in the end.
struct Leftovers {
  std::string name, out;

  ~Leftovers() {
    std::error_code ignored;
    std::filesystem::remove_all(out, ignored);
    std::filesystem::remove(out + ".arming", ignored);
    for (const char* part :
         {"drives", "controller", "guard", "bells", "truth", "hand-stop", "operating"})
      shm_unlink(fmt::format("/tuina-{}-{}", name, part).c_str());
  }
};

/// Waits until a tool has pressed for some time; the force then.
std::optional<Onlooker::Sight> wait_for_contact(Onlooker& onlooker) {
  std::uint64_t light_tick = 0;  // the last in which no tool pressed
  while (auto sight = onlooker.next()) {
    if (sight->force_n < pressing_n) light_tick = sight->tick;
    if (sight->tick - light_tick >= pressing_ticks) return sight;
  }
  return std::nullopt;
}

/// Watches from before the blow on. On a busy machine the robot has gone on before it falls, so for
/// a process that says nothing any more time counts from its last word.
void watch(Onlooker& onlooker, std::uint64_t struck_tick, ProcessOutcome& outcome) {
  const ProcessTrial& trial = outcome.trial;
  std::vector<Onlooker::Sight> sights;
  std::uint64_t blow_tick = struck_tick;
  while (auto sight = onlooker.next()) {
    sights.push_back(*sight);
    if (trial.blow <= Blow::crash)
      blow_tick = std::max(struck_tick, onlooker.last_word(trial.victim));
    if (sight->tick >= blow_tick + watched_ticks) break;
  }
  std::uint64_t pressed_tick = blow_tick;
  for (const Onlooker::Sight& sight : sights) {
    if (sight.tick < blow_tick) continue;
    outcome.max_force_n = std::max(outcome.max_force_n, sight.force_n);
    // What drives do without a guard is their own affair: no frame tells of it.
    if (trial.victim != Victim::guard && outcome.first_action_ms < 0.0 && sight.guard_acts)
      outcome.first_action_ms = static_cast<double>(sight.tick - blow_tick);
    if (sight.force_n > let_go_n) pressed_tick = sight.tick;
    outcome.left_n = sight.force_n;
  }
  if (!sights.empty() && sights.back().tick > pressed_tick)
    outcome.released_ms = static_cast<double>(pressed_tick + 1 - blow_tick);
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
  const Leftovers leftovers{name, out};
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
  watch(*onlooker, contact->tick, outcome);
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
  return outcome;
}

}  // namespace tuina::app
