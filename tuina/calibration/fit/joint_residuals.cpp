// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/fit/joint_residuals.hpp"

#include <ceres/autodiff_cost_function.h>
#include <ceres/rotation.h>

#include <Eigen/Core>
#include <array>

namespace tuina::calibration {
namespace {

constexpr std::array<double, usual_lens_size> usual_distortion = {0.5, 1.0, 0.01, 0.01};

template <typename T>
using Vec3 = Eigen::Matrix<T, 3, 1>;

// Distortion of OpenCV (k1, k2, p1, p2) on ray coordinates.
template <typename T>
void bend(const T* camera, const T& x, const T& y, T& bent_x, T& bent_y) {
  const T r2 = x * x + y * y;
  const T radial = T(1.0) + r2 * (camera[4] + r2 * camera[5]);
  bent_x = x * radial + T(2.0) * camera[6] * x * y + camera[7] * (r2 + T(2.0) * x * x);
  bent_y = y * radial + camera[6] * (r2 + T(2.0) * y * y) + T(2.0) * camera[7] * x * y;
}

// Ray of a pixel; distortion is inverted by fixed-point steps, each ten times more accurate.
template <typename T>
Vec3<T> ray_of(const T* camera, double column, double row) {
  const T x = (column - camera[2]) / camera[0];
  const T y = (row - camera[3]) / camera[1];
  T straight_x = x;
  T straight_y = y;
  for (int i = 0; i < 6; ++i) {
    T bent_x;
    T bent_y;
    bend(camera, straight_x, straight_y, bent_x, bent_y);
    straight_x += x - bent_x;
    straight_y += y - bent_y;
  }
  return {straight_x, straight_y, T(1.0)};
}

template <typename T>
Vec3<T> placed(const T* pose, const Vec3<T>& at) {
  Vec3<T> moved;
  ceres::AngleAxisRotatePoint(pose, at.data(), moved.data());
  return moved + Vec3<T>(pose[3], pose[4], pose[5]);
}

struct CornerOfBoard : SeenCorner {
  template <typename T>
  void compare(const T* camera, const Vec3<T>& in_camera, T* residual) const {
    T x;
    T y;
    bend(camera, T(in_camera.x() / in_camera.z()), T(in_camera.y() / in_camera.z()), x, y);
    residual[0] = (camera[0] * x + camera[2] - seen_px.x()) / deviation_px;
    residual[1] = (camera[1] * y + camera[3] - seen_px.y()) / deviation_px;
  }
  template <typename T>
  bool operator()(const T* camera, const T* pose, T* residual) const {
    compare(camera, placed<T>(pose, at.cast<T>()), residual);
    return true;
  }
};

struct CornerOfStandingBoard : CornerOfBoard, FirstAxis {
  template <typename T>
  bool operator()(const T* camera, const T* pose, const T* axis, const T* first_yaw, const T* yaw,
                  T* residual) const {
    const Vec3<T> along =
        (direction.cast<T>() + axis[0] * aside_1.cast<T>() + axis[1] * aside_2.cast<T>())
            .normalized();
    const Vec3<T> on_axis =
        point.cast<T>() + axis[2] * aside_1.cast<T>() + axis[3] * aside_2.cast<T>();
    const Vec3<T> turn = (first_yaw[0] - yaw[0]) * along;
    const Vec3<T> before = placed<T>(pose, at.cast<T>()) - on_axis;
    Vec3<T> after;
    ceres::AngleAxisRotatePoint(turn.data(), before.data(), after.data());
    compare(camera, Vec3<T>(after + on_axis), residual);
    return true;
  }
};

struct PointOfLine : SeenLinePoint {
  template <typename T>
  bool operator()(const T* camera, const T* pose, const T* light, T* residual) const {
    const Vec3<T> ray = ray_of(camera, column_px, row_px);
    const Vec3<T> z(T(0.0), T(0.0), T(1.0));
    Vec3<T> normal;
    ceres::AngleAxisRotatePoint(pose, z.data(), normal.data());
    const T range = normal.dot(Vec3<T>(pose[3], pose[4], pose[5])) / normal.dot(ray);
    const T value = (light[0] * ray.x() + light[1] * ray.y() + light[2] * ray.z()) * range;
    residual[0] = (value - T(1.0)) / (per_px * deviation_px);
    return true;
  }
};

struct Near {
  double value, deviation;
  template <typename T>
  bool operator()(const T* parameter, T* residual) const {
    residual[0] = (parameter[0] - value) / deviation;
    return true;
  }
};

struct NearUsualLens {
  template <typename T>
  bool operator()(const T* camera, T* residual) const {
    for (std::size_t i = 0; i < usual_distortion.size(); ++i) {
      residual[i] = camera[4 + i] / usual_distortion[i];
    }
    return true;
  }
};

}  // namespace

ceres::CostFunction* corner_of_board(const SeenCorner& corner) {
  return new ceres::AutoDiffCostFunction<CornerOfBoard, 2, camera_size, 6>(
      new CornerOfBoard{corner});
}

ceres::CostFunction* corner_of_standing_board(const SeenCorner& corner, const FirstAxis& axis) {
  return new ceres::AutoDiffCostFunction<CornerOfStandingBoard, 2, camera_size, 6, axis_size, 1, 1>(
      new CornerOfStandingBoard{{corner}, axis});
}

ceres::CostFunction* point_of_line(const SeenLinePoint& point) {
  return new ceres::AutoDiffCostFunction<PointOfLine, 1, camera_size, 6, light_size>(
      new PointOfLine{point});
}

double light_value(const double* camera, const double* light, const Transform& camera_from_board,
                   double column_px, double row_px) {
  const Vector3 ray = ray_of(camera, column_px, row_px);
  const Vector3 normal = camera_from_board.linear().col(2);
  const double range = normal.dot(camera_from_board.translation()) / normal.dot(ray);
  return range * Vector3(light[0], light[1], light[2]).dot(ray);
}

ceres::CostFunction* near_value(double value, double deviation) {
  return new ceres::AutoDiffCostFunction<Near, 1, 1>(new Near{value, deviation});
}

ceres::CostFunction* near_usual_lens() {
  return new ceres::AutoDiffCostFunction<NearUsualLens, usual_lens_size, camera_size>(
      new NearUsualLens);
}

}  // namespace tuina::calibration
