// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/known_bodies.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/check/check_box.hpp"
#include "tuina/scanner/check/check_sphere.hpp"

namespace tuina::app {
namespace {

// "150x150x200mm" or "150x150x200", millimetres in both cases.
Result<Vector3> box_size(const std::string& text) {
  Vector3 size_m = Vector3::Zero();
  std::string_view rest = text;
  if (rest.ends_with("mm")) rest.remove_suffix(2);
  bool good = true;
  for (Eigen::Index k = 0; good && k < 3; ++k) {
    const std::size_t cross = k < 2 ? rest.find('x') : rest.size();
    const auto edge_mm = to_number<double>(rest.substr(0, cross));
    good = cross != std::string_view::npos && edge_mm && *edge_mm >= 20.0 && *edge_mm <= 1000.0;
    if (!good) break;
    size_m(k) = from_mm(*edge_mm);
    rest.remove_prefix(std::min(rest.size(), cross + 1));
  }
  if (!good) {
    return fail(Fault::usage,
                "--check-box {}: three edges from 20 to 1000 mm are needed, as 150x150x200mm",
                text);
  }
  return size_m;
}

nlohmann::json json_of(const scanner::FoundBox& box) {
  nlohmann::json json{{"flatness_mm", to_mm(box.flatness_m)},
                      {"border_mm", to_mm(box.border_m)},
                      {"points", box.points}};
  for (const double edge_m : box.edges_m) json["edges_mm"].push_back(to_mm(edge_m));
  for (const double angle_rad : box.angles_rad) json["angles_deg"].push_back(to_deg(angle_rad));
  return json;
}

}  // namespace

void KnownBodies::describe(Options& options) {
  options
      .add("--check-sphere", ball_mm_,
           "a ball of this diameter in mm is in the scene; refuse a scan that shows it "
           "hollow or of another size")
      .between(20.0, 1000.0);
  options.add(
      "--check-box", box_,
      "a box of this size, as 150x150x200mm, is in the scene, two or three faces in view; refuse "
      "a scan that shows it of another size or askew");
}

Result<void> KnownBodies::begin() {
  if (box_.empty()) return {};
  const auto size_m = box_size(box_);
  if (!size_m) return tl::unexpected(size_m.error());
  box_m_ = *size_m;
  return {};
}

Result<void> KnownBodies::check(const PointCloud& cloud, nlohmann::json& json,
                                std::string& text) const {
  if (ball_mm_ > 0.0) {
    const auto ball = scanner::check_sphere(cloud, from_mm(ball_mm_));
    if (!ball) return tl::unexpected(ball.error());
    json["sphere"] = {{"diameter_mm", to_mm(ball->diameter_m)},
                      {"rms_mm", to_mm(ball->rms_m)},
                      {"points", ball->points}};
    text +=
        fmt::format("; the ball of {} mm measures {:.2f} mm", ball_mm_, to_mm(ball->diameter_m));
  }
  if (!box_.empty()) {
    const auto box = scanner::check_box(cloud, box_m_);
    if (!box) return tl::unexpected(box.error());
    json["box"] = json_of(*box);
    text += fmt::format("; the box of {} measures {:.1f} x {:.1f} x {:.1f} mm", box_,
                        to_mm(box->edges_m[0]), to_mm(box->edges_m[1]), to_mm(box->edges_m[2]));
  }
  return {};
}

}  // namespace tuina::app
