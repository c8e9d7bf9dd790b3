// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/acupoint_file.hpp"

#include <fmt/ranges.h>

#include <cmath>
#include <string>

#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/record/shared_fields.hpp"

namespace tuina::record {
namespace {

constexpr auto places_fields = [](auto& visit, auto& acupoints, auto& landmarks) {
  visit.named("acupoints", acupoints, [](auto& all, const char* name, auto& point) {
    all.object(name, [&](auto& inside) { acupoint_fields(inside, point); });
  });
  if (!visit.has("landmarks")) return;
  visit.named("landmarks", landmarks,
              [](auto& all, const char* name, auto& landmark) { all(name, landmark.at_in_couch); });
};

constexpr auto map_fields = [](auto& visit, auto& map) {
  const body::Mapping& mapping = map.mapping;
  visit("method", mapping.method);
  visit("position", mapping.position);
  visit("arms", mapping.arms);
  visit("compute_ms", map.compute_ms);
  visit("points", map.points);
  visit("dropped_points", map.dropped_points);
  visit("seen_percent", mapping.coverage, percent);
  visit("misfit_mm", mapping.rms_residual_m, mm);
  visit("strangeness", mapping.mahalanobis2_per_mode);
  places_fields(visit, mapping.acupoints, mapping.landmarks);
  if (mapping.fixed.empty()) return;
  visit.named("fixed", mapping.fixed, [](auto& all, const char* name, auto& point) {
    all.object(name, [&](auto& inside) {
      inside("position_m", point.at_in_couch);
      inside("error_mm", point.error_m, mm);
    });
  });
};

/// What of it is read again: other hands may have written it, with no more than the points.
constexpr auto back_fields = [](auto& visit, auto& back) {
  if (visit.has("position")) visit("position", back.position);
  places_fields(visit, back.acupoints, back.landmarks);
};

/// Refuses a place that is not on the couch, as millimetres for metres would put it.
Result<void> check_place(const Vector3& at_in_couch, std::string_view where) {
  constexpr double furthest_m = 10.0;
  const double away_m = at_in_couch.cwiseAbs().maxCoeff();
  if (away_m <= furthest_m) return {};
  return fail(Fault::bad_input, "{} lies {:.0f} m from the couch; metres are needed", where,
              away_m);
}

Result<void> check_acupoint(const Acupoint& point, std::string_view where) {
  if (auto good = check_place(point.at_in_couch, fmt::format("{}.position_m", where)); !good)
    return good;
  constexpr double rounding = 0.01;  // a file may carry two or three digits
  const double length = point.normal_in_couch.norm();
  if (!(std::abs(length - 1.0) <= rounding))
    return fail(Fault::bad_input, "{}.normal has length {:.3f}, 1 is needed", where, length);
  if (!(point.uncertainty_m >= 0.0 && point.uncertainty_m <= 1.0))
    return fail(Fault::bad_input, "{}.uncertainty_mm is not a number from 0 to 1000", where);
  return {};
}

}  // namespace

Result<MappedBack> parse_acupoints(std::string_view text, std::string_view name) {
  auto back = parse_json<MappedBack>(text, name, "answer of `tuina map`", back_fields);
  if (!back) return back;
  std::vector<std::string> missing(seven_acupoints.begin(), seven_acupoints.end());
  for (Acupoint& point : back->acupoints) {
    const auto good = check_acupoint(point, fmt::format("{}: acupoints.{}", name, point.name));
    if (!good) return tl::unexpected(good.error());
    point.normal_in_couch.normalize();
    std::erase(missing, point.name);
  }
  if (!missing.empty()) {
    return fail(Fault::bad_input, "{}: acupoints lacks {}; all seven of the thesis are needed",
                name, fmt::join(missing, ", "));
  }
  for (const Landmark& landmark : back->landmarks) {
    const auto good =
        check_place(landmark.at_in_couch, fmt::format("{}: landmarks.{}", name, landmark.name));
    if (!good) return tl::unexpected(good.error());
  }
  return back;
}

Result<MappedBack> read_acupoints(const std::filesystem::path& file) {
  constexpr std::size_t max_bytes = 1 << 24;
  const auto text = read_file(file, max_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_acupoints(*text, file.string());
}

std::string to_json(const MapFile& map) {
  return to_json(map, map_fields).dump(2);
}

}  // namespace tuina::record
