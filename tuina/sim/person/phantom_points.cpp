// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/person/phantom_points.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <string>

namespace tuina::sim {
namespace {

/// Heights of the spinous processes, counted C7 = 0, T1 = 1, T12 = 12, L1 = 13, S1 = 18, S2 = 19;
/// linear between the named ones.
class Processes {
 public:
  explicit Processes(const Proportions& p)
      : height_({1.0, p.of[height_t3], p.of[height_t7], p.of[height_t9], p.of[height_t12],
                 p.of[height_l2], p.of[height_l4], 0.0}) {}
  /// Half way down to the next process.
  [[nodiscard]] double hollow_below(int process) const {
    std::size_t i = 0;
    while (number[i + 1] <= process) ++i;
    const double part = (process + 0.49 - number[i]) / (number[i + 1] - number[i]);
    return height_[i] + part * (height_[i + 1] - height_[i]);
  }

 private:
  static constexpr std::array<int, 8> number = {0, 3, 7, 9, 12, 14, 16, 19};
  std::array<double, 8> height_;
};

constexpr int c7 = 0, t3 = 3, t5 = 5, t7 = 7, t9 = 9, t11 = 11, t12 = 12, l2 = 14, l4 = 16;

/// Outward shift of the skin beside the spine by arms that reach up or forward, since the rules
/// hold for a standing person: up to 5 mm at the inferior angle and 2 mm above it, measured on the
/// people of models/phantom.csv.
double drawn_outwards(BodyPosture position, bool arms_up, double height) {
  const auto around = [&](double middle) {
    const double off = (height - middle) / 0.11;
    return std::exp(-0.5 * off * off);
  };
  if (position == BodyPosture::sitting) return 0.0036 * around(0.80);
  return arms_up ? 0.0098 * around(0.69) : 0.0;
}

}  // namespace

void mark_points(const Proportions& proportions, const PhantomForm& form, const PhantomPose& pose,
                 bool arms_up, Person& person) {
  const auto& of = proportions.of;
  const double length_m = form.length_m();
  const auto landmark = [&](const std::string& name, const Vector3& skin_in_trunk) {
    person.landmarks.push_back({.name = name, .at_in_couch = pose.couch_from_trunk(skin_in_trunk)});
  };
  const auto on_back = [&](double x, double z) { return form.skin_at(x * length_m, z * length_m); };
  const auto landmark_pair = [&](const std::string& name, double x, double z) {
    landmark(name + "_L", on_back(x, z));
    landmark(name + "_R", on_back(-x, z));
  };
  landmark("C7", on_back(0.0, 1.0));
  landmark("T3", on_back(0.0, of[height_t3]));
  landmark("T7", on_back(0.0, of[height_t7]));
  landmark("T9", on_back(0.0, of[height_t9]));
  landmark("T12", on_back(0.0, of[height_t12]));
  landmark("L2", on_back(0.0, of[height_l2]));
  landmark("L4", on_back(0.0, of[height_l4]));
  landmark("sacrum_S2", on_back(0.0, 0.0));
  landmark_pair("psis", of[psis_x], of[psis_z]);
  landmark_pair("scapula_root", of[scapula_root_x], of[scapula_root_z]);
  landmark_pair("scapula_spine_mid", of[scapula_spine_mid_x], of[scapula_spine_mid_z]);
  landmark_pair("scapula_inferior_angle", of[inferior_angle_x], of[inferior_angle_z]);
  // Where the surface turns away from the viewer, depth locates the point too.
  const auto at_side = [&](const std::string& name, double x, double y, double z) {
    landmark(name + "_L", form.onto_skin(length_m * Vector3(x, y, z)));
    landmark(name + "_R", form.onto_skin(length_m * Vector3(-x, y, z)));
  };
  at_side("acromial_angle", of[acromial_angle_x], of[acromial_angle_y], of[acromial_angle_z]);
  at_side("axillary_fold", of[axillary_fold_x], of[axillary_fold_y], of[axillary_fold_z]);
  at_side("acromion", of[acromion_x], of[acromion_y], of[acromion_z]);
  at_side("waist", of[waist_x], of[waist_y], of[waist_z]);

  const auto point = [&](const std::string& name, double x, double z) {
    const Vector3 skin = on_back(x, z);
    const Vector3 normal = gradient_of(std::cref(form), skin).normalized();
    person.acupoints.push_back({.name = name,
                                .at_in_couch = pose.couch_from_trunk(skin),
                                .normal_in_couch = pose.normal_in_couch(skin, normal)});
  };
  const auto point_pair = [&](const std::string& name, double x, double z) {
    const double drawn = drawn_outwards(pose.position, arms_up, z);
    point(name + "_L", x + drawn, z);
    point(name + "_R", -x - drawn, z);
  };
  const Processes processes(proportions);
  const double cun = of[three_cun] / 3.0;
  const auto third_down = [&](Measure from, Measure to) {
    return of[from] + (of[to] - of[from]) / 3.0;
  };
  // Arms that leave the standing position pull the skin over the scapula inwards: 4 mm forward, 2
  // mm prone.
  const double slid = pose.position == BodyPosture::sitting ? 0.008 : 0.003;
  point_pair("SI11", third_down(scapula_spine_mid_x, inferior_angle_x) - slid,
             third_down(scapula_spine_mid_z, inferior_angle_z) + 0.002);
  point_pair("BL47", 3.0 * cun, processes.hollow_below(t9));
  point_pair("BL50", 3.0 * cun, processes.hollow_below(t12));
  point("GV4", 0.0, processes.hollow_below(l2));
  point_pair("BL13", 1.5 * cun, processes.hollow_below(t3));
  point_pair("BL15", 1.5 * cun, processes.hollow_below(t5));
  point_pair("BL17", 1.5 * cun, processes.hollow_below(t7));
  point_pair("BL18", 1.5 * cun, processes.hollow_below(t9));
  point_pair("BL20", 1.5 * cun, processes.hollow_below(t11));
  point_pair("BL21", 1.5 * cun, processes.hollow_below(t12));
  point_pair("BL23", 1.5 * cun, processes.hollow_below(l2));
  point("GV2", 0.0, of[gv2_z]);
  point("GV3", 0.0, processes.hollow_below(l4));
  point("GV6", 0.0, processes.hollow_below(t11));
  point("GV9", 0.0, processes.hollow_below(t7));
  point("GV12", 0.0, processes.hollow_below(t3));
  point("GV14", 0.0, processes.hollow_below(c7));
}

}  // namespace tuina::sim
