// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/cli/command_line.hpp"
#include "apps/cli/options.hpp"
#include "apps/cli/position_option.hpp"
#include "apps/evaluation/contact/contact_experiment.hpp"
#include "tuina/record/session_file.hpp"

namespace tuina::app {

/// One technique at one acupoint of the person who is before the arms of a device file.
struct DevicePress {
  record::SessionOrder order;  ///< device file, person, position, robot
  std::string at = "BL47_L";   ///< acupoint, one side of it
  double force_n = 0.0;
  Technique technique = Technique::press;
  double duration_s = 10.0;
};

struct DevicePressed {
  ContactOutcome outcome;  ///< its trace has a row each 5 ms
  TangentTissue tissue;    ///< true, where it pressed hardest
  double ordered_n = 0.0;  ///< of the plan, which regards what is borne there
  std::string lowered_by;  ///< what bears less than was asked for; empty: nothing
  record::DeviceRecord devices;
};

/// A session with that one technique in it: the back is scanned, the point found, the way planned,
/// the guard armed, as for a massage.
[[nodiscard]] Result<DevicePressed> press_on_device(const DevicePress& wanted,
                                                    const session::Config& config,
                                                    const CommonOptions& common);

/// `--device` of `tuina press`, and who is before its arms.
class DeviceOptions {
 public:
  /// Adds `--device` and what belongs to it. `of_the_bench`, the options of a simulated bench,
  /// cannot stand beside it.
  void describe(Options& options, const std::vector<Option>& of_the_bench);
  [[nodiscard]] bool asked() const { return !order_.device.empty(); }
  /// Robot, technique, force and duration are those of the experiment.
  [[nodiscard]] Result<DevicePressed> press(const ContactExperiment& wanted,
                                            const session::Config& config,
                                            const CommonOptions& common);

 private:
  record::SessionOrder order_;
  PositionOption position_;
  std::string at_ = "BL47_L";
};

}  // namespace tuina::app
