// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "tuina/body/back_surface.hpp"

namespace tuina::body {

/// Columns are places (3 x n), in a frame like `back`: x to the person's left, y out, z towards the
/// head.
using Places = Eigen::Matrix3Xd;

/// Backs of one position as one Gaussian: a mean and modes, over skin points and labelled points
/// together. Column k of `modes` is one standard deviation of mode k; rows are x, y, z of point 0,
/// of point 1, ...
struct ShapeModel {
  Position position = Position::sitting;
  int bodies = 0;                   ///< that it was learned from
  int acupoints = 0;                ///< the first labels are acupoints, the others landmarks
  std::vector<std::string> labels;  ///< names, `BL47_L`
  Places mean;                      ///< skin points, then labels
  Places normals;                   ///< of the skin points, out of the body
  Eigen::MatrixXd modes;
  Transform person_from_model = Transform::Identity();  ///< how people usually sit or lie
  /// What the fitted skin says about a label beyond the model: offsets in millimetres are
  /// `correction * [skin features; 1]`. Empty when there were too few bodies to learn it.
  Eigen::MatrixXd correction;
  Eigen::VectorXd radius95_m;  ///< of each label, measured on bodies left out
  Eigen::VectorXd
      nominal_var_m2;             ///< of each label, the variance that a fit to a whole back leaves
  double usual_residual_m = 0.0;  ///< RMS misfit of the skin on bodies left out, median
  double most_unusual = 0.0;      ///< largest ShapeFit::unusualness of bodies left out

  [[nodiscard]] Eigen::Index skin_points() const {
    return mean.cols() - static_cast<Eigen::Index>(labels.size());
  }
};

/// The rigid motion that brings `from` onto `to` with least squares.
[[nodiscard]] Transform align(const Places& from, const Places& to);

/// Mean and modes of places `first`.. of the model, in its frame.
[[nodiscard]] Places placed(const ShapeModel& model, const Eigen::VectorXd& weights,
                            Eigen::Index first, Eigen::Index count);

/// The fitted skin in the model's frame, as coefficients of the modes: what the correction looks
/// at.
[[nodiscard]] Eigen::VectorXd skin_features(const ShapeModel& model, const Places& skin_in_model);

}  // namespace tuina::body
