// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/wrist_calibration.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/decompositions.hpp"
#include "tuina/core/io/csv.hpp"
#include "tuina/core/io/toml_reader.hpp"
#include "tuina/core/units.hpp"

namespace tuina::hardware {
namespace {

constexpr std::size_t min_poses = 6;
constexpr double max_condition = 20.0;
// Errors that a calibration may leave: together far less than the 1.2 N of wrong weight or zero at
// which the guard brakes an arm.
constexpr double max_mass_sd_kg = 0.02, max_com_sd_m = 10_mm, max_offset_sd_n = 0.3;
constexpr double max_stray_n = 0.5, stray_share = 5.0;  // of the median over the other poses
constexpr double max_rms_n = 1.0;
constexpr double min_weight_n = 0.2;
constexpr double max_force_n = 1e4, max_torque_nm = 1e3, max_mass_kg = 20.0, max_com_m = 1.0;

Matrix3 cross_of(const Vector3& v) {
  Matrix3 cross;
  cross << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return cross;
}

Vector3 down_in_tool(const WristPose& pose) {
  return pose.base_from_tool.transpose() * Vector3(0.0, 0.0, -1.0);
}

/// Least squares of rows of three equations each.
struct Squares {
  explicit Squares(Eigen::Index unknowns)
      : normal(Eigen::MatrixXd::Zero(unknowns, unknowns)), right(Eigen::VectorXd::Zero(unknowns)) {}

  void add(const Eigen::Matrix3Xd& rows, const Vector3& seen) {
    normal += rows.transpose() * rows;
    right += rows.transpose() * seen;
    equations += 3;
  }
  [[nodiscard]] double condition() const {
    const Eigen::VectorXd values = eigenvalues(normal);
    return std::sqrt(values(values.size() - 1) / std::max(values(0), 1e-12));
  }
  [[nodiscard]] Eigen::VectorXd solve() const { return solve_symmetric(normal, right); }
  /// Variances of the unknowns where the residuals' squares sum up to `sum2`.
  [[nodiscard]] Eigen::VectorXd variances(double sum2) const {
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(right.size(), right.size());
    const auto spare = static_cast<double>(equations - right.size());
    return solve_symmetric(normal, one).diagonal() * (sum2 / spare);
  }

