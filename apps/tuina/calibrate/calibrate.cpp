// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/calibrate.hpp"

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/tuina/calibrate/calibrate_capture.hpp"
#include "apps/tuina/calibrate/calibrate_robot.hpp"
#include "apps/tuina/calibrate/calibrate_wrist.hpp"
#include "apps/tuina/calibrate/report.hpp"
#include "apps/tuina/calibrate/wrist_poses.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/scanner/synthetic_shots.hpp"

namespace tuina::app {
namespace {

namespace fs = std::filesystem;
using calibration::Calibrated;
using calibration::Covariance;
using calibration::Views;

nlohmann::json or_null(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

nlohmann::json deviations_of(const Calibrated& result) {
  const Covariance& covariance = result.fit.covariance;
  const auto of = [&](int i) { return std::sqrt(covariance(i, i)); };
  const auto pair = [&](int i, int k) { return std::sqrt(covariance(i, i) + covariance(k, k)); };
  using namespace calibration;
  // The light plane is n / d: turning it moves it across itself, d scales it along.
  const Vector3& normal = result.calibration.laser_normal_in_camera;
  const double d = result.calibration.laser_distance_m;
  const Matrix3 light = covariance.block<3, 3>(light_x, light_x);
  const double along2 = normal.dot(light * normal);
  nlohmann::json json{{"fx_px", of(fx)},
                      {"fy_px", of(fy)},
                      {"cx_px", of(cx)},
                      {"cy_px", of(cy)},
                      {"distortion", {of(k1), of(k2), of(p1), of(p2), 0.0}},
                      {"laser_normal_deg", to_deg(std::abs(d) * std::sqrt(light.trace() - along2))},
                      {"laser_distance_mm", to_mm(d * d * std::sqrt(along2))},
                      {"axis_direction_deg", to_deg(pair(axis_tilt_1, axis_tilt_2))},
                      {"axis_point_mm", to_mm(pair(axis_shift_1, axis_shift_2))},
                      {"latency_ms", nullptr},
                      {"couch_height_mm", nullptr},
                      {"couch_tilt_deg", nullptr}};
  if (result.latency) json["latency_ms"] = 1e3 * result.latency->deviation_s;
  if (result.couch) {
    json["couch_height_mm"] = to_mm(result.couch->height_deviation_m);
    json["couch_tilt_deg"] = to_deg(result.couch->tilt_deviation_rad);
  }
  return json;
}

nlohmann::json json_of(const Calibrated& result, const Views& views) {
  nlohmann::json expected;
  nlohmann::json systematic;
  for (std::size_t i = 0; i < result.expected.size(); ++i) {
    const char* key = std::array{"at_0.65m", "at_1.0m", "at_1.75m"}[i];
    const auto& error = result.expected[i];
    expected[key] = or_null(error ? std::optional(to_mm(error->total_m())) : std::nullopt);
    systematic[key] = or_null(error ? std::optional(to_mm(error->systematic_m)) : std::nullopt);
  }
  auto residuals = nlohmann::json::array();
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    const auto& residual = result.fit.residuals[i];
    residuals.push_back(
        {{"frame", views.views[i].frame},
         {"pose", views.views[i].pose},
         {"yaw_deg", to_deg(views.views[i].yaw_rad)},
         {"distance_m", result.fit.geometry.camera_from_board[i].translation().z()},
         {"reprojection_px", residual.reprojection_px},
         {"line_points", residual.line_points},
         {"laser_rms_mm", residual.line_points > 0 ? nlohmann::json(to_mm(residual.line_m))
                                                   : nlohmann::json(nullptr)}});
  }
  return {{"reprojection_px", result.reprojection_px},
          {"laser_rms_mm", to_mm(result.laser_rms_m)},
          {"axis_rms_mm", to_mm(result.axis_rms_m)},
          {"latency_ms",
           or_null(result.latency ? std::optional(1e3 * result.latency->latency_s) : std::nullopt)},
          {"poses", result.poses},
          {"expected_error_mm", expected},
          {"systematic_error_mm", systematic},
          {"standard_deviations", deviations_of(result)},
          {"couch_measured", result.couch.has_value()},
          {"residuals", residuals},
          {"remarks", advice(result, views)}};
}

std::string text_of(const Calibrated& result, const Views& views) {
  std::string text =
      fmt::format("{} poses, corners {:.3f} px, laser line {:.2f} mm, axis {:.2f} mm", result.poses,
                  result.reprojection_px, to_mm(result.laser_rms_m), to_mm(result.axis_rms_m));
  if (result.latency) {
    text += fmt::format(", latency {:.1f} +- {:.1f} ms", 1e3 * result.latency->latency_s,
                        1e3 * result.latency->deviation_s);
  }
  text += "\nexpected range error:";
  for (std::size_t i = 0; i < result.expected.size(); ++i) {
    if (!result.expected[i]) continue;
    text +=
        fmt::format(" {:.2f} mm at {} m{}", to_mm(result.expected[i]->total_m()),
                    calibration::reported_depths_m[i], i + 1 < result.expected.size() ? "," : "");
  }
  for (const std::string& sentence : advice(result, views)) text += "\n" + sentence;
  return text;
}

/// Pictures of a board to a calibration, or such pictures to learn with.
class Calibrate final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "calibrate"; }
  [[nodiscard]] const char* summary() const override {
    return "camera, laser plane, yaw axis and latency of a scanner, from pictures of a board; "
           "or where the robot stands, from spots that it touched; or weight and zero at a wrist "
           "sensor";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina calibrate --rehearse shots        # photographs a board in simulation\n"
           "  tuina calibrate --capture shots --device device.toml  # takes the pictures\n"
           "  tuina calibrate shots --out calibration.toml\n"
           "  tuina calibrate --robot --rehearse touches      # a simulated robot touches a board\n"
           "  tuina calibrate touches --robot --out robot.toml\n"
           "  tuina calibrate --wrist poses.csv --out wrist.toml\n"
           "  tuina calibrate --wrist poses.csv --turn left --device device.toml --out wrist.toml";
  }
  void describe(Options& options) override {
    auto shots = options.add("shots", shots_, "the folder with the pictures, or with the touches");
    auto out = options.add("--out", out_, "what is found, as TOML");
    auto report =
        options.add("--report", report_,
                    "an HTML page: boards seen, how well each agrees, what to improve next");
    report.needs(out);
    auto robot = options.flag("--robot", robot_,
                              "the place of the robot instead, from touches.csv in the folder");
    robot.excludes(report);
    options
        .add("--position", position_,
             "with --robot and --turn: of the person for whom it stands there")
        .one_of({"sitting", "prone"})
        .show_default();
    options
        .add("--arms", arms_,
             "with --robot and --turn: whose arms touch or turn, a TOML file or " +
                 shipped_robot_names())
        .show_default();
    auto wrist = options.add(
        "--wrist", wrist_,
        "the weight of a tool, its centre and the offset of its force sensor instead, from "
        "this table of poses (docs/wrist_sensors.md)");
    wrist.excludes(shots).excludes(robot).excludes(report).needs(out);
    auto capture = options.add("--capture", capture_,
                               "take the pictures with a real scanner, into this folder, which has "
                               "board.toml; what to do is told picture by picture");
    capture.excludes(shots).excludes(out).excludes(robot);
    live_
        .describe(options,
                  "with --capture: show what the camera sees and what to do in a browser, too")
        .needs(capture);
    auto device = options.add("--device", device_,
                              "with --capture: the file that names camera and turntable; with "
                              "--turn: arms and wrist sensors");
    options
        .add("--turn", turn_,
             "with --wrist: this arm of the device file holds its tool in twelve ways, with nobody "
             "near, and the table is made of that")
        .one_of({"left", "right"})
        .needs(wrist)
        .needs(device);
    options.add("--poses", poses_, "with --capture: boards in the hand, a multiple of 12")
        .show_default()
        .needs(capture);
    auto rehearse =
        options.add("--rehearse", rehearse_,
                    "make such a set with the simulated scanner or robot, in this new folder");
    rehearse.excludes(shots).excludes(out).excludes(capture);
    options
        .add("--board", board_,
             "with --rehearse: what is photographed, chessboard or charuco (a board with "
             "markers, of which a part in view is enough)")
        .one_of({"chessboard", "charuco"})
        .show_default()
        .needs(rehearse)
        .excludes(robot);
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const BodyPosture position = position_ == "prone" ? BodyPosture::prone : BodyPosture::sitting;
    if (const auto fits = judge_words(); !fits) return tl::unexpected(fits.error());
    if (!turn_.empty())
      if (const auto made = make_poses(common, position); !made)
        return tl::unexpected(made.error());
    if (!wrist_.empty()) return calibrate_wrist(wrist_, out_);
    if (!capture_.empty()) return capture(common);
    if (!rehearse_.empty()) {
      return robot_ ? rehearse_robot(rehearse_, arms_, position, common.seed) : rehearse(common);
    }
    if (shots_.empty() || out_.empty()) {
      return fail(Fault::usage,
                  "calibrate needs a folder of pictures and --out, or --rehearse to make one");
    }
    if (robot_) return calibrate_robot(shots_, arms_, position, out_);
    for (const std::string& path : {out_, report_}) {
      if (const auto good = check_folder_of(path); !good) return tl::unexpected(good.error());
    }
    Views views;
    const auto result =
        calibration::calibrate_folder(shots_, views, progress_bar(common, "calibrate"));
    if (!result) return tl::unexpected(result.error());
    if (!report_.empty()) {
      const auto page = calibration_report(*result, views, shots_);
      if (const auto written = write_file(report_, page); !written) {
        return tl::unexpected(written.error());
      }
    }
    // Last, so that no calibration is left behind a failure.
    if (const auto written = write_file(out_, scanner::to_toml(result->calibration)); !written) {
      return tl::unexpected(written.error());
    }
    return Answer{.json = json_of(*result, views).dump(2), .text = text_of(*result, views)};
  }

