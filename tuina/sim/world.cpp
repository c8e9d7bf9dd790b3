// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/world.hpp"

#include <chrono>
#include <cmath>
#include <optional>
#include <thread>
#include <utility>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/person/tissue_map.hpp"
#include "tuina/sim/robot/back_contact.hpp"

namespace tuina::sim {
namespace {

std::vector<TangentTissue> changed(std::vector<TangentTissue> per_vertex, double alpha_share) {
  for (TangentTissue& tissue : per_vertex) tissue.alpha_n *= 1.0 + alpha_share;
  return per_vertex;
}

}  // namespace

Person moved(Person person, const Vector3& by_in_couch) {
  for (Vector3& point : person.skin_in_couch.vertices) point += by_in_couch;
  for (Acupoint& point : person.acupoints) point.at_in_couch += by_in_couch;
  for (Landmark& point : person.landmarks) point.at_in_couch += by_in_couch;
  return person;
}

struct World::Parts {
  // Each turn of the unit sees the person where they are when it begins.
  class Scanner final : public scanner::Camera, public scanner::Turntable {
   public:
    explicit Scanner(const Parts& world) : world_(world) {}
    Result<scanner::Frame> next_frame(double timeout_s) override {
      return unit().next_frame(timeout_s);
    }
    Result<void> sweep(double from_rad, double to_rad, double rad_per_s) override {
      return turning_unit().sweep(from_rad, to_rad, rad_per_s);
    }
    Result<void> step(double from_rad, double to_rad, double step_rad) override {
      return turning_unit().step(from_rad, to_rad, step_rad);
    }
    Result<bool> arrived() const override { return unit_->arrived(); }
    Result<void> switch_laser(bool on) override { return unit().switch_laser(on); }
    Result<std::vector<scanner::YawReading>> readings() const override { return unit_->readings(); }

   private:
    // Before a person who has moved the unit begins anew.
    LaserScanner& turning_unit() {
      if (world_.shift_in_couch() != shift_) unit_.reset();
      return unit();
    }
    LaserScanner& unit() {
      if (!unit_) {
        shift_ = world_.shift_in_couch();
        unit_.emplace(moved(world_.person, shift_).skin_in_couch, world_.person.position,
                      world_.options.breathing, world_.seed,
                      LaserScannerOptions{.room_light_dn = world_.options.room_light_dn,
                                          .flaws = world_.options.scan_flaws});
      }
      return *unit_;
    }
    const Parts& world_;
    std::optional<LaserScanner> unit_;
    Vector3 shift_ = Vector3::Zero();
  };

  // The plant is made where the session wants the robot to stand.
  class ReadyRobot final : public robot::Robot {
   public:
    explicit ReadyRobot(Parts& world) : world_(world) {}
    Result<void> stand_ready(const robot::ReadyPose& pose) override {
      if (world_.plant) return {};
      PlantOptions devices = world_.options.devices;
      devices.seed = world_.seed;
      auto made =
          Plant::make(world_.robot, world_.true_arms, {.q_rad = pose.q_rad, .rail_m = pose.rail_m},
                      &world_.contact, devices);
      if (!made) return tl::unexpected(made.error());
      world_.plant = std::move(*made);
      return {};
    }
    std::optional<robot::RobotReading> read() noexcept override {
      if (!world_.plant) return std::nullopt;
      auto reading = world_.plant->read();
      if (world_.options.pace) wait_for(reading->time_s / *world_.options.pace);
      return reading;
    }
    void apply(const robot::RobotCommand& command) noexcept override {
      world_.plant->apply(command);
    }
    const char* fault() const noexcept override {
      return world_.plant ? world_.plant->fault() : "it does not stand ready";
    }

   private:
    using Clock = std::chrono::steady_clock;
    void wait_for(double clock_s) noexcept {
      // A scan or a plan in between is not caught up with: time goes on from there.
      constexpr std::chrono::duration<double> max_behind(0.1);
      const auto due = start_ + std::chrono::duration<double>(clock_s);
      if (!started_ || Clock::now() - due > max_behind) {
        start_ = Clock::now() - std::chrono::duration_cast<Clock::duration>(
                                    std::chrono::duration<double>(clock_s));
        started_ = true;
        return;
      }
      std::this_thread::sleep_until(due);
    }
    Parts& world_;
    Clock::time_point start_;
    bool started_ = false;
  };

