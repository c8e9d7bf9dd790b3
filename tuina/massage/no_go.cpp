// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/no_go.hpp"

#include <fmt/format.h>

#include <cmath>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/toml_reader.hpp"

namespace tuina::massage {
namespace {

/// True where two sides of an outline cross: what lies between them would count as outside. Seen
/// along the axis of couch in which the outline is flattest, for skin is nearly flat there.
bool crosses_itself(const std::vector<Vector3>& corners) {
  Vector3 low = corners.front(), high = low;
  for (const Vector3& corner : corners) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  Eigen::Index flat = 0;
  (high - low).minCoeff(&flat);
  const Eigen::Index x = (flat + 1) % 3, y = (flat + 2) % 3;
  // Twice the area to the left of the line from a to b.
  const auto left_of = [&](const Vector3& a, const Vector3& b, const Vector3& at) {
    return (b[x] - a[x]) * (at[y] - a[y]) - (b[y] - a[y]) * (at[x] - a[x]);
  };
  const std::size_t n = corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3 &a = corners[i], &b = corners[(i + 1) % n];
    for (std::size_t k = i + 2; k < n; ++k) {
      if ((k + 1) % n == i) continue;  // neighbours share a corner
      const Vector3 &c = corners[k], &d = corners[(k + 1) % n];
      if (left_of(a, b, c) * left_of(a, b, d) < 0.0 && left_of(c, d, a) * left_of(c, d, b) < 0.0)
        return true;
    }
  }
  return false;
}

NoGo entry_of(const TomlTable& table) {
  constexpr double max_m = 3.0;  // a couch is smaller; millimetres are not
  table.only({"name", "corners_m"}, {}, "no_go");
  NoGo entry;
  entry.name = table.text("name").value_or("");
  if (entry.name.empty())
    table.reject("name", "a no_go needs a name in quotes, for the notes of the plan");
  const auto corners = table.list("corners_m");
  if (!corners || corners->size() < 3) {
    table.reject("corners_m",
                 "corners_m is not a list of three or more [x, y, z] in couch, metres");
    return entry;
  }
  for (const TomlValue& value : *corners) {
    const auto corner = value.numbers(3);
    const Vector3 at = corner ? Vector3((*corner)[0], (*corner)[1], (*corner)[2]) : Vector3::Zero();
    if (corner && at.cwiseAbs().maxCoeff() <= max_m) {
      entry.corners_in_couch.push_back(at);
    } else if (corner) {
      table.reject(value, fmt::format("the corner [{}, {}, {}] is not within {} m: it is in metres",
                                      at.x(), at.y(), at.z(), max_m));
    } else {
      table.reject(value, "a corner is not three numbers in metres");
    }
  }
  if (entry.corners_in_couch.size() == corners->size() && crosses_itself(entry.corners_in_couch))
    table.reject("corners_m", "sides of the outline cross; give its corners in their order");
  return entry;
}

}  // namespace

Result<std::vector<NoGo>> parse_no_go(std::string_view text, std::string_view name) {
  std::vector<NoGo> entries;
  const auto read = read_toml(text, name, Fault::config, [&](const TomlTable& root) {
    const auto tables = root.tables("no_go");
    if (tables.empty() || root.keys().size() != 1) {
      return root.reject("", "[[no_go]] entries are needed, and nothing else");
    }
    for (const TomlTable& table : tables) entries.push_back(entry_of(table));
  });
  if (!read) return tl::unexpected(read.error());
  return entries;
}

Result<std::vector<NoGo>> read_no_go(const std::filesystem::path& file) {
  constexpr std::size_t max_bytes = 1 << 20;
  const auto text = read_file(file, max_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_no_go(*text, file.string());
}

}  // namespace tuina::massage
