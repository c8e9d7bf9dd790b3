// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "apps/simulated/scanned_people.hpp"
#include "tuina/body/acupoints.hpp"
#include "tuina/body/learn/labelled_body.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::app {

inline constexpr std::array<const char*, 5> acupoint_methods = {
    "field_morphing", "surface", "rigid_icp", "axis_scaling", "cun_rule"};

/// Points that a finger shows before the method surface is judged once more, one set after another.
inline const std::array<std::vector<std::string>, 5> palpated_sets = {
    {{"GV14"}, {"GV4"}, {"BL18_L"}, {"GV14", "GV4"}, {"BL18_L", "BL23_R"}}};
/// Standard deviation of that finger in each direction of the skin.
inline constexpr double finger_error_mm = 3.0;
/// Key of such a set among the scores: "GV14 and GV4".
[[nodiscard]] std::string name_of(const std::vector<std::string>& palpated);

/// One acupoint of one person found by one method.
struct Finding {
  std::size_t person = 0;
  std::string type, position, arms, point;
  Vector3 found_in_couch, true_in_couch;
  double error_mm = 0.0;
  double uncertainty_mm = 0.0;
  bool of_the_seven = false;
};

/// What one method did on everybody.
struct Score {
  std::vector<Finding> findings;
  std::vector<double> compute_ms;
  std::vector<std::string> failures;
};

/// Seconds from the person on the couch to the plan, [thesis] 5.5.
struct Times {
  std::vector<double> scan_s, map_s, plan_s;
};

/// How far the found points of one person, number `index`, are from the marks.
void add_findings(const body::LabelledBody& person, std::size_t index, const body::Mapping& found,
                  const std::vector<Acupoint>& marks, Score& score);

/// Judges every method on one person, number `index`, and the points of the method surface that
/// are left when others were palpated. `marks` are the places to be found: the truth, or what a
/// therapist marked. The seed draws the errors of the finger.
void judge(const body::LabelledBody& person, std::size_t index, const Result<Seen>& seen,
           const body::Atlas& atlas, const std::vector<Acupoint>& marks, std::uint64_t seed,
           std::map<std::string, Score>& scores, Times& times);

/// The true points as a therapist would mark them: each off in the skin by a Gaussian whose
/// distance has this RMS.
[[nodiscard]] std::vector<Acupoint> marked(const std::vector<Acupoint>& points, double scatter_mm,
                                           std::uint64_t seed);

}  // namespace tuina::app
