// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/acupoints/trials.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "tuina/baselines/acupoint_baselines.hpp"
#include "tuina/body/palpation.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/plan.hpp"
#include "tuina/massage/programme.hpp"

namespace tuina::app {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Result<body::Mapping> map(const body::BackSurface& back, const body::Atlas& atlas,
                          std::string_view method) {
  if (method == "rigid_icp") return baselines::rigid_icp(back, atlas);
  if (method == "axis_scaling") return baselines::scale_axes(back, atlas);
  if (method == "cun_rule") return baselines::cun_rule(back, atlas);
  return body::locate_acupoints(back, atlas, *body::parse_method(method));
}

void time_the_plan(const body::BackSurface& back, const body::Mapping& mapping, Times& times) {
  const auto start = Clock::now();
  const auto programme = massage::load_programme("relax");
  if (!programme) return;
  if (!massage::plan(back, mapping.acupoints, mapping.landmarks, *programme)) return;
  times.plan_s.push_back(seconds_since(start));
}

/// The other points when a finger has shown some of them, each set for itself.
void judge_palpated(const body::LabelledBody& person, std::size_t index,
                    const body::BackSurface& back, const body::Mapping& found,
                    const std::vector<Acupoint>& marks, std::uint64_t seed,
                    std::map<std::string, Score>& scores) {
  const auto touched = marked(marks, finger_error_mm * std::sqrt(2.0), seed);
  for (const auto& names : palpated_sets) {
    std::vector<body::PalpatedPoint> fixed;
    std::vector<Acupoint> others;
    for (std::size_t i = 0; i < marks.size(); ++i) {
      if (std::find(names.begin(), names.end(), marks[i].name) == names.end()) {
        others.push_back(marks[i]);
      } else {
        fixed.push_back({marks[i].name, touched[i].at_in_couch, from_mm(finger_error_mm)});
      }
    }
    Score& score = scores[name_of(names)];
    const auto followed = body::fix_points(found, back, fixed);
    if (followed) {
      add_findings(person, index, *followed, others, score);
    } else {
      score.failures.push_back(fmt::format("{}: {}", person.id, followed.error().message));
    }
  }
}

}  // namespace

std::string name_of(const std::vector<std::string>& palpated) {
  return fmt::format("{}", fmt::join(palpated, " and "));
}

void add_findings(const body::LabelledBody& person, std::size_t index, const body::Mapping& found,
                  const std::vector<Acupoint>& marks, Score& score) {
  for (const Acupoint& mark : marks) {
    const bool seven = std::find(seven_acupoints.begin(), seven_acupoints.end(), mark.name) !=
                       seven_acupoints.end();
    for (const Acupoint& point : found.acupoints) {
      if (point.name != mark.name) continue;
      score.findings.push_back({.person = index,
                                .type = person.body_type,
                                .position = name_of(person.position),
                                .arms = name_of(found.arms),
                                .point = mark.name,
                                .found_in_couch = point.at_in_couch,
                                .true_in_couch = mark.at_in_couch,
                                .error_mm = to_mm((point.at_in_couch - mark.at_in_couch).norm()),
                                .uncertainty_mm = to_mm(point.uncertainty_m),
                                .of_the_seven = seven});
    }
  }
}

void judge(const body::LabelledBody& person, std::size_t index, const Result<Seen>& seen,
           const body::Atlas& atlas, const std::vector<Acupoint>& marks, std::uint64_t seed,
           std::map<std::string, Score>& scores, Times& times) {
  if (seen && seen->sweep_s > 0.0) times.scan_s.push_back(seen->sweep_s + 1e-3 * seen->compute_ms);
  for (const char* method : acupoint_methods) {
    Score& score = scores[method];
    const auto start = Clock::now();
    const auto back = seen ? body::fit_back(seen->cloud_in_couch)
                           : Result<body::BackSurface>(tl::unexpected(seen.error()));
    const auto found =
        back ? map(*back, atlas, method) : Result<body::Mapping>(tl::unexpected(back.error()));
    const double taken_s = seconds_since(start);
    score.compute_ms.push_back(1e3 * taken_s);
    if (!found) {
      score.failures.push_back(fmt::format("{}: {}", person.id, found.error().message));
      continue;
    }
    if (std::string_view(method) == "surface") {
      times.map_s.push_back(taken_s);
      time_the_plan(*back, *found, times);
      judge_palpated(person, index, *back, *found, marks, seed, scores);
    }
    add_findings(person, index, *found, marks, score);
  }
}

std::vector<Acupoint> marked(const std::vector<Acupoint>& points, double scatter_mm,
                             std::uint64_t seed) {
  std::vector<Acupoint> marks = points;
  Random random = make_random(seed, "therapist");
  const double each_m = from_mm(scatter_mm) / std::sqrt(2.0);
  for (Acupoint& mark : marks) {
    const Vector3 along = mark.normal_in_couch.unitOrthogonal();
    mark.at_in_couch += gaussian(random, each_m) * along;
    mark.at_in_couch += gaussian(random, each_m) * mark.normal_in_couch.cross(along);
  }
  return marks;
}

}  // namespace tuina::app
