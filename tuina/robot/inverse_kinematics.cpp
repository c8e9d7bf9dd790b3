// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/inverse_kinematics.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "tuina/robot/tool_task.hpp"

namespace tuina::robot {
namespace {

constexpr double radian_m = 0.3;  // a radian of tool direction counts like so many metres
constexpr double position_close_m = 1e-5;
constexpr double direction_close_rad = 1e-3;
constexpr double max_step_rad = 0.3;
constexpr int max_iterations = 60;
constexpr int seeds = 10;
constexpr double jump_rad = 0.35;  // too far between neighbours on a path

double lowest(const Link& link, double margin) {
  return link.min_rad + margin;
}
double highest(const Link& link, double margin) {
  return link.max_rad - margin;
}

/// Halton points: spread evenly over all joints at once, and the same on every machine.
double halton(int index, int base) {
  double result = 0.0, part = 1.0;
  for (; index > 0; index /= base) {
    part /= base;
    result += part * (index % base);
  }
  return result;
}

JointVector seed_posture(const ArmTable& table, int index) {
  constexpr std::array<int, max_joints> primes = {2, 3, 5, 7, 11, 13, 17};
  JointVector q(table.joints);
  for (int i = 0; i < table.joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Link& link = table.links[k];
    q[i] = link.min_rad + halton(index + 1, primes[k]) * (link.max_rad - link.min_rad);
  }
  return q;
}

/// The task: position of the tool, and its axis within a cone around the direction of pressing.
struct Task {
  const ArmModel& arm;
  double rail_m;
  Vector3 centre_in_base;
  Vector3 press_in_base;  // unit, into the body
  Vector3 skin_in_base;
  const PostureOptions& options;
};

struct TaskState {
  ArmModel::Kinematics kinematics;
  Matrix6 weighted;   // J J^T of the task
  Jacobian jacobian;  // of the task, rows 3-5 scaled by radian_m and without the turn about the
                      // tool's axis
  Vector6 error;
  double off_m, tilt_rad, elbow_height_m;
};

TaskState look(const Task& task, const JointVector& q, double cone_rad) {
  TaskState state;
  state.kinematics = task.arm.kinematics(q, task.rail_m);
  const auto& k = state.kinematics;
  const Vector3 axis = k.base_from_tool.linear().col(0);
  const Vector3 off = task.centre_in_base - k.base_from_tool.translation();
  const Vector3 turn = axis.cross(task.press_in_base);
  const double sine = turn.norm();
  state.off_m = off.norm();
  state.tilt_rad = std::atan2(sine, axis.dot(task.press_in_base));
  const double excess = state.tilt_rad - cone_rad;
  state.jacobian = k.jacobian;
  Vector3 correction = Vector3::Zero();
  if (excess > 0.0) {
    // A tool that points straight backwards may turn about anything across its axis.
    const Vector3 about = sine > 1e-9 ? Vector3(turn / sine) : Vector3(axis.unitOrthogonal());
    correction = about * excess;
    const Matrix3 across = Matrix3::Identity() - axis * axis.transpose();
    state.jacobian.bottomRows<3>() = radian_m * across * k.jacobian.bottomRows<3>();
  } else {
    state.jacobian.bottomRows<3>().setZero();
  }
  state.error << off, radian_m * correction;
  state.weighted = state.jacobian * state.jacobian.transpose();
  const std::size_t elbow = task.arm.elbow();
  state.elbow_height_m = (k.origins_in_base[elbow] - task.skin_in_base).dot(-task.press_in_base);
  return state;
}

/// Where the free joint should go: away from the limits, the elbow away from the person, the tool
/// upright.
JointVector wish(const Task& task, const TaskState& state, const JointVector& q) {
  const ArmTable& table = task.arm.table();
  JointVector wish(q.size());
  for (int i = 0; i < q.size(); ++i) {
    const Link& link = table.links[static_cast<std::size_t>(i)];
    const double half = 0.5 * (link.max_rad - link.min_rad);
    const double from_middle = (q[i] - 0.5 * (link.max_rad + link.min_rad)) / half;
    wish[i] = -0.05 * from_middle;
  }
  const std::size_t elbow = task.arm.elbow();
  const auto& origins = state.kinematics.origins_in_base;
  // The base's origin is midway between the shoulders.
  const Vector3 outward = task.arm.shoulder_in_base(0.0).normalized();
  const double low_m = 2.0 * task.options.elbow_clearance_m - state.elbow_height_m;
  const double inward_m = task.options.elbow_outward_m > 0.0
                              ? task.options.elbow_outward_m - origins[elbow].dot(outward)
                              : 0.0;
  const Vector3 pull_m =
      std::max(low_m, 0.0) * -task.press_in_base + std::max(inward_m, 0.0) * outward;
  if (!pull_m.isZero()) {
    for (std::size_t i = 0; i < elbow; ++i) {
      const Vector3 axis = state.kinematics.jacobian.col(static_cast<Eigen::Index>(i)).tail<3>();
      const Vector3 velocity = axis.cross(origins[elbow] - origins[i]);
      wish[static_cast<Eigen::Index>(i)] += 20.0 * velocity.dot(pull_m);
    }
  }
  const Vector3 axis = state.kinematics.base_from_tool.linear().col(0);
  wish +=
      0.2 * state.kinematics.jacobian.bottomRows<3>().transpose() * axis.cross(task.press_in_base);
  return wish;
}

/// How well a posture suits: dexterous, upright, and not so close to the end of a joint that the
/// next place on the skin may lie beyond it.
double worth(const ContactPosture& posture) {
  return posture.dexterity * (1.0 - posture.tilt_rad) *
         std::min(1.0, posture.limit_room_rad / 15_deg);
}

ContactPosture descend(const Task& task, JointVector q, double cone_rad) {
  const ArmTable& table = task.arm.table();
  const double margin = task.options.limit_margin_rad;
  bool limited = false;
  TaskState state = look(task, q, cone_rad);
  for (int n = 0; n < max_iterations; ++n) {
    // Damping by the error itself keeps far steps sane and close ones quadratic, [sugihara2011].
    const double damping = 1e-7 + 1e-2 * state.error.squaredNorm();
    Matrix6 damped = state.weighted;
    damped.diagonal().array() += damping;
    const Eigen::LDLT<Matrix6> factor(damped);
    const JointVector wanted = wish(task, state, q);
    const Vector6 rest = state.error - state.jacobian * wanted;
    const Vector6 along = factor.solve(rest);
    JointVector step = state.jacobian.transpose() * along + wanted;
    const double most = step.cwiseAbs().maxCoeff();
    if (most > max_step_rad) step *= max_step_rad / most;
    q += step;
    limited = false;
    for (int i = 0; i < table.joints; ++i) {
      const Link& link = table.links[static_cast<std::size_t>(i)];
      const double inside = std::clamp(q[i], lowest(link, margin), highest(link, margin));
      limited = limited || inside != q[i];
      q[i] = inside;
    }
    state = look(task, q, cone_rad);
    const bool there =
        state.off_m < position_close_m && state.tilt_rad < cone_rad + direction_close_rad;
    if (there && state.elbow_height_m > task.options.elbow_clearance_m && (most < 0.01 || n > 20))
      break;
  }
  ContactPosture posture{
      .q_rad = q, .limit_room_rad = limit_room_rad(table, q), .tilt_rad = state.tilt_rad};
  // Comparisons that hold make it reached: with a goal that is no number none holds.
  if (!(state.off_m <= position_close_m && state.tilt_rad <= cone_rad + direction_close_rad)) {
    posture.reach = limited ? Reach::joint_limits : Reach::too_far;
  } else if (!(state.elbow_height_m >= task.options.elbow_clearance_m)) {
    posture.reach = Reach::elbow_in_person;
  } else {
    posture.reach = Reach::reached;
  }
  if (posture.reach == Reach::reached)
    posture.dexterity = robot::dexterity(task.arm.kinematics(q, task.rail_m));
  return posture;
}

Task make_task(const ArmModel& arm, double rail_m, const ContactGoal& goal,
               const PostureOptions& options) {
  const double radius_m = arm.table().tool_radius_m - options.press_depth_m;
  return {arm,
          rail_m,
          goal.at_in_base + radius_m * goal.normal_in_base,
          -goal.normal_in_base,
          goal.at_in_base,
          options};
}

/// No posture reaches farther than the stretched arm, whatever the tilt.
bool out_of_reach(const Task& task) {
  const Vector3 from_shoulder = task.centre_in_base - task.arm.shoulder_in_base(task.rail_m);
  return !(from_shoulder.norm() <= task.arm.reach_m());
}

}  // namespace

double dexterity(const ArmModel::Kinematics& pose) noexcept {
  ToolJacobian J = tool_jacobian(pose.base_from_tool, pose.jacobian);
  J.bottomRows<2>() *= radian_m;
  const Eigen::Matrix<double, 5, 5> square = J * J.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 5, 5>> eigen(square,
                                                                         Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[0]));
}

