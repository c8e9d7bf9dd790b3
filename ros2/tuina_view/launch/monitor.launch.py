# SPDX-License-Identifier: Apache-2.0
"""rqt_robot_monitor on /diagnostics of the session that `tuina massage --ros2` publishes, grouped."""
import os

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    here = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    # Of these the clock is this machine's: a session that is over shall become stale.
    return LaunchDescription([
        Node(package="diagnostic_aggregator", executable="aggregator_node", name="analyzers",
             parameters=[os.path.join(here, "config", "analyzers.yaml")]),
        Node(package="rqt_robot_monitor", executable="rqt_robot_monitor"),
    ])
