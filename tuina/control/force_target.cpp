// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/force_target.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::control {
namespace {

constexpr double touching_n = 0.7;
constexpr double lost_after_s = 0.006;
constexpr double lost_matters_n = 3.0;
constexpr double slipping_share = 0.3;
constexpr double found_again_n = 1.5;
// Force above the set force that means a person who comes closer, where the place bears little: so
// much of what it bears beyond the set force, but at least `min_startle_n`.
constexpr double borne_share = 0.8, min_startle_n = 6.0;
constexpr double creep_m_per_s = 10e-3;
constexpr double max_creep_m = 3e-3;
// Rate of the set force up to which a speed of the tool that lasts counts as the skin's; beyond it
// the tool moves by itself.
constexpr double carried_below_n_per_s = 8.0;
// Lag of the force beyond which it counts as late, as of arms that take places (late_force.hpp).
constexpr double prompt_lag_s = 4e-3;
// Rules for a late force: `max_blind_m`, how far the tool may sink, by the believed tissue, before
// that is felt, which bounds the rate of the set force; `late_belief` is the share of the predicted
// speed that is fed forward; `late_share` is damping over (contact stiffness x lag beyond prompt).
constexpr double max_blind_m = 0.6e-3, late_belief = 0.6, late_share = 2.5;

bool is_late(const ForceTarget::Options& options) noexcept {
  return options.sensor_lag_s > prompt_lag_s;
}

/// Fastest change of the set force, N/s.
double max_rate_n_per_s(const ForceTarget::Options& options, const ContactModel& model,
                        double set_n, double since_touch_s) noexcept {
  const double landed =
      since_touch_s < options.landing_s ? options.landing_n_per_s : options.max_rate_n_per_s;
  if (!is_late(options)) return landed;
  return std::min(landed, max_blind_m / options.sensor_lag_s * stiffness_at(model, set_n));
}

// A force that is late by T and moves a tool of mass m is followed without ringing by D where
// K_c (T + m / D) / D stays below a share of one.
double damping_of(const ForceTarget::Options& options, double mass_kg, double contact_n_per_m,
                  bool lost) noexcept {
  const double free =
      2.0 * options.free_damping_ratio * std::sqrt(mass_kg * options.stiffness_n_per_m);
  if (lost) return 2.0 * free;
  const double prompt = 2.0 * options.contact_damping_ratio * std::sqrt(mass_kg * contact_n_per_m);
  const double late_s = std::max(options.sensor_lag_s - prompt_lag_s, 0.0);
  const double late = 0.5 * late_share * contact_n_per_m * late_s;
  return std::clamp(late + std::hypot(late, prompt), free, options.max_damping_n_s_per_m);
}

}  // namespace

double depth_at(const ContactModel& model, double force_n) noexcept {
  const double force = std::max(force_n, 0.0);
  return std::atan(force / model.tissue.alpha_n) / model.tissue.beta_per_m +
         force / model.torso_n_per_m;
}

double stiffness_at(const ContactModel& model, double force_n) noexcept {
  const double share = std::max(force_n, 0.0) / model.tissue.alpha_n;
  const double tissue = model.tissue.alpha_n * model.tissue.beta_per_m * (1.0 + share * share);
  return 1.0 / (1.0 / tissue + 1.0 / model.torso_n_per_m);
}

void ForceTarget::begin(const Input& input, double spring_n) noexcept {
  skin_m_ = 0.0;
  if (options_.finds_skin) skin_m_ = input.depth_m - depth_at(input.model, input.force_n);
  set_n_ = std::max(input.force_n, options_.kept_n);
  const double K = options_.stiffness_n_per_m;
  const double expected_m = skin_m_ + depth_at(input.model, set_n_);
  trim_n_ = 0.0;
  if (options_.finds_skin) trim_n_ = spring_n - set_n_ - K * (expected_m - input.depth_m);
  trim_n_ = std::clamp(trim_n_, -options_.max_trim_out_n, options_.max_trim_in_n);
  spring_n_ = spring_n;
  foreseen_m_per_s_ = carried_m_per_s_ = deepening_m_per_s_ = 0.0;
  last_depth_m_ = input.depth_m;
  tank_j_ = options_.tank_j;
  without_contact_s_ = 0.0;
  lost_ = false;
  escape_.begin(input.force_n);
  since_touch_s_ = since_felt_s_ = 0.0;
}

