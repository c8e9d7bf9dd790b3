// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "tests/allocation.hpp"
#include "tuina/sim/person/breath.hpp"
#include "tuina/sim/robot/back_contact.hpp"
#include "tuina/tissue/tangent_model.hpp"

using namespace tuina;
using namespace tuina::sim;

namespace {

constexpr TangentTissue bone{.alpha_n = 4.559, .beta_per_m = 263.2};
constexpr TangentTissue hard{.alpha_n = 9.786, .beta_per_m = 185.4};
constexpr TangentTissue soft{.alpha_n = 4.275, .beta_per_m = 143.6};
constexpr double step_s = 0.25e-3;

BackContact back_with(const LivingBack& living, ContactOptions options = {}) {
  const Mesh mesh = make_patch({});
  options.living = living;
  return {mesh, std::vector<TangentTissue>(mesh.vertices.size(), hard), options};
}

/// Where the centre of a 17 mm sphere is that has gone `travel_m` into the flat back.
Vector3 pressed_by(double travel_m) {
  return {0.003, 17_mm - travel_m, 0.002};
}

/// Holds the tool so far in for a time; the force at its end.
double held_n(BackContact& back, double travel_m, double from_s, double for_s) {
  const int steps = static_cast<int>(std::lround(for_s / step_s));
  double force_n = 0.0;
  for (int i = 0; i <= steps; ++i) {
    force_n =
        back.touch(Arm::left, from_s + i * step_s, pressed_by(travel_m), Vector3::Zero()).force_n;
  }
  return force_n;
}

}  // namespace

TEST_CASE("layers yield as much as the tangent at 20 N, and nowhere else, and ever more slowly") {
  Random random = make_random(1, "forms");
  for (const TangentTissue& place : {bone, hard, soft}) {
    for (int n = 0; n < 20; ++n) {
      const ElasticForm form = draw_form(ElasticForm::Law::layers, random);
      const double meeting_m = tissue::depth_at_force(place, 20.0);
      CHECK(elastic_force_n(form, place, meeting_m) == doctest::Approx(20.0).epsilon(1e-9));
      CHECK(elastic_force_n(form, place, 0.0) == 0.0);
      CHECK(elastic_force_n(form, place, -1_mm) == 0.0);
      const double half_n = elastic_force_n(form, place, 0.5 * meeting_m);
      CHECK(half_n > 0.3);
      CHECK(half_n < 0.5 * 20.0);
      double off_share = 0.0;
      for (const double part : {0.25, 0.5, 1.2}) {
        const double tangent_n = tissue::force_at_depth(place, part * meeting_m);
        const double layers_n = elastic_force_n(form, place, part * meeting_m);
        off_share = std::max(off_share, std::abs(layers_n / tangent_n - 1.0));
      }
      CHECK(off_share > 0.1);
      double last_n = 0.0, last_rise_n = 0.0;
      for (double depth_m = 0.25_mm; depth_m < 2.0 * meeting_m; depth_m += 0.25_mm) {
        const double force_n = elastic_force_n(form, place, depth_m);
        CHECK(force_n - last_n >= last_rise_n);
        last_rise_n = force_n - last_n;
        last_n = force_n;
      }
      CHECK(std::isfinite(last_n));
    }
  }
}

TEST_CASE("tissue that relaxes loses its share and no more, and has it again after a rest") {
  BackContact back = back_with({.relaxing_share = 0.3}, {.torso_n_per_m = rigid});
  const double at_once_n = held_n(back, 5_mm, 0.0, 0.0);
  const double later_n = held_n(back, 5_mm, 0.0, 100.0);
  CHECK(later_n / at_once_n > 1.0 - 1.2 * 0.3);
  CHECK(later_n / at_once_n < 1.0 - 0.8 * 0.3 + 0.02);
  const double again_n = held_n(back, 5_mm, 100.0, 0.0);
  CHECK(again_n == doctest::Approx(later_n).epsilon(1e-3));
  (void)held_n(back, -20_mm, 100.0, 200.0);
  CHECK(held_n(back, 5_mm, 300.0, 0.0) == doctest::Approx(at_once_n).epsilon(1e-3));
}

