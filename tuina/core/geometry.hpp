// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace tuina {

/// @{
/// Vectors and matrices of doubles; what they hold and in which frame their names say.
using Vector2 = Eigen::Vector2d;
using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
/// @}

/// A rigid motion, named `<to>_from_<from>`: `base_from_couch * spine_in_couch` is `spine_in_base`.
using Transform = Eigen::Isometry3d;

}  // namespace tuina
