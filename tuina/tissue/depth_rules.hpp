// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "tuina/core/contact.hpp"

namespace tuina::tissue {

/// What an estimate means for the massage: small rules from numbers to numbers, none of which
/// knows a robot. They only ever lower what the zone of the body allows (`region_cap_n`). All are
/// real-time: no heap, no exceptions; what is not finite counts as not known. The thresholds are
/// proposals that a therapist has to confirm; the numbering A1 to A9 is that of docs/tissue.md.

/// A1. The peak of the next probing press, of a second: rising until the tissue shows its bend at
/// 2.5 alpha, never above half of what the region allows.
[[nodiscard]] double probing_force_n(const TissueEstimate& estimate, double region_cap_n) noexcept;
/// A1. Two presses at least, and either the bend was reached or the region allows no more.
[[nodiscard]] bool probed_enough(const TissueEstimate& estimate, double peak_force_n,
                                 double region_cap_n) noexcept;

/// A2. Whether an estimate may change anything at all: converged, and the law describes the tissue.
[[nodiscard]] bool may_steer(const TissueEstimate& estimate, double chi) noexcept;
/// A2. The half of it: the law describes the tissue, how well it may be known.
[[nodiscard]] bool follows_law(const TissueEstimate& estimate, double chi) noexcept;

/// A3. The least the region allows and three times the smallest alpha believed: beyond, the tissue
/// is compressed, not massaged. Unknown tissue gets the half of the region's cap.
[[nodiscard]] double force_cap_n(const TissueEstimate& estimate, double chi,
                                 double region_cap_n) noexcept;
/// A3. The deepest indentation, four fifths of the way to the pole of the stiffest beta believed;
/// infinite while nothing is known.
[[nodiscard]] double depth_cap_m(const TissueEstimate& estimate, double chi) noexcept;

/// A4. Where the tool must go for a force, along the inward normal on the axis of the estimate's
/// samples; the torso beneath gives way too (0 or infinity: it does not). A feed-forward only: on
/// bone at 20 N a tenth of a millimetre is two newtons.
[[nodiscard]] double position_for_force_m(const TissueEstimate& estimate, double force_n,
                                          double torso_n_per_m) noexcept;

/// A5. Stiffness and damping of the robot from the tangent stiffness of the tissue at the working
/// force, not from its class: half as stiff, damped for 0.7 together.
struct ContactImpedance {
  double stiffness_n_per_m = 200.0;
  double damping_n_s_per_m = 0.0;
};
[[nodiscard]] ContactImpedance impedance_for(double tissue_n_per_m, double mass_kg) noexcept;
/// A5. One step from a stiffness towards a wanted one: low-pass of a second, at most a fifth per
/// second, so that what the springs hold is not pumped up.
[[nodiscard]] double eased_stiffness(double now_n_per_m, double wanted_n_per_m,
                                     double dt_s) noexcept;

/// A6. Share of impedance against admittance control, 0 on tissue of 2 N/mm and softer, 1 from 15
/// N/mm on, following Ott's hybrid. It moves only when the wish differs by a tenth, a third of a
/// second after the last change, and while the tool is slow, so it cannot chatter.
class ControlShare {
 public:
  double step(double tissue_n_per_m, double tool_speed_m_per_s, double dt_s) noexcept;
  [[nodiscard]] double share() const noexcept { return share_; }

 private:
  double share_ = 0.0, since_s_ = 1.0;
};

/// A7. How one set of six presses found the place: the logarithm of its tangent stiffness at one
/// and the same force, and the standard deviation of that.
struct PressSet {
  double log_stiffness = 0.0;
  double sd = 0.0;
};
/// The smallest change between two sets that can be told from noise at 95 %.
[[nodiscard]] double detectable_change(const PressSet& a, const PressSet& b) noexcept;
/// A7. Go on with this place, or why not: a tenth softer than at first; twice no change that could
/// be told from noise; a minute and a half gone. "No change" is an honest end.
enum class Dwell : std::uint8_t { go_on, softened, no_change, time_up };
[[nodiscard]] const char* name_of(Dwell dwell) noexcept;
[[nodiscard]] Dwell dwell_after(std::span<const PressSet> sets, double elapsed_s) noexcept;

/// A8. What suits a place, relative to this person: mean logarithm of stiffness at the reference
/// force, and median beta, over the places felt so far.
struct PersonMean {
  double log_stiffness = 0.0;
  double median_beta_per_m = 0.0;
};
struct TechniqueAdvice {
  Technique technique = Technique::stroke;
  double force_n = 0.0;
  bool known = false;  ///< false: keep to the plan, and gently
};
/// Much stiffer than the person's mean, but not a thin layer over bone: slow pressing, a fifth
/// harder. A thin layer: stroking with 10 N at most. Else rubbing. All below the cap of A3.
[[nodiscard]] TechniqueAdvice technique_for(const TissueEstimate& estimate, double chi,
                                            const PersonMean& person, double reference_force_n,
                                            double region_cap_n) noexcept;

/// A9. What should make a robot let go (at `letting_go_n_per_s`) and ask.
enum class Alarm : std::uint8_t { none, guarding, moved, misfit };
[[nodiscard]] const char* name_of(Alarm alarm) noexcept;
inline constexpr double letting_go_n_per_s = 100.0;
/// A9. The tissue now against the tissue at first, at one force: a quarter more alpha or tangent
/// stiffness, beyond what both intervals explain, means that the person tenses; skin more than 3 mm
/// elsewhere, that the person moved. `now` comes from an estimator of its own for the last press.
[[nodiscard]] Alarm compare(const TissueEstimate& reference, const TissueEstimate& now,
                            double force_n) noexcept;

/// A9. Force that the tissue does not explain: beyond five standard deviations for 50 ms.
class MisfitWatch {
 public:
  [[nodiscard]] Alarm step(double residual_n, double sd_n, double dt_s) noexcept;

 private:
  double beyond_s_ = 0.0;
};

}  // namespace tuina::tissue
