// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/history/open.hpp"

#include <fmt/chrono.h>

#include <chrono>
#include <cstdlib>
#include <random>

namespace tuina::app {

Option add_history_option(Options& options, std::string& address) {
  return options.add("--history", address,
                     "a SQLite file or postgresql://...; else history.sqlite in "
                     "$XDG_DATA_HOME/tuina or ~/.local/share/tuina");
}

Result<std::filesystem::path> data_folder() {
  namespace fs = std::filesystem;
  const char* data = std::getenv("XDG_DATA_HOME");
  if (data != nullptr && *data != '/') data = nullptr;  // as its specification wants it
  const char* home = std::getenv("HOME");
  if (data == nullptr && home == nullptr)
    return fail(Fault::usage, "a folder for the history: neither XDG_DATA_HOME nor HOME is set");
  const fs::path folder =
      (data != nullptr ? fs::path(data) : fs::path(home) / ".local" / "share") / "tuina";
  std::error_code fault;
  fs::create_directories(folder, fault);
  if (fault) return fail(Fault::file, "{}: cannot be made: {}", folder.string(), fault.message());
  // Whoever else uses this computer has no business in it.
  fs::permissions(folder, fs::perms::owner_all, fault);
  return folder;
}

Result<history::History> open_history(const std::string& address) {
  if (!address.empty()) return history::History::open(address);
  const auto folder = data_folder();
  if (!folder) return tl::unexpected(folder.error());
  return history::History::open(*folder / "history.sqlite");
}

Result<history::History> open_known_history(const std::string& address) {
  if (!address.empty() && !history::is_server(address)) {
    std::error_code fault;
    const auto bytes = std::filesystem::file_size(address, fault);
    if (fault || bytes == 0) {
      return fail(Fault::file, "{}: {}; `tuina massage --who NAME --history FILE` begins a history",
                  address, fault ? fault.message() : "is empty");
    }
  }
  return open_history(address);
}

namespace {

std::string stamp(std::chrono::system_clock::time_point time) {
  const auto second = std::chrono::time_point_cast<std::chrono::seconds>(time);
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(second));
}

}  // namespace

std::string utc_now() {
  return stamp(std::chrono::system_clock::now());
}

Result<std::string> day_of_file(const std::filesystem::path& file) {
  std::error_code fault;
  const auto written = std::filesystem::last_write_time(file, fault);
  if (fault) return fail(Fault::file, "{}: {}", file.string(), fault.message());
  return stamp(std::chrono::file_clock::to_sys(written));
}

record::VisitLabel new_visit(const std::string& who) {
  std::random_device random;
  const std::uint64_t number = (std::uint64_t{random()} << 32U) | random();
  const std::string began = utc_now();
  return {.who = who, .id = fmt::format("{}-{:016x}", began, number), .began = began};
}

}  // namespace tuina::app
