// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/control/escape.hpp"
#include "tuina/core/contact.hpp"

namespace tuina::control {

/// Belief about the place under the tool: tissue law and stiffness of the torso beneath it.
struct ContactModel {
  TangentTissue tissue = {.alpha_n = 7.0, .beta_per_m = 190.0};  ///< between hard and soft muscle
  double torso_n_per_m = 35'000.0;
};

/// Indentation of tissue and torso together at a force, m; a negative force counts as none.
[[nodiscard]] double depth_at(const ContactModel& model, double force_n) noexcept;
/// Stiffness dF/dx of tissue and torso together at a force.
[[nodiscard]] double stiffness_at(const ContactModel& model, double force_n) noexcept;

/// Force controller along the inward normal, for skin whose position and tissue law are roughly
/// known.
///
/// A spring of fixed stiffness pulls the tool to a virtual target beneath the skin, fed forward
/// from the model: x_v = skin + depth(F) + F / K + trim / K. The trim is a slow integral of the
/// force error; its lasting part corrects the position of the skin. Damping acts on the tool speed
/// less what lasts of it, and grows with the contact stiffness. Trim, spring force beyond the set
/// force and the energy from target changes are bounded.
class ForceTarget {
 public:
  /// Gains and bounds of the force law; the defaults are those of docs/control.md.
  struct Options {
    double stiffness_n_per_m = 1000.0;
    double trim_per_s = 45.0;
    /// Force gain as a share of damping / (contact stiffness x sensor lag), where the loop would
    /// ring.
    double gain_share = 0.2;
    double max_gain = 2.0;
    double sensor_lag_s = 4e-3;
    double max_quick_in_n = 5.0;  ///< limit of the force that this gain adds, inward
    double max_trim_in_n = 10.0;  ///< more would wind up against stiction
    double max_trim_out_n = 30.0;
    /// Time constant with which a lasting trim corrects the skin position.
    double skin_follows_s = 0.7;
    double max_skin_error_m = 15e-3;  ///< deepest correction of the skin position
    double max_skin_rise_m = 60e-3;
    double max_over_set_n = 14.0;  ///< limit of the spring force beyond the set force
    double free_damping_ratio = 1.3;
    double contact_damping_ratio = 0.5;
    double max_damping_n_s_per_m = 600.0;
    double max_outward_damping_n = 12.0;  ///< damping must not hold down a person who rises
    /// Limit of all that presses inward, beyond the set force, and what it falls by for each newton
    /// that is felt beyond that: the guard takes an arm for broken that presses on against somebody
    /// who pushes it out (safety/limits.hpp, `pressing_n`), and who coughs is pressed less so.
    double max_inward_n = 20.0, yields_per_n = 2.0;
    /// Time after which the speed of a tool counts as that of the skin beneath it, which is not
    /// damped.
    double carried_after_s = 0.1;
    double max_carried_m_per_s = 0.02;  ///< skin of a person who breathes, under a tool that slides
    double kept_n = 1.0;                ///< minimum set force
    double max_rate_n_per_s = 300.0;
    double landing_s = 0.3;  ///< time after touch with the slower `landing_n_per_s`
    double landing_n_per_s = 15.0;
    double foreseen_lag_s = 8e-3;  ///< smooths the predicted speed for the inertia feed-forward
    double max_inertia_n = 4.0;
    double tank_j = 3.0;
    Escape::Options escape;
    bool finds_skin = true;  ///< the first touch sets the skin position
  };

  /// What one step of the law is told.
  struct Input {
    double depth_m = 0.0;        ///< depth of the tip beneath the believed skin, negative above
    double speed_m_per_s = 0.0;  ///< tool speed, inward
    double path_speed_m_per_s = 0.0;  ///< speed of the believed skin, inward
    /// Speed at which the skin was found to fall away from the believed one along the way, inward.
    double slope_speed_m_per_s = 0.0;
    double force_n = 0.0;  ///< measured, pressing positive
    double set_force_n = 0.0;
    double mass_kg = 3.5;        ///< apparent mass along the normal
    double max_spring_n = 90.0;  ///< spring limit of the body zone, besides max_over_set_n
    ContactModel model;
  };

  ForceTarget() = default;
  /// Out of contact.
  explicit ForceTarget(const Options& options) noexcept
      : options_(options), escape_(options.escape) {}

  /// Starts at the first touch; `spring_n` is the present spring force, continued without a step.
  void begin(const Input& input, double spring_n) noexcept;
  /// Inward force on the tool for this tick.
  [[nodiscard]] double step(const Input& input, double dt_s) noexcept;

  [[nodiscard]] bool lost() const noexcept { return lost_; }  ///< contact ended
  /// True when contact ended by an escape from a person who came closer.
  [[nodiscard]] bool pushed_away() const noexcept { return lost_ && escape_.startled(); }
  [[nodiscard]] double spring_n() const noexcept { return spring_n_; }
  [[nodiscard]] double set_n() const noexcept { return set_n_; }
  [[nodiscard]] double skin_error_m() const noexcept { return skin_m_; }
  /// Speed at which a set force that changes presses the tool in, by the model.
  [[nodiscard]] double deepening_m_per_s() const noexcept { return deepening_m_per_s_; }
  [[nodiscard]] double tank_j() const noexcept { return tank_j_; }

 private:
  void watch_contact(const Input& input, double dt_s) noexcept;
  [[nodiscard]] double landing_rate_n_per_s(const Input& input) const noexcept;
  [[nodiscard]] double expected_n(const Input& input) const noexcept;
  [[nodiscard]] double push_out(const Input& input) noexcept;
  [[nodiscard]] bool slips(const Input& input) const noexcept;
  [[nodiscard]] double spring_without_skin(const Input& input, double dt_s) noexcept;
  [[nodiscard]] double spring_on_skin(const Input& input, double contact_n_per_m, double damping,
                                      double dt_s) noexcept;
  [[nodiscard]] double paid_for(double spring_n, const Input& input) noexcept;

  Options options_;
  double skin_m_ = 0.0;  // found minus believed skin position, inward positive
  double set_n_ = 0.0;
  double trim_n_ = 0.0;
  double foreseen_m_per_s_ = 0.0, carried_m_per_s_ = 0.0;
  double deepening_m_per_s_ = 0.0;
  double spring_n_ = 0.0;
  Escape escape_;
  double since_touch_s_ = 0.0, since_felt_s_ = 0.0;
  double last_depth_m_ = 0.0;
  double tank_j_ = 0.0;
  double without_contact_s_ = 0.0;
  bool lost_ = false;
  double hold_m_ = 0.0, crept_m_ = 0.0;
};

}  // namespace tuina::control