TEST_CASE("a tool that slides meets fresh tissue, one that stands meets relaxed tissue") {
  const LivingBack living{.relaxing_share = 0.4};
  BackContact stands = back_with(living, {.torso_n_per_m = rigid});
  BackContact slides = back_with(living, {.torso_n_per_m = rigid});
  double standing_n = 0.0, sliding_n = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    const double time_s = i * step_s, aside_m = 0.03 * time_s - 0.1;
    standing_n = stands.touch(Arm::left, time_s, pressed_by(5_mm), Vector3::Zero()).force_n;
    sliding_n = slides
                    .touch(Arm::left, time_s, pressed_by(5_mm) + Vector3(aside_m, 0.0, 0.0),
                           Vector3(0.03, 0.0, 0.0))
                    .force_n;
  }
  CHECK(sliding_n > 1.08 * standing_n);
}

TEST_CASE("a torso with a mass swings and comes to rest where its spring holds the force") {
  BackContact back = back_with({.torso_mass_kg = 6.0}, {.torso_n_per_m = 20e3});
  double highest_n = 0.0, lowest_n = 1e9;
  for (int i = 0; i < 8000; ++i) {
    const double now_n =
        back.touch(Arm::left, i * step_s, pressed_by(5_mm), Vector3::Zero()).force_n;
    if (i > 40) lowest_n = std::min(lowest_n, now_n);
    highest_n = std::max(highest_n, now_n);
  }
  const ContactTruth& rest = back.truth(Arm::left);
  const double torso_m = 5_mm - rest.depth_m;
  CHECK(rest.force_n / torso_m > 0.75 * 20e3);
  CHECK(rest.force_n / torso_m < 1.25 * 20e3);
  CHECK(rest.force_n == doctest::Approx(tissue::force_at_depth(hard, rest.depth_m)).epsilon(1e-3));
  CHECK(highest_n > 1.2 * rest.force_n);
  CHECK(lowest_n < rest.force_n);
}

TEST_CASE("tissue that damps holds still on a torso however light it is") {
  for (const double mass_kg : {0.0, 0.02, 0.1}) {
    CAPTURE(mass_kg);
    BackContact back = back_with({.damping_s_per_m = 20.0, .torso_mass_kg = mass_kg}, {});
    double lowest_n = 1e9, highest_n = 0.0;
    for (int i = 0; i < 3000; ++i) {
      const double now_n =
          back.touch(Arm::left, i * step_s, pressed_by(9_mm), Vector3::Zero()).force_n;
      if (i < 2000) continue;
      lowest_n = std::min(lowest_n, now_n);
      highest_n = std::max(highest_n, now_n);
    }
    const ContactTruth& rest = back.truth(Arm::left);
    CHECK(rest.force_n > 40.0);
    CHECK(highest_n - lowest_n < 1e-6);
    CHECK(rest.force_n ==
          doctest::Approx(tissue::force_at_depth(hard, rest.depth_m)).epsilon(1e-3));
    const double torso_m = 9_mm - rest.depth_m;
    CHECK(rest.force_n / torso_m > 0.75 * 35e3);
    CHECK(rest.force_n / torso_m < 1.25 * 35e3);
  }
}

TEST_CASE("a place that has been worked yields more than at its first press") {
  BackContact back = back_with({.first_press_stiffer = 0.2}, {.torso_n_per_m = rigid});
  const double first_n = held_n(back, 5_mm, 0.0, 0.0);
  (void)held_n(back, 5_mm, 0.0, 20.0);
  (void)held_n(back, -5_mm, 20.0, 0.5);
  const double second_n = held_n(back, 5_mm, 20.5, 0.0);
  CHECK(first_n / second_n > 1.14);
  CHECK(first_n / second_n < 1.25);
}

