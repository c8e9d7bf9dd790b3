// SPDX-License-Identifier: Apache-2.0
// Pictures for a calibration, taken of a simulated board in the hands of somebody who is not always
// careful.
#include "tuina/calibration/capture/capture.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <vector>

#include "tests/folder.hpp"
#include "tests/reason.hpp"
#include "tuina/calibration/board/find_board.hpp"
#include "tuina/calibration/calibrate.hpp"
#include "tuina/calibration/capture/held_board.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/scanner/board_renderer.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"
#include "tuina/sim/scanner/synthetic_shots.hpp"

using namespace tuina;
using namespace tuina::calibration;
using tuina::test::Folder;

namespace {

const scanner::Board small_board = {.columns = 5, .rows = 8, .square_m = 0.025};

/// A board on the light plane and in view, its far side at that angle from right over down.
Transform held(const scanner::ScannerCalibration& truth, double depth_m, double tilt_rad,
               double far_side_rad) {
  const Vector3& normal = truth.laser_normal_in_camera;
  // Turned about the direction across, so that what lies towards the far side goes back.
  const Vector3 axis(std::sin(far_side_rad), -std::cos(far_side_rad), 0.0);
  Transform pose = Transform::Identity();
  pose.linear() = Eigen::AngleAxisd(tilt_rad, axis).toRotationMatrix();
  // Near boards have the line beside their middle, or they would be out of view.
  for (double aside_m = 0.0; aside_m < 0.045; aside_m += 0.005) {
    const double line_m = (truth.laser_distance_m - normal.z() * depth_m) / normal.x();
    const Vector3 middle(line_m - std::copysign(aside_m, line_m), 0.0, depth_m);
    pose.translation() =
        middle - pose.linear() * Vector3(0.5 * (small_board.columns - 1) * small_board.square_m,
                                         0.5 * (small_board.rows - 1) * small_board.square_m, 0.0);
    if (sim::in_view(truth.camera, small_board, pose)) return pose;
  }
  FAIL("out of view at " << depth_m << " m");
  return pose;
}

/// What is before the scanner for a while.
struct Scene {
  Transform camera_from_board = Transform::Identity();  ///< at yaw 0
  double shakes_px = 0.0;
  bool shown = true;
};

/// A scanner with somebody before it who goes from scene to scene, and stays at the last.
class Stage final : public scanner::Camera, public scanner::Turntable {
 public:
  Stage(const scanner::ScannerCalibration& truth, std::vector<Scene> scenes)
      : truth_(truth), scenes_(std::move(scenes)) {}

  [[nodiscard]] Result<scanner::Frame> next_frame(double) override {
    time_s_ += 0.1;
    lit_s_ = lit_ ? lit_s_ + 0.1 : 0.0;
    max_lit_s = std::max(max_lit_s, lit_s_);
    return scanner::Frame{.time_s = time_s_, .image = picture(), .dark = {}};
  }
  [[nodiscard]] Result<void> sweep(double, double, double) override {
    return fail(Fault::device, "no sweep is in this play");
  }
  [[nodiscard]] Result<void> step(double from_rad, double, double) override {
    yaw_rad_ = scanner::yaw_count_rad * std::round(from_rad / scanner::yaw_count_rad);
    return {};
  }
  [[nodiscard]] Result<bool> arrived() const override { return true; }
  [[nodiscard]] Result<void> switch_laser(bool on) override {
    lit_ = on;
    return {};
  }
  [[nodiscard]] Result<std::vector<scanner::YawReading>> readings() const override {
    return std::vector{scanner::YawReading{time_s_, yaw_rad_}};
  }
  [[nodiscard]] bool lit() const { return lit_; }
  /// Whoever holds the board has heard that a picture was kept, or what is wrong, and goes on.
  void hear(const CaptureTold& told) {
    const bool kept = told.kept > kept_;
    kept_ = told.kept;
    patience_ = told.seen.empty() ? 0 : patience_ + 1;
    if (!kept && patience_ < 8) return;
    patience_ = 0;
    at_ = std::min(at_ + 1, scenes_.size() - 1);
  }
  double max_lit_s = 0.0;

 private:
  Image picture() {
    const Scene& scene = scenes_[at_];
    const bool shakes = scene.shakes_px > 0.0;
    const auto key = std::tuple(at_, lit_, yaw_rad_);
    if (const auto known = pictures_.find(key); known != pictures_.end() && !shakes)
      return known->second;
    Random random = make_random(at_, lit_ ? "lit" : "bare");
    Transform seen = truth_.couch_from_camera_at(yaw_rad_).inverse() * truth_.couch_from_camera *
                     scene.camera_from_board;
    if (!scene.shown) seen.translation().x() += 10.0;
    const double shake_m = scene.shakes_px * seen.translation().z() / truth_.camera.fx_px;
    if (shakes) seen.translation().x() += shake_m * std::sin(9.0 * time_s_);
    // One exposure for the board and the line.
    const Image image = sim::photograph(truth_, small_board, seen,
                                        {.white_dn = 65.0,
                                         .black_dn = 10.0,
                                         .behind_dn = 25.0,
                                         .laser_dn = lit_ ? 55.0 : 0.0,
                                         .noise_dn = 2.0},
                                        random);
    if (!shakes) pictures_[key] = image;
    return image;
  }

