// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <new>
#include <stdexcept>
#include <string>

namespace tuina::tests {

/// The clock of a stage of emulated devices, which a host under fake_v4l2.cpp goes by, too. It
/// stands still while the host computes, so that a slow machine is as good as a quick one.
class StageClock {
 public:
  static constexpr double begins_s = 1000.0;

  /// The clock is FOLDER/clock; the number of the host's process stands in FOLDER/host.
  explicit StageClock(const std::string& folder) : host_file_(folder + "/host") {
    const std::string path = folder + "/clock";
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (file < 0 || ::ftruncate(file, bytes) != 0) throw std::runtime_error("cannot write " + path);
    void* page = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    ::close(file);
    if (page == MAP_FAILED) throw std::runtime_error("cannot map " + path);
    time_ns_ = new (page) std::atomic<std::int64_t>(static_cast<std::int64_t>(1e9 * begins_s));
  }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;
  ~StageClock() { ::munmap(time_ns_, bytes); }

  [[nodiscard]] double now_s() const { return 1e-9 * static_cast<double>(time_ns_->load()); }
  void set(double time_s) { *time_ns_ = static_cast<std::int64_t>(1e9 * time_s); }

  /// 0 before there is one.
  [[nodiscard]] long host() {
    if (host_ == 0) std::ifstream(host_file_) >> host_;
    return host_;
  }
  /// Whether a thread of the host runs or could.
  [[nodiscard]] bool host_computes() {
    std::error_code gone;
    if (host() == 0) return false;
    const std::filesystem::path tasks = "/proc/" + std::to_string(host_) + "/task";
    for (const auto& thread : std::filesystem::directory_iterator(tasks, gone)) {
      std::string text;
      std::getline(std::ifstream(thread.path() / "stat"), text);
      const std::size_t name_end = text.rfind(") ");
      if (name_end == std::string::npos) continue;
      const char state = text[name_end + 2];
      if (state == 'R' || state == 'D') return true;
    }
    return false;
  }

 private:
  static constexpr std::size_t bytes = 4096;
  std::string host_file_;
  long host_ = 0;
  std::atomic<std::int64_t>* time_ns_;
};

}  // namespace tuina::tests
