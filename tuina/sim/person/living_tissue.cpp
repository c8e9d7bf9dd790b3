// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/person/living_tissue.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::sim {
namespace {

constexpr double meeting_n = 20.0;  // where all forms have the depth of the place's tangent
constexpr double max_bone_share = 0.15;

/// Layers in series: x(F) = sum of a_i ln(1 + F / n_i) + F / k. Solved for F by Newton in
/// u = ln(n_1 + F), in which x is convex, from above, so that every step stays above the answer.
double force_of_layers(const ElasticForm& form, double meeting_m, double depth_m) noexcept {
  const double bone_share = std::min(max_bone_share, meeting_n / form.bone_n_per_m / meeting_m);
  const double fat = meeting_m * form.fat_share / std::log1p(meeting_n / form.fat_n);
  const double muscle =
      meeting_m * (1.0 - form.fat_share - bone_share) / std::log1p(meeting_n / form.muscle_n);
  const double bone_m_per_n = meeting_m * bone_share / meeting_n;
  // No layer alone yields more than all of them.
  const double max_n = std::min({form.fat_n * std::expm1(depth_m / std::max(fat, 1e-9)),
                                 form.muscle_n * std::expm1(depth_m / std::max(muscle, 1e-9)),
                                 depth_m / std::max(bone_m_per_n, 1e-12)});
  double u = std::log(form.fat_n + max_n);
  for (int i = 0; i < 60; ++i) {
    const double soft_n = std::exp(u), force_n = soft_n - form.fat_n;
    const double x = fat * (u - std::log(form.fat_n)) +
                     muscle * std::log1p(force_n / form.muscle_n) + bone_m_per_n * force_n;
    const double slope = fat + soft_n * (muscle / (form.muscle_n + force_n) + bone_m_per_n);
    const double step = (x - depth_m) / slope;
    u -= step;
    if (std::abs(step) < 1e-12) break;
  }
  return std::max(0.0, std::exp(u) - form.fat_n);
}

}  // namespace

ElasticForm draw_form(ElasticForm::Law law, Random& random) {
  ElasticForm form{.law = law};
  // Exponents of Hunt and Crossley's law for tissue: 1.3 to 2.2.
  if (law == ElasticForm::Law::power) form.shape = uniform(random, 1.3, 2.2);
  if (law == ElasticForm::Law::exponential) form.shape = uniform(random, 2.0, 3.5);
  if (law == ElasticForm::Law::layers) {
    // Fat of [isogai2022] is some ten times stiffer at 20 N than at 1 N, muscle three times.
    form.fat_share = uniform(random, 0.3, 0.6);
    form.fat_n = uniform(random, 0.6, 1.5);
    form.muscle_n = uniform(random, 5.0, 10.0);
    form.bone_n_per_m = uniform(random, 30e3, 60e3);
  }
  return form;
}

double elastic_force_n(const ElasticForm& form, const TangentTissue& place,
                       double depth_m) noexcept {
  if (depth_m <= 0.0) return 0.0;
  if (form.law == ElasticForm::Law::tangent) return tissue::force_at_depth(place, depth_m);
  const double meeting_m = tissue::depth_at_force(place, meeting_n);
  switch (form.law) {
    case ElasticForm::Law::power:
      return meeting_n * std::pow(depth_m / meeting_m, form.shape);
    case ElasticForm::Law::exponential:
      return meeting_n * std::expm1(form.shape * depth_m / meeting_m) / std::expm1(form.shape);
    default:
      return force_of_layers(form, meeting_m, depth_m);
  }
}

Relaxation Relaxation::draw(double in_all, const std::array<double, 3>& tau_s, Random& random) {
  Relaxation drawn{.tau_s = tau_s};
  double sum = 0.0;
  for (double& part : drawn.share) sum += part = uniform(random, 0.2, 1.0);
  for (double& part : drawn.share) part *= in_all / sum;
  return drawn;
}

double Relaxation::left(double elastic_n, double step_s, double renewed_per_s) noexcept {
  double left_n = elastic_n;
  for (std::size_t i = 0; i < tau_s.size(); ++i) {
    force_n[i] += step_s / tau_s[i] * (elastic_n - force_n[i]);
    force_n[i] -= std::min(1.0, step_s * renewed_per_s) * force_n[i];
    left_n -= share[i] * force_n[i];
  }
  return left_n;
}