double limit_room_rad(const ArmTable& table, const JointVector& q_rad) noexcept {
  double room_rad = pi;
  for (int i = 0; i < table.joints; ++i) {
    const Link& link = table.links[static_cast<std::size_t>(i)];
    room_rad = std::min({room_rad, q_rad[i] - link.min_rad, link.max_rad - q_rad[i]});
  }
  return room_rad;
}

const char* explain(Reach reach) noexcept {
  switch (reach) {
    case Reach::reached:
      return "reached";
    case Reach::too_far:
      return "too far for the arm with the tool along the normal";
    case Reach::joint_limits:
      return "beyond the joints' limits";
    case Reach::elbow_in_person:
      return "only with the elbow in the person";
  }
  return "";
}

ContactPosture find_posture(const ArmModel& arm, double rail_m, const ContactGoal& goal,
                            const JointVector& near_rad, const PostureOptions& options) noexcept {
  const Task task = make_task(arm, rail_m, goal, options);
  if (out_of_reach(task)) return {.q_rad = near_rad};
  ContactPosture best{.q_rad = near_rad};
  for (const double cone : {0.0, 0.5 * options.max_tilt_rad, options.max_tilt_rad}) {
    ContactPosture posture = descend(task, near_rad, cone);
    if (posture.reach == Reach::reached) return posture;
    best.reach = posture.reach;
    for (int seed = 0; seed < seeds; ++seed) {
      posture = descend(task, seed_posture(arm.table(), seed), cone);
      if (posture.reach == Reach::reached && worth(posture) > worth(best)) best = posture;
    }
    if (best.reach == Reach::reached) return best;
  }
  return best;
}

