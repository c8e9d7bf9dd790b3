// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/acupoints/marked_people.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/evaluation/acupoints/scores.hpp"
#include "tuina/body/acupoints.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/json_fault.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

using nlohmann::json;

constexpr std::array<std::string_view, 5> midline = {"GV14", "GV12", "GV9", "GV6", "GV4"};
constexpr double max_spread_mm = 15.0;
constexpr double upright_deg = 10.0;
constexpr double min_wrong_m = 15_mm;  // what therapists and skin over bones scatter by

Result<MarkedPerson> read_marked(const std::filesystem::path& ply) {
  std::filesystem::path beside = ply;
  beside.replace_extension(".json");
  const auto text = read_file(beside);
  if (!text) return tl::unexpected(text.error());
  auto scan = read_surface(ply);
  if (!scan) return tl::unexpected(scan.error());
  MarkedPerson person{.id = ply.stem().string(), .scan_in_couch = std::move(scan->cloud)};
  try {
    const json marks = json::parse(*text);
    for (const json& at : marks.at("spinous_line")) {
      person.spinous_line_in_couch.emplace_back(at.at(0).get<double>(), at.at(1).get<double>(),
                                                at.at(2).get<double>());
    }
    person.gv4_z_m = marks.contains("L2L3_disc_z") ? marks.at("L2L3_disc_z").get<double>()
                                                   : marks.at("GV4_z_expected").get<double>();
    person.gv4_z_known = marks.value("registration_spread_mm", 0.0) <= max_spread_mm;
    const bool bent = std::abs(marks.value("bend_deg", 0.0)) > upright_deg;
    person.group = person.id.substr(0, person.id.find('_')) + (bent ? ", bent" : "");
  } catch (const json::exception& e) {
    return tl::unexpected(
        json_fault(e, *text, beside.string(), "the marks of a person: spinous_line and a height"));
  }
  if (person.spinous_line_in_couch.empty()) {
    return fail(Fault::bad_input, "{}: spinous_line has no points", beside.string());
  }
  return person;
}

double distance_m(const Vector3& from, const std::vector<Vector3>& line) {
  double least = std::numeric_limits<double>::max();
  for (const Vector3& at : line) least = std::min(least, (at - from).norm());
  return least;
}

/// Sums over the answered people of one group.
struct Group {
  int people = 0;
  int answered = 0;
  std::vector<double> along_mm, across_mm;
  int inside = 0;
  json wrong_and_sure = json::array();
  json refused = json::array();

  void add(const MarkedPerson& person, const Result<body::Mapping>& found) {
    ++people;
    if (!found) {
      refused.push_back(fmt::format("{}: {}", person.id, found.error().message));
      return;
    }
    ++answered;
    for (const Acupoint& point : found->acupoints) {
      if (std::find(midline.begin(), midline.end(), point.name) == midline.end()) continue;
      const double across_m = distance_m(point.at_in_couch, person.spinous_line_in_couch);
      if (across_m > std::max(point.uncertainty_m, min_wrong_m)) {
        wrong_and_sure.push_back(fmt::format("{}: {} is {:.0f} mm off, {:.0f} said", person.id,
                                             point.name, to_mm(across_m),
                                             to_mm(point.uncertainty_m)));
      }
      if (point.name != "GV4") continue;
      across_mm.push_back(to_mm(across_m));
      if (!person.gv4_z_known) continue;
      const double along_m = point.at_in_couch.z() - person.gv4_z_m;
      along_mm.push_back(to_mm(along_m));
      if (std::hypot(along_m, across_m) <= point.uncertainty_m) ++inside;
    }
  }
};

std::optional<double> mean_of(const std::vector<double>& values, int power) {
  if (values.empty()) return std::nullopt;
  double sum = 0.0;
  for (const double value : values) sum += std::pow(value, power);
  return sum / static_cast<double>(values.size());
}

json number(std::optional<double> value) {
  return value ? json(*value) : json();
}

json to_json(const Group& group) {
  const auto rms = [](const std::vector<double>& values) {
    const auto square = mean_of(values, 2);
    return square ? json(std::sqrt(*square)) : json();
  };
  return {{"people", group.people},
          {"answered", group.answered},
          {"along_bias_mm", number(mean_of(group.along_mm, 1))},
          {"along_rms_mm", rms(group.along_mm)},
          {"across_rms_mm", rms(group.across_mm)},
          {"heights_judged", group.along_mm.size()},
          {"coverage", group.along_mm.empty()
                           ? json()
                           : json(group.inside / static_cast<double>(group.along_mm.size()))},
          {"wrong_and_sure", group.wrong_and_sure},
          {"refused", group.refused}};
}

}  // namespace

Result<std::vector<MarkedPerson>> read_marked_people(const std::filesystem::path& folder) {
  const auto files = body::list_labelled_bodies(folder);
  if (!files) return tl::unexpected(files.error());
  std::vector<MarkedPerson> people;
  for (const auto& file : *files) {
    auto person = read_marked(file);
    if (!person) return tl::unexpected(person.error());
    people.push_back(std::move(*person));
  }
  return people;
}

json judge_marked_people(const std::vector<MarkedPerson>& people, const body::Atlas& atlas,
                         const Progress& progress) {
  std::map<std::string, Group> groups;
  for (std::size_t i = 0; i < people.size(); ++i) {
    const auto back = body::fit_back(people[i].scan_in_couch, {.position = BodyPosture::sitting});
    groups[people[i].group].add(
        people[i], back ? body::locate_acupoints(*back, atlas) : tl::unexpected(back.error()));
    if (progress) progress(static_cast<double>(i + 1) / static_cast<double>(people.size()));
  }
  json judged = json::object();
  for (const auto& [name, group] : groups) judged[name] = to_json(group);
  return judged;
}

std::string marked_people_text(const json& judged) {
  telemetry::Table table{.note = "GV4 against the spine that was felt or X-rayed, mm",
                         .columns = {{.head = "people"}, {.head = "answered"}, {.head = "of"}}};
  for (const char* head : {"along: bias", "along: RMS", "across: RMS"})
    table.columns.push_back({.head = head, .digits = 1});
  table.columns.push_back({.head = "within the radius, %", .digits = 0});
  table.columns.push_back({.head = "wrong and sure"});
  std::string remarks;
  for (const auto& [name, group] : judged.items()) {
    table.add({name, group["answered"].get<int>(), group["people"].get<int>(),
               number_in(group, "along_bias_mm"), number_in(group, "along_rms_mm"),
               number_in(group, "across_rms_mm"), number_in(group, "coverage", 100.0),
               group["wrong_and_sure"].size()});
    for (const char* list : {"wrong_and_sure", "refused"}) {
      for (const json& remark : group[list]) remarks += remark.get<std::string>() + "\n";
    }
  }
  std::string text = to_text(table) + remarks;
  while (text.ends_with('\n')) text.pop_back();
  return text;
}

}  // namespace tuina::app
