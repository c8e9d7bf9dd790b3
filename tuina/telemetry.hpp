// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room telemetry: what people look at: MCAP with messages of ROS 2, plots, reports.

#include "tuina/telemetry/mcap/cdr.hpp"
#include "tuina/telemetry/mcap/reader.hpp"
#include "tuina/telemetry/mcap/ros_messages.hpp"
#include "tuina/telemetry/mcap/ros_schema.hpp"
#include "tuina/telemetry/mcap/writer.hpp"
#include "tuina/telemetry/plot/heat_map.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/telemetry/table.hpp"
