// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tuina/massage/plan.hpp"
#include "tuina/session/massage_step.hpp"

namespace tuina::app {

/// Mean of a force while all of it is asked for.
class HeldForce {
 public:
  void add(double asked_n, double force_n) noexcept;
  [[nodiscard]] double mean_n() const noexcept { return samples_ > 0 ? sum_n_ / samples_ : 0.0; }
  [[nodiscard]] double asked_n() const noexcept { return asked_n_; }  ///< the largest

 private:
  double asked_n_ = 0.0, since_n_ = 0.0, sum_n_ = 0.0, samples_ = 0.0;
};

/// One press or tap as it was given, by the true force.
struct GivenPress {
  std::string place;  ///< acupoint
  Technique technique = Technique::press;
  int index = 0;  ///< of this technique at this place in the session, from 1, probes included
  bool probing = false;    ///< it only felt a new place
  bool foretold = false;   ///< what was felt before foretold one as strong as planned
  double planned_n = 0.0;  ///< strongest force of its path in the plan
  double asked_n = 0.0;    ///< largest force that was asked for
  double peak_n = 0.0;     ///< largest true force
  double held_n = 0.0;     ///< mean true force while all of it was asked for
  Arm arm = Arm::left;
  double contact_s = 0.0, end_s = 0.0;  ///< from when the tool was on the skin, until it was over

  /// Largest true force as a share of the plan.
  [[nodiscard]] double given() const { return peak_n / planned_n; }
};

/// Tells presses apart by the force that is asked for: one begins as that rises above the light
/// touch, and is over as it is back there.
class GivenPresses {
 public:
  /// One millisecond of one arm; `plan` is the plan that it carries out.
  void add(double time_s, Arm arm, const session::ArmView& seen, double true_force_n,
           const massage::Plan& plan);
  [[nodiscard]] std::vector<GivenPress> take() { return std::move(done_); }

 private:
  struct Side {
    bool in_contact = false, open = false;
    GivenPress press = {};
    HeldForce held = {};
    double contact_s = 0.0;
  };
  void close(Side& side, double time_s);

  PerArm<Side> sides_ = {};
  std::map<std::pair<std::string, Technique>, int> count_;
  std::vector<GivenPress> done_;
};

}  // namespace tuina::app
