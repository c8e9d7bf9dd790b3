// SPDX-License-Identifier: Apache-2.0
#include "tuina/ros2/node.hpp"

namespace tuina::ros2 {

Result<std::unique_ptr<Node>> open_node(std::uint32_t, Reach) {
  return fail(Fault::usage,
              "--ros2: this build has no ROS 2; install cyclonedds-dev and build once more");
}

}  // namespace tuina::ros2
