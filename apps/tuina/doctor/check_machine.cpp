// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/doctor/check_machine.hpp"

#include <fmt/format.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tuina/hardware/video_device.hpp"
#include "tuina/link/real_time.hpp"

namespace tuina::app {
namespace {

using std::chrono::steady_clock;

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

/// Devices that somebody of that group may open.
MachineCheck check_devices(const char* what, const std::vector<std::string>& paths,
                           const char* group, const char* plug_in) {
  MachineCheck check{.what = what, .finding = "none", .remedy = plug_in};
  std::vector<std::string> mine, others;
  for (const std::string& path : paths)
    (::access(path.c_str(), R_OK | W_OK) == 0 ? mine : others).push_back(path);
  if (!mine.empty()) check = {.what = what, .good = true, .finding = joined(mine), .remedy = {}};
  if (others.empty()) return check;
  check.good = false;
  check.finding = fmt::format("{}{}{}, not for this user", joined(mine), mine.empty() ? "" : "; ",
                              joined(others));
  check.remedy = fmt::format("`sudo usermod -aG {} $USER`, and log in again", group);
  return check;
}

std::vector<std::string> serial_lines() {
  std::vector<std::string> all;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", none)) {
    const std::string name = entry.path().filename();
    if (name.starts_with("ttyACM") || name.starts_with("ttyUSB")) all.push_back(entry.path());
  }
  std::sort(all.begin(), all.end());
  return all;
}

long number_in(const std::filesystem::path& file, bool hexadecimal = false) {
  std::string word;
  std::ifstream(file) >> word;
  return std::strtol(word.c_str(), nullptr, hexadecimal ? 16 : 10);
}

MachineCheck check_can() {
  std::vector<std::string> up, down;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator("/sys/class/net", none)) {
    if (number_in(entry.path() / "type") != ARPHRD_CAN) continue;
    const bool is_up = (number_in(entry.path() / "flags", true) & IFF_UP) != 0;
    (is_up ? up : down).push_back(entry.path().filename());
  }
  if (up.empty() && down.empty())
    return {.what = "CAN",
            .finding = "none",
            .remedy = "only drives on CAN need one: plug an adapter in (docs/can_drives.md)"};
  if (down.empty()) return {.what = "CAN", .good = true, .finding = joined(up), .remedy = {}};
  return {.what = "CAN",
          .finding = fmt::format("{}{}{} down", joined(up), up.empty() ? "" : "; ", joined(down)),
          .remedy = fmt::format("`sudo ip link set {} up txqueuelen 100 type can bitrate 1000000`",
                                down.front())};
}

MachineCheck check_limits() {
  constexpr rlim_t needed_priority = 80;
  rlimit priority{}, locked{};
  ::getrlimit(RLIMIT_RTPRIO, &priority);
  ::getrlimit(RLIMIT_MEMLOCK, &locked);
  const bool root = ::geteuid() == 0;
  const std::string memory =
      locked.rlim_cur == RLIM_INFINITY ? "any" : fmt::format("{} MB", locked.rlim_cur >> 20U);
  return {
      .what = "real-time",
      .good = root || (priority.rlim_cur >= needed_priority && locked.rlim_cur == RLIM_INFINITY),
      .finding = root ? "root may have any priority and lock all memory"
                      : fmt::format("priority {} of {}, {} of memory to lock", priority.rlim_cur,
                                    needed_priority, memory),
      .remedy =
          "only a robot needs it: write `@dialout - rtprio 80` and `@dialout - memlock "
          "unlimited` into /etc/security/limits.d/tuina.conf, join the group `dialout`, and log in "
          "again"};
}

/// By how much a thread is woken too late that asks for the priority of one that controls arms.
MachineCheck check_wake_ups(double seconds, const Progress& progress) {
  const auto wake_ups = static_cast<int>(1e3 * seconds);
  constexpr auto every = std::chrono::milliseconds(1);
  constexpr double max_late_ms = 0.5;
  constexpr int told_every = 250;
  double worst_ms = 0.0;
  int late = 0;
  (void)link::be_real_time(link::Priority::loop);
  for (int i = 0; i < wake_ups; ++i) {
    const auto due = steady_clock::now() + every;
    std::this_thread::sleep_until(due);
    const std::chrono::duration<double, std::milli> by = steady_clock::now() - due;
    worst_ms = std::max(worst_ms, by.count());
    late += by.count() > max_late_ms ? 1 : 0;
    if (progress && i % told_every == 0) progress(static_cast<double>(i) / wake_ups);
  }
  link::end_real_time();
  if (progress) progress(1.0);
  return {.what = "wake-ups",
          .good = late == 0,
          .finding = fmt::format(
              "of {} sleeps of 1 ms {} ended more than {} ms late, the worst by {:.1f} ms",
              wake_ups, late, max_late_ms, worst_ms),
          .remedy =
              "only a robot minds, which is stopped by 10 ms: end other programs, boot a kernel "
              "with PREEMPT_RT, or take a machine that is no virtual one"};
}

}  // namespace

std::vector<MachineCheck> check_machine(double seconds, const Progress& progress) {
  const unsigned cores = std::thread::hardware_concurrency();
  std::vector<MachineCheck> all = {
      {.what = "cores",
       .good = cores >= 2,
       .finding = fmt::format("{} to compute with", cores),
       .remedy = "two are wanted: one for control, one for the rest"},
      check_devices("cameras", hardware::video_devices(), "video",
                    "only a scanner needs one: plug it in (docs/build_a_scanner.md)"),
      check_devices("serial lines", serial_lines(), "dialout",
                    "only a scanner's board and wrist sensors at USB need one: plug them in "
                    "(docs/wrist_sensors.md)"),
      check_can(),
      check_limits(),
      check_wake_ups(seconds, progress)};
  for (MachineCheck& check : all)
    if (check.good) check.remedy.clear();
  return all;
}

}  // namespace tuina::app
