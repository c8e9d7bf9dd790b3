// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "tuina/core/geometry.hpp"
#include "tuina/core/random.hpp"
#include "tuina/sim/person/living_tissue.hpp"

namespace tuina::sim {

/// What a back does beyond the tangent law over a torso without mass; all zero, nothing. A person's
/// own numbers are drawn within a fifth of these.
struct LivingBack {
  double fat_share = 0.0;            ///< of the depth at 20 N, layers below it; 0: the tangent law
  double relaxing_share = 0.0;       ///< of the elastic force, within 0.3-1 s and 5-20 s
  double damping_s_per_m = 0.0;      ///< mu of the tissue
  double torso_mass_kg = 0.0;        ///< the torso then has a damping ratio of 0.2-0.4
  double first_press_stiffer = 0.0;  ///< share, until a place has been worked
  double tensing_share = 0.0;        ///< stiffer by it, and let go again
  double tensing_probability = 0.0;  ///< in four seconds of contact
  double grain_share = 0.0;          ///< standard deviation of alpha within centimetres
  double place_share = 0.0;          ///< of layers and relaxation, from place to place
  double skin_shear_n_per_m = 0.0;   ///< skin gives way sideways before it slips; 0: it does not

  [[nodiscard]] bool operator==(const LivingBack&) const = default;
};

/// One tool on a living back: the memory of the tissue under it, the torso below, muscles that
/// tense, skin that is dragged along. No heap after construction.
class LivingContact {
 public:
  /// Two tools on one person have the same `person` and streams of their own in `events`.
  LivingContact(const LivingBack& back, double torso_n_per_m, double friction, Random person,
                Random events);

  /// Where a tool is on the person, and what the tissue there is like.
  struct Tool {
    TangentTissue place;
    Vector3 at = Vector3::Zero();  ///< on the resting person
    double worked = 0.0;           ///< 0: never pressed before, 1: no further change
    double travel_m = 0.0;         ///< below the resting skin
    Vector3 normal = Vector3::UnitZ();
    Vector3 velocity_m_per_s = Vector3::Zero();  ///< against the skin
  };
  /// The tool touches, or may; then a step of time passes.
  void press(const Tool& tool, double step_s) noexcept;
  /// As `LivingTissue::first_loading`, of a place that has not been worked.
  [[nodiscard]] TangentTissue first_loading(const TangentTissue& place, const Vector3& at,
                                            double to_n) const noexcept;
  /// The tool is away for a step.
  void rest(double step_s) noexcept;

  double force_n = 0.0;
  double depth_m = 0.0;
  Vector3 drag_n = Vector3::Zero();  ///< of the skin onto the tool, across the normal

 private:
  /// Height of a landscape over the body, with hills and hollows of 0.1 to 0.3 m and a standard
  /// deviation of one.
  class Landscape {
   public:
    Landscape() = default;  ///< flat
    explicit Landscape(Random& random);
    [[nodiscard]] double at(const Vector3& place) const noexcept;

   private:
    struct Wave {
      Vector3 way = Vector3::Zero();  // radians in a metre
      double phase = 0.0;
    };
    std::array<Wave, 6> waves_;
  };

  /// The layers and the relaxation of a place.
  void lay(const Vector3& at, LivingTissue& tissue) const noexcept;
  [[nodiscard]] double tension(double step_s) noexcept;
  /// Stretches the skin; how fast the tool slips over it.
  double slip(const Tool& tool, double step_s) noexcept;

  LivingBack back_;
  LivingTissue tissue_;
  std::array<double, 3> relaxing_ = {};  // shares of the person, as is the fat of `back_`
  Landscape fat_, relaxation_;
  double friction_, shear_n_s_per_m_;
  Random events_;
  Vector3 stretch_ = Vector3::Zero();
  double time_s_ = 0.0, in_contact_s_ = 0.0;
  double tenses_at_s_ = -100.0, tensed_for_s_ = 0.0;
};

}  // namespace tuina::sim
