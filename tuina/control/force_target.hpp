// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "tuina/core/contact.hpp"

namespace tuina::control {

/// What is believed of the place under the tool: the tissue's law, and what gives way beneath it.
struct ContactModel {
  TangentTissue tissue = {.alpha_n = 7.0, .beta_per_m = 190.0};  ///< between hard and soft muscle
  double torso_n_per_m = 35'000.0;
};

/// Depth of the skin, tissue and torso together, at a force, and dF/dx there.
[[nodiscard]] double depth_at(const ContactModel& model, double force_n) noexcept;
[[nodiscard]] double stiffness_at(const ContactModel& model, double force_n) noexcept;

/// Force along the inward normal that holds a set force on skin whose place and law are known
/// roughly.
///
/// A spring of fixed stiffness pulls the tool to a virtual target beneath the skin, fed forward
/// from the model: x_v = skin + depth(F) + F / K + trim / K. A slow integral of the force error is
/// the trim, and the part of it that lasts moves the skin. Damping acts on the tool's own speed and
/// rises with the stiffness of the contact. Everything is bounded in newtons: the trim, the leash
/// (spring beyond the set force) and the energy that changes of the target may put in.
class ForceTarget {
 public:
  struct Options {
    double stiffness_n_per_m = 1000.0;
    double trim_per_s = 30.0;
    /// The force gain, as a share of damping / (contact stiffness x sensor lag), where it would
    /// ring.
    double gain_share = 0.2;
    double max_gain = 2.0;
    double sensor_lag_s = 4e-3;
    double max_gain_in_n = 5.0;
    double max_trim_in_n = 10.0;  ///< more would wind up against stiction
    double max_trim_out_n = 30.0;
    double skin_follows_s = 0.7;      ///< a trim that lasts so long is a wrong place of the skin
    double max_skin_error_m = 15e-3;  ///< deeper is never followed
    double max_skin_rise_m = 60e-3;
    double max_over_set_n = 14.0;  ///< leash
    double free_damping_ratio = 1.3;
    double contact_damping_ratio = 0.5;
    double max_damping_n_s_per_m = 600.0;
    double max_outward_damping_n = 12.0;  ///< a person who rises is not held down by damping
    double kept_n = 1.0;                  ///< a set force is never lower than this
    double max_rate_n_per_s = 150.0;
    double landing_s = 0.3;  ///< after the touch the set force changes by `landing_n_per_s` at most
    double landing_n_per_s = 15.0;
    double foreseen_lag_s = 8e-3;  ///< smooths the speed that the model foresees, for its inertia
    double max_inertia_n = 4.0;
    double tank_j = 3.0;
    double startle_n = 8.0;     ///< so far above the set force somebody comes closer,
    double push_out_n = 100.0;  ///< and the arm pushes itself away with so much
    bool finds_skin = true;     ///< the first touch tells where the skin is
  };

  struct Input {
    double depth_m = 0.0;             ///< of the tool beneath the believed skin, negative above
    double speed_m_per_s = 0.0;       ///< of the tool, inward
    double path_speed_m_per_s = 0.0;  ///< of the believed skin, inward
    double force_n = 0.0;             ///< measured, pressing positive
    double set_force_n = 0.0;
    double mass_kg = 3.5;        ///< apparent, along the normal
    double max_spring_n = 90.0;  ///< leash of the zone, besides the one of the options
    ContactModel model;
  };

  ForceTarget() = default;
  explicit ForceTarget(const Options& options) noexcept : options_(options) {}

  /// Contact was just felt; `spring_n` is the spring force at this moment, which goes on without a
  /// step.
  void begin(const Input& input, double spring_n) noexcept;
  /// Inward force on the tool for this tick.
  [[nodiscard]] double step(const Input& input, double dt_s) noexcept;

  [[nodiscard]] bool lost() const noexcept { return lost_; }  ///< contact went away
  /// The person came closer than the set force allows, and was let go.
  [[nodiscard]] bool pushed_away() const noexcept { return lost_ && startled_; }
  [[nodiscard]] double spring_n() const noexcept { return spring_n_; }
  [[nodiscard]] double set_n() const noexcept { return set_n_; }
  [[nodiscard]] double skin_error_m() const noexcept { return skin_m_; }
  [[nodiscard]] double tank_j() const noexcept { return tank_j_; }

 private:
  void watch_contact(const Input& input, double dt_s) noexcept;
  [[nodiscard]] double force_soon_n(const Input& input, double dt_s) noexcept;
  [[nodiscard]] double push_out(const Input& input, double soon_n) noexcept;
  [[nodiscard]] bool slips(const Input& input) const noexcept;
  [[nodiscard]] double spring_without_skin(const Input& input, double dt_s) noexcept;
  [[nodiscard]] double spring_on_skin(const Input& input, double contact_n_per_m, double damping,
                                      double dt_s) noexcept;
  [[nodiscard]] double paid_for(double spring_n, const Input& input) noexcept;

  Options options_;
  double skin_m_ = 0.0;  // where the skin is, beneath where it was believed
  double set_n_ = 0.0;
  double trim_n_ = 0.0;
  double foreseen_m_per_s_ = 0.0;
  double spring_n_ = 0.0;
  std::array<double, 3> last_forces_n_ = {};  // newest first
  double since_touch_s_ = 0.0;
  double last_depth_m_ = 0.0;
  double tank_j_ = 0.0;
  double without_contact_s_ = 0.0;
  bool lost_ = false;
  bool startled_ = false, pushing_out_ = false;
  double hold_m_ = 0.0, crept_m_ = 0.0;
};

}  // namespace tuina::control