TEST_CASE("who tenses is stiffer for a while, and as they were afterwards") {
  BackContact back =
      back_with({.tensing_share = 0.5, .tensing_probability = 1.0}, {.torso_n_per_m = rigid});
  double relaxed_n = held_n(back, 5_mm, 0.0, 0.0), highest_n = 0.0, last_n = 0.0;
  for (int i = 1; i < 15'600; ++i) {  // less than the four seconds after which it may come again
    last_n = back.touch(Arm::left, i * step_s, pressed_by(5_mm), Vector3::Zero()).force_n;
    highest_n = std::max(highest_n, last_n);
  }
  CHECK(highest_n > 1.39 * relaxed_n);
  CHECK(highest_n < 1.61 * relaxed_n);
  CHECK(last_n < highest_n);
}

TEST_CASE("skin is dragged along before it slips, and never holds more than friction") {
  BackContact back =
      back_with({.skin_shear_n_per_m = 2000.0}, {.torso_n_per_m = rigid, .friction = 0.4});
  const Vector3 along(0.01, 0.0, 0.0);
  std::vector<double> drag_n;
  for (int i = 0; i < 4000; ++i) {
    const ContactTruth& now =
        back.touch(Arm::left, i * step_s, pressed_by(5_mm) + i * step_s * along, along);
    drag_n.push_back(-now.on_tool_in_couch.force_n.x());
    CHECK(drag_n.back() <= 0.4 * now.force_n * (1.0 + 1e-9));
  }
  const double held_n = 0.4 * back.truth(Arm::left).force_n;
  CHECK(drag_n[200] < 0.7 * held_n);  // after half a millimetre
  CHECK(drag_n.back() == doctest::Approx(held_n));
}

TEST_CASE("two backs of one seed are the same person, of another seed another one") {
  const LivingBack living{.fat_share = 0.4, .relaxing_share = 0.3, .grain_share = 0.1};
  const auto force_n = [&](std::uint64_t seed) {
    BackContact back = back_with(living, {.seed = seed});
    return held_n(back, 5_mm, 0.0, 1.0);
  };
  CHECK(force_n(3) == force_n(3));
  CHECK(force_n(3) != force_n(4));
}

TEST_CASE("a living contact takes nothing from the heap") {
  BackContact back = back_with({.fat_share = 0.4,
                                .relaxing_share = 0.3,
                                .damping_s_per_m = 5.0,
                                .torso_mass_kg = 5.0,
                                .first_press_stiffer = 0.1,
                                .tensing_share = 0.3,
                                .tensing_probability = 0.5,
                                .grain_share = 0.1,
                                .skin_shear_n_per_m = 2000.0},
                               {.breathing = {.amplitude_m = 3_mm, .variation = 1.0}});
  const auto before = test::allocations();
  double sum_n = 0.0;
  for (int n = 0; n < 100; ++n)
    sum_n += back.touch(Arm::left, n * 1e-3, pressed_by(n * 0.1_mm), Vector3::UnitX()).force_n;
  CHECK(test::allocations() == before);
  CHECK(sum_n > 0.0);
}

