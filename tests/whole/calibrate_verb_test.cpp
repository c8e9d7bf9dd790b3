// SPDX-License-Identifier: Apache-2.0
// Folders of calibration shots as a newcomer spoils them. None gives a calibration.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/reason.hpp"
#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/png.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/recording.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"
#include "tuina/sim/scanner/synthetic_shots.hpp"

namespace fs = std::filesystem;
using namespace tuina::units;
using tuina::scanner::ScannerCalibration;
using tuina::test::Folder;
using tuina::test::run_tuina;

namespace {

constexpr int poses = 9;

void rehearse(const fs::path& folder, double nearest_m = 0.5,
              const ScannerCalibration& truth = tuina::sim::built_scanner(2)) {
  const auto written = tuina::sim::render_calibration_shots(truth, 2, folder,
                                                            {.poses = poses,
                                                             .standing_poses = 1,
                                                             .nearest_m = nearest_m,
                                                             .max_distance_m = 1.4,
                                                             .sweeps = false});
  REQUIRE_MESSAGE(written.has_value(), tuina::test::reason(written));
}

std::string text_of(const fs::path& path) {
  return tuina::read_file(path).value();
}

void put(const fs::path& path, const std::string& text) {
  REQUIRE(tuina::write_file(path, text).has_value());
}

void replace(const fs::path& path, const std::string& from, const std::string& to) {
  std::string text = text_of(path);
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  put(path, text.replace(at, from.size(), to));
}

// The rows of frames.csv, each as it is or changed or, when empty, left out.
template <typename Change>
void edit_rows(const fs::path& folder, Change&& change) {
  std::istringstream in(text_of(folder / "frames.csv"));
  std::string row;
  std::getline(in, row);
  std::string out = row + "\n";
  while (std::getline(in, row)) {
    int frame = 0;
    int pose = 0;
    char kind[8] = {};
    double time_s = 0.0;
    double yaw_deg = 0.0;
    REQUIRE(std::sscanf(row.c_str(), "%d,%5[a-z],%d,%lf,%lf", &frame, kind, &pose, &time_s,
                        &yaw_deg) == 5);
    const std::string changed = change(row, frame, std::string(kind), pose, yaw_deg);
    if (!changed.empty()) out += changed + "\n";
  }
  put(folder / "frames.csv", out);
}

void mirror(const fs::path& picture) {
  const auto png = tuina::read_png(picture).value();
  tuina::Image image(png.image.width, png.image.height);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      image.row(y)[x] = static_cast<std::uint8_t>(png.image.row(y)[png.image.width - 1 - x]);
    }
  }
  put(picture, tuina::to_png(image));
}

// Copies the shots, spoils the copy, and says what tuina says of it.
template <typename Spoil>
std::string refusal(const fs::path& shots, const Folder& folder, Spoil&& spoil) {
  const fs::path copy = folder / "copy";
  fs::remove_all(copy);
  fs::copy(shots, copy, fs::copy_options::recursive);
  spoil(copy);
  const std::string out = folder / "calibration.toml";
  const auto outcome = run_tuina({"calibrate", copy.string(), "--out", out, "--report",
                                  folder / "report.html", "--json", "--quiet"});
  CHECK(outcome.exit_code == 2);
  CHECK(outcome.out.empty());
  CHECK_FALSE(fs::exists(out));
  CHECK_FALSE(fs::exists(folder / "report.html"));
  return outcome.err;
}

// All there is lies above the scanner.
tuina::Mesh nothing() {
  return {.vertices = {{0.0, 0.0, 9.0}, {0.1, 0.0, 9.0}, {0.0, 0.1, 9.0}},
          .triangles = {{0, 1, 2}}};
}

// A wall bent about the axis of the unit: it looks the same from every yaw.
tuina::Mesh bent_about_the_axis() {
  const auto truth = tuina::sim::built_scanner(2);
  const tuina::Transform& couch_from_camera = truth.couch_from_camera;
  const tuina::Vector3 axis = couch_from_camera.linear() * truth.axis_direction_in_camera;
  const tuina::Vector3 on_axis = couch_from_camera * truth.axis_point_in_camera;
  const tuina::Vector3 ahead = couch_from_camera.linear().col(2);
  const tuina::Vector3 out = (ahead - axis.dot(ahead) * axis).normalized();
  tuina::Mesh mesh;
  for (int i = -60; i <= 60; ++i) {
    const tuina::Vector3 at = on_axis + Eigen::AngleAxisd(0.5_deg * i, axis) * out;
    const int first = static_cast<int>(mesh.vertices.size());
    mesh.vertices.push_back(at - 0.6 * axis);
    mesh.vertices.push_back(at + 0.6 * axis);
    if (i == 60) break;
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first + 1, first + 3, first + 2});
  }
  return mesh;
}

