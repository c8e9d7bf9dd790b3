// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/skin_slope.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::control {
namespace {

constexpr double slides_m_per_s = 10e-3;  // slower tools tell nothing of the slope
constexpr double slope_sd = 0.1, bend_sd_per_m = 2.5;
constexpr double breath_sd_m_per_s = 2e-3, breath_lasts_s = 1.0;
// Slope and bend of one place are not those of the next: variance per metre of way.
constexpr double slope_changes_per_m = 5e-3, bend_changes_per_m = 5.0;
// Tissue that is harder or thinner in places moves the tool by 10 mm/s for 50 ms.
constexpr double grain_m_per_s = 10e-3, grain_lasts_s = 0.05;
// Tissue that is believed wrong yields otherwise than foretold, while a force changes.
constexpr double deepening_lasts_s = 5.0;
constexpr double max_slope = 0.3;

}  // namespace

void SkinSlope::begin(const Vector3& normal_in_base) noexcept {
  normal_ = normal_in_base;
  along_ = normal_.unitOrthogonal();
  across_ = normal_.cross(along_);
  state_.setZero();
  State sd;
  sd << breath_sd_m_per_s, slope_sd, slope_sd, bend_sd_per_m, bend_sd_per_m, bend_sd_per_m;
  covariance_ = sd.cwiseAbs2().asDiagonal();
}

// The Taylor expansion about a place becomes that about the next.
void SkinSlope::travel(const Eigen::Vector2d& way_m, double dt_s) noexcept {
  const double length_m = way_m.norm(), kept = 1.0 - dt_s / breath_lasts_s;
  Covariance step = Covariance::Identity();
  step(0, 0) = kept;
  step(1, 3) = step(2, 4) = way_m.x();
  step(1, 4) = step(2, 5) = way_m.y();
  state_ = step * state_;
  covariance_ = step * covariance_ * step.transpose();
  const double bend = bend_changes_per_m * length_m, slope = slope_changes_per_m * length_m;
  State grown;
  grown << (1.0 - kept * kept) * breath_sd_m_per_s * breath_sd_m_per_s, slope, slope, bend, bend,
      bend;
  covariance_ += grown.asDiagonal();
}

void SkinSlope::learn(const Vector3& velocity_m_per_s, const Vector3& normal_in_base,
                      double deepening_m_per_s, double dt_s) noexcept {
  normal_ = normal_in_base;
  along_ = (along_ - along_.dot(normal_) * normal_).normalized();
  across_ = normal_.cross(along_);
  const Eigen::Vector2d way(velocity_m_per_s.dot(along_), velocity_m_per_s.dot(across_));
  travel(dt_s * way, dt_s);
  const double speed = way.norm();
  if (speed < slides_m_per_s) return;

  State seen;
  seen << 1.0, way, 0.0, 0.0, 0.0;
  const double outward = velocity_m_per_s.dot(normal_) + deepening_m_per_s;
  // A person who moves is no slope.
  const double news = std::clamp(outward - seen.dot(state_), -max_slope * speed, max_slope * speed);
  const State covered = covariance_ * seen;
  const double noise = 2.0 / dt_s *
                       (grain_m_per_s * grain_m_per_s * grain_lasts_s +
                        deepening_m_per_s * deepening_m_per_s * deepening_lasts_s);
  const State gain = covered / (seen.dot(covered) + noise);
  state_ += news * gain;
  covariance_ -= gain * covered.transpose();
  covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
}

Vector3 SkinSlope::rise_in_base() const noexcept {
  const Vector3 rise = state_[1] * along_ + state_[2] * across_;
  return rise * std::min(1.0, max_slope / std::max(rise.norm(), 1e-9));
}

Vector3 SkinSlope::normal_in_base() const noexcept {
  return (normal_ - rise_in_base()).normalized();
}

}  // namespace tuina::control