  Eigen::MatrixXd normal;
  Eigen::VectorXd right;
  Eigen::Index equations = 0;
};

Eigen::Matrix3Xd force_rows(const Vector3& down) {
  Eigen::Matrix3Xd rows(3, 4);
  rows << Matrix3::Identity(), down;
  return rows;
}

Eigen::Matrix3Xd torque_rows(const Vector3& down) {
  Eigen::Matrix3Xd rows(3, 6);
  rows << Matrix3::Identity(), -cross_of(down);
  return rows;
}

/// The pose that the others contradict, and by how much; nothing where there is none.
Result<void> judge_strays(std::span<const WristPose> poses, const std::vector<double>& left_n) {
  std::vector<double> sorted = left_n;
  std::sort(sorted.begin(), sorted.end());
  const double usual_n = sorted[sorted.size() / 2];
  const auto worst = std::max_element(left_n.begin(), left_n.end());
  if (*worst <= max_stray_n || *worst <= stray_share * usual_n) return {};
  const auto index = static_cast<std::size_t>(worst - left_n.begin());
  return fail(Fault::bad_input,
              "line {}: the force is {:.1f} N from what the other {} poses say; did something "
              "touch the tool, or is its rotation another pose's?",
              index + 2, *worst, poses.size() - 1);
}

Result<void> judge(const WristFit& fit) {
  const WristCalibration& found = fit.found;
  if (fit.force_rms_n > max_rms_n)
    return fail(Fault::bad_input,
                "the forces fit a weight to {:.1f} N only, {} N are borne; do the rotations go "
                "from tool to base, and are forces and rotations of the same pose?",
                fit.force_rms_n, max_rms_n);
  const double weight_n = found.mass_kg * gravity_m_per_s2;
  if (weight_n < -min_weight_n)
    return fail(Fault::bad_input,
                "the tool would weigh {:.3f} kg: the sensor says what the tool does to the "
                "environment; write `reversed` into the device file the other way round",
                found.mass_kg);
  if (weight_n < min_weight_n)
    return fail(Fault::bad_input,
                "the forces do not turn with the tool: {:.3f} kg; is the tool mounted on the "
                "sensor's own side, and do the numbers change from pose to pose?",
                found.mass_kg);
  if (fit.mass_sd_kg > max_mass_sd_kg || fit.com_sd_m > max_com_sd_m ||
      fit.offset_sd_n > max_offset_sd_n)
    return fail(Fault::bad_input,
                "the noise leaves the mass uncertain by {:.3f} kg, its centre by {:.0f} mm, the "
                "offset by {:.2f} N; {} kg, {:.0f} mm and {} N are borne: average longer, tilt "
                "further",
                fit.mass_sd_kg, to_mm(fit.com_sd_m), fit.offset_sd_n, max_mass_sd_kg,
                to_mm(max_com_sd_m), max_offset_sd_n);
  if (found.mass_kg > max_mass_kg || found.com_in_tool_m.norm() > max_com_m)
    return fail(Fault::bad_input,
                "a tool of {:.1f} kg with its centre {:.0f} mm from the tool's origin is none; are "
                "forces in N and torques in Nm?",
                found.mass_kg, to_mm(found.com_in_tool_m.norm()));
  return {};
}

}  // namespace

Wrench WristCalibration::weight_in_tool(const Matrix3& base_from_tool) const noexcept {
  const Vector3 force_n =
      base_from_tool.transpose() * Vector3(0.0, 0.0, -mass_kg * gravity_m_per_s2);
  return {.force_n = force_n, .torque_nm = com_in_tool_m.cross(force_n)};
}

Result<WristFit> fit_wrist(std::span<const WristPose> poses) {
  if (poses.size() < min_poses)
    return fail(Fault::bad_input, "{} poses; at least {} are needed, twelve are better",
                poses.size(), min_poses);
  Squares forces(4), torques(6);
  for (const WristPose& pose : poses) {
    const Vector3 down = down_in_tool(pose);
    forces.add(force_rows(down), pose.in_tool.force_n);
    torques.add(torque_rows(down), pose.in_tool.torque_nm);
  }
  WristFit fit{.condition = std::max(forces.condition(), torques.condition())};
  if (fit.condition > max_condition)
    return fail(Fault::bad_input,
                "the poses do not tell weight from offset (condition {:.0f}, {} is borne): gravity "
                "stands the same way in the tool in all of them; tilt the tool to all sides, by 45 "
                "degrees and more",
                std::min(fit.condition, 1e6), max_condition);
  const Eigen::VectorXd by_force = forces.solve();
  const Eigen::VectorXd by_torque = torques.solve();
  const double weight_n = by_force(3);
  fit.found.mass_kg = weight_n / gravity_m_per_s2;
  fit.found.offset_in_tool = {.force_n = by_force.head<3>(), .torque_nm = by_torque.head<3>()};
  if (weight_n != 0.0) fit.found.com_in_tool_m = by_torque.tail<3>() / weight_n;
  std::vector<double> left_n;
  double force2 = 0.0, torque2 = 0.0;
  for (const WristPose& pose : poses) {
    const Vector3 down = down_in_tool(pose);
    left_n.push_back((pose.in_tool.force_n - force_rows(down) * by_force).norm());
    force2 += left_n.back() * left_n.back();
    torque2 += (pose.in_tool.torque_nm - torque_rows(down) * by_torque).squaredNorm();
  }
  const auto count = static_cast<double>(poses.size());
  fit.force_rms_n = std::sqrt(force2 / count);
  fit.torque_rms_nm = std::sqrt(torque2 / count);
  fit.max_force_n = *std::max_element(left_n.begin(), left_n.end());
  const Eigen::VectorXd force_variances = forces.variances(force2);
  const Eigen::VectorXd torque_variances = torques.variances(torque2);
  fit.mass_sd_kg = std::sqrt(force_variances(3)) / gravity_m_per_s2;
  fit.offset_sd_n = std::sqrt(force_variances.head<3>().maxCoeff());
  fit.offset_sd_nm = std::sqrt(torque_variances.head<3>().maxCoeff());
  // The centre is a torque by the weight, and both are uncertain.
  const double known_n = std::max(std::abs(weight_n), min_weight_n);
  fit.com_sd_m = std::sqrt(torque_variances.tail<3>().sum() +
                           fit.found.com_in_tool_m.squaredNorm() * force_variances(3)) /
                 known_n;
  if (const auto good = judge_strays(poses, left_n); !good) return tl::unexpected(good.error());
  if (const auto good = judge(fit); !good) return tl::unexpected(good.error());
  return fit;
}

Result<std::vector<WristPose>> read_wrist_poses(const std::filesystem::path& file) {
  const auto csv = read_csv(file, {"qw", "qx", "qy", "qz", "force_x_n", "force_y_n", "force_z_n",
                                   "torque_x_nm", "torque_y_nm", "torque_z_nm"});
  if (!csv) return tl::unexpected(csv.error());
  std::vector<WristPose> poses(csv->rows());
  for (std::size_t row = 0; row < poses.size(); ++row) {
    const auto at = [&](std::size_t column) { return csv->columns[column][row]; };
    const Eigen::Quaterniond turn(at(0), at(1), at(2), at(3));
    if (!(std::abs(turn.norm() - 1.0) <= 0.01))
      return fail(Fault::bad_input, "{}:{}: the quaternion is {:.3f} long; it must be 1",
                  file.string(), row + 2, turn.norm());
    poses[row] = {
        .base_from_tool = turn.normalized().toRotationMatrix(),
        .in_tool = {.force_n = {at(4), at(5), at(6)}, .torque_nm = {at(7), at(8), at(9)}}};
    const Wrench& seen = poses[row].in_tool;
    if (!(seen.force_n.norm() <= max_force_n) || !(seen.torque_nm.norm() <= max_torque_nm))
      return fail(Fault::bad_input, "{}:{}: {:g} N and {:g} Nm; up to {:g} N and {:g} Nm are read",
                  file.string(), row + 2, seen.force_n.norm(), seen.torque_nm.norm(), max_force_n,
                  max_torque_nm);
  }
  return poses;
}

std::string to_toml(const WristCalibration& calibration) {
  const auto list = [](const Vector3& v) {
    return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z());
  };
  return fmt::format(
      "# What the wrist sensor says with nothing at the tool; axes and origin are the tool's.\n"
      "[wrist]\nmass_kg = {}\ncom_mm = {}\noffset_n = {}\noffset_nm = {}\n",
      calibration.mass_kg, list(1e3 * calibration.com_in_tool_m),
      list(calibration.offset_in_tool.force_n), list(calibration.offset_in_tool.torque_nm));
}

Result<WristCalibration> parse_wrist_calibration(std::string_view text, std::string_view name) {
  WristCalibration calibration;
  const auto read = read_toml(text, name, Fault::config, [&](const TomlTable& root) {
    root.only({}, {"wrist"});
    const auto table = root.table("wrist");
    if (!table) return;
    table->only({}, {"mass_kg", "com_mm", "offset_n", "offset_nm"});
    const auto vector = [&](const char* key, double limit) -> Vector3 {
      const auto numbers = table->numbers(key, 3, limit);
      return numbers ? Vector3((*numbers)[0], (*numbers)[1], (*numbers)[2]) : Vector3::Zero();
    };
    calibration.mass_kg = table->number("mass_kg", 0.0, max_mass_kg).value_or(0.0);
    calibration.com_in_tool_m = 1e-3 * vector("com_mm", to_mm(max_com_m));
    calibration.offset_in_tool = {.force_n = vector("offset_n", max_force_n),
                                  .torque_nm = vector("offset_nm", max_torque_nm)};
  });
  if (!read) return tl::unexpected(read.error());
  return calibration;
}

}  // namespace tuina::hardware