Result<std::vector<ContactPosture>> follow(const ArmModel& arm, double rail_m,
                                           std::span<const ContactGoal> path,
                                           const JointVector& near_rad,
                                           const PostureOptions& options) {
  std::size_t farthest = 0;
  Reach why = Reach::too_far;
  // The posture that suits the start best need not lead to the end: others are tried before giving
  // up.
  for (int attempt = -1; attempt < seeds; ++attempt) {
    const JointVector start = attempt < 0 ? near_rad : seed_posture(arm.table(), attempt);
    std::vector<ContactPosture> postures;
    for (const ContactGoal& goal : path) {
      const Task task = make_task(arm, rail_m, goal, options);
      ContactPosture posture;
      for (const double cone : {0.0, 0.5 * options.max_tilt_rad, options.max_tilt_rad}) {
        posture = postures.empty() && attempt < 0
                      ? find_posture(arm, rail_m, goal, start, options)
                      : descend(task, postures.empty() ? start : postures.back().q_rad, cone);
        const bool jumps = !postures.empty() &&
                           (posture.q_rad - postures.back().q_rad).cwiseAbs().maxCoeff() > jump_rad;
        if (posture.reach == Reach::reached && jumps) posture.reach = Reach::joint_limits;
        if (posture.reach == Reach::reached) break;
      }
      if (posture.reach != Reach::reached) {
        if (postures.size() >= farthest) why = posture.reach;
        break;
      }
      postures.push_back(posture);
    }
    if (postures.size() == path.size()) return postures;
    farthest = std::max(farthest, postures.size());
  }
  const Vector3 at = path[farthest].at_in_base;
  return fail(Fault::not_found,
              "place {} of {} is {}: {:.0f} mm from the shoulder, the arm reaches {:.0f} mm",
              farthest + 1, path.size(), explain(why),
              to_mm((at - arm.shoulder_in_base(rail_m)).norm()),
              to_mm(arm.reach_m() + arm.table().tool_radius_m));
}

Result<double> choose_rail(const PerArm<const ArmModel*>& arms, const RobotMount& mount,
                           const PerArm<std::vector<ContactGoal>>& goals,
                           const PerArm<JointVector>& near_rad, const PostureOptions& options) {
  constexpr double step_m = 50_mm;
  double best_rail_m = 0.0, best_worth = -1.0;
  std::size_t best_reached = 0;
  const std::size_t all = goals[Arm::left].size() + goals[Arm::right].size();
  const int steps = static_cast<int>((mount.max_rail_m - mount.min_rail_m + 1e-9) / step_m);
  for (int i = 0; i <= steps; ++i) {
    const double rail_m = mount.min_rail_m + i * step_m;
    std::size_t reached = 0, left = all;
    double worst = 1e9;
    // A place of the base that cannot become the best any more is not looked at further.
    const auto hopeless = [&] {
      return reached + left < best_reached ||
             (reached + left == best_reached && worst <= best_worth);
    };
    for (const Arm arm : both_arms) {
      for (const ContactGoal& goal : goals[arm]) {
        if (hopeless()) break;
        --left;
        const Task task = make_task(*arms[arm], rail_m, goal, options);
        if (out_of_reach(task)) continue;
        const ContactPosture posture =
            find_posture(*arms[arm], rail_m, goal, near_rad[arm], options);
        if (posture.reach != Reach::reached) continue;
        ++reached;
        worst = std::min(worst, worth(posture));
      }
    }
    if (reached > best_reached || (reached == best_reached && reached > 0 && worst > best_worth)) {
      best_rail_m = rail_m;
      best_worth = worst;
      best_reached = reached;
    }
  }
  if (best_reached < all) {
    return fail(Fault::not_found, "the arms reach {} of {} places, best with the base at {:.0f} mm",
                best_reached, all, to_mm(best_rail_m));
  }
  return best_rail_m;
}

}  // namespace tuina::robot
