// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <thread>
#include <vector>

#include "tests/devices/own_port.hpp"
#include "tests/whole/command.hpp"

// Simulated arms as another program, over UDP.
namespace tuina::test {

using Words = std::vector<std::string>;

inline Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

inline std::string device_file(const Folder& folder, int port) {
  const auto arm = [](const char* name, int at) {
    return "[arm." + std::string(name) +
           "]\nkind = \"armlink\"\naddress = \"127.0.0.1:" + std::to_string(at) + "\"\n";
  };
  return folder.with("device.toml", arm("left", port) + arm("right", port + 1));
}

/// The program with the arms, which ends with the session of its host.
class Arms {
 public:
  Arms(int port, const Words& words)
      : thread_([=, this] {
          outcome_ = run_tuina(Words{"robot", "armlink", "--pace", "max", "--quiet", "--json",
                                     "--listen", "127.0.0.1:" + std::to_string(port)} +
                                   words,
                               max_s);
        }) {}
  ~Arms() {
    if (thread_.joinable()) thread_.join();
  }
  [[nodiscard]] const Outcome& end() {
    thread_.join();
    return outcome_;
  }

 private:
  static constexpr int max_s = 600;
  Outcome outcome_;
  std::thread thread_;
};

inline bool is_there(const std::string& device) {
  for (int i = 0; i < 60; ++i)
    if (run_tuina({"doctor", "--device", device, "--quiet"}).exit_code == 0) return true;
  return false;
}

}  // namespace tuina::test
