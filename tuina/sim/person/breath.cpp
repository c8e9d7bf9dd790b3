// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/person/breath.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::sim {
namespace {

constexpr double course_s = 7200.0;
// A person at rest breathes in for two fifths of a breath and waits at its end for a tenth.
constexpr double in_share = 0.4, out_share = 0.5;
// Who speaks breathes in quickly and lets the air out with their words, five syllables a second.
constexpr double spoken_in_share = 0.15, spoken_out_share = 0.8, spoken_longer = 1.4;
constexpr double spoken_breaths = 3.0, syllables_hz = 5.0, syllable_m = 0.1_mm;
constexpr int bursts = 3;  // of a cough
constexpr double burst_s = 0.25;

template <typename Event>
const Event* last_before(const std::vector<Event>& events, double time_s) noexcept {
  const auto next =
      std::upper_bound(events.begin(), events.end(), time_s,
                       [](double at_s, const Event& event) { return at_s < event.start_s; });
  return next == events.begin() ? nullptr : &*(next - 1);
}

}  // namespace

Breath draw_breath(const Breathing& usual, Random& random) {
  double depth_m =
      usual.amplitude_m * std::max(0.2, 1.0 + gaussian(random, 0.33 * usual.variation));
  if (uniform(random, 0.0, 1.0) < usual.sigh_share) depth_m *= 2.0;
  const double rate_hz =
      usual.frequency_hz * std::max(0.5, 1.0 + gaussian(random, 0.21 * usual.variation));
  return {.depth_m = depth_m, .rate_hz = rate_hz};
}

BreathShare breath_share(double phase, double in_part, double out_part) noexcept {
  const bool in = phase < in_part;
  const double part = in ? in_part : out_part;
  const double done = in ? phase / in_part : 1.0 + (phase - in_part) / out_part;
  if (done >= 2.0) return {0.0, 0.0};
  return {0.5 * (1.0 - std::cos(pi * done)), 0.5 * pi / part * std::sin(pi * done)};
}

BreathCourse::BreathCourse(const Breathing& breathing, std::uint64_t seed) : breathing_(breathing) {
  const bool alike = breathing.variation == 0.0 && breathing.sigh_share == 0.0 &&
                     breathing.speaking_share == 0.0 && breathing.coughs_per_h == 0.0;
  if (!alike) draw(seed);
}

void BreathCourse::draw(std::uint64_t seed) {
  Random random = make_random(seed, "breath");
  int spoken = 0;
  const double silent_share = std::max(0.05, 1.0 - breathing_.speaking_share);
  const double begins_share = breathing_.speaking_share / silent_share / spoken_breaths;
  for (double time_s = 0.0; time_s < course_s;) {
    const Breath breath = draw_breath(breathing_, random);
    const bool begins = uniform(random, 0.0, 1.0) < begins_share;
    spoken = spoken > 0 ? spoken - 1 : begins ? static_cast<int>(spoken_breaths) : 0;
    const double duration_s = (spoken > 0 ? spoken_longer : 1.0) / breath.rate_hz;
    breaths_.push_back({time_s, duration_s, breath.depth_m, spoken > 0});
    time_s += duration_s;
  }
  if (breathing_.coughs_per_h <= 0.0) return;
  const double mean_s = 3600.0 / breathing_.coughs_per_h;
  for (double time_s = 0.0;;) {
    time_s -= mean_s * std::log(1.0 - uniform(random, 0.0, 1.0));
    if (time_s > course_s) break;
    coughs_.push_back({time_s, uniform(random, 3_mm, 8_mm)});
    time_s += bursts * burst_s;
  }
}

BreathCourse::Way BreathCourse::breathed(double time_s) const noexcept {
  const Drawn* now = last_before(breaths_, time_s);
  if (now == nullptr) return {};
  const double phase = (time_s - now->start_s) / now->duration_s;
  if (!now->spoken) {
    const BreathShare share = breath_share(phase, in_share, out_share);
    return {now->depth_m * share.at, now->depth_m * share.per_phase / now->duration_s};
  }
  const BreathShare share = breath_share(phase, spoken_in_share, spoken_out_share);
  const double turn = 2.0 * pi * syllables_hz * (time_s - now->start_s);
  const Way breath = {now->depth_m * share.at, now->depth_m * share.per_phase / now->duration_s};
  if (phase < spoken_in_share) return breath;
  // The words tremble as long as air goes out; they fade in and out.
  const double tremble_m = syllable_m * 4.0 * share.at * (1.0 - share.at);
  const double fading_m_per_s =
      syllable_m * 4.0 * (1.0 - 2.0 * share.at) * share.per_phase / now->duration_s;
  return {breath.at_m + tremble_m * std::sin(turn),
          breath.speed_m_per_s + fading_m_per_s * std::sin(turn) +
              2.0 * pi * syllables_hz * tremble_m * std::cos(turn)};
}

BreathCourse::Way BreathCourse::coughed(double time_s) const noexcept {
  const Cough* now = last_before(coughs_, time_s);
  if (now == nullptr || time_s >= now->start_s + bursts * burst_s) return {};
  const BreathShare share = breath_share(std::fmod(time_s - now->start_s, burst_s) / burst_s);
  return {now->depth_m * share.at, now->depth_m * share.per_phase / burst_s};
}

BreathCourse::Way BreathCourse::at(double time_s) const noexcept {
  if (breaths_.empty()) {
    const double rate = 2.0 * pi * breathing_.frequency_hz;
    return {breathing_.amplitude_m * (1.0 - std::cos(rate * time_s)) / 2.0,
            breathing_.amplitude_m * rate * std::sin(rate * time_s) / 2.0};
  }
  const double in_course_s = std::fmod(std::max(0.0, time_s), course_s);
  const Way breath = breathed(in_course_s), cough = coughed(in_course_s);
  return {breath.at_m + cough.at_m, breath.speed_m_per_s + cough.speed_m_per_s};
}

}  // namespace tuina::sim
