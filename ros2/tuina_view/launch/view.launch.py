# SPDX-License-Identifier: Apache-2.0
"""RViz on the session that `tuina massage --ros2` publishes, in the time of that session."""
import os

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    here = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    return LaunchDescription([
        Node(package="rviz2", executable="rviz2", arguments=["-d", os.path.join(here, "rviz", "session.rviz")],
             parameters=[{"use_sim_time": True}])
    ])
