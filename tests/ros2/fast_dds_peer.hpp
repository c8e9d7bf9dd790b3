// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace tuina::test {

/// Another implementation of DDS, Fast DDS, which ROS 2 uses by default: hears and says topics as
/// bytes. Only loopback.
class FastDdsPeer {
 public:
  /// With 0 the socket has the size that the machine gives it, 208 kB on Debian.
  explicit FastDdsPeer(unsigned domain, unsigned receive_buffer_bytes = 0);
  ~FastDdsPeer();

  /// As ROS 2 subscribes: reliable, and latched topics with what was said before.
  void subscribe(const std::string& dds_topic, const std::string& dds_type, bool latched);
  /// Publishes on a topic from now on, reliably.
  void advertise(const std::string& dds_topic, const std::string& dds_type);
  /// Says these bytes, of which the first four name their encoding.
  void say(const std::string& dds_topic, std::string bytes);
  /// Waits until all of it has come to the other side.
  [[nodiscard]] bool has_come(const std::string& dds_topic);
  /// Takes nothing of the topic for so long from its next message on, and answers nothing.
  void sleep(const std::string& dds_topic, std::chrono::milliseconds time);

  /// What came on a topic so far.
  [[nodiscard]] std::vector<std::string> messages(const std::string& dds_topic) const;
  /// Publishers that a topic's reader is matched with.
  [[nodiscard]] int publishers(const std::string& dds_topic) const;
  /// USER_DATA of the publisher of a topic, as discovery said it.
  [[nodiscard]] std::string user_data(const std::string& dds_topic) const;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

/// Waits until it is so; false where the time is over before.
template <typename Claim>
bool comes_true(const Claim& claim, std::chrono::milliseconds limit = std::chrono::seconds(3)) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!claim()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace tuina::test
