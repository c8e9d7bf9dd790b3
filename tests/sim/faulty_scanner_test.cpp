// SPDX-License-Identifier: Apache-2.0
// A scanner that goes wrong as it is told to, and only then.
#include "tuina/sim/scanner/faulty_scanner.hpp"

#include <doctest/doctest.h>

#include "tests/fake_scanner.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/sim/person/phantom.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"

using namespace tuina;
using sim::FaultyScanner;
using sim::ScanFault;

namespace {

/// A sweep of the fake scanner behind a fault.
struct Seen {
  explicit Seen(const sim::TimedScanFault& fault) : faulty(fake, fake, fault, 1) {
    REQUIRE(faulty.switch_laser(true).has_value());
    REQUIRE(faulty.sweep(0.0, 1.0, 1.0).has_value());
    for (;;) {
      const auto arrived = faulty.arrived();
      if (!arrived) message = arrived.error().message;
      if (!arrived || *arrived) break;
      auto frame = faulty.next_frame(0.5);
      if (!frame) message = frame.error().message;
      if (!frame) break;
      frames.push_back(std::move(*frame));
    }
  }
  tests::FakeScanner fake;
  FaultyScanner faulty;
  std::vector<scanner::Frame> frames;
  std::string message;
};

const std::vector<scanner::Frame>& usual() {
  static const std::vector<scanner::Frame> frames = Seen({}).frames;
  return frames;
}

}  // namespace

TEST_CASE("without a fault a scanner behind it is the scanner") {
  Seen seen({});
  CHECK(seen.frames.size() == tests::FakeScanner::frames_of_a_sweep);
  CHECK(seen.message.empty());
  CHECK(seen.faulty.readings()->size() == seen.fake.readings()->size());
  CHECK(seen.faulty.lit());
  CHECK(seen.faulty.lit_after_onset_s() == 0.0);
}

TEST_CASE("frames are lost, frozen, cut and swapped from the onset on") {
  CHECK(Seen({ScanFault::frames_lost, 0.5, 0.0}).frames.size() < 20);
  const Seen frozen({ScanFault::frames_frozen, 0.2, 0.3});
  CHECK(frozen.frames[8].image.data == usual()[8].image.data);
  CHECK(frozen.frames[12].image.data == frozen.frames[11].image.data);
  CHECK(frozen.frames[12].time_s == usual()[12].time_s);
  CHECK(frozen.frames[18].image.data == usual()[18].image.data);
  const Seen cut({ScanFault::frames_cut, 10.0, 0.3});
  CHECK(cut.frames[20].image.row(10)[5] == usual()[20].image.row(10)[5]);
  CHECK(cut.frames[20].image.row(60)[5] == 128);
  const Seen swapped({ScanFault::frames_swapped, 0.0, 0.0});
  CHECK(swapped.frames[0].time_s == usual()[1].time_s);
  CHECK(swapped.frames[1].time_s == usual()[0].time_s);
}

TEST_CASE("what lies in the view changes the picture where it is") {
  const Seen lamp({ScanFault::lamp, 60.0, 0.0});
  CHECK(lamp.frames[3].image.row(30)[2] > usual()[3].image.row(30)[2] + 40);
  CHECK(lamp.frames[3].image.row(60)[2] == usual()[3].image.row(60)[2]);
  const Seen covered({ScanFault::covered, 0.5, 0.0});
  CHECK(covered.frames[3].image.row(36)[40] == 0);
  CHECK(covered.frames[3].image.row(5)[40] == usual()[3].image.row(5)[40]);
  const Seen twice({ScanFault::second_line, 30.0, 0.0});
  CHECK(twice.frames[0].image.row(36)[70] > 150);
  CHECK(usual()[0].image.row(36)[70] < 50);
  const Seen blurred({ScanFault::blurred, 15.0, 0.0});
  CHECK(blurred.frames[0].image.row(36)[40] < usual()[0].image.row(36)[40] - 50);
}

TEST_CASE("a silent camera or motor fails, and how long the laser was lit then is told") {
  const Seen camera({ScanFault::camera_silent, 0.0, 0.4});
  CHECK(camera.message.find("no frame") != std::string::npos);
  CHECK(camera.faulty.lit_after_onset_s() >= 0.5);
  const Seen motor({ScanFault::motor_silent, 0.0, 0.4});
  CHECK(motor.message.find("motor does not answer") != std::string::npos);
  CHECK(motor.faulty.lit_after_onset_s() < 0.1);
}

TEST_CASE("readings of the motor stick and skip") {
  const Seen stuck({ScanFault::yaw_stuck, 0.2, 0.3}), skips({ScanFault::yaw_skips, 0.5, 0.3});
  const auto usual_readings = tests::FakeScanner().readings().value();
  const auto stuck_readings = stuck.faulty.readings().value();
  const auto skipped_readings = skips.faulty.readings().value();
  const std::size_t last = usual_readings.size() - 1;
  CHECK(stuck_readings[18].yaw_rad == stuck_readings[20].yaw_rad);
  CHECK(stuck_readings[last].yaw_rad == usual_readings[last].yaw_rad);
  CHECK(skipped_readings.front().yaw_rad == usual_readings.front().yaw_rad);
  CHECK(skipped_readings[last].yaw_rad == doctest::Approx(usual_readings[last].yaw_rad + 0.5));
}

TEST_CASE("before a back, what hangs or skips is refused, and the laser is dark in 0.25 s") {
  struct Wrong {
    sim::TimedScanFault fault;
    const char* said;
  };
  const auto person =
      sim::make_phantom(sim::draw_phantom(sim::BodyType::medium, 1), BodyPosture::sitting);
  for (const Wrong& wrong :
       {Wrong{{ScanFault::camera_silent, 0.0, 1.5}, "no frame within"},
        Wrong{{ScanFault::frames_frozen, 0.5, 1.5}, "the camera has given the same picture"},
        Wrong{{ScanFault::motor_silent, 0.0, 1.5}, "the motor does not answer"},
        Wrong{{ScanFault::yaw_stuck, 1.0, 1.5}, "the motor stands still"},
        Wrong{{ScanFault::yaw_skips, 2.0_deg, 1.5}, "the motor skips"}}) {
    sim::LaserScanner scanner(person.skin_in_couch, person.position, {}, 1);
    FaultyScanner faulty(scanner, scanner, wrong.fault, 1);
    const auto scan = scanner::scan_sweep(faulty, faulty, scanner.true_calibration(),
                                          {.from_rad = -9.0_deg, .to_rad = 9.0_deg});
    REQUIRE_FALSE(scan.has_value());
    CHECK_MESSAGE(scan.error().message.find(wrong.said) != std::string::npos, scan.error().message);
    CHECK_FALSE(faulty.lit());
    if (wrong.fault.kind != ScanFault::yaw_skips) CHECK(faulty.lit_after_onset_s() < 0.25);
  }
}
