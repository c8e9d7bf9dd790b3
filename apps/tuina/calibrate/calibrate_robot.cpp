// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/calibrate/calibrate_robot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/session/robot_pose.hpp"
#include "tuina/sim/person/person.hpp"
#include "tuina/sim/robot/robot_touches.hpp"

namespace tuina::app {

namespace fs = std::filesystem;

namespace {

/// The option that names a robot, with a blank behind it; nothing of the usual one.
std::string option(const char* name, const std::string& robot) {
  return robot == "thesis" ? "" : fmt::format("{} {} ", name, robot);
}

}  // namespace

Result<Answer> calibrate_robot(const fs::path& folder, const std::string& robot,
                               BodyPosture position, const fs::path& out) {
  const auto model = robot::load_robot(robot);
  if (!model) return tl::unexpected(model.error());
  const robot::RobotPlacement there = robot::place_robot(*model, position);
  const robot::ArmTable& table = there.arm;
  const auto arms = robot::both_models(table, there.mount);
  const fs::path file = folder / "touches.csv";
  const auto touches = session::read_touches(file, table);
  if (!touches) return tl::unexpected(touches.error());
  const auto pose = session::locate_robot(*touches, arms);
  if (!pose) return fail(pose.error().fault, "{}: {}", file.string(), pose.error().message);
  const session::PlacedRobot placed{
      .robot = robot, .position = position, .base_from_couch = pose->base_from_couch};
  if (const auto written = write_file(out, session::to_toml(placed)); !written) {
    return tl::unexpected(written.error());
  }

  // What it means for a massage: the points of somebody of medium build.
  const auto person = sim::parse_person("phantom:medium", position, 1);
  if (!person) return tl::unexpected(person.error());
  nlohmann::json expected = nlohmann::json::object();
  double max_mm = 0.0;
  for (const Acupoint& point : person->acupoints) {
    const double error_mm = to_mm(pose->expected_error_m(point.at_in_couch));
    expected[point.name] = error_mm;
    max_mm = std::max(max_mm, error_mm);
  }
  auto residuals = nlohmann::json::array();
  double sum2 = 0.0;
  for (const double residual_m : pose->residual_m) {
    residuals.push_back(to_mm(residual_m));
    sum2 += residual_m * residual_m;
  }
  const double rms_mm = to_mm(std::sqrt(sum2 / static_cast<double>(pose->residual_m.size())));
  return Answer{.json = nlohmann::json{{"touches", touches->size()},
                                       {"residual_rms_mm", rms_mm},
                                       {"residuals_mm", residuals},
                                       {"expected_error_mm", expected}}
                            .dump(2),
                .text = fmt::format(
                    "{} touches agree to {:.1f} mm; an acupoint is expected to be off by {:.1f} mm "
                    "or less for this\nnow: tuina massage {}--robot-pose {}",
                    touches->size(), rms_mm, max_mm, option("--robot", robot), out.string())};
}

Result<Answer> rehearse_robot(const fs::path& folder, const std::string& robot,
                              BodyPosture position, std::uint64_t seed) {
  const auto model = robot::load_robot(robot);
  if (!model) return tl::unexpected(model.error());
  const robot::RobotPlacement there = robot::place_robot(*model, position);
  std::error_code fault;
  if (!fs::create_directory(folder, fault)) {
    return fail(Fault::file, "{}: {}", folder.string(),
                fault ? fault.message() : "there is such a folder already");
  }
  constexpr int rows = 3;
  const auto touches = sim::touch_board(there.arm, there.mount, position, rows, {}, seed);
  if (!touches) return tl::unexpected(touches.error());
  const fs::path file = folder / "touches.csv";
  if (const auto written = write_file(file, session::to_csv(*touches)); !written) {
    return tl::unexpected(written.error());
  }
  return Answer{
      .json = nlohmann::json{{"folder", folder.string()}, {"touches", touches->size()}}.dump(2),
      .text = fmt::format("{}: {} touches; now: tuina calibrate {} --robot {}--position {} "
                          "--out robot.toml",
                          file.string(), touches->size(), folder.string(), option("--arms", robot),
                          name_of(position))};
}

}  // namespace tuina::app
