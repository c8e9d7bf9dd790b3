// SPDX-License-Identifier: Apache-2.0
// `tuina calibrate --capture` before a whole scanner: pictures of a board by an emulated camera,
// the laser and the motor by the board's firmware in simavr. Somebody who hears what tuina says
// holds the board, and not always well. What was captured is then calibrated.
#include "tests/devices/capture_stage.hpp"

#include <doctest/doctest.h>

#include <array>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/reason.hpp"
#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/scanner/board_renderer.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"
#include "tuina/sim/scanner/line_renderer.hpp"
#include "tuina/sim/scanner/synthetic_shots.hpp"

using namespace tuina;
using nlohmann::json;
using test::Folder;
using test::Outcome;
using test::run_tuina;
using tests::CaptureStage;

namespace {

const scanner::Board board = {.columns = 5, .rows = 8, .square_m = 0.025};

/// What is shown until tuina has said this, or has kept a picture of it where nothing is to be
/// said.
struct Scene {
  std::string said;
  Transform camera_from_board = Transform::Identity();  ///< at yaw 0
  double shakes_px = 0.0;
  int blur_px = 0;  ///< half a box that a picture is smeared over
  bool shown = true;
};

/// A board whose far side is at that angle from right over down; `aside_m` off the light plane.
std::optional<Transform> placed(const scanner::ScannerCalibration& truth, double depth_m,
                                double tilt_rad, double far_side_rad, double aside_m) {
  const Vector3& normal = truth.laser_normal_in_camera;
  const Vector3 axis(std::sin(far_side_rad), -std::cos(far_side_rad), 0.0);
  Transform pose = Transform::Identity();
  pose.linear() = Eigen::AngleAxisd(tilt_rad, axis).toRotationMatrix();
  const double line_m = (truth.laser_distance_m - normal.z() * depth_m) / normal.x();
  const Vector3 middle(line_m - std::copysign(aside_m, line_m), 0.0, depth_m);
  pose.translation() =
      middle - pose.linear() * Vector3(0.5 * (board.columns - 1) * board.square_m,
                                       0.5 * (board.rows - 1) * board.square_m, 0.0);
  return sim::in_view(truth.camera, board, pose) ? std::optional(pose) : std::nullopt;
}

/// As near to the line as it is wholly in view, or at least that far from it.
Transform held(const scanner::ScannerCalibration& truth, double depth_m, double tilt_rad,
               double far_side_rad, double min_aside_m = 0.0) {
  for (double aside_m = min_aside_m; aside_m < min_aside_m + 0.045; aside_m += 0.005)
    if (const auto pose = placed(truth, depth_m, tilt_rad, far_side_rad, aside_m)) return *pose;
  FAIL("out of view at " << depth_m << " m");
  return {};
}

/// Bad ones first, then twelve good ones, one of them shown twice, then boards that stand.
std::vector<Scene> scenes_of(const scanner::ScannerCalibration& truth) {
  constexpr double tilt_rad = 30.0_deg;
  const Transform good = held(truth, 0.9, tilt_rad, 0.0);
  std::vector<Scene> scenes = {
      {.said = "no board is seen", .shown = false},
      {.said = "degrees only", .camera_from_board = held(truth, 0.9, 3.0_deg, 0.0)},
      {.said = "degrees, too far", .camera_from_board = held(truth, 0.9, 52.0_deg, 0.0)},
      {.said = "focus the camera", .camera_from_board = good, .blur_px = 5},
      {.said = "hold it still", .camera_from_board = good, .shakes_px = 4.0},
      {.said = "the laser line does not cross the board",
       .camera_from_board = held(truth, 1.3, tilt_rad, 0.0, 0.14)}};
  for (const double depth_m : {0.6, 0.9, 1.3})
    for (int quarter = 0; quarter < 4; ++quarter)
      scenes.push_back({.camera_from_board = held(truth, depth_m, tilt_rad, 0.5 * pi * quarter)});
  scenes.insert(scenes.end() - 1, {.said = "such a pose is there", .camera_from_board = good});
  for (const double depth_m : {0.8, 1.05, 1.45})
    scenes.push_back(
        {.camera_from_board = held(truth, depth_m, 20.0_deg, depth_m < 0.9 ? 0.0 : pi)});
  return scenes;
}

Image smeared(const Image& image, int by_px) {
  Image out = image;
  for (int pass = 0; pass < 2; ++pass) {
    const Image from = out;
    for (int y = by_px; y < image.height - by_px; ++y) {
      for (int x = by_px; x < image.width - by_px; ++x) {
        int sum = 0;
        for (int k = -by_px; k <= by_px; ++k)
          sum += pass == 0 ? from.row(y)[x + k] : from.row(y + k)[x];
        out.row(y)[x] = static_cast<std::uint8_t>(sum / (2 * by_px + 1));
      }
    }
  }
  return out;
}

/// Books like tents under the scanner, for the sweeps.
Mesh still_scene() {
  Mesh mesh;
  const auto rectangle = [&](const Vector3& corner, const Vector3& along, const Vector3& across) {
    const auto first = static_cast<int>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(),
                         {corner, corner + along, corner + along + across, corner + across});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  };
  for (const double x : {-0.22, 0.0, 0.22}) {
    const Vector3 ridge(x, -0.56, 0.11), along(0.0, 0.44, 0.0);
    rectangle(ridge, Vector3(0.09, 0.0, -0.11), along);
    rectangle(ridge + along, Vector3(-0.09, 0.0, -0.11), -along);
  }
  return mesh;
}