 private:
  Result<Answer> capture(const CommonOptions& common) {
    if (device_.empty())
      return fail(Fault::usage, "--capture needs --device, a file that names camera and turntable");
    if (poses_ < 12 || poses_ > 96 || poses_ % 12 != 0)
      return fail(Fault::usage, "--poses must be 12, 24, 36 ... 96, not {}", poses_);
    return calibrate_capture(capture_, device_, poses_, live_, common.quiet);
  }

  /// Words that nothing takes are a mistake.
  [[nodiscard]] Result<void> judge_words() const {
    if (!device_.empty() && capture_.empty() && turn_.empty())
      return fail(Fault::usage, "--device belongs to --capture or to --wrist with --turn");
    if (!robot_ && turn_.empty() && (arms_ != "thesis" || position_ != "sitting"))
      return fail(Fault::usage, "--arms and --position belong to --robot or to --turn");
    return {};
  }

  [[nodiscard]] Result<void> make_poses(const CommonOptions& common, BodyPosture position) const {
    const auto model = robot::load_robot(arms_);
    if (!model) return tl::unexpected(model.error());
    return record_wrist_poses(device_, turn_ == "left" ? Arm::left : Arm::right,
                              robot::place_robot(*model, position), wrist_,
                              progress_bar(common, "poses"));
  }

  Result<Answer> rehearse(const CommonOptions& common) {
    sim::SyntheticShotsOptions options;
    if (board_ == "charuco") options.board = sim::charuco_board();
    const auto done =
        sim::render_calibration_shots(sim::built_scanner(common.seed), common.seed, rehearse_,
                                      options, progress_bar(common, "rehearse"));
    if (!done) return tl::unexpected(done.error());
    return Answer{
        .json = nlohmann::json{{"folder", rehearse_}}.dump(2),
        .text = fmt::format("{} holds a set of calibration shots; now: tuina calibrate {} --out "
                            "calibration.toml",
                            rehearse_, rehearse_)};
  }

  std::string shots_;
  std::string out_;
  std::string report_;
  std::string arms_ = "thesis";
  std::string rehearse_;
  std::string capture_;
  LivePicture live_;
  std::string device_;
  int poses_ = 12;
  std::string wrist_, turn_;
  std::string position_ = "sitting";
  std::string board_ = "chessboard";
  bool robot_ = false;
};

}  // namespace

std::unique_ptr<Verb> make_calibrate() {
  return std::make_unique<Calibrate>();
}

}  // namespace tuina::app
