// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/fit/yaw_axis.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "tuina/core/decompositions.hpp"
#include "tuina/core/units.hpp"

namespace tuina::calibration {
namespace {

constexpr double min_turn_rad = 5.0_deg;
// Turn between two views: motor counts, play, and errors of the initial poses.
constexpr double tolerated_rad = 1.5_deg;
constexpr double tolerated_turn_share = 0.03;

// Motion of the unit from view a to view b, T(yaw_a)^-1 T(yaw_b), in the camera frame.
struct Turn {
  int pose = 0;
  double yaw_rad = 0.0;
  Transform motion = Transform::Identity();
  Vector3 turned_rad = Vector3::Zero();  // rotation vector
};

Vector3 logarithm(const Matrix3& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

// The board counted from its opposite corner; a chessboard looks the same that way round.
void count_from_other_end(View& view, Transform& camera_from_board, const Board& board) {
  std::reverse(view.corners_px.begin(), view.corners_px.end());
  Transform half_turn = Transform::Identity();
  half_turn.linear() = Eigen::AngleAxisd(pi, Vector3::UnitZ()).toRotationMatrix();
  half_turn.translation() = board.square_m * Vector3(board.columns - 1, board.rows - 1, 0.0);
  camera_from_board = camera_from_board * half_turn;
}

// Turns from the first view of each standing board to its others.
std::vector<Turn> turns_of(Views& views, std::vector<Transform>& camera_from_board) {
  std::map<int, std::size_t> first;
  std::vector<Turn> turns;
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    View& view = views.views[i];
    const auto [entry, is_first] = first.emplace(view.pose, i);
    if (is_first) continue;
    const std::size_t reference = entry->second;
    const Matrix3 seen_before = camera_from_board[reference].linear();
    // No unit turns by 90 degrees and still sees the board; counted from the other end it appears
    // turned by 180.
    if (!views.board.has_markers() &&
        logarithm(seen_before * camera_from_board[i].linear().transpose()).norm() > 0.5 * pi) {
      count_from_other_end(view, camera_from_board[i], views.board);
    }
    Turn turn{.pose = view.pose, .yaw_rad = view.yaw_rad - views.views[reference].yaw_rad};
    turn.motion = camera_from_board[reference] * camera_from_board[i].inverse();
    turn.turned_rad = logarithm(turn.motion.linear());
    turns.push_back(turn);
  }
  return turns;
}

Result<void> check(const std::vector<Turn>& turns, const Vector3& direction) {
  double max_rad = 0.0;
  for (const Turn& turn : turns) {
    max_rad = std::max(max_rad, std::abs(turn.yaw_rad));
    const double tolerance_rad = tolerated_rad + tolerated_turn_share * std::abs(turn.yaw_rad);
    if ((turn.turned_rad + turn.yaw_rad * direction).norm() < tolerance_rad &&
        std::abs(turn.yaw_rad) > tolerance_rad) {
      return fail(Fault::bad_input,
                  "the standing board of pose {} shows the unit turning by {:.1f} deg where "
                  "yaw_deg says {:.1f}: the sign of its yaw is wrong, or its pictures are mirrored",
                  turn.pose, to_deg(turn.turned_rad.dot(direction)), to_deg(turn.yaw_rad));
    }
    if ((turn.turned_rad - turn.yaw_rad * direction).norm() > tolerance_rad) {
      return fail(Fault::bad_input,
                  "the standing board of pose {} shows the unit turning by {:.1f} deg where "
                  "yaw_deg says {:.1f}: did the board move, or is a picture in the wrong row?",
                  turn.pose, to_deg(turn.turned_rad.norm()), to_deg(turn.yaw_rad));
    }
  }
  if (max_rad < min_turn_rad) {
    return fail(Fault::bad_input,
                "the unit turned by {:.1f} deg before a standing board, {:.0f} needed; turn it "
                "from one side of the picture to the other",
                to_deg(max_rad), to_deg(min_turn_rad));
  }
  return {};
}

}  // namespace

Result<YawAxis> find_yaw_axis(Views& views, std::vector<Transform>& camera_from_board) {
  const auto turns = turns_of(views, camera_from_board);
  if (turns.empty()) {
    return fail(Fault::bad_input,
                "no pose is seen at several yaw angles, so the yaw axis is unknown: leave the "
                "board standing and turn the unit, with the same pose number in frames.csv");
  }
  Vector3 sum = Vector3::Zero();
  for (const Turn& turn : turns) sum += turn.yaw_rad * turn.turned_rad;
  YawAxis axis;
  if (sum.norm() > 0.0) axis.direction_in_camera = sum.normalized();
  if (const auto good = check(turns, axis.direction_in_camera); !good) {
    return tl::unexpected(good.error());
  }
  // A point of the axis stays fixed: (1 - R) p = t for every turn, and p is perpendicular to the
  // axis.
  Matrix3 sums = axis.direction_in_camera * axis.direction_in_camera.transpose();
  Vector3 moments = Vector3::Zero();
  for (const Turn& turn : turns) {
    const Matrix3 moved = Matrix3::Identity() - turn.motion.linear();
    sums += moved.transpose() * moved;
    moments += moved.transpose() * turn.motion.translation();
  }
  axis.point_in_camera = solve_symmetric(sums, moments);
  return axis;
}

}  // namespace tuina::calibration
