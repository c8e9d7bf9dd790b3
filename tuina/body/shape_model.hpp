// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "tuina/body/back_surface.hpp"

namespace tuina::body {

/// Points as columns (3 x n), in a frame like `back`: x to the person's left, y out, z towards the
/// head.
using Places = Eigen::Matrix3Xd;

/// Gaussian shape model of the backs of one position: mean and modes of skin points and labels
/// together. Column k of `modes` is one standard deviation of mode k; rows are x, y, z of point 0,
/// of point 1, ...
struct ShapeModel {
  BodyPosture position = BodyPosture::sitting;
  int bodies = 0;                   ///< number of bodies learned from
  int acupoints = 0;                ///< the first labels are acupoints, the others landmarks
  std::vector<std::string> labels;  ///< names, `BL47_L`
  Places mean;                      ///< skin points, then labels
  Places normals;                   ///< of the skin points, out of the body
  Eigen::MatrixXd modes;
  Transform person_from_model = Transform::Identity();  ///< usual pose of people who sit or lie
  /// Regression of label errors on the fitted skin: offsets in millimetres are `correction * [skin
  /// features; 1]`. Empty with too few bodies.
  Eigen::MatrixXd correction;
  Eigen::VectorXd radius95_m;      ///< 95 % radius of each label on left-out bodies
  Eigen::VectorXd nominal_var_m2;  ///< variance of each label after a fit to a whole back
  double usual_residual_m = 0.0;   ///< median RMS residual of the skin on left-out bodies
  double max_outlier_score = 0.0;  ///< maximum ShapeFit outlier score of left-out bodies

  /// Points of the skin; the columns of `mean` after them are labels.
  [[nodiscard]] Eigen::Index skin_points() const {
    return mean.cols() - static_cast<Eigen::Index>(labels.size());
  }
};

/// The rigid motion that brings `from` onto `to`, by least squares.
[[nodiscard]] Transform align(const Places& from, const Places& to);

/// Points `first`.. of the model for given mode weights, in its frame.
[[nodiscard]] Places placed(const ShapeModel& model, const Eigen::VectorXd& weights,
                            Eigen::Index first, Eigen::Index count);

/// Coefficients of the modes for a fitted skin in the model's frame, the input of the correction.
[[nodiscard]] Eigen::VectorXd skin_features(const ShapeModel& model, const Places& skin_in_model);

}  // namespace tuina::body
