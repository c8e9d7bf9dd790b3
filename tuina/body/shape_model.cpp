// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/shape_model.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "tuina/core/decompositions.hpp"

namespace tuina::body {

using Eigen::Index;

Places placed(const ShapeModel& model, const Eigen::VectorXd& weights, Index first, Index count) {
  Places places = model.mean.middleCols(first, count);
  const Eigen::VectorXd moved =
      model.modes.block(3 * first, 0, 3 * count, weights.size()) * weights;
  places += Eigen::Map<const Places>(moved.data(), 3, count);
  return places;
}

Transform align(const Places& from, const Places& to) {
  return rigid_motion(from, to);
}

Eigen::VectorXd skin_features(const ShapeModel& model, const Places& skin_in_model) {
  const Index n = model.skin_points();
  const Places offset = skin_in_model - model.mean.leftCols(n);
  const Eigen::Map<const Eigen::VectorXd> stacked(offset.data(), 3 * n);
  Eigen::VectorXd features = model.modes.topRows(3 * n).transpose() * stacked;
  for (Index k = 0; k < features.size(); ++k) {
    features[k] /= std::max(1e-12, model.modes.col(k).head(3 * n).squaredNorm());
  }
  return features;
}

}  // namespace tuina::body