  Parts(const Person& who, const robot::RobotPlacement& placement, const WorldOptions& given,
        std::uint64_t drawn_by)
      : person(who),
        robot(placement),
        options(given),
        seed(drawn_by),
        contact(who.skin_in_couch, changed(lay_tissue(who, drawn_by), given.tissue_change_share),
                {.torso_n_per_m = given.torso_n_per_m,
                 .friction = given.skin_friction,
                 .breathing = given.breathing,
                 .living = given.living,
                 .seed = drawn_by}),
        scanner(*this),
        ready_robot(*this) {
    Random errors = make_random(drawn_by, "true arms");
    for (const Arm arm : both_arms)
      true_arms[arm] = draw_arm(placement.arm, given.arm_errors, errors);
    if (given.shift_m == 0.0) return;
    contact.add_shift({.start_s = given.shift_at_s,
                       .by_in_couch = given.shift_m * contact.mean_normal_in_couch(),
                       .speed_m_per_s = 0.05,
                       .acceleration_m_per_s2 = 0.5});
  }

  [[nodiscard]] Vector3 shift_in_couch() const {
    const double time_s = told ? told->time_s : plant ? plant->truth().time_s : 0.0;
    const bool has_moved = options.shift_m != 0.0 && time_s >= options.shift_at_s;
    return has_moved ? Vector3(options.shift_m * contact.mean_normal_in_couch())
                     : Vector3(Vector3::Zero());
  }

  Person person;
  robot::RobotPlacement robot;
  WorldOptions options;
  std::uint64_t seed;
  PerArm<robot::ArmTable> true_arms;
  BackContact contact;
  std::unique_ptr<Plant> plant;
  std::optional<PlantTruth> told;  ///< by another process
  Scanner scanner;
  ReadyRobot ready_robot;
};

World::World(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
World::~World() = default;

Result<std::unique_ptr<World>> World::make(const Person& person, const robot::RobotPlacement& robot,
                                           const WorldOptions& options, std::uint64_t seed) {
  if (person.skin_in_couch.vertices.empty())
    return fail(Fault::bad_input, "{}: the person has no skin", person.name);
  return std::unique_ptr<World>(new World(std::make_unique<Parts>(person, robot, options, seed)));
}

scanner::Camera& World::camera() {
  return parts_->scanner;
}
scanner::Turntable& World::turntable() {
  return parts_->scanner;
}
robot::Robot& World::robot() {
  return parts_->ready_robot;
}

scanner::ScannerCalibration World::believed_calibration() const {
  return sim::believed_calibration(true_calibration(parts_->person.position), parts_->seed);
}

Transform World::believed_base_from_couch() const {
  constexpr double place_sd_m = 2_mm, turn_sd_rad = 0.3_deg;
  Random random = make_random(parts_->seed, "scanner to robot");
  const auto drawn = [&](double sd) {
    const double each = sd / std::sqrt(3.0);
    const double x = gaussian(random, each), y = gaussian(random, each), z = gaussian(random, each);
    return Vector3(x, y, z);
  };
  const Vector3 turn = drawn(turn_sd_rad);
  const Vector3 shift = drawn(place_sd_m);
  Transform error = Transform::Identity();
  error.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  error.translation() = shift;
  return error * parts_->robot.mount.base_from_couch;
}

const Person& World::person() const {
  return parts_->person;
}
const robot::RobotMount& World::mount() const {
  return parts_->robot.mount;
}
const robot::ArmTable& World::robot_table() const {
  return parts_->robot.arm;
}
Vector3 World::shift_in_couch() const {
  return parts_->shift_in_couch();
}
const PlantTruth& World::truth() const {
  return parts_->told ? *parts_->told : parts_->plant->truth();
}
void World::tell_truth(const PlantTruth& truth) {
  parts_->told = truth;
}
Plant& World::plant() {
  return *parts_->plant;
}
BackContact& World::contact() {
  return parts_->contact;
}
const BackContact& World::contact() const {
  return parts_->contact;
}

}  // namespace tuina::sim