Torso Torso::with(double mass_kg, double n_per_m, double damping_ratio) noexcept {
  constexpr double follows_s = 5e-3;
  return {.mass_kg = mass_kg,
          .n_per_m = n_per_m,
          .n_s_per_m = mass_kg > 0.0 ? 2.0 * damping_ratio * std::sqrt(mass_kg * n_per_m)
                                     : follows_s * n_per_m};
}

void Torso::step(double force_n, double step_s) noexcept {
  if (!std::isfinite(n_per_m)) return;
  if (mass_kg > 0.0) {
    speed_m_per_s += step_s / mass_kg * (force_n - n_per_m * at_m - n_s_per_m * speed_m_per_s);
  } else {
    speed_m_per_s = (force_n - n_per_m * at_m) / n_s_per_m;
  }
  at_m += step_s * speed_m_per_s;
}

double tensed(double since_s, double kept_s) noexcept {
  if (since_s < 0.0) return 0.0;
  if (since_s < 0.3) return since_s / 0.3;
  return std::clamp(1.0 - (since_s - 0.3 - kept_s), 0.0, 1.0);
}

double LivingTissue::press(const TangentTissue& place, double travel_m, double m_per_s,
                           double stiffer, double step_s, double renewed_per_s) noexcept {
  depth_m = travel_m - torso.at_m;
  const double into_m_per_s = m_per_s - torso.speed_m_per_s;
  const double elastic_n = stiffer * elastic_force_n(form, place, depth_m);
  const double left_n = std::max(0.0, relaxation.left(elastic_n, step_s, renewed_per_s));
  const double damping_n_s_per_m = left_n * damping_s_per_m;
  if (std::isfinite(torso.n_per_m) && damping_n_s_per_m * step_s > torso.mass_kg)
    return step_with_torso(left_n, m_per_s, step_s);
  const double force_n = left_n * std::max(0.0, 1.0 + damping_s_per_m * into_m_per_s);
  torso.step(force_n, step_s);
  return force_n;
}

double LivingTissue::step_with_torso(double left_n, double m_per_s, double step_s) noexcept {
  const double inertia = torso.mass_kg / step_s, spring_n = torso.n_per_m * torso.at_m;
  const double push_n = inertia * torso.speed_m_per_s - spring_n;
  const double damped_n = left_n * (1.0 + damping_s_per_m * m_per_s);
  const double resists = inertia + torso.n_s_per_m;
  double speed_m_per_s = (push_n + damped_n) / (resists + left_n * damping_s_per_m);
  const double share = 1.0 + damping_s_per_m * (m_per_s - speed_m_per_s);
  if (share <= 0.0) speed_m_per_s = push_n / resists;  // the tool leaves faster than tissue follows
  torso.speed_m_per_s = speed_m_per_s;
  torso.at_m += step_s * speed_m_per_s;
  return left_n * std::max(0.0, share);
}

TangentTissue LivingTissue::first_loading(const TangentTissue& place, double stiffer,
                                          double force_n) const noexcept {
  constexpr double m_per_s = 10e-3, step_s = 1e-3, max_depth_m = 100e-3;
  LivingTissue rested{.form = form,
                      .relaxation = {.tau_s = relaxation.tau_s, .share = relaxation.share},
                      .damping_s_per_m = damping_s_per_m};
  double half_m = 0.0, at_m = 0.0, before_n = 0.0;
  // The depth at which a force is passed lies between two steps.
  const auto passed_m = [&](double passed_n, double now_n) {
    return at_m - m_per_s * step_s * (now_n - passed_n) / (now_n - before_n);
  };
  while (at_m < max_depth_m) {
    at_m += m_per_s * step_s;
    const double now_n = rested.press(place, at_m, m_per_s, stiffer, step_s);
    if (before_n < 0.5 * force_n && now_n >= 0.5 * force_n) half_m = passed_m(0.5 * force_n, now_n);
    if (now_n >= force_n) return tissue::tangent_through(force_n, passed_m(force_n, now_n), half_m);
    before_n = now_n;
  }
  return place;
}

}  // namespace tuina::sim
