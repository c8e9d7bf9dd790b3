// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "tuina/core/contact.hpp"

namespace tuina::tissue {

/// Rules from an estimate to massage parameters. They only lower what the body zone allows
/// (`region_cap_n`). Real-time: no heap, no exceptions; non-finite input counts as unknown. The
/// thresholds are proposals for a therapist to confirm; the numbers A1 to A9 are those of
/// docs/tissue.md.

/// A1. Peak force of the next probing press: rises until the force reaches the bend of the curve at
/// 2.5 alpha, at most half of the region's cap.
[[nodiscard]] double probing_force_n(const TissueEstimate& estimate, double region_cap_n) noexcept;
/// A1. True after two presses if the bend was reached or the cap allows no more.
[[nodiscard]] bool probed_enough(const TissueEstimate& estimate, double peak_force_n,
                                 double region_cap_n) noexcept;

/// A2. True when an estimate may change the massage: converged, and the tangent law fits.
[[nodiscard]] bool may_steer(const TissueEstimate& estimate, double nis) noexcept;
/// A2. True when the tangent law fits, converged or not.
[[nodiscard]] bool follows_law(const TissueEstimate& estimate, double nis) noexcept;

/// A3. Minimum of the region's cap and three times the lower bound of alpha: beyond that the tissue
/// is compressed, not massaged. Unknown tissue gets half the cap.
[[nodiscard]] double force_cap_n(const TissueEstimate& estimate, double nis,
                                 double region_cap_n) noexcept;
/// A5. Robot impedance from the tangent stiffness of the tissue at the working force: half as
/// stiff, damping ratio 0.7 together.
struct ContactImpedance {
  double stiffness_n_per_m = 200.0;
  double damping_n_s_per_m = 0.0;
};
[[nodiscard]] ContactImpedance impedance_for(double tissue_n_per_m, double mass_kg) noexcept;
/// A6. Share of impedance against admittance control after Ott's hybrid: 0 on tissue up to 2 N/mm,
/// 1 from 15 N/mm. To avoid chatter it changes only when the wanted share differs by a tenth, a
/// third of a second after the last change, and while the tool is slow.
class ControlShare {
 public:
  double step(double tissue_n_per_m, double tool_speed_m_per_s, double dt_s) noexcept;
  [[nodiscard]] double share() const noexcept { return share_; }

 private:
  double share_ = 0.0, since_s_ = 1.0;
};

/// A7. Result of one set of six presses: log tangent stiffness at a common force, and its standard
/// deviation.
struct PressSet {
  double log_stiffness = 0.0;
  double sd = 0.0;
};
/// Smallest change between two sets that is significant at 95 %.
[[nodiscard]] double detectable_change(const PressSet& a, const PressSet& b) noexcept;
/// A7. Continue at this place, or stop because it is a tenth softer, twice without a significant
/// change, or after a minute and a half. "No change" is an honest end.
enum class Dwell : std::uint8_t { go_on, softened, no_change, time_up };
[[nodiscard]] const char* name_of(Dwell dwell) noexcept;
[[nodiscard]] Dwell dwell_after(std::span<const PressSet> sets, double elapsed_s) noexcept;

/// A8. Mean log stiffness at the reference force and median beta over all places of the person.
struct PersonMean {
  double log_stiffness = 0.0;
  double median_beta_per_m = 0.0;
};
struct TechniqueAdvice {
  Technique technique = Technique::stroke;
  double force_n = 0.0;
  bool known = false;  ///< false: keep to the plan, gently
};
/// A8. Much stiffer than the person's mean and not a thin layer over bone: slow pressing, a fifth
/// harder. Thin layer: stroking with 10 N at most. Else rubbing. All below the cap of A3.
[[nodiscard]] TechniqueAdvice technique_for(const TissueEstimate& estimate, double nis,
                                            const PersonMean& person, double reference_force_n,
                                            double region_cap_n) noexcept;

/// A9. Reasons to let go and ask the person.
enum class Alarm : std::uint8_t { none, guarding, moved };
[[nodiscard]] const char* name_of(Alarm alarm) noexcept;
/// A9. Compares the tissue now with the reference at one force. Guarding: alpha or tangent
/// stiffness a quarter higher, beyond both intervals (the person tenses). Moved: the skin is more
/// than 3 mm away. `now` comes from a separate estimator of the last press.
[[nodiscard]] Alarm compare(const TissueEstimate& reference, const TissueEstimate& now,
                            double force_n) noexcept;

}  // namespace tuina::tissue