void ForceTarget::watch_contact(const Input& input, double dt_s) noexcept {
  const bool gone = input.force_n < touching_n && set_n_ > lost_matters_n;
  without_contact_s_ = gone ? without_contact_s_ + dt_s : 0.0;
  if (!lost_ && without_contact_s_ > lost_after_s) {
    lost_ = true;
    hold_m_ = input.depth_m;
    crept_m_ = 0.0;
  } else if (lost_ && !escape_.startled() && input.force_n > found_again_n) {
    begin(input, spring_n_);
  }
}

// A falling force means that the skin recedes; the force law must not follow it.
bool ForceTarget::slips(const Input& input) const noexcept {
  return set_n_ > lost_matters_n && input.force_n < slipping_share * set_n_;
}

// Without contact the tool creeps forward a little instead of chasing the skin.
double ForceTarget::spring_without_skin(const Input& input, double dt_s) noexcept {
  const double creep_m = crept_m_ < max_creep_m ? creep_m_per_s * dt_s : 0.0;
  crept_m_ += creep_m;
  hold_m_ += creep_m;
  return options_.stiffness_n_per_m * (hold_m_ - input.depth_m);
}

double ForceTarget::spring_on_skin(const Input& input, double contact_n_per_m, double damping,
                                   double dt_s) noexcept {
  const double K = options_.stiffness_n_per_m;
  const double error_n = slips(input) ? 0.0 : set_n_ - input.force_n;
  trim_n_ += options_.trim_per_s * (1.0 + K / contact_n_per_m) * error_n * dt_s;
  trim_n_ = std::clamp(trim_n_, -options_.max_trim_out_n, options_.max_trim_in_n);
  const double lasting_n = trim_n_ * std::min(dt_s / options_.skin_follows_s, 1.0);
  const double skin_m =
      std::clamp(skin_m_ + lasting_n / K, -options_.max_skin_rise_m, options_.max_skin_error_m);
  trim_n_ -= K * (skin_m - skin_m_);
  skin_m_ = std::clamp(skin_m + input.slope_speed_m_per_s * dt_s, -options_.max_skin_rise_m,
                       options_.max_skin_error_m);

  const double rings_at = damping / (contact_n_per_m * options_.sensor_lag_s);
  const double gain = std::min(options_.gain_share * rings_at, options_.max_gain);
  const double quick_n =
      std::clamp(gain * error_n, -options_.max_trim_out_n, options_.max_quick_in_n);
  const double expected_m = skin_m_ + depth_at(input.model, set_n_);
  return K * (expected_m - input.depth_m) + set_n_ + trim_n_ + quick_n;
}

// Energy tank: each inward step of the virtual target against the spring is paid for, and an empty
// tank stops the target. Damping and outward steps fill it.
double ForceTarget::paid_for(double spring_n, const Input& input) noexcept {
  const double K = options_.stiffness_n_per_m;
  const double sunk_m = input.depth_m - last_depth_m_;
  last_depth_m_ = input.depth_m;
  const double cost_j = spring_n * ((spring_n - spring_n_) / K + sunk_m);
  if (cost_j > tank_j_) return std::min(spring_n, spring_n_ - K * sunk_m);
  tank_j_ -= cost_j;
  return spring_n;
}

double ForceTarget::push_out(const Input& input) noexcept {
  if (escape_.over()) {
    lost_ = true;
    hold_m_ = input.depth_m;
    crept_m_ = max_creep_m;
  }
  last_depth_m_ = input.depth_m;
  spring_n_ = -escape_.push_n(-input.speed_m_per_s);
  return spring_n_;
}

// A tool that lands, or that left light contact and comes back, presses harder by its own speed;
// nobody comes closer then.
double ForceTarget::landing_rate_n_per_s(const Input& input) const noexcept {
  if (since_felt_s_ >= options_.landing_s) return 0.0;
  return std::max(input.speed_m_per_s, 0.0) * stiffness_at(input.model, input.force_n);
}

