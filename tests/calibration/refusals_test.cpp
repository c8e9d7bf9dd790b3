// SPDX-License-Identifier: Apache-2.0
// Sets of pictures that a newcomer takes, and what is said about them. Few give a calibration.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/calibration/seen_boards.hpp"
#include "tests/fake_scanner.hpp"
#include "tests/folder.hpp"
#include "tests/reason.hpp"
#include "tuina/calibration/calibrate.hpp"
#include "tuina/calibration/latency.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/recording.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"

using namespace tuina;
using namespace tuina::calibration;
using tuina::test::seen_boards;

namespace {

constexpr int held = 16;
const sim::SyntheticShotsOptions usual{.poses = held, .standing_poses = 2};

Views good_views(std::uint64_t seed = 1) {
  return seen_boards(sim::built_scanner(seed), seed, usual);
}

void refused_saying(Views views, const std::string& cause) {
  const auto result = calibrate(views);
  CAPTURE(cause);
  REQUIRE_FALSE(result.has_value());
  CHECK(result.error().fault == Fault::bad_input);
  CHECK_MESSAGE(result.error().message.find(cause) != std::string::npos, result.error().message);
}

void mirror(View& view, int width_px) {
  for (Vector2& corner : view.corners_px) corner.x() = width_px - 1 - corner.x();
  for (auto& point : view.line) {
    point.column_px = static_cast<float>(width_px - 1) - point.column_px;
  }
}

View& of_pose(Views& views, int pose) {
  return *std::find_if(views.views.begin(), views.views.end(),
                       [pose](const View& view) { return view.pose == pose; });
}

}  // namespace

TEST_CASE("the set that the others spoil is a good one") {
  for (const std::uint64_t seed : {1U, 2U}) {
    Views views = good_views(seed);
    const auto result = calibrate(views);
    REQUIRE_MESSAGE(result.has_value(), test::reason(result));
    const auto truth = sim::built_scanner(seed);
    CHECK(sim::range_error_m(truth, result->calibration, 1.0) < 1.0_mm);
  }
}

TEST_CASE("fewer than eight poses with board and laser") {
  Views views = good_views();
  std::erase_if(views.views, [](const View& view) { return view.pose >= 7 && view.pose < held; });
  refused_saying(views, "8 with both are needed");
}

TEST_CASE("the same pictures under other numbers are no more poses") {
  Views views = good_views();
  std::erase_if(views.views, [](const View& view) { return view.pose >= 7 && view.pose < held; });
  const std::vector<View> seven = views.views;
  for (const int more : {100, 200}) {
    for (View view : seven) {
      if (view.pose >= held) continue;
      view.pose += more, view.frame += 1000 * more;
      views.views.push_back(view);
    }
  }
  refused_saying(views, "14 more poses show the board where another does");

  Views whole = good_views();
  View again = of_pose(whole, 3);
  again.pose = 300, again.frame = 3000;
  whole.views.push_back(again);
  const auto result = calibrate(whole);
  REQUIRE_MESSAGE(result.has_value(), test::reason(result));
  CHECK(std::ranges::count_if(result->remarks, [](const std::string& remark) {
          return remark.find("Pose 300 shows the board in the same place") != std::string::npos;
        }) == 1);
  // A board that stands where it was held before is turned before all the same.
  Views stood = good_views();
  View held_there = of_pose(stood, held);
  held_there.pose = 4;
  std::erase_if(stood.views, [](const View& view) { return view.pose == 4; });
  held_there.frame = -1;
  stood.views.push_back(held_there);
  const auto turned = calibrate(stood);
  REQUIRE_MESSAGE(turned.has_value(), test::reason(turned));
}

TEST_CASE("a sweep whose pictures have another size than those of the board") {
  const test::Folder folder;
  tests::FakeScanner scanner;
  auto recorder = scanner::Recorder::open(scanner, scanner, folder / "couch");
  REQUIRE(recorder.has_value());
  REQUIRE(recorder->sweep(0.0, 1.0, 1.0).has_value());
  REQUIRE(recorder->switch_laser(true).has_value());
  while (recorder->arrived() == false)
    REQUIRE(recorder->next_frame(scanner::frame_timeout_s).has_value());
  const auto calibration = tests::calibration_of_fake();
  REQUIRE(recorder->finish(calibration).has_value());
  scanner::CameraModel camera = calibration.camera;
  CHECK(read_sweep(folder / "couch", camera).has_value());
  camera.width_px += 16;
  const auto other = read_sweep(folder / "couch", camera);
  REQUIRE_FALSE(other.has_value());
  CHECK(other.error().message.find("all come from one camera") != std::string::npos);
}

TEST_CASE("laser pictures missing") {
  Views views = good_views();
  for (View& view : views.views) {
    view.laser_on = view.laser_on && view.pose < 5;
    if (!view.laser_on) view.line.clear();
  }
  refused_saying(views, "5 of them have a laser picture");
}