Mesh bed() {
  Mesh mesh;
  mesh.vertices = {{-1.0, -1.5, 0.0}, {1.0, -1.5, 0.0}, {1.0, 1.0, 0.0}, {-1.0, 1.0, 0.0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// Who holds the board: shows scene after scene, by what stands in tuina's last line.
class Hands {
 public:
  Hands(const scanner::ScannerCalibration& truth, std::string heard)
      : truth_(truth),
        heard_(std::move(heard)),
        scenes_(scenes_of(truth)),
        books_(still_scene(), bed(), truth, {.room_light_dn = 10.0}, 5) {}

  [[nodiscard]] std::size_t scenes_shown() const { return at_; }
  [[nodiscard]] std::size_t scenes() const { return scenes_.size(); }

  Image picture(double yaw_rad, double time_s, bool lit) {
    listen();
    ++frame_;
    if (at_ == scenes_.size()) return sweep_picture(yaw_rad, lit);
    const Scene& scene = scenes_[at_];
    Random random = make_random(frame_, "photograph");
    // Pictures of a board at rest differ by noise only, so that of each few are made.
    const auto key = std::tuple(at_, lit, yaw_rad, scene.shakes_px > 0.0 ? 0 : frame_ % 3);
    if (const auto known = pictures_.find(key); known != pictures_.end() && scene.shakes_px == 0.0)
      return known->second;
    Transform seen = truth_.couch_from_camera_at(yaw_rad).inverse() * truth_.couch_from_camera *
                     scene.camera_from_board;
    if (!scene.shown) seen.translation().x() += 10.0;
    const double shake_m = scene.shakes_px * seen.translation().z() / truth_.camera.fx_px;
    seen.translation().x() += shake_m * std::sin(40.0 * time_s);
    Image image = sim::photograph(truth_, board, seen,
                                  {.white_dn = 65.0,
                                   .black_dn = 10.0,
                                   .behind_dn = 25.0,
                                   .laser_dn = lit ? 55.0 : 0.0,
                                   .noise_dn = 2.0},
                                  random);
    if (scene.blur_px > 0) image = smeared(image, scene.blur_px);
    pictures_[key] = image;
    return image;
  }

 private:
  Image sweep_picture(double yaw_rad, bool lit) {
    return lit ? books_.render(yaw_rad, Vector3::Zero(), frame_) : books_.render_dark(frame_);
  }
  /// "3 of 17  hold the board ...: what is wrong", each of them on a line.
  void listen() {
    const std::string text = read_file(heard_, 1 << 24).value_or("");
    const std::string fresh = text.substr(std::min(read_, text.size()));
    if (fresh.empty() || fresh.back() != '\n') return;
    read_ = text.size();
    if (at_ >= scenes_.size()) return;
    const std::size_t last = fresh.rfind('\n', fresh.size() - 2);
    const int kept = std::atoi(fresh.c_str() + (last == std::string::npos ? 0 : last + 1));
    const std::string& said = scenes_[at_].said;
    if (said.empty() ? kept > kept_ : fresh.find(said) != std::string::npos) ++at_;
    kept_ = std::max(kept, kept_);
  }

  scanner::ScannerCalibration truth_;
  std::string heard_;
  std::vector<Scene> scenes_;
  sim::LineRenderer books_;
  std::map<std::tuple<std::size_t, bool, double, std::uint64_t>, Image> pictures_;
  std::size_t at_ = 0, read_ = 0;
  std::uint64_t frame_ = 0;
  int kept_ = 0;
};

}  // namespace

TEST_CASE("twelve good poses are kept of a board that is also held badly, and calibrate to truth" *
          doctest::skip(!tests::PseudoTerminal::exist())) {
  scanner::ScannerCalibration truth = sim::built_scanner(3);
  truth.latency_s = 0.12;
  const Folder folder;
  const std::string at = folder.path(), shots = folder / "shots";
  std::filesystem::create_directory(shots);
  std::ofstream(shots + "/board.toml")
      << "[board]\nkind = \"chessboard\"\ncolumns = 5\nrows = 8\nsquare_m = 0.025\n";
  Hands hands(truth, at + "/err");
  int status = 0;
  {
    CaptureStage stage(at, TUINA_FIRMWARE, truth.latency_s,
                       [&](double yaw_rad, double time_s, bool lit) {
                         return hands.picture(yaw_rad, time_s, lit);
                       });
    const std::string host =
        "echo $$ >" + at + "/host; exec env TUINA_CLOCK=" + at +
        "/clock LD_PRELOAD='" TUINA_FAKE_V4L2 "' " TUINA_BINARY " calibrate --capture " + shots +
        " --device " + at + "/device.toml --json >" + at + "/out 2>" + at + "/err </dev/null";
    status = std::system(host.c_str());
    CHECK_FALSE(stage.lit());
    CHECK_FALSE(stage.crashed());
    // The firmware puts it out after a quarter of a second; the host does so before.
    CHECK(stage.max_lit_s() < 0.25);
    MESSAGE(hands.scenes_shown(), " scenes in ", stage.now_s(), " s; lit for at most ",
            stage.max_lit_s(), " s at once while the unit stood");
  }
  const std::string words = read_file(at + "/err", 1 << 24).value_or("");
  REQUIRE_MESSAGE(WEXITSTATUS(status) == 0, words);
  CHECK(hands.scenes_shown() == hands.scenes());
  for (const char* said :
       {"no board is seen", "degrees only", "degrees, too far", "focus the camera", "hold it still",
        "does not cross the board", "such a pose is there"})
    CHECK_MESSAGE(words.find(said) != std::string::npos, said);
  const json taken = json::parse(read_file(at + "/out", 1 << 20).value_or("{}"));
  CHECK(taken["poses"] == 12);
  CHECK(std::filesystem::exists(shots + "/frames/000023.png"));

  const Outcome done =
      run_tuina({"calibrate", shots, "--out", folder / "calibration.toml", "--json", "--quiet"});
  REQUIRE_MESSAGE(done.exit_code == 0, done.err);
  const auto found = scanner::read_calibration(folder / "calibration.toml");
  REQUIRE_MESSAGE(found.has_value(), test::reason(found));
  const double near_mm = to_mm(sim::range_error_m(truth, *found, 0.65)),
               far_mm = to_mm(sim::range_error_m(truth, *found, 1.0));
  MESSAGE("range error ", near_mm, " mm at 0.65 m, ", far_mm, " mm at 1 m; latency ",
          1e3 * (found->latency_s - truth.latency_s), " ms off ", 1e3 * truth.latency_s);
  CHECK(near_mm < 0.8);
  CHECK(far_mm < 1.2);
  CHECK(std::abs(found->latency_s - truth.latency_s) < 3e-3);
}
