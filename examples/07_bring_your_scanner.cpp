// SPDX-License-Identifier: Apache-2.0
// A whole session with a scanner of your own: implement Camera and Turntable, hand them to
// session::run. Here a picture is drawn where a driver would fetch one; all the rest is what a real
// scanner does: it turns, tells its angle in coarse counts, and gives frames until it has arrived.
#include <fmt/core.h>

#include "simulated_order.hpp"
#include "tuina/sim.hpp"

using namespace tuina;

namespace {

class MyScanner final : public scanner::Camera, public scanner::Turntable {
 public:
  MyScanner(const sim::Person& person, const scanner::ScannerCalibration& built)
      : driver_(person.skin_in_couch, sim::couch_mesh(person.position), built, {}, 1),
        latency_s_(built.latency_s) {}

  Result<scanner::Frame> next_frame(double timeout_s) override {
    if (!lit_) return fail(Fault::device, "no line within {:.1f} s: the laser is off", timeout_s);
    const double time_s = frames_given_ / 30.0;
    ++frames_given_;
    return scanner::Frame{.time_s = time_s,
                          .image = driver_.render(yaw_rad(time_s), Vector3::Zero(),
                                                  static_cast<std::uint64_t>(frames_given_)),
                          .dark = {}};
  }
  Result<void> sweep(double from_rad, double to_rad, double rad_per_s) override {
    from_rad_ = from_rad;
    rad_per_s_ = to_rad > from_rad ? rad_per_s : -rad_per_s;
    turn_s_ = (to_rad - from_rad) / rad_per_s_;
    frames_given_ = 0;
    return {};
  }
  Result<void> step(double, double, double) override {
    return fail(Fault::device, "this unit turns evenly only");
  }
  Result<bool> arrived() const override { return frames_given_ / 30.0 > turn_s_; }
  Result<void> switch_laser(bool on) override {
    lit_ = on;
    return {};
  }
  Result<std::vector<scanner::YawReading>> readings() const override {
    constexpr double count_rad = 0.29_deg;  // of the motor's own encoder
    std::vector<scanner::YawReading> readings;
    for (double time_s = -0.3; time_s < turn_s_ + 0.3; time_s += 0.0173)
      readings.push_back(
          {time_s - latency_s_, count_rad * std::round(yaw_rad(time_s) / count_rad)});
    return readings;
  }

 private:
  [[nodiscard]] double yaw_rad(double time_s) const { return from_rad_ + rad_per_s_ * time_s; }
  sim::LineRenderer driver_;
  double latency_s_, from_rad_ = 0.0, rad_per_s_ = 0.0, turn_s_ = 0.0;
  int frames_given_ = 0;
  bool lit_ = false;
};

}  // namespace

int main() {
  const auto person = sim::parse_person("phantom:slim", BodyPosture::sitting, 1).value();
  const auto stand = robot::place_robot(robot::load_robot("thesis").value(), person.position);
  const auto world = sim::World::make(person, stand, {}, 1).value();
  MyScanner mine(person, sim::true_calibration(person.position));
  session::Observers nobody({});
  const auto session =
      session::run({mine, mine, world->robot()}, simulated_order(*world), {}, nobody).value();
  fmt::print("{} points, {} paths performed, {} stops\n", session.scan.cloud_in_couch.size(),
             session.performed.size(), session.stops.size());
  return session.stops.empty() && !session.performed.empty() ? 0 : 1;
}
