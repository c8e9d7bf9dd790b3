// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/taught_motion.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <tuple>

#include "tests/folder.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/programme.hpp"

using namespace tuina;

namespace {

const robot::ArmTable table = robot::thesis_arm();

JointVector posture_at(double time_s) {
  JointVector q = JointVector::Zero(table.joints);
  for (int j = 0; j < table.joints; ++j) {
    q(j) = 0.3 * (j + 1.0) / 6.0 * (1.0 - std::cos(2.0 * pi * time_s / 4.0));
  }
  return q;
}

/// Four seconds to and fro, a tremor on top, as a hand leads.
session::TaughtMotion led(double tremor_rad) {
  Random random = make_random(4, "tremor");
  session::TaughtMotion motion{.name = "to and fro", .arm = Arm::right, .rail_m = 0.12};
  for (int i = 0; i <= 4000; ++i) {
    session::TaughtSample sample{.time_s = 1e-3 * i, .q_rad = posture_at(1e-3 * i)};
    for (double& q : sample.q_rad) q += gaussian(random, tremor_rad);
    sample.force_n = 12.0;
    motion.samples.push_back(std::move(sample));
  }
  return motion;
}

}  // namespace

TEST_CASE("smoothing takes the tremor of a hand away and leaves the motion where it was") {
  const session::TaughtMotion smooth = session::smoothed(led(2e-3));
  REQUIRE(smooth.samples.size() == 401);
  double worst = 0.0, worst_speed = 0.0;
  for (double time_s = 0.5; time_s < 3.5; time_s += 0.0037) {
    const auto moment = smooth.at(time_s);
    worst = std::max(worst, (moment.q_rad - posture_at(time_s)).cwiseAbs().maxCoeff());
    const JointVector speed = (posture_at(time_s + 1e-4) - posture_at(time_s - 1e-4)) / 2e-4;
    worst_speed = std::max(worst_speed, (moment.dq_rad_per_s - speed).cwiseAbs().maxCoeff());
  }
  CHECK(worst < 1.5e-3);  // a Gaussian of 50 ms flattens a cosine of 4 s by three thousandths
  CHECK(worst_speed < 0.02);
  // Before and after it the arm rests.
  CHECK(smooth.at(-1.0).dq_rad_per_s.isZero());
  CHECK(smooth.at(9.0).q_rad.isApprox(smooth.samples.back().q_rad));
  CHECK(smooth.at(9.0).dq_rad_per_s.isZero());
}

TEST_CASE("a taught motion survives its files") {
  const test::Folder folder;
  const auto file = folder / "fro.toml";
  const session::TaughtMotion motion = session::smoothed(led(0.0));
  REQUIRE(session::write_taught(motion, file).has_value());
  const auto again = session::read_taught(file);
  REQUIRE(again.has_value());
  CHECK(again->name == motion.name);
  CHECK(again->arm == Arm::right);
  CHECK(again->rail_m == doctest::Approx(motion.rail_m));
  REQUIRE(again->samples.size() == motion.samples.size());
  CHECK((again->samples[200].q_rad - motion.samples[200].q_rad).norm() < 1e-6);
}

TEST_CASE("a taught motion that cannot be played is refused with file and line") {
  const test::Folder folder;
  const auto file = folder / "fro.toml";
  const auto samples = folder / "fro.csv";
  REQUIRE(session::write_taught(session::smoothed(led(0.0)), file).has_value());
  const std::string toml = *read_file(file), csv = *read_file(samples);
  const auto refused_for = [&](const std::string& in, const std::string& path,
                               const std::string& from, const std::string& to) {
    std::string wrong = in;
    const auto at = wrong.find(from);
    REQUIRE(at != std::string::npos);
    wrong.replace(at, from.size(), to);
    REQUIRE(write_file(path, wrong).has_value());
    const auto read = session::read_taught(file);
    REQUIRE_FALSE(read.has_value());
    REQUIRE(write_file(path, in).has_value());
    return read.error().message;
  };
  const auto says = [](const std::string& message, const char* what) {
    CAPTURE(message);
    CHECK(message.find(what) != std::string::npos);
  };
  says(refused_for(toml, file, "arm = \"right\"", "arm = \"third\""),
       "arm = \"third\" is unknown; known: left, right");
  says(refused_for(toml, file, "zone = \"muscle\"", "zone = \"spine\""),
       "zone = \"spine\" is unknown; known: muscle");
  says(refused_for(toml, file, "rail_mm", "rail_m"), "fro.toml:4: `rail_m` is unknown");
  says(refused_for(csv, samples, "force_n", "force"), "no column `force_n`");
  says(refused_for(csv, samples, "\n0.0200,", "\n0.0270,"), "fro.csv:4: time_s is 0.027");
  says(refused_for(csv, samples, "\n0.0300,0", "\n0.0300,9"), "fro.csv:5: joint 1 moves at");
  says(refused_for(csv, samples, ",12.000\n0.0400", ",72.000\n0.0400"),
       "fro.csv:5: 72.0 N; the zone `muscle` bears 60");
  says(refused_for(csv, samples, ",12.000\n0.0400", ",-1.500\n0.0400"),
       "fro.csv:5: force_n is -1.5; a tool only presses");
  says(refused_for(csv, samples, "\n0.0300,", "\n0.0300,nan"), "fro.csv:5");
}

TEST_CASE("what an arm feels below zero away from the skin is written as no force") {
  const test::Folder folder;
  const auto file = folder / "fro.toml";
  session::TaughtMotion motion = session::smoothed(led(0.0));
  motion.samples.front().force_n = -0.4;
  REQUIRE(session::write_taught(motion, file).has_value());
  const auto again = session::read_taught(file);
  REQUIRE_MESSAGE(again.has_value(), again.error().message);
  CHECK(again->samples.front().force_n == 0.0);
}

TEST_CASE("a taught line is carried only as a programme that is taken") {
  session::TaughtMotion motion{
      .name = "stroke", .line = {{3.0, 0.8}, {3.0, 0.2}}, .force_n = 12.0, .speed_m_per_s = 60_mm};
  const auto carried = session::programme_of(motion);
  REQUIRE_MESSAGE(carried.has_value(), carried.error().message);
  CHECK(massage::parse_programme(*carried, "stroke").has_value());
  const auto refused = [](const session::TaughtMotion& wrong, const char* value) {
    const auto programme = session::programme_of(wrong);
    REQUIRE_FALSE(programme.has_value());
    CAPTURE(programme.error().message);
    CHECK(programme.error().message.find(value) != std::string::npos);
  };
  session::TaughtMotion strong = motion, wide = motion;
  strong.force_n = 900.0;
  refused(strong, "force_n = 900");
  wide.line[1] = {9.5, 0.2};
  refused(wide, "[9.5, 0.2]: a place is two numbers: 0.5 to 8 cun");
}
