// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "tuina/massage/plan.hpp"
#include "tuina/massage/targets.hpp"
#include "tuina/massage/technique/rub.hpp"

namespace tuina::massage {

/// Lays one target after the other onto one person's skin, within what the zones bear, and keeps
/// account of the zones touched and of everything that could not be done as it was ordered.
class PathLayer {
 public:
  /// All but the factor on the forces must outlive it.
  PathLayer(const body::BackSurface& back, const BackChart& chart, const ZoneMap& zones,
            const PlanOptions& options, double force_scale);

  /// Nothing if the zones leave nothing of it, or the scan does not show the skin it needs.
  /// `pass_s`: time of one stroke where two hands stroke hand over hand; nothing elsewhere.
  [[nodiscard]] Result<std::optional<WaitingPath>> lay(const Part& part, const Target& target,
                                                       std::optional<double> pass_s = {});
  /// The time of one stroke for hands that stroke these lines hand over hand; nothing where that
  /// cannot be done, and the notes say why.
  [[nodiscard]] std::optional<double> hand_over_hand_s(const Part& part,
                                                       std::span<const Target> lines);

  /// Zones that a path so far has touched.
  [[nodiscard]] const std::set<Zone>& touched() const { return touched_; }
  /// Sentences for people: what was not done as ordered, and why.
  [[nodiscard]] const std::vector<Sentence>& notes() const { return notes_; }

 private:
  using MaybePath = Result<std::optional<WaitingPath>>;
  [[nodiscard]] MaybePath lay_standing(const Part& part, const Target& target);
  [[nodiscard]] MaybePath lay_sliding(const Part& part, const Target& target,
                                      std::optional<double> pass_s);
  [[nodiscard]] ContactPath pressed(const body::SurfacePoint& place, const Part& part, Zone zone,
                                    double force_n);
  [[nodiscard]] int repeats_of(const Part& part, double one_s, Zone zone);

  [[nodiscard]] Result<SurfaceCurve> circle(const Part& part, const Target& target,
                                            const Bend& bend) const;
  [[nodiscard]] Result<SurfaceCurve> line(const Part& part, const Target& target,
                                          const Bend& bend) const;
  [[nodiscard]] std::optional<Arm> arm_of(const Vector3& in_couch) const;
  [[nodiscard]] double cap_of(Technique technique, Zone zone, bool perhaps_spine) const;
  [[nodiscard]] WaitingPath waiting(const Part& part, Zone zone, bool perhaps_spine);
  [[nodiscard]] MaybePath left_out(Zone zone);
  template <typename... Args>
  void note(const char* key, fmt::format_string<Args...> words, const Args&... args);

  const body::BackSurface& back_;
  const BackChart& chart_;
  const ZoneMap& zones_;
  const PlanOptions& options_;
  double force_scale_;
  std::string name_;  // name of the path being laid
  std::set<Zone> touched_;
  std::vector<Sentence> notes_;
};

}  // namespace tuina::massage
