// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/simulated/simulated_session.hpp"

namespace tuina::app {

/// `session::run` with the scanner and the arms of a device file. Nothing is simulated, so what is
/// known is what the sensors say. Where no attendant reviews the plan, the terminal is asked for a
/// word before the first arm moves. Fails with Fault::usage where something is not given that a
/// simulated person would have answered, and with Fault::device where a device is missing.
[[nodiscard]] Result<SessionResult> run_device_session(const SessionOrder& order,
                                                       const session::Config& config,
                                                       const CommonOptions& common,
                                                       const std::filesystem::path& record_file,
                                                       const Attendant& attendant);

}  // namespace tuina::app