  scanner::ScannerCalibration truth_;
  std::vector<Scene> scenes_;
  std::map<std::tuple<std::size_t, bool, double>, Image> pictures_;
  std::size_t at_ = 0;
  double time_s_ = 0.0, yaw_rad_ = 0.0, lit_s_ = 0.0;
  int kept_ = 0, patience_ = 0;
  bool lit_ = false;
};

constexpr std::array depths_m = {0.6, 0.9, 1.3};

std::vector<Scene> careful_hands(const scanner::ScannerCalibration& truth) {
  std::vector<Scene> scenes;
  for (const double depth_m : depths_m) {
    for (int quarter = 0; quarter < 4; ++quarter)
      scenes.push_back({.camera_from_board = held(truth, depth_m, 30.0_deg, 0.5 * pi * quarter)});
  }
  return scenes;
}

Result<void> play(Stage& stage, const Folder& folder, const CaptureOptions& options,
                  std::string* words = nullptr) {
  return capture_shots(stage, stage, small_board, folder.path(), options,
                       [&](const CaptureTold& told) {
                         if (words != nullptr) *words += told.seen + "\n";
                         stage.hear(told);
                       });
}

}  // namespace

TEST_CASE("distance, tilt and far side of a board are told before the camera is known") {
  const auto truth = sim::built_scanner(3);
  FocalGuess guess(truth.camera.width_px, truth.camera.height_px);
  for (const double depth_m : depths_m) {
    for (const double far_side : {0.0, 0.5 * pi, pi, -0.5 * pi}) {
      Random random = make_random(1, "board");
      const Image image =
          sim::photograph(truth, small_board, held(truth, depth_m, 30.0_deg, far_side),
                          sim::board_exposure(), random);
      const auto seen = find_board(image, small_board);
      REQUIRE(seen.has_value());
      guess.see(*seen, small_board);
      const HeldBoard board = look_at_board(*seen, image, small_board, guess);
      CHECK(board.distance_m == doctest::Approx(depth_m).epsilon(0.15));
      CHECK(std::abs(board.tilt_rad - 30.0_deg) < 10.0_deg);
      CHECK(std::cos(board.far_side_rad - far_side) > std::cos(20.0_deg));
      CHECK(board.blur_px < 4.0);
      CHECK(board.contrast_dn > 60.0);
    }
  }
}

TEST_CASE("a set that was led through calibrates, whatever else the hands have shown") {
  const auto truth = sim::built_scanner(3);
  std::vector<Scene> scenes = careful_hands(truth);
  scenes.insert(scenes.begin(),
                {{.shown = false},
                 {.camera_from_board = held(truth, 0.9, 3.0_deg, 0.0)},
                 {.camera_from_board = held(truth, 0.9, 30.0_deg, 0.0), .shakes_px = 4.0}});
  scenes.insert(scenes.begin() + 5, scenes[4]);  // the same once more
  for (const double far_side : {0.0, pi})
    scenes.push_back(
        {.camera_from_board = held(truth, far_side == 0.0 ? 0.8 : 1.0, 20.0_deg, far_side)});
  Stage stage(truth, scenes);
  const Folder folder;
  std::string words;
  const auto taken = play(stage, folder, {.standing_boards = 2, .sweeps = false}, &words);
  REQUIRE_MESSAGE(taken.has_value(), test::reason(taken), "\n", words);
  for (const char* said :
       {"no board is seen", "degrees only", "hold it still", "such a pose is there"})
    CHECK_MESSAGE(words.find(said) != std::string::npos, said);
  CHECK_FALSE(stage.lit());
  CHECK(stage.max_lit_s < 1.5);  // of pictures a tenth of a second apart

  (void)folder.with("board.toml",
                    "[board]\nkind = \"chessboard\"\ncolumns = 5\nrows = 8\nsquare_m = 0.025\n");
  Views views;
  const auto result = calibrate_folder(folder.path(), views);
  REQUIRE_MESSAGE(result.has_value(), test::reason(result));
  CHECK(result->poses == 12);
  CHECK(sim::range_error_m(truth, result->calibration, 0.65) < 0.8_mm);
  CHECK(sim::range_error_m(truth, result->calibration, 1.0) < 1.2_mm);
  MESSAGE("range error, mm: ", to_mm(sim::range_error_m(truth, result->calibration, 0.65)),
          " at 0.65 m, ", to_mm(sim::range_error_m(truth, result->calibration, 1.0)), " at 1 m");
}

TEST_CASE("a scanner before which nobody shows a board gives up, and what was kept stays") {
  const auto truth = sim::built_scanner(3);
  Stage stage(truth, {careful_hands(truth)[0], {.shown = false}});
  const Folder folder;
  const auto taken = play(stage, folder, {.patience_s = 3.0});
  REQUIRE_FALSE(taken.has_value());
  CHECK(taken.error().fault == Fault::device);
  CHECK(taken.error().message.find("no board is seen") != std::string::npos);
  CHECK(std::filesystem::exists(folder.path() / "frames.csv"));
  CHECK(std::filesystem::exists(folder.path() / "frames/000001.png"));
  const auto again = play(stage, folder, {});
  REQUIRE_FALSE(again.has_value());
  CHECK(again.error().message.find("has pictures already") != std::string::npos);
}