// Where the place bears little more than what is asked for, less is a surprise: the guard would
// stop the arm for a force that the place does not bear.
double ForceTarget::expected_n(const Input& input) const noexcept {
  const double margin_n = std::max(borne_share * (input.max_spring_n - set_n_), min_startle_n);
  const double sooner_n = options_.escape.startle_n - margin_n;
  return std::isfinite(sooner_n) ? set_n_ - std::max(sooner_n, 0.0) : set_n_;
}

double ForceTarget::step(const Input& input, double dt_s) noexcept {
  since_felt_s_ = input.force_n < touching_n ? 0.0 : since_felt_s_ + dt_s;
  if (escape_.step(input.force_n, {expected_n(input), landing_rate_n_per_s(input)}, dt_s))
    return push_out(input);

  const double wanted_n = std::max(input.set_force_n, options_.kept_n);
  // Light contact is soft: a fast change of a small force would throw the tool off the skin.
  since_touch_s_ += dt_s;
  const double fastest = max_rate_n_per_s(options_, input.model, set_n_, since_touch_s_);
  const double change_n = std::clamp(wanted_n - set_n_, -fastest * dt_s, fastest * dt_s);
  set_n_ += change_n;
  watch_contact(input, dt_s);

  // Damping and inertia are led by the model's prediction only. With the trim in it this would be a
  // force gain that ignores the tissue, which limit-cycles on bone.
  const double believed_share = is_late(options_) ? late_belief : 1.0;
  deepening_m_per_s_ =
      lost_ ? 0.0 : believed_share * change_n / dt_s / stiffness_at(input.model, set_n_);
  const double foreseen = input.path_speed_m_per_s + input.slope_speed_m_per_s + deepening_m_per_s_;
  const double acceleration = (foreseen - foreseen_m_per_s_) / options_.foreseen_lag_s;
  foreseen_m_per_s_ += acceleration * dt_s;
  const double inertia_n =
      std::clamp(input.mass_kg * acceleration, -options_.max_inertia_n, options_.max_inertia_n);

  const double contact_n_per_m = stiffness_at(input.model, std::max(input.force_n, 1.0));
  const double damping = damping_of(options_, input.mass_kg, contact_n_per_m, lost_);

  const double spring_n = lost_ ? spring_without_skin(input, dt_s)
                                : spring_on_skin(input, contact_n_per_m, damping, dt_s);
  // Spring force that the receding skin no longer bears must not accelerate the tool.
  const double borne_n = slips(input) ? std::max(input.force_n, 0.0) : set_n_;
  spring_n_ = paid_for(std::clamp(spring_n, -options_.max_trim_out_n,
                                  std::min(borne_n + options_.max_over_set_n, input.max_spring_n)),
                       input);
  // Skin that rises and falls, or leans, takes the tool along: what lasts of its speed is no motion
  // to damp, and damping it would only be one more error for the trim. A tool that lands, or that
  // presses harder, has speed of its own.
  const double relative = input.speed_m_per_s - foreseen;
  const bool of_its_own =
      since_touch_s_ < options_.landing_s || std::abs(change_n) > carried_below_n_per_s * dt_s;
  const double goal_m_per_s = of_its_own ? 0.0
                                         : std::clamp(relative, -options_.max_carried_m_per_s,
                                                      options_.max_carried_m_per_s);
  carried_m_per_s_ +=
      std::min(dt_s / options_.carried_after_s, 1.0) * (goal_m_per_s - carried_m_per_s_);
  if (lost_ || slips(input)) carried_m_per_s_ = 0.0;
  const double damping_n = damping * (relative - carried_m_per_s_);
  tank_j_ = std::clamp(tank_j_ + damping_n * relative * dt_s, 0.0, options_.tank_j);
  const double inward_n =
      spring_n_ + std::min(inertia_n - damping_n, options_.max_outward_damping_n);
  const double beyond_n = std::max(input.force_n - set_n_, 0.0);
  const double max_n = set_n_ + options_.max_inward_n - options_.yields_per_n * beyond_n;
  return std::min(inward_n, std::max(max_n, 0.0));
}

}  // namespace tuina::control