void record(const fs::path& folder, double from_rad, const tuina::Mesh& scene) {
  const auto truth = tuina::sim::built_scanner(2);
  tuina::sim::LaserScanner unit(scene, nothing(), truth, 1, {});
  auto recorder = tuina::scanner::Recorder::open(unit, unit, folder);
  REQUIRE(recorder.has_value());
  REQUIRE(recorder->sweep(from_rad, -from_rad, 6.0_deg).has_value());
  while (recorder->arrived() == false)
    REQUIRE(recorder->next_frame(tuina::scanner::frame_timeout_s).has_value());
  REQUIRE(recorder->finish(tuina::sim::true_calibration(tuina::BodyPosture::prone)).has_value());
}

bool says(const std::string& message, std::string_view words) {
  const bool said = message.find(words) != std::string::npos;
  if (!said) MESSAGE(message);
  return said;
}

}  // namespace

TEST_CASE("what a newcomer does wrong with calibration shots is refused with its cause") {
  const Folder folder;
  const fs::path shots = folder.path() / "shots";
  rehearse(shots);
  const auto said = [&](auto&& spoil) { return refusal(shots, folder, spoil); };

  CHECK(says(said([](const fs::path& f) { fs::remove(f / "board.toml"); }), "board.toml"));
  CHECK(says(said([](const fs::path& f) { fs::remove(f / "frames.csv"); }), "frames.csv"));
  CHECK(says(said([](const fs::path& f) { fs::remove(f / "frames/000003.png"); }), "000003.png"));
  CHECK(says(said([](const fs::path& f) { put(f / "frames/000003.png", "no picture"); }),
             "000003.png"));
  CHECK(
      says(said([](const fs::path& f) { replace(f / "board.toml", "columns = 7", "columns = 6"); }),
           "is found in 0 of"));
  CHECK(says(said([](const fs::path& f) {
               edit_rows(f, [](auto row, int, auto, int pose, double) {
                 return pose < 4 || pose >= poses ? row : std::string();
               });
             }),
             "8 with both are needed"));
  CHECK(says(said([](const fs::path& f) {
               edit_rows(f, [](auto row, int, auto kind, int, double) {
                 return kind == "board" ? row : std::string();
               });
             }),
             "0 of them have a laser picture"));
  CHECK(says(said([](const fs::path& f) {
               replace(f / "board.toml", "square_m = 0.025", "square_m = 0.25");
             }),
             "square_m"));
  CHECK(says(said([](const fs::path& f) {
               // The laser pictures of poses 2 and 6 change places.
               edit_rows(f, [](auto row, int frame, auto kind, int pose, double yaw_deg) {
                 if (kind != "laser" || (pose != 2 && pose != 6)) return row;
                 return fmt::format("{},laser,{},{},{}", frame, 8 - pose, 2 * frame, yaw_deg);
               });
             }),
             "swapped"));
  CHECK(says(said([](const fs::path& f) {
               for (int frame = 0; frame < poses; ++frame) {
                 mirror(f / fmt::format("frames/{:06}.png", frame));
               }
             }),
             "mirrored"));
  CHECK(says(said([](const fs::path& f) {
               // To the other side the motor counts backwards.
               edit_rows(f, [](auto, int frame, auto kind, int pose, double yaw_deg) {
                 const double told_deg = -std::abs(yaw_deg);
                 return fmt::format("{},{},{},{},{}", frame, kind, pose, 2 * frame, told_deg);
               });
             }),
             "yaw_deg says"));
  CHECK(says(said([](const fs::path& f) {
               edit_rows(f, [](auto row, int, auto, int pose, double) {
                 return pose < poses ? row : std::string();
               });
             }),
             "yaw axis is unknown"));
  CHECK(says(said([](const fs::path& f) { fs::create_directory(f / "sweep_left"); }),
             "without sweep_right"));
  CHECK(says(said([](const fs::path& f) { fs::create_directory(f / "couch"); }), "couch"));

  // What was spoilt each time is good as it was.
  const auto good =
      run_tuina({"calibrate", shots.string(), "--out", folder / "good.toml", "--json", "--quiet"});
  REQUIRE_MESSAGE(good.exit_code == 0, good.err);
  CHECK(nlohmann::json::parse(good.out)["poses"] == poses);
  CHECK(says(text_of(folder / "good.toml"), "[standard_deviations]"));
}

