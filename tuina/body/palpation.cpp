// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/palpation.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tuina/core/io/near_miss.hpp"
#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A finger presses soft tissue in by some 10 mm, and the couch plane holds to 10 mm.
constexpr double max_off_skin_m = 20_mm;
// 99.9 % quantile of chi-squared with two degrees of freedom: the directions of the skin.
constexpr double max_mahalanobis2 = 13.8;
// A miscounted vertebra, the usual error of palpation: how often the finger is assumed one too high
// and one too low, and how much distances of vertebrae differ from their mean.
constexpr double miscounted = 0.1;
constexpr double vertebrae_differ = 0.2;

// What a scan leaves open is where along the spine a level lies, alike on both sides of it; across
// the spine the skin shows more. Variances relative to that along the spine, and lengths over which
// errors hang together: chosen on 54 people of docs/bodies.md whom the shipped atlas has not seen,
// by the errors and the coverage of the radii that one or two palpated points leave.
constexpr double across_variance = 0.2;
constexpr double out_variance = 0.05;
constexpr double along_m = 200_mm;
constexpr double along_over_sides_m = 500_mm;
constexpr double across_m = 100_mm;
constexpr double own_share = 0.02;  // variance that a point shares with no other

double correlation(double a, double b) {
  return std::exp(-0.5 * (a * a + b * b));
}

/// Places of the acupoints, then of the landmarks, and their joint covariance.
struct Belief {
  std::vector<std::string> names;
  VectorXd at_in_couch;
  MatrixXd covariance_m2;
  Vector3 vertebra_up = Vector3::Zero();  ///< from a vertebra to the next one
};

/// From a vertebra to the next one above it, as the mean of five: BL47 lies beside the hollow below
/// T9, GV4 in the one below L2. Zero without these points.
Vector3 vertebra_up(const Mapping& mapping) {
  const auto place = [&](std::string_view name) {
    const auto found = std::ranges::find(mapping.acupoints, name, &Acupoint::name);
    return found == mapping.acupoints.end() ? nullptr : &found->at_in_couch;
  };
  const Vector3 *left = place("BL47_L"), *right = place("BL47_R"), *below = place("GV4");
  if (left == nullptr || right == nullptr || below == nullptr) return Vector3::Zero();
  return (0.5 * (*left + *right) - *below) / 5.0;
}

Belief belief_of(const Mapping& mapping) {
  Belief belief{.names = {},
                .at_in_couch = VectorXd(mapping.covariance_m2.rows()),
                .covariance_m2 = mapping.covariance_m2,
                .vertebra_up = vertebra_up(mapping)};
  const auto add = [&](const std::string& name, const Vector3& at) {
    belief.at_in_couch.segment<3>(3 * static_cast<Index>(belief.names.size())) = at;
    belief.names.push_back(name);
  };
  for (const Acupoint& point : mapping.acupoints) add(point.name, point.at_in_couch);
  for (const Landmark& landmark : mapping.landmarks) add(landmark.name, landmark.at_in_couch);
  return belief;
}

double density(const Eigen::Matrix2d& spread, const Vector2& off) {
  return std::exp(-0.5 * off.dot(spread.inverse() * off)) / std::sqrt(spread.determinant());
}

/// Refuses a finger that the scan excludes, or whose place a miscounted vertebra explains better.
Result<void> check_surprise(const PalpatedPoint& point, const Vector2& surprise,
                            const Eigen::Matrix2d& spread, const Vector2& vertebra_up) {
  const double mahalanobis2 = surprise.dot(spread.inverse() * surprise);
  if (!(mahalanobis2 <= max_mahalanobis2)) {
    return fail(
        Fault::bad_input,
        "{} is fixed {:.0f} mm from where this back has it, which is {:.1f} times as far as "
        "can be; is it another point, or the other side?",
        point.name, to_mm(surprise.norm()), std::sqrt(mahalanobis2 / max_mahalanobis2));
  }
  const Eigen::Matrix2d wider =
      spread + vertebrae_differ * vertebrae_differ * vertebra_up * vertebra_up.transpose();
  const double right = (1.0 - 2.0 * miscounted) * density(spread, surprise);
  const double above = miscounted * density(wider, surprise - vertebra_up);
  const double below = miscounted * density(wider, surprise + vertebra_up);
  if (above + below <= right) return {};
  return fail(
      Fault::bad_input,
      "{} is fixed {:.0f} mm from where this back has it; the next vertebra {} is {:.0f} mm away "
      "and likelier: count again, or state a larger error of the finger",
      point.name, to_mm(surprise.norm()), above > below ? "above" : "below",
      to_mm(vertebra_up.norm()));
}

