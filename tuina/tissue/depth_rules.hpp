// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "tuina/core/contact.hpp"

namespace tuina::tissue {

/// Rules from what was felt to massage parameters. They only lower what was ordered (`ordered_n`)
/// and what the body zone allows (`region_cap_n`). Real-time: no heap, no exceptions; non-finite
/// input counts as unknown. The thresholds are proposals for a therapist to confirm; numbers and
/// names of rules are those of docs/tissue.md. A5 and A6 are for experiments only (there it stands
/// why); A8 is in session/steering.cpp.

/// A1. Peak force of the next probing press, N. The first one has 8 N. Later ones have 2.5 alpha,
/// the bend of the curve, where alpha and beta can be told apart; but at least 0.7 of what was
/// ordered, since from there the rest is foretold. Half of the region's cap, or 7 N where that is
/// more, bounds the 8 N and the 2.5 alpha; the cap and the order bound all.
[[nodiscard]] double probing_force_n(const TissueEstimate& estimate, double ordered_n,
                                     double region_cap_n) noexcept;
/// A1. True after two presses if the last had at least 0.9 of the force that the next would have.
[[nodiscard]] bool probed_enough(const TissueEstimate& estimate, double peak_force_n,
                                 double ordered_n, double region_cap_n) noexcept;

/// A2. What the presses of a place say of the next one.
enum class Foretold : std::uint8_t {
  well,     ///< its force is foretold to `well_foretold_share`
  loosely,  ///< the band is wider than that
  wrongly,  ///< the last press came otherwise than foretold: the person tenses, or the tool slips
};
/// A2. The most that the next press may ask for: whatever the zone allows where it is well
/// foretold; else twice the strongest that this place has felt; and no more than that one after a
/// press that came otherwise.
[[nodiscard]] double firmest_next_n(Foretold foretold, double strongest_n,
                                    double region_cap_n) noexcept;
/// True when an estimate may be reasoned with: converged, and its law fits.
[[nodiscard]] bool may_steer(const TissueEstimate& estimate, double nis) noexcept;
/// True when the law fits, converged or not.
[[nodiscard]] bool follows_law(const TissueEstimate& estimate, double nis) noexcept;

/// A5. Robot impedance from the tangent stiffness of the tissue at the working force: half as
/// stiff, damping ratio 0.7 together.
struct ContactImpedance {
  double stiffness_n_per_m = 200.0;
  double damping_n_s_per_m = 0.0;
};
/// For tissue of that stiffness before an arm that is felt as so heavy; 200 N/m at least, 3000 at
/// most.
[[nodiscard]] ContactImpedance impedance_for(double tissue_n_per_m, double mass_kg) noexcept;
/// A6. Share of impedance against admittance control after Ott's hybrid: 0 on tissue up to 2 N/mm,
/// 1 from 15 N/mm. To avoid chatter it changes only when the wanted share differs by a tenth, a
/// third of a second after the last change, and while the tool is slow.
class ControlShare {
 public:
  /// The share for this millisecond, 0 to 1.
  double step(double tissue_n_per_m, double tool_speed_m_per_s, double dt_s) noexcept;
  [[nodiscard]] double share() const noexcept { return share_; }  ///< as of the last step

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
/// @{
/// A sentence for people, and its key for who says it in another language.
[[nodiscard]] const char* name_of(Dwell dwell) noexcept;
[[nodiscard]] const char* key_of(Dwell dwell) noexcept;
/// @}
/// What the sets of presses at a place so far, and the time there, advise.
[[nodiscard]] Dwell dwell_after(std::span<const PressSet> sets, double elapsed_s) noexcept;

/// A9. Reasons to let go and ask the person.
enum class Alarm : std::uint8_t { none, guarding, moved };
/// @{
/// A sentence for people, and its key for who says it in another language.
[[nodiscard]] const char* name_of(Alarm alarm) noexcept;
[[nodiscard]] const char* key_of(Alarm alarm) noexcept;
/// @}
/// A9. Compares the tissue now with the reference at one force. Guarding: alpha or tangent
/// stiffness a quarter higher, beyond both intervals (the person tenses). Moved: the skin is more
/// than 3 mm away. `now` comes from a separate estimator of the last press.
[[nodiscard]] Alarm compare(const TissueEstimate& reference, const TissueEstimate& now,
                            double force_n) noexcept;

}  // namespace tuina::tissue
