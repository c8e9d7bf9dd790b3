// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/robot/living_contact.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tuina/core/units.hpp"

namespace tuina::sim {
namespace {

constexpr double touch_n = 2.0;    // lighter than this nobody minds
constexpr double decides_s = 4.0;  // of contact, after which a person may tense again
constexpr double patch_m = 20_mm;  // width of the tissue that carries a sphere of 17 mm
constexpr double skin_mass_kg = 0.5, skin_damping_ratio = 0.3;

}  // namespace

LivingContact::Landscape::Landscape(Random& random) {
  for (Wave& wave : waves_) {
    Vector3 way;
    for (double& component : way) component = gaussian(random, 1.0);
    wave.way = way.normalized() * (2.0 * pi / uniform(random, 0.1, 0.3));
    wave.phase = uniform(random, 0.0, 2.0 * pi);
  }
}

double LivingContact::Landscape::at(const Vector3& place) const noexcept {
  double height = 0.0;
  for (const Wave& wave : waves_) height += std::sin(wave.way.dot(place) + wave.phase);
  return height * std::sqrt(2.0 / static_cast<double>(waves_.size()));
}

LivingContact::LivingContact(const LivingBack& back, double torso_n_per_m, double friction,
                             Random person, Random events)
    : back_(back), friction_(friction), events_(events) {
  const auto near = [&person](double usual) { return usual * uniform(person, 0.8, 1.2); };
  const bool layers = back.fat_share > 0.0;
  tissue_.form = draw_form(layers ? ElasticForm::Law::layers : ElasticForm::Law::tangent, person);
  back_.fat_share = near(back.fat_share);
  const double fast_s = uniform(person, 0.3, 1.0), slow_s = uniform(person, 5.0, 20.0);
  const double fast_share = uniform(person, 0.3, 0.7), relaxing_share = near(back.relaxing_share);
  tissue_.relaxation = {
      .tau_s = {fast_s, slow_s, 1.0},
      .share = {relaxing_share * fast_share, relaxing_share * (1.0 - fast_share), 0.0}};
  relaxing_ = tissue_.relaxation.share;
  tissue_.damping_s_per_m = near(back.damping_s_per_m);
  const double mass_kg = near(back.torso_mass_kg), damping_ratio = uniform(person, 0.2, 0.4);
  tissue_.torso = Torso::with(mass_kg, near(torso_n_per_m), damping_ratio);
  back_.first_press_stiffer = near(back.first_press_stiffer);
  back_.tensing_share = near(back.tensing_share);
  back_.skin_shear_n_per_m = near(back.skin_shear_n_per_m);
  fat_ = Landscape(person);
  relaxation_ = Landscape(person);
  shear_n_s_per_m_ = 2.0 * skin_damping_ratio * std::sqrt(skin_mass_kg * back_.skin_shear_n_per_m);
}

double LivingContact::tension(double step_s) noexcept {
  time_s_ += step_s;
  if (back_.tensing_probability <= 0.0) return 0.0;
  if (force_n > touch_n) {
    const bool decides = in_contact_s_ == 0.0 || in_contact_s_ > decides_s;
    in_contact_s_ = decides ? step_s : in_contact_s_ + step_s;
    if (decides && uniform(events_, 0.0, 1.0) < back_.tensing_probability) {
      tenses_at_s_ = time_s_ + uniform(events_, 0.1, 2.0);
      tensed_for_s_ = uniform(events_, 0.3, 1.5);
    }
  } else if (force_n <= 0.0) {
    in_contact_s_ = 0.0;
  }
  return back_.tensing_share * tensed(time_s_ - tenses_at_s_, tensed_for_s_);
}

double LivingContact::slip(const Tool& tool, double step_s) noexcept {
  const Vector3& v = tool.velocity_m_per_s;
  const Vector3 across = v - v.dot(tool.normal) * tool.normal;
  const double max_n = friction_ * force_n, shear = back_.skin_shear_n_per_m;
  if (shear <= 0.0) {
    drag_n = -max_n * across / std::max(across.norm(), 5_mm);
    return across.norm();
  }
  // Skin stretches like a spring with some damping and slips where friction ends, as in [dahl1968].
  stretch_ += step_s * across;
  stretch_ -= stretch_.dot(tool.normal) * tool.normal;
  const double pulled_m = stretch_.norm(), held_m = max_n / shear;
  if (pulled_m > held_m) stretch_ *= held_m / pulled_m;
  drag_n = -shear * stretch_ - shear_n_s_per_m_ * across;
  if (drag_n.norm() > max_n) drag_n *= max_n / drag_n.norm();
  return step_s > 0.0 ? std::max(0.0, pulled_m - held_m) / step_s : 0.0;
}

void LivingContact::lay(const Vector3& at, LivingTissue& tissue) const noexcept {
  constexpr double max_fat_share = 0.7, max_relaxing_share = 0.8;
  tissue.form.fat_share =
      std::min(max_fat_share, back_.fat_share * std::exp(back_.place_share * fat_.at(at)));
  double& fast = tissue.relaxation.share[0];
  double& slow = tissue.relaxation.share[1];
  const double more = std::min(std::exp(back_.place_share * relaxation_.at(at)),
                               max_relaxing_share / std::max(relaxing_[0] + relaxing_[1], 1e-9));
  fast = more * relaxing_[0];
  slow = more * relaxing_[1];
}

TangentTissue LivingContact::first_loading(const TangentTissue& place, const Vector3& at,
                                           double to_n) const noexcept {
  LivingTissue tissue = tissue_;
  lay(at, tissue);
  return tissue.first_loading(place, 1.0 + back_.first_press_stiffer, to_n);
}

void LivingContact::press(const Tool& tool, double step_s) noexcept {
  lay(tool.at, tissue_);
  const double stiffer =
      (1.0 + back_.first_press_stiffer * (1.0 - tool.worked)) * (1.0 + tension(step_s));
  const double slipping_m_per_s = slip(tool, step_s);
  force_n = tissue_.press(tool.place, tool.travel_m, -tool.velocity_m_per_s.dot(tool.normal),
                          stiffer, step_s, slipping_m_per_s / patch_m);
  depth_m = std::max(0.0, tissue_.depth_m);
}

void LivingContact::rest(double step_s) noexcept {
  (void)tissue_.press({.alpha_n = 1.0, .beta_per_m = 1.0}, -1.0, 0.0, 1.0, step_s);
  force_n = depth_m = 0.0;
  (void)tension(step_s);
  stretch_ = drag_n = Vector3::Zero();
}

}  // namespace tuina::sim
