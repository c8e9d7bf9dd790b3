// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/audit.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "tuina/core/io/file.hpp"
#include "tuina/web/digest.hpp"

namespace tuina::web {
namespace {

// The hash stands at the end of a line, so that all before it is what it was made of.
constexpr std::string_view hash_key = ",\"hash\":\"";
constexpr std::string_view line_end = "\"}";
const std::string first_hash(64, '0');
constexpr std::string_view line_begin = "{\"line\":";

/// Whether a line of a log may begin so; what does not is somebody else's, and is not cut off.
bool begins_line(std::string_view torn) {
  return torn.starts_with(line_begin) || line_begin.starts_with(torn);
}

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm parts{};
  ::gmtime_r(&now, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%FT%TZ", &parts);
  return text.data();
}

}  // namespace

Result<AuditSummary> check_audit(std::string_view text, std::string_view name) {
  AuditSummary summary{.last_hash = first_hash};
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    const std::uint64_t number = summary.lines + 1;
    if (end == std::string_view::npos)
      return fail(Fault::bad_input, "{}:{}: the line does not end", name, number);
    const std::string_view line = text.substr(at, end - at);
    const std::size_t hash_at = line.rfind(hash_key);
    const std::size_t length = hash_key.size() + first_hash.size() + line_end.size();
    if (hash_at == std::string_view::npos || line.size() - hash_at != length ||
        !line.ends_with(line_end)) {
      return fail(Fault::bad_input, "{}:{}: does not end in a hash", name, number);
    }
    const std::string_view written = line.substr(hash_at + hash_key.size(), first_hash.size());
    if (written != sha256(summary.last_hash + std::string(line.substr(0, hash_at)))) {
      return fail(Fault::bad_input,
                  "{}:{}: was changed, or a line before it was: its hash is not that of its text",
                  name, number);
    }
    summary = {.lines = number, .last_hash = std::string(written)};
    at = end + 1;
  }
  return summary;
}

AuditLog::AuditLog(std::filesystem::path file, int descriptor, AuditSummary end)
    : file_(std::move(file)), descriptor_(descriptor), end_(std::move(end)) {}

AuditLog::AuditLog(AuditLog&& other) noexcept
    : file_(std::move(other.file_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      end_(std::move(other.end_)),
      left_out_(other.left_out_),
      torn_bytes_(other.torn_bytes_),
      requests_(other.requests_) {}

AuditLog::~AuditLog() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<AuditLog> AuditLog::open(const std::filesystem::path& file) {
  constexpr int for_owner_only = 0600;
  const int descriptor =
      ::open(file.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, for_owner_only);
  if (descriptor < 0)
    return fail(Fault::file, "{}: cannot be written: {}", file.string(), std::strerror(errno));
  AuditLog log(file, descriptor, {.last_hash = first_hash});
  // A server that was told to end takes some seconds for it.
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    if (std::chrono::steady_clock::now() > until)
      return fail(
          Fault::file,
          "{}: another server writes there; end it, or give this one another folder by --out",
          file.string());
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  std::error_code none;
  if (std::filesystem::file_size(file, none) > 0) {
    auto text = read_file(file);
    if (!text) return tl::unexpected(text.error());
    // A line that does not end was being written when its server was killed or its disk full.
    std::size_t whole = text->rfind('\n') + 1;
    if (!begins_line(std::string_view(*text).substr(whole))) whole = text->size();
    auto checked = check_audit(std::string_view(*text).substr(0, whole), file.string());
    if (!checked) return tl::unexpected(checked.error());
    log.end_ = std::move(*checked);
    log.torn_bytes_ = text->size() - whole;
    if (log.torn_bytes_ > 0 && ::ftruncate(log.descriptor_, static_cast<off_t>(whole)) != 0)
      return fail(Fault::file, "{}: cannot be written: {}", file.string(), std::strerror(errno));
  }
  return log;
}

Result<void> AuditLog::add_refused(const AuditEntry& entry, double now_s) {
  if (requests_.take(now_s)) return add(entry, now_s);
  ++left_out_;
  return {};
}

Result<void> AuditLog::add(const AuditEntry& entry, double now_s) {
  nlohmann::ordered_json json = {{"line", end_.lines + 1},  {"utc", utc_now()},
                                 {"clock_s", now_s},        {"who", entry.who},
                                 {"what", entry.what},      {"phase", entry.phase},
                                 {"outcome", entry.outcome}};
  if (left_out_ > 0) json["left_out"] = left_out_;
  if (torn_bytes_ > 0) json["torn_bytes"] = torn_bytes_;  // of a line before that did not end
  std::string line = json.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  line.pop_back();  // the closing brace comes after the hash
  const std::string hash = sha256(end_.last_hash + line);
  line += fmt::format("{}{}{}\n", hash_key, hash, line_end);
  struct stat before = {};
  const bool known = ::fstat(descriptor_, &before) == 0;
  if (!known ||
      ::write(descriptor_, line.data(), line.size()) != static_cast<ssize_t>(line.size())) {
    const int why = errno;
    // Half a line would break the chain for whoever opens the log next.
    if (known) (void)!::ftruncate(descriptor_, before.st_size);
    return fail(Fault::file, "{}: cannot be written: {}", file_.string(), std::strerror(why));
  }
  end_ = {.lines = end_.lines + 1, .last_hash = hash};
  left_out_ = torn_bytes_ = 0;
  return {};
}

}  // namespace tuina::web