/// The Kalman update by one point. The finger tells where on the skin the point is, not how deep.
Result<void> update(Belief& belief, const BackSurface& back, const PalpatedPoint& point) {
  if (auto known = check_names({&point, 1}, belief.names); !known) return known;
  const auto found = std::find(belief.names.begin(), belief.names.end(), point.name);
  const SurfacePoint skin = back.nearest(point.at_in_couch);
  if (!(skin.distance_m <= max_off_skin_m)) {
    return fail(Fault::bad_input,
                "{} is fixed {:.0f} mm off the skin of this scan, at most {:.0f} mm are possible; "
                "metres in the frame of the scan are needed",
                point.name, to_mm(skin.distance_m), to_mm(max_off_skin_m));
  }
  const Index i = 3 * (found - belief.names.begin());
  Eigen::Matrix<double, 3, 2> along;
  along.col(0) = skin.normal_in_couch.unitOrthogonal();
  along.col(1) = skin.normal_in_couch.cross(along.col(0));
  const MatrixXd seen = belief.covariance_m2.middleCols<3>(i) * along;
  const Eigen::Matrix2d spread = along.transpose() * seen.middleRows<3>(i) +
                                 point.error_m * point.error_m * Eigen::Matrix2d::Identity();
  const Vector2 surprise =
      along.transpose() * (skin.at_in_couch - belief.at_in_couch.segment<3>(i));
  if (auto good = check_surprise(point, surprise, spread, along.transpose() * belief.vertebra_up);
      !good)
    return good;
  const Eigen::Matrix2d information = spread.inverse();
  const VectorXd moved = seen * (information * surprise);
  belief.at_in_couch += moved;
  belief.covariance_m2 -= seen * information * seen.transpose();
  belief.covariance_m2 *= std::max(1.0, surprise.dot(information * surprise) / 2.0);
  // Finger and scan contradict each other by what moves, and which of them errs nobody knows.
  belief.covariance_m2 += moved * moved.transpose();
  return {};
}

}  // namespace

double radius95_of(const Matrix3& covariance_m2) {
  // The squared length is a weighted sum of squares; a scaled chi-squared with the same mean and
  // variance stands for it, and its quantile is that of Wilson and Hilferty (1931).
  constexpr double normal95 = 1.645;
  const double mean = covariance_m2.trace();
  const double h = 2.0 / 9.0 * covariance_m2.squaredNorm() / (mean * mean);
  return std::sqrt(mean * std::pow(1.0 - h + normal95 * std::sqrt(h), 3));
}

MatrixXd joint_covariance(const Places& at_in_couch, const Matrix3& axes_in_couch,
                          const VectorXd& radius95_m) {
  const Places at = axes_in_couch.transpose() * at_in_couch;
  const Index count = at.cols();
  MatrixXd covariance(3 * count, 3 * count);
  for (Index i = 0; i < count; ++i) {
    for (Index j = 0; j < count; ++j) {
      const Vector3 apart = at.col(i) - at.col(j);
      const double shared = i == j ? 1.0 : 1.0 - own_share;
      const double along = correlation(apart.x() / along_over_sides_m, apart.z() / along_m);
      const double across = correlation(apart.x() / across_m, apart.z() / across_m);
      const Vector3 axes = shared * Vector3(across_variance * across, out_variance * across, along);
      covariance.block<3, 3>(3 * i, 3 * j) =
          axes_in_couch * axes.asDiagonal() * axes_in_couch.transpose();
    }
  }
  // The variances are alike for all points, so one factor a point gives it its radius.
  const double radius_of_one = radius95_of(covariance.topLeftCorner<3, 3>());
  for (Index i = 0; i < count; ++i) {
    covariance.middleRows<3>(3 * i) *= radius95_m[i] / radius_of_one;
    covariance.middleCols<3>(3 * i) *= radius95_m[i] / radius_of_one;
  }
  return covariance;
}

Result<void> check_names(std::span<const PalpatedPoint> palpated,
                         const std::vector<std::string>& names) {
  for (const PalpatedPoint& point : palpated) {
    if (std::find(names.begin(), names.end(), point.name) != names.end()) continue;
    return fail(Fault::usage, "no point is called {}; {}", in_quotes(point.name),
                suggestion(point.name, names));
  }
  return {};
}

std::vector<std::string> labels_of(const Atlas& atlas) {
  std::vector<std::string> names;
  for (const PositionAtlas& position : atlas.positions) {
    for (const std::string& name : position.shape.labels)
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

Result<Mapping> fix_points(const Mapping& mapping, const BackSurface& back,
                           std::span<const PalpatedPoint> palpated) {
  if (mapping.covariance_m2.size() == 0) {
    return fail(Fault::usage, "points can be fixed with the method surface only");
  }
  Belief belief = belief_of(mapping);
  for (const PalpatedPoint& point : palpated) {
    if (auto good = update(belief, back, point); !good) return tl::unexpected(good.error());
  }
  Mapping fixed = mapping;
  fixed.fixed.insert(fixed.fixed.end(), palpated.begin(), palpated.end());
  fixed.covariance_m2 = std::move(belief.covariance_m2);
  Index i = 0;
  for (Acupoint& point : fixed.acupoints) {
    const SurfacePoint skin = on_skin(back, belief.at_in_couch.segment<3>(i));
    point.at_in_couch = skin.at_in_couch;
    point.normal_in_couch = skin.normal_in_couch;
    point.uncertainty_m = radius95_of(fixed.covariance_m2.block<3, 3>(i, i));
    i += 3;
  }
  for (Landmark& landmark : fixed.landmarks) {
    landmark.at_in_couch = on_skin(back, belief.at_in_couch.segment<3>(i)).at_in_couch;
    i += 3;
  }
  return fixed;
}

}  // namespace tuina::body
