// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "apps/cli/table.hpp"
#include "apps/evaluation/cells.hpp"
#include "apps/evaluation/verbs.hpp"
#include "tuina/core/stopwatch.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/back_chart.hpp"
#include "tuina/massage/plan.hpp"
#include "tuina/motion/ready_plan.hpp"
#include "tuina/robot/inverse_kinematics.hpp"
#include "tuina/robot/ready_posture.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/sim/person/person.hpp"

namespace tuina::app {
namespace {

using nlohmann::ordered_json;

/// A phantom as it truly is: no scan stands between the robots that are compared.
struct Subject {
  sim::Person person;
  body::BackSurface back;
};

Result<Subject> subject_of(const std::string& who, BodyPosture position, std::uint64_t seed) {
  auto person = sim::parse_person(who, position, seed);
  if (!person) return tl::unexpected(person.error());
  PointCloud skin_in_couch;
  skin_in_couch.points = person->skin_in_couch.vertices;
  auto back = body::fit_back(skin_in_couch, {.position = position});
  if (!back) return tl::unexpected(back.error());
  return Subject{std::move(*person), std::move(*back)};
}

/// How well both arms reach a back from the best place of the linear base.
struct Workspace {
  int places = 0, reached = 0;
  double dexterity = 0.0;       ///< median, m/rad
  double limit_room_rad = 0.0;  ///< median, from the joint that is closest to its end
};

/// Places every 30 mm, from GV4 to the shoulders, as wide as the shoulder blades; each arm serves
/// its half and 30 mm more.
PerArm<std::vector<robot::ContactGoal>> patch_on(const Subject& subject,
                                                 const massage::BackChart& chart,
                                                 const Transform& base_from_couch) {
  constexpr double step_m = 30_mm;
  constexpr int half_width = 5, up = 11, below = 1;  // steps
  PerArm<std::vector<robot::ContactGoal>> goals;
  for (int i = -half_width; i <= half_width; ++i) {
    for (int k = -below; k <= up; ++k) {
      const double left_m = i * step_m;
      const Vector3 flat = chart.in_couch({.left_m = left_m, .up_m = k * step_m});
      const auto met = subject.back.along(flat + 250_mm * chart.out(), -chart.out());
      if (!met) continue;
      const double to_plus_x_m = chart.left().x() > 0.0 ? left_m : -left_m;
      for (const Arm arm : both_arms) {
        if ((arm == Arm::left ? to_plus_x_m : -to_plus_x_m) < -step_m - 1e-9) continue;
        goals[arm].push_back(
            {base_from_couch * met->at_in_couch, base_from_couch.linear() * met->normal_in_couch});
      }
    }
  }
  return goals;
}

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Workspace workspace_of(const robot::RobotPlacement& placement, const Subject& subject,
                       const massage::BackChart& chart) {
  constexpr double step_m = 100_mm;
  const auto arms = robot::both_models(placement.arm, placement.mount);
  const auto ready = robot::ready_posture(placement.arm, placement.mount);
  const auto goals = patch_on(subject, chart, placement.mount.base_from_couch);
  Workspace best;
  const double min_m = placement.mount.min_rail_m, max_m = placement.mount.max_rail_m;
  const int steps = static_cast<int>((max_m - min_m + 1e-9) / step_m);
  for (int step = 0; step <= steps; ++step) {
    const double rail_m = min_m + step * step_m;
    Workspace here;
    std::vector<double> dexterities, rooms;
    for (const Arm arm : both_arms) {
      for (const robot::ContactGoal& goal : goals[arm]) {
        ++here.places;
        const auto posture = robot::find_posture(arms[arm], rail_m, goal, ready[arm]);
        if (posture.reach != robot::Reach::reached) continue;
        ++here.reached;
        dexterities.push_back(posture.dexterity);
        rooms.push_back(posture.limit_room_rad);
      }
    }
    here.dexterity = median(dexterities);
    here.limit_room_rad = median(rooms);
    if (best.places == 0 || here.reached > best.reached) best = here;
  }
  return best;
}

/// What one robot came to on one person with one programme: a cell.
struct RobotResult {
  double reached_percent = 0.0, dexterity_m_per_rad = 0.0, limit_room_deg = 0.0;
  std::size_t paths = 0, left_out = 0;
  double duration_s = 0.0, plan_ms = 0.0, arms_mm = 0.0, couch_mm = 0.0, body_mm = 0.0;
};

template <typename Outcome, typename Visit>
requires std::is_same_v<std::remove_const_t<Outcome>, RobotResult>
void visit_fields(Outcome& result, const Visit& visit) {
  visit("reached_percent", result.reached_percent);
  visit("dexterity_m_per_rad", result.dexterity_m_per_rad);
  visit("limit_room_deg", result.limit_room_deg);
  visit("paths", result.paths);
  visit("left_out", result.left_out);
  visit("duration_s", result.duration_s);
  visit("plan_ms", result.plan_ms);
  visit("arms_mm", result.arms_mm);
  visit("couch_mm", result.couch_mm);
  visit("body_mm", result.body_mm);
}

struct Row {
  std::string robot;
  std::string who;
  BodyPosture position;
  std::string programme;
  RobotResult result;
};

/// Robots beside each other: what they reach of a back, and how long their sessions are.
class EvaluateRobots final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "evaluate robots"; }
  [[nodiscard]] const char* summary() const override {
    return "robots beside each other: workspace, session times, distances";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina evaluate robots --programmes relax full_back_20min";
  }
  void describe(Options& options) override {
    options.add("--programmes", programmes_, "shipped ones or files").show_default();
    options.add("--robots", robots_, "shipped ones or files").show_default();
    cells_.describe(options);
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (auto opened = cells_.open(common, *config); !opened) return tl::unexpected(opened.error());
    std::vector<massage::Programme> programmes;
    for (const std::string& name : programmes_) {
      auto programme = massage::load_programme(name);
      if (!programme) return tl::unexpected(programme.error());
      programmes.push_back(std::move(*programme));
    }
    std::vector<robot::RobotModel> robots;
    for (const std::string& name : robots_) {
      auto robot = robot::load_robot(name);
      if (!robot) return tl::unexpected(robot.error());
      robots.push_back(std::move(*robot));
    }
    const Progress bar = progress_bar(common, "robots");
    std::vector<Row> rows;
    double done = 0.0;
    for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
      for (const char* who : {"phantom:slim", "phantom:medium", "phantom:hefty"}) {
        const auto subject = subject_of(who, position, common.seed);
        if (!subject) return tl::unexpected(subject.error());
        for (const robot::RobotModel& robot : robots) {
          for (const massage::Programme& programme : programmes) {
            const auto cell =
                fmt::format("{} {} {} {}", who, name_of(position), robot.name, programme.name);
            const auto result =
                cells_.at<RobotResult>(cell, [&] { return result_of(robot, *subject, programme); });
            if (!result) return tl::unexpected(result.error());
            rows.push_back({robot.name, who, position, programme.name, *result});
          }
          if (bar) bar((done += 1.0) / (6.0 * static_cast<double>(robots.size())));
        }
      }
    }
    return cells_.answer([&]() -> Result<Answer> { return answer(rows); });
  }

 private:
  static Result<RobotResult> result_of(const robot::RobotModel& model, const Subject& subject,
                                       const massage::Programme& programme) {
    const sim::Person& person = subject.person;
    const auto chart = massage::BackChart::from(person.acupoints, person.landmarks);
    if (!chart) return tl::unexpected(chart.error());
    auto plan = massage::plan(subject.back, person.acupoints, person.landmarks, programme);
    if (!plan) return tl::unexpected(plan.error());
    RobotResult result{.paths = plan->paths.size()};
    const robot::RobotPlacement placement = robot::place_robot(model, person.position, false);
    const Workspace workspace = workspace_of(placement, subject, *chart);
    result.reached_percent = 100.0 * workspace.reached / std::max(workspace.places, 1);
    result.dexterity_m_per_rad = workspace.dexterity;
    result.limit_room_deg = to_deg(workspace.limit_room_rad);
    const Stopwatch watch;
    const auto ready = motion::make_ready(std::move(*plan), subject.back, placement.mount,
                                          robot::both_models(placement.arm, placement.mount),
                                          placement.mount.base_from_couch, 40_mm);
    result.plan_ms = watch.ms();
    if (!ready) return tl::unexpected(ready.error());
    result.left_out = result.paths - ready->plan.paths.size();
    result.duration_s = ready->plan.duration_s;
    result.arms_mm = to_mm(ready->min_arm_distance_m);
    result.couch_mm = to_mm(ready->clear[robot::Surrounding::couch]);
    result.body_mm = to_mm(ready->clear[robot::Surrounding::body]);
    return result;
  }

  static Answer answer(const std::vector<Row>& rows) {
    telemetry::Table table{
        .columns = {{.head = "robot", .key = "robot"},
                    {.head = "person", .key = "person"},
                    {.head = "position", .key = "position"},
                    {.head = "reach, %", .key = "reached_percent", .digits = 1},
                    {.head = "m/rad", .key = "dexterity_m_per_rad", .digits = 3},
                    {.head = "room, deg", .key = "limit_room_deg", .digits = 1},
                    {.head = "programme", .key = "programme"},
                    {.head = "s", .key = "duration_s", .digits = 0},
                    {.key = "paths"},
                    {.head = "left out", .key = "left_out"},
                    {.head = "arms, mm", .key = "min_arm_distance_mm", .digits = 0},
                    {.head = "couch, mm", .key = "min_couch_distance_mm", .digits = 0},
                    {.head = "own body, mm", .key = "min_body_distance_mm", .digits = 0},
                    {.head = "plan, ms", .key = "plan_ms", .digits = 0}}};
    for (const Row& row : rows) {
      const RobotResult& did = row.result;
      table.add({row.robot, row.who, name_of(row.position), did.reached_percent,
                 did.dexterity_m_per_rad, did.limit_room_deg, row.programme, did.duration_s,
                 did.paths, did.left_out, did.arms_mm, did.couch_mm, did.body_mm, did.plan_ms});
    }
    return {.json = ordered_json{{"robots", to_json(table)}}.dump(2), .text = to_text(table)};
  }

  Cells cells_;
  std::vector<std::string> robots_ = {"thesis", "successor"};
  std::vector<std::string> programmes_ = {"relax", "full_back_20min"};
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_robots() {
  return std::make_unique<EvaluateRobots>();
}

}  // namespace tuina::app
