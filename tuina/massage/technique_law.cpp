// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/technique_law.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "tuina/core/units.hpp"
#include "tuina/massage/technique/contact_path.hpp"
#include "tuina/massage/technique/knead.hpp"
#include "tuina/massage/technique/rub.hpp"
#include "tuina/massage/technique/tap.hpp"

namespace tuina::massage {
namespace {

double rub_once_s(const SurfaceCurve& curve, const SlidingOrder& order) {
  const Part& part = order.part;
  const double round_m_per_s = std::min(2.0 * pi * part.radius_m * part.rate_hz, max_slide_m_per_s);
  return part.spiral ? curve.length_m() / round_m_per_s + 1.0 : 1.0 / part.rate_hz;
}

ContactPath rub_along(const SurfaceCurve& curve, const SlidingOrder& order, std::string name) {
  return plan_rub(curve,
                  {.force_n = order.force_n,
                   .rate_hz = order.part.rate_hz,
                   .turns = order.repeats,
                   .radius_m = order.part.radius_m},
                  std::move(name));
}

double stroke_once_s(const SurfaceCurve& curve, const SlidingOrder& order) {
  return order.turn ? 2.0 * (order.turn->pass_s - hands_overlap_s)
                    : 2.0 * (curve.length_m() / order.part.speed_m_per_s + 0.5);
}

ContactPath stroke_along(const SurfaceCurve& curve, const SlidingOrder& order, std::string name) {
  return plan_stroke(curve,
                     {.force_n = order.force_n,
                      .speed_m_per_s = order.part.speed_m_per_s,
                      .repeats = order.repeats,
                      .turn = order.turn},
                     std::move(name));
}

KneadOptions knead_of(const SlidingOrder& order) {
  return {.force_n = order.force_n, .rate_hz = order.part.rate_hz, .turns = order.repeats};
}

double knead_once_s(const SurfaceCurve& curve, const SlidingOrder& order) {
  return 1.0 / knead_hz(curve, knead_of(order));
}

ContactPath knead_along(const SurfaceCurve& curve, const SlidingOrder& order, std::string name) {
  return plan_knead(curve, knead_of(order), std::move(name));
}

const std::array laws = {
    TechniqueLaw{.technique = Technique::press,
                 .keys = {"technique", "points", "side", "order", "together", "alternating",
                          "force_n", "repeats", "time_s", "hold_s", "rise_s"}},
    TechniqueLaw{.technique = Technique::rub,
                 .keys = {"technique", "points", "side", "order", "together", "alternating",
                          "force_n", "repeats", "time_s", "rate_hz", "radius_mm", "spiral"},
                 .circles = true,
                 .once_s = rub_once_s,
                 .along = rub_along},
    TechniqueLaw{
        .technique = Technique::stroke,
        .keys = {"technique", "points", "line", "places", "side", "together", "alternating",
                 "hand_over_hand", "force_n", "repeats", "time_s", "speed_mm_per_s"},
        .once_s = stroke_once_s,
        .along = stroke_along},
    TechniqueLaw{.technique = Technique::tap,
                 .keys = {"technique", "points", "side", "order", "together", "force_n", "time_s",
                          "rate_hz"},
                 .rate_hz = {.usual = 3.0, .min = min_tap_hz, .max = max_tap_hz},
                 .max_beat_n_per_s = max_tap_n_per_s},
    TechniqueLaw{.technique = Technique::knead,
                 .keys = {"technique", "points", "side", "order", "together", "alternating",
                          "force_n", "repeats", "time_s", "rate_hz", "radius_mm"},
                 .rate_hz = {.usual = 0.8, .min = min_knead_hz, .max = max_knead_hz},
                 .radius_mm = {.usual = 15.0,
                               .min = to_mm(min_knead_radius_m),
                               .max = to_mm(max_knead_radius_m)},
                 .max_beat_n_per_s = max_beat_n_per_s,
                 .circles = true,
                 .begins_at_spine = true,  // where its force is least
                 .once_s = knead_once_s,
                 .along = knead_along},
};
static_assert(laws.size() == all_techniques.size());

}  // namespace

const TechniqueLaw& law_of(Technique technique) {
  const TechniqueLaw& law = laws[static_cast<std::size_t>(technique)];
  assert(law.technique == technique);
  return law;
}

}  // namespace tuina::massage
