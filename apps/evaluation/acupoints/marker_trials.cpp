// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/acupoints/marker_trials.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/cli/mark_names.hpp"
#include "apps/evaluation/acupoints/scores.hpp"
#include "tuina/body/marks/bumps.hpp"
#include "tuina/body/palpation.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

using nlohmann::json;

Result<std::vector<std::filesystem::path>> scans_of(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> scans;
  std::error_code fault;
  for (const auto& entry : std::filesystem::directory_iterator(folder, fault)) {
    if (entry.path().extension() == ".ply") scans.push_back(entry.path());
  }
  if (fault) return fail(Fault::file, "{}: there is no such folder", folder.string());
  if (scans.empty()) return fail(Fault::file, "{}: no scan (NAME.ply) in it", folder.string());
  std::sort(scans.begin(), scans.end());
  return scans;
}

std::vector<std::string> names_of(const MarkGroup& labels) {
  std::vector<std::string> names;
  for (const auto& level : labels.levels) names.insert(names.end(), level.begin(), level.end());
  return names;
}

json at_mm(const Vector3& place) {
  return {to_mm(place.x()), to_mm(place.y()), to_mm(place.z())};
}

/// Places and 95 % radii of acupoints and landmarks.
std::map<std::string, std::pair<Vector3, double>> places_of(const body::Mapping& mapping) {
  std::map<std::string, std::pair<Vector3, double>> places;
  for (const Acupoint& point : mapping.acupoints)
    places[point.name] = {point.at_in_couch, point.uncertainty_m};
  auto row = static_cast<Eigen::Index>(3 * mapping.acupoints.size());
  for (const Landmark& landmark : mapping.landmarks) {
    places[landmark.name] = {landmark.at_in_couch,
                             body::radius95_of(mapping.covariance_m2.block<3, 3>(row, row))};
    row += 3;
  }
  return places;
}

/// Errors at the markers of one person, by label.
Result<json> judge_person(const PointCloud& scan_in_couch, const MarkGroup& labels,
                          const body::Atlas& atlas) {
  const auto back = body::fit_back(scan_in_couch);
  if (!back) return tl::unexpected(back.error());
  const auto found = body::locate_acupoints(*back, atlas);
  if (!found) return tl::unexpected(found.error());
  const auto bumps = body::find_bumps(scan_in_couch, *back);
  if (!bumps) return tl::unexpected(bumps.error());
  std::vector<SkinMark> marks;
  for (const body::Bump& bump : *bumps) marks.push_back({labels.kind, bump.at_in_couch});
  // How far the atlas is off is what is judged, so that it refuses nobody.
  const auto named = name_marks(marks, {labels}, *found, std::numeric_limits<double>::infinity());
  if (!named) return tl::unexpected(named.error());
  const auto places = places_of(*found);
  json judged = json::object();
  for (const auto& [name, mark] : *named) {
    const auto& [place, radius_m] = places.at(name);
    const Vector3& marker = marks[mark].at_in_couch;
    judged[name] = {{"marker_mm", at_mm(marker)},
                    {"found_mm", at_mm(place)},
                    {"off_mm", to_mm((marker - place).norm())},
                    {"radius_mm", to_mm(radius_m)}};
  }
  return judged;
}

}  // namespace

Result<json> judge_markers(const std::filesystem::path& folder, const MarkGroup& labels,
                           const body::Atlas& atlas, const Progress& progress) {
  const auto scans = scans_of(folder);
  if (!scans) return tl::unexpected(scans.error());
  json people = json::object();
  json refused = json::array();
  for (std::size_t i = 0; i < scans->size(); ++i) {
    const std::string id = (*scans)[i].stem().string();
    const auto scan = read_surface((*scans)[i]);
    auto judged = scan ? judge_person(scan->cloud, labels, atlas)
                       : Result<json>(tl::unexpected(scan.error()));
    if (judged)
      people[id] = std::move(*judged);
    else
      refused.push_back(scan ? fmt::format("{}: {}", id, judged.error().message)
                             : judged.error().message);
    if (progress) progress(static_cast<double>(i + 1) / static_cast<double>(scans->size()));
  }
  json points = json::object();
  for (const std::string& name : names_of(labels)) {
    double sum_mm = 0.0, max_mm = 0.0;
    int marked = 0, within = 0;
    for (const json& person : people) {
      const json& mark = person.at(name);
      const double off_mm = mark["off_mm"];
      ++marked;
      sum_mm += off_mm;
      max_mm = std::max(max_mm, off_mm);
      within += off_mm <= mark["radius_mm"] ? 1 : 0;
    }
    if (marked == 0) continue;
    points[name] = {{"marked", marked},
                    {"mean_mm", sum_mm / marked},
                    {"max_mm", max_mm},
                    {"coverage", static_cast<double>(within) / marked}};
  }
  return json{{"scans", scans->size()},
              {"judged", people.size()},
              {"points", points},
              {"people", people},
              {"refused", refused}};
}

std::string markers_text(const json& judged) {
  telemetry::Table table{.note = "the shipped atlas against the markers on the skin, mm",
                         .columns = {{.head = "point"},
                                     {.head = "marked"},
                                     {.head = "mean", .digits = 1},
                                     {.head = "largest", .digits = 1},
                                     {.head = "within the radius, %", .digits = 0}}};
  for (const auto& [name, row] : judged["points"].items())
    table.add({name, row["marked"].get<int>(), number_in(row, "mean_mm"), number_in(row, "max_mm"),
               number_in(row, "coverage", 100.0)});
  std::string text = judged["judged"] == 0 ? "nobody could be judged\n" : to_text(table);
  for (const json& remark : judged["refused"]) text += remark.get<std::string>() + "\n";
  while (text.ends_with('\n')) text.pop_back();
  return text;
}

}  // namespace tuina::app
