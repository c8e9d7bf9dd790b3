// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "tuina/body/acupoints.hpp"

namespace tuina::body {

/// Brings the palpated points into a mapping: all points are one Gaussian given the scan, and each
/// palpated place is a measurement of it, as in a Kalman filter. The other points follow, stay on
/// the skin, and their uncertainty shrinks where finger and scan agree; where they do not, it
/// reaches back to the place that the scan had. A palpated point itself ends between the finger and
/// the scan, weighted by their errors. May be called again with further points. Fails when a name
/// is unknown, a place is off the skin, the scan and the points before it exclude it, or a finger
/// on the vertebra above or below is likelier.
[[nodiscard]] Result<Mapping> fix_points(const Mapping& mapping, const BackSurface& back,
                                         std::span<const PalpatedPoint> palpated);

/// Refuses a point whose name is not among `names`, such as the labels of an atlas, so that a
/// misspelled one is told before anybody is scanned.
[[nodiscard]] Result<void> check_names(std::span<const PalpatedPoint> palpated,
                                       const std::vector<std::string>& names);

/// Labels of an atlas in any of its positions: which one a person is in shows in the scan only.
[[nodiscard]] std::vector<std::string> labels_of(const Atlas& atlas);

/// Radius of the sphere that holds 95 % of a centred Gaussian.
[[nodiscard]] double radius95_of(const Matrix3& covariance_m2);

/// Joint covariance of the errors of points with these 95 % radii: x, y, z of each, in couch. The
/// errors of points hang together the more, the nearer they are along the spine. `axes_in_couch`:
/// the person's left, outward and towards the head, as columns.
[[nodiscard]] Eigen::MatrixXd joint_covariance(const Places& at_in_couch,
                                               const Matrix3& axes_in_couch,
                                               const Eigen::VectorXd& radius95_m);

}  // namespace tuina::body
