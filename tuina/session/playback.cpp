// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/playback.hpp"

#include <algorithm>

#include "tuina/massage/technique/contact_path.hpp"

namespace tuina::session {

void Playback::begin(double path_s) noexcept {
  path_s_ = path_s;
  fading_ = Eased(1.0);
}

void Playback::pause(bool paused) noexcept {
  rate_.send_to(paused ? 0.0 : 1.0);
}

void Playback::step(double dt_s) noexcept {
  rate_.step(dt_s);
  intensity_.step(dt_s);
  fading_.step(dt_s);
  path_s_ += std::max(rate_.value(), 0.0) * dt_s;
}

// A pause takes the force back to the light touch, not to nothing: the tool stays on the skin.
double Playback::force_n(double planned_n) const noexcept {
  const double scaled_n = planned_n * intensity_.value();
  const double kept_n = std::min(massage::kept_force_n, scaled_n);
  const double share = std::clamp(rate_.value(), 0.0, 1.0);
  return std::clamp(fading_.value(), 0.0, 1.0) * (kept_n + share * (scaled_n - kept_n));
}

}  // namespace tuina::session