TEST_CASE("sweeps that show nothing, turn alike or contradict the boards are refused") {
  const Folder folder;
  const fs::path shots = folder.path() / "shots";
  rehearse(shots);
  record(shots / "sweep_left", 6.0_deg, nothing());
  record(shots / "sweep_right", -6.0_deg, nothing());
  const auto said = [&](auto&& spoil) { return refusal(shots, folder, spoil); };
  CHECK(says(said([](const fs::path&) {}), "sweep the same still scene both ways"));
  CHECK(says(said([](const fs::path& f) {
               fs::remove_all(f / "sweep_right");
               fs::copy(f / "sweep_left", f / "sweep_right", fs::copy_options::recursive);
             }),
             "must fall"));
  CHECK(says(said([](const fs::path& f) {
               // Every yaw of the boards negated, which the boards alone cannot show.
               edit_rows(f, [](auto, int frame, auto kind, int pose, double yaw_deg) {
                 return fmt::format("{},{},{},{},{}", frame, kind, pose, 2 * frame, -yaw_deg);
               });
             }),
             "the other way than the nominal"));
  const auto flat = said([](const fs::path& f) {
    fs::remove_all(f / "sweep_left");
    fs::remove_all(f / "sweep_right");
    record(f / "sweep_left", 6.0_deg, bent_about_the_axis());
    record(f / "sweep_right", -6.0_deg, bent_about_the_axis());
  });
  CHECK(says(flat, "slanted surfaces"));
  // Without sweeps it is said that nothing was checked.
  const auto alone = [&] {
    fs::remove_all(shots / "sweep_left");
    fs::remove_all(shots / "sweep_right");
    return run_tuina({"calibrate", shots.string(), "--out", folder / "a.toml", "--json"});
  }();
  REQUIRE_MESSAGE(alone.exit_code == 0, alone.err);
  CHECK(says(alone.out, "Whether left is left"));
}

TEST_CASE("a light plane almost through the camera is refused") {
  const Folder folder;
  auto truth = tuina::sim::built_scanner(2);
  truth.laser_distance_m = 6.0_mm;
  truth.laser_normal_in_camera = tuina::Vector3(1.0, 0.0, 0.02).normalized();
  rehearse(folder.path() / "shots", 0.5, truth);
  CHECK(says(refusal(folder.path() / "shots", folder, [](const fs::path&) {}), "almost through"));
}

TEST_CASE("boards that are all held alike are refused") {
  const Folder folder;
  const fs::path shots = folder.path() / "shots";
  rehearse(shots);
  // The held boards once more, all upright to the line of sight.
  const auto truth = tuina::sim::built_scanner(2);
  const tuina::scanner::Board board;
  for (int pose = 0; pose < poses; ++pose) {
    tuina::Transform held = tuina::Transform::Identity();
    const double away_m = 0.6 + 0.1 * pose;
    const double x_m = truth.laser_distance_m / truth.laser_normal_in_camera.x() -
                       truth.laser_normal_in_camera.z() / truth.laser_normal_in_camera.x() * away_m;
    held.translation() = tuina::Vector3(x_m - 0.075, -0.1125, away_m);
    for (const bool laser : {false, true}) {
      tuina::Random random = tuina::make_random(1, "held alike");
      const auto image = tuina::sim::photograph(
          truth, board, held, laser ? tuina::sim::laser_exposure() : tuina::sim::board_exposure(),
          random);
      put(shots / fmt::format("frames/{:06}.png", 2 * pose + (laser ? 1 : 0)),
          tuina::to_png(image));
    }
  }
  CHECK(says(refusal(shots, folder, [](const fs::path&) {}), "parallel"));
}

TEST_CASE("boards at one distance are refused") {
  const Folder folder;
  const fs::path shots = folder.path() / "shots";
  rehearse(shots, 1.35);
  CHECK(says(refusal(shots, folder, [](const fs::path&) {}), "one distance"));
}

TEST_CASE("wrong use of calibrate is told") {
  const Folder folder;
  CHECK(run_tuina({"calibrate"}).exit_code == 1);
  CHECK(run_tuina({"calibrate", folder.path().string()}).exit_code == 1);
  CHECK(run_tuina({"calibrate", "--rehearse", folder / "a", "--out", folder / "b"}).exit_code == 1);
  CHECK(run_tuina({"calibrate", folder / "none", "--out", folder / "c.toml"}).exit_code == 2);
  CHECK(run_tuina({"calibrate", folder / "none", "--out", folder / "no/c.toml"}).exit_code == 2);
}
