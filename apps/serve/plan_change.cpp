// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/plan_change.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace tuina::app {
namespace {

using nlohmann::json;

constexpr std::size_t max_places = 20, max_corners = 80, max_label_bytes = 40;
constexpr double max_coordinate_m = 5.0;

Result<Vector3> place_of(const json& numbers, const char* key) {
  Vector3 place = Vector3::Zero();
  bool whole = numbers.is_array() && numbers.size() == 3;
  for (std::size_t i = 0; whole && i < 3; ++i) {
    whole = numbers[i].is_number() && std::abs(numbers[i].get<double>()) <= max_coordinate_m;
    if (whole) place[static_cast<Eigen::Index>(i)] = numbers[i].get<double>();
  }
  if (!whole) {
    return fail(Fault::bad_input, "{}: a place is three numbers between {} and {} m", key,
                -max_coordinate_m, max_coordinate_m);
  }
  return place;
}

Result<std::string> name_in(const json& entry, const char* key) {
  const auto name = entry.is_object() ? entry.find("name") : entry.end();
  if (!entry.is_object() || name == entry.end() || !name->is_string() ||
      name->get_ref<const std::string&>().empty() ||
      name->get_ref<const std::string&>().size() > max_label_bytes) {
    return fail(Fault::bad_input, "{}: name is no text of 1 to {} bytes", key, max_label_bytes);
  }
  return name->get<std::string>();
}

Result<massage::NoGo> no_go_of(const json& entry) {
  auto name = name_in(entry, "no_go");
  if (!name) return tl::unexpected(name.error());
  const auto corners = entry.find("corners");
  if (corners == entry.end() || !corners->is_array() || corners->size() < 3 ||
      corners->size() > max_corners || entry.size() != 2) {
    return fail(Fault::bad_input, "no_go: has a name and 3 to {} corners", max_corners);
  }
  massage::NoGo area{.name = std::move(*name), .corners_in_couch = {}};
  for (const json& corner : *corners) {
    const auto place = place_of(corner, "no_go");
    if (!place) return tl::unexpected(place.error());
    area.corners_in_couch.push_back(*place);
  }
  return area;
}

Result<body::PalpatedPoint> fixed_of(const json& entry) {
  auto name = name_in(entry, "fixed");
  if (!name) return tl::unexpected(name.error());
  const auto at = entry.find("at");
  if (at == entry.end() || entry.size() != 2)
    return fail(Fault::bad_input, "fixed: has a name and at");
  const auto place = place_of(*at, "fixed");
  if (!place) return tl::unexpected(place.error());
  return body::PalpatedPoint{.name = std::move(*name), .at_in_couch = *place};
}

}  // namespace

Result<session::ByHand> parse_plan_change(std::string_view text) {
  const json object = json::parse(text, nullptr, false);
  if (!object.is_object() || object.size() != 2 || !object.contains("no_go") ||
      !object.contains("fixed")) {
    return fail(Fault::bad_input, "order: has no_go and fixed, two lists");
  }
  for (const char* key : {"no_go", "fixed"}) {
    if (!object[key].is_array() || object[key].size() > max_places)
      return fail(Fault::bad_input, "{}: is no list of at most {} entries", key, max_places);
  }
  session::ByHand wanted;
  for (const json& entry : object["no_go"]) {
    auto area = no_go_of(entry);
    if (!area) return tl::unexpected(area.error());
    wanted.no_go.push_back(std::move(*area));
  }
  for (const json& entry : object["fixed"]) {
    auto point = fixed_of(entry);
    if (!point) return tl::unexpected(point.error());
    wanted.fixed.push_back(std::move(*point));
  }
  return wanted;
}

std::string plan_change_json(const session::ByHand& by_hand) {
  const auto numbers = [](const Vector3& place) { return json{place.x(), place.y(), place.z()}; };
  json no_go = json::array(), fixed = json::array();
  for (const massage::NoGo& area : by_hand.no_go) {
    json corners = json::array();
    for (const Vector3& corner : area.corners_in_couch) corners.push_back(numbers(corner));
    no_go.push_back({{"name", area.name}, {"corners", std::move(corners)}});
  }
  for (const body::PalpatedPoint& point : by_hand.fixed)
    fixed.push_back({{"name", point.name}, {"at", numbers(point.at_in_couch)}});
  return json{{"no_go", std::move(no_go)}, {"fixed", std::move(fixed)}}.dump();
}

}  // namespace tuina::app