TEST_CASE("no breath is like the other, and the speed of the skin is that of its place") {
  const Breathing usual{.amplitude_m = 3_mm,
                        .variation = 1.0,
                        .sigh_share = 0.05,
                        .speaking_share = 0.2,
                        .coughs_per_h = 60.0};
  const BreathCourse course(usual, 5);
  std::vector<double> depths_m;
  double deepest_m = 0.0, fastest_m_per_s = 0.0;
  bool out = true;
  for (double time_s = 0.0; time_s < 600.0; time_s += 1e-3) {
    const auto now = course.at(time_s);
    fastest_m_per_s = std::max(fastest_m_per_s, now.speed_m_per_s);
    deepest_m = std::max(deepest_m, now.at_m);
    const double by_m = course.at(time_s + 1e-6).at_m - course.at(time_s - 1e-6).at_m;
    if (time_s > 0.0 && std::abs(by_m / 2e-6 - now.speed_m_per_s) > 2e-3) {
      FAIL_CHECK("at " << time_s << " s: " << by_m / 2e-6 << " and " << now.speed_m_per_s);
      break;
    }
    if (now.at_m < 0.1_mm && !out) {
      depths_m.push_back(deepest_m);
      out = true;
      deepest_m = 0.0;
    }
    out = out && now.at_m < 0.2_mm;
  }
  double sum_m = 0.0, squares = 0.0;
  for (const double depth_m : depths_m) sum_m += depth_m, squares += depth_m * depth_m;
  const double n = static_cast<double>(depths_m.size()), mean_m = sum_m / n;
  CHECK(n > 100.0);
  CHECK(n < 200.0);
  CHECK(mean_m > 2.2_mm);
  CHECK(mean_m < 5_mm);
  CHECK(std::sqrt(squares / n - mean_m * mean_m) > 0.2 * mean_m);
  CHECK(fastest_m_per_s > 0.03);  // a cough
}

TEST_CASE("with depth and rate alone a breath is a sine") {
  const BreathCourse course({.amplitude_m = 3_mm, .frequency_hz = 0.25}, 1);
  CHECK(course.at(0.0).at_m == doctest::Approx(0.0));
  CHECK(course.at(2.0).at_m == doctest::Approx(3_mm));
  CHECK(course.at(1.0).speed_m_per_s == doctest::Approx(3_mm * pi * 0.25));
}

TEST_CASE("the first loading of a place that keeps to the tangent law is that law") {
  const BackContact back = back_with({});
  CHECK(back.first_loading(hard, Vector3::Zero(), 20.0).alpha_n == hard.alpha_n);
  CHECK(back.first_loading(hard, Vector3::Zero(), 20.0).beta_per_m == hard.beta_per_m);
}

TEST_CASE("the first loading meets what a tool feels that goes in with 10 mm/s, and half of it") {
  constexpr double m_per_s = 10e-3, dt_s = 1e-3, wanted_n = 22.0;
  BackContact back = back_with({.fat_share = 0.45, .relaxing_share = 0.3, .damping_s_per_m = 3.0},
                               {.torso_n_per_m = rigid, .seed = 7});
  const TangentTissue law = back.first_loading(hard, Vector3::Zero(), wanted_n);
  double worst_half_n = 0.0, worst_full_n = 0.0, force_n = 0.0;
  for (int i = 0; force_n < wanted_n && i < 5000; ++i) {
    const double depth_m = m_per_s * dt_s * i;
    force_n = back.touch(Arm::left, dt_s * i, pressed_by(depth_m), {0.0, -m_per_s, 0.0}).force_n;
    const double off_n = std::abs(tissue::force_at_depth(law, depth_m) - force_n);
    if (std::abs(force_n - 0.5 * wanted_n) < 0.1) worst_half_n = std::max(worst_half_n, off_n);
    if (std::abs(force_n - wanted_n) < 0.2) worst_full_n = std::max(worst_full_n, off_n);
  }
  CHECK(force_n >= wanted_n);
  CHECK(worst_half_n < 0.3);
  CHECK(worst_full_n < 0.4);
  // Not the numbers that the place was drawn with.
  CHECK(std::abs(law.alpha_n / hard.alpha_n - 1.0) > 0.2);
}

TEST_CASE("the first loading is that of a place that has not been worked") {
  const auto law_of = [](double first_press_stiffer) {
    return back_with({.first_press_stiffer = first_press_stiffer},
                     {.torso_n_per_m = rigid, .seed = 7})
        .first_loading(hard, Vector3::Zero(), 22.0);
  };
  CHECK(law_of(0.2).alpha_n > 1.1 * law_of(0.0).alpha_n);
  CHECK(law_of(0.2).alpha_n < 1.4 * law_of(0.0).alpha_n);
}