TEST_CASE("a laser that was off") {
  Views views = good_views();
  for (View& view : views.views) {
    if (view.pose > 3) view.line.clear();
  }
  refused_saying(views, "is the laser on");
}

TEST_CASE("laser pictures of two poses exchanged") {
  for (const auto& [one, other] : {std::pair{2, 12}, {6, 15}}) {
    Views views = good_views(5);
    std::swap(of_pose(views, one).line, of_pose(views, other).line);
    CAPTURE(one);
    refused_saying(views, "swapped between poses");
  }
}

TEST_CASE("every laser picture one pose too late") {
  Views views = good_views();
  for (int pose = 0; pose + 1 < held; ++pose) {
    std::swap(of_pose(views, pose).line, of_pose(views, pose + 1).line);
  }
  refused_saying(views, "swapped between poses");
}

TEST_CASE("half of the pictures mirrored") {
  Views views = good_views(2);
  for (View& view : views.views) {
    if (view.pose % 2 == 1) mirror(view, views.width_px);
  }
  refused_saying(views, "mirrored");
}

TEST_CASE("one mirrored picture among good ones") {
  Views views = good_views(2);
  mirror(of_pose(views, 7), views.width_px);
  refused_saying(views, "mirrored");
}

TEST_CASE("a line beside the board is left out, and the pose is named") {
  Views views = good_views();
  for (auto& point : of_pose(views, 7).line) {
    point.column_px += 45.0F + 0.2F * static_cast<float>(point.row - 240);
  }
  const auto result = calibrate(views);
  REQUIRE_MESSAGE(result.has_value(), test::reason(result));
  CHECK(result->laser_rms_m < 1.0_mm);
  REQUIRE(result->remarks.size() == 1);
  CHECK(result->remarks.front().starts_with("The laser line of pose 7 was left out: it lies "));
}

TEST_CASE("all boards at one distance") {
  sim::SyntheticShotsOptions options = usual;
  options.nearest_m = 0.98;
  options.max_distance_m = 1.02;
  auto pictures = sim::synthetic_pictures(sim::built_scanner(1), 1, options);
  refused_saying(seen_boards(sim::built_scanner(1), pictures, options.board, 1),
                 "about one distance");
}

TEST_CASE("all boards parallel") {
  const auto truth = sim::built_scanner(1);
  auto pictures = sim::synthetic_pictures(truth, 1, usual);
  for (auto& picture : pictures) {
    if (picture.pose < held) picture.camera_from_board.linear().setIdentity();
  }
  refused_saying(seen_boards(truth, pictures, usual.board, 1), "parallel");
}

TEST_CASE("a square size in the wrong unit") {
  for (const double factor : {10.0, 0.1}) {
    Views views = good_views();
    views.board.square_m *= factor;
    refused_saying(views, "square_m");
  }
}

TEST_CASE("a laser that shines almost through the camera") {
  auto truth = sim::built_scanner(1);
  truth.laser_distance_m = 6.0_mm;
  truth.laser_normal_in_camera = Vector3(1.0, 0.0, 0.02).normalized();
  refused_saying(seen_boards(truth, 1, usual), "almost through");
}

TEST_CASE("no board that stood while the unit turned, or hardly any turn") {
  Views views = good_views();
  Views none = views;
  std::erase_if(none.views, [](const View& view) { return view.pose >= held; });
  refused_saying(none, "several yaw angles");
  std::erase_if(views.views, [](const View& view) {
    return view.pose >= held && std::abs(view.yaw_rad) > 2.0_deg;
  });
  const auto result = calibrate(views);
  CHECK_FALSE(result.has_value());
}

TEST_CASE("the yaw of one standing board with the wrong sign") {
  Views views = good_views();
  for (View& view : views.views) {
    if (view.pose == held + 1) view.yaw_rad = -view.yaw_rad;
  }
  refused_saying(views, "yaw_deg says");
}

TEST_CASE("a standing board that was moved") {
  Views views = good_views();
  int seen = 0;
  for (View& view : views.views) {
    if (view.pose == held && seen++ == 2) view.yaw_rad += 8.0_deg;
  }
  refused_saying(views, "yaw_deg says");
}

TEST_CASE("corners counted from the other end are the same board") {
  Views views = good_views();
  int seen = 0;
  for (View& view : views.views) {
    if (seen++ % 2 == 0) std::reverse(view.corners_px.begin(), view.corners_px.end());
  }
  const auto turned = calibrate(views);
  REQUIRE_MESSAGE(turned.has_value(), test::reason(turned));
  Views straight = good_views();
  const auto same = calibrate(straight);
  REQUIRE(same.has_value());
  CHECK(turned->calibration.camera.fx_px ==
        doctest::Approx(same->calibration.camera.fx_px).epsilon(1e-4));
  CHECK(turned->calibration.axis_direction_in_camera.isApprox(
      same->calibration.axis_direction_in_camera, 1e-4));
}
