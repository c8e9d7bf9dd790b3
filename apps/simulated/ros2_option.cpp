// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/ros2_option.hpp"

#include <cstdlib>

#include "tuina/ros2/names.hpp"

namespace tuina::app {

void Ros2Option::describe(Options& options, const std::string& what_is_told) {
  auto asked = options.flag("--ros2", asked_,
                            fmt::format("publish {} to ROS 2 on this machine, in the domain of "
                                        "ROS_DOMAIN_ID (docs/ros2.md)",
                                        what_is_told));
  options.flag("--lan", lan_, "to ROS 2 on the whole network").needs(asked);
}

Result<void> Ros2Option::begin(const std::filesystem::path& folder) {
  if (!asked_) return {};
  const auto domain = ros2::parse_domain(std::getenv("ROS_DOMAIN_ID"));
  if (!domain) return tl::unexpected(domain.error());
  auto node = ros2::open_node(*domain, reach());
  if (!node) return tl::unexpected(node.error());
  node_ = std::move(*node);
  if (folder.empty()) return {};
  auto desk = Ros2Desk::open(*node_, reach(), folder / "audit.log");
  if (!desk) return tl::unexpected(desk.error());
  desk_ = std::move(*desk);
  return {};
}

Attendant Ros2Option::attendant() {
  Attendant attendant = desk_ ? desk_->attendant() : Attendant{};
  attendant.channels = node_.get();
  return attendant;
}

std::string Ros2Option::text(std::uint64_t untold_ms) const {
  const ros2::Traffic traffic = node_->traffic();
  std::string text = fmt::format("ROS 2: {} messages on {} topics, {} readers at the end",
                                 traffic.messages, traffic.topics, traffic.readers);
  if (traffic.dropped > 0)
    text += fmt::format(", {} dropped for slow readers: {}", traffic.dropped, traffic.first_fault);
  if (untold_ms > 0) text += fmt::format(", {} ms left out", untold_ms);
  return text;
}

}  // namespace tuina::app
