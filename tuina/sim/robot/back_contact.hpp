// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "tuina/core/arm.hpp"
#include "tuina/core/contact.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/person/breath.hpp"
#include "tuina/sim/robot/closest_point.hpp"
#include "tuina/sim/robot/living_contact.hpp"

namespace tuina::sim {

/// Translation of the whole person from a time on: constant acceleration up to a constant speed.
/// With infinite acceleration the speed jumps, the hardest test.
struct Shift {
  double start_s = 0.0;
  Vector3 by_in_couch = Vector3::Zero();
  double speed_m_per_s = 0.1;
  double acceleration_m_per_s2 = std::numeric_limits<double>::infinity();
};

/// A person's back as tools feel it, and the tools themselves.
struct ContactOptions {
  double tool_radius_m = 17_mm;
  double torso_n_per_m = 35'000.0;  ///< stiffness beneath the tissue; may be `rigid`
  double friction = 0.1;            ///< Coulomb coefficient of oiled skin
  double creep_m_per_s = 5_mm;      ///< below this sliding speed friction is viscous
  Breathing breathing = {};
  std::vector<Shift> shifts = {};
  LivingBack living = {};
  std::uint64_t seed = 1;  ///< of what is drawn for this person
};

/// Ground truth of one tool on the skin.
struct ContactTruth {
  /// Normal to the skin: the contact force that all controllers are judged by.
  double force_n = 0.0;
  double depth_m = 0.0;  ///< indentation of the tissue, without the torso's
  double gap_m = 0.0;    ///< sphere to skin; negative: depth plus torso; far away a lower bound
  Vector3 at_in_couch = Vector3::Zero();  ///< closest point of the skin, on the resting person
  Vector3 normal_in_couch = Vector3::UnitZ();
  TangentTissue tissue;     ///< at the closest point
  Wrench on_tool_in_couch;  ///< about the centre of the sphere, friction included
};

/// Contact of two sphere tools with a person's back: a mesh with one tangent law per vertex, in
/// series with the torso, breathing, moving. Quasi-static, tissue and torso without mass and
/// damping, unless `living` says more.
class BackContact {
 public:
  /// `per_vertex`: one tissue per vertex of the skin.
  BackContact(Mesh skin_in_couch, std::vector<TangentTissue> per_vertex,
              ContactOptions options = {});

  /// Contact of a tool at this centre and velocity. No heap.
  const ContactTruth& touch(Arm arm, double time_s, const Vector3& centre_in_couch,
                            const Vector3& velocity_in_couch) noexcept;

  /// Of the newest `touch`.
  [[nodiscard]] const ContactTruth& truth(Arm arm) const noexcept { return sides_[arm].truth; }
  /// @{
  /// Displacement and velocity of the person from the mesh: breathing and shifts.
  [[nodiscard]] Vector3 moved_in_couch(double time_s) const noexcept;
  [[nodiscard]] Vector3 moving_m_per_s(double time_s) const noexcept;
  /// @}
  /// The tangent law that somebody who presses the person there, up to that force, can find: of the
  /// first loading of rested tissue at 10 mm/s. The place's own law where it keeps to that.
  [[nodiscard]] TangentTissue first_loading(const TangentTissue& place, const Vector3& at_in_couch,
                                            double to_n) const noexcept;
  /// Out of the back; unit.
  [[nodiscard]] const Vector3& mean_normal_in_couch() const noexcept { return mean_normal_; }
  /// The person will move so, too.
  void add_shift(const Shift& shift) { options_.shifts.push_back(shift); }

 private:
  struct Side {
    ContactTruth truth;
    int triangle = 0;         // triangle of the last answer
    double free_way_m = 0.0;  // distance the tool may move before contact is possible
    Vector3 last_on_mesh = Vector3::Constant(std::numeric_limits<double>::max());
    std::optional<LivingContact> living;  // empty: nothing to remember
    double time_s = 0.0;
  };
  void press(Side& side, const ClosestPoint::Place& place, const Vector3& normal, double height_m,
             const Vector3& sliding_m_per_s, double step_s) noexcept;
  /// How far the places under the tool have been worked; counts this step's work.
  [[nodiscard]] double worked(const Side& side, const ClosestPoint::Place& place,
                              double step_s) noexcept;
  [[nodiscard]] Vector3 normal_at(const ClosestPoint::Place& place) const noexcept;
  [[nodiscard]] TangentTissue tissue_at(const ClosestPoint::Place& place) const noexcept;
  [[nodiscard]] bool on_the_rim(const ClosestPoint::Place& place) const noexcept;

  ClosestPoint skin_;
  std::vector<TangentTissue> tissue_;
  ContactOptions options_;
  BreathCourse breath_;
  std::vector<double> worked_;  // of each vertex; empty: no place changes
  std::vector<Vector3> vertex_normals_;
  std::vector<bool> on_rim_;
  Vector3 mean_normal_;
  PerArm<Side> sides_;
};

/// Indentation of the tissue when tissue and torso together are indented by `travel_m`.
[[nodiscard]] double depth_in_series(const TangentTissue& tissue, double torso_n_per_m,
                                     double travel_m) noexcept;

/// A square of skin for contact experiments, flat or bent like a back about its long axis (couch z
/// for an upright patch, else couch y).
struct Patch {
  Vector3 centre_in_couch = Vector3::Zero();
  Vector3 normal_in_couch = Vector3::UnitY();
  double size_m = 500_mm;
  double bend_radius_m = std::numeric_limits<double>::infinity();
  double edge_m = 8_mm;
};
/// Makes the mesh of a patch, in couch.
[[nodiscard]] Mesh make_patch(const Patch& patch);

}  // namespace tuina::sim
