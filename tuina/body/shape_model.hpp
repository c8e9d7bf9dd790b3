// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "tuina/body/back_surface.hpp"

namespace tuina::body {

/// Columns are places (3 x n), in a frame like `back`: x to the person's left, y out, z towards the head.
using Places = Eigen::Matrix3Xd;

/// Backs of one position as one Gaussian: a mean and modes, over skin points and labelled points together.
/// Column k of `modes` is one standard deviation of mode k; rows are x, y, z of point 0, of point 1, ...
struct ShapeModel {
  Position position = Position::sitting;
  int bodies = 0;                   ///< that it was learned from
  int acupoints = 0;                ///< the first labels are acupoints, the others landmarks
  std::vector<std::string> labels;  ///< names, `BL47_L`
  Places mean;                      ///< skin points, then labels
  Places normals;                   ///< of the skin points, out of the body
  Eigen::MatrixXd modes;
  Transform model_from_outline = Transform::Identity();  ///< where outlines usually lie
  /// What the fitted skin says about a label beyond the model: offsets in millimetres are
  /// `correction * [skin features; 1]`. Empty when there were too few bodies to learn it.
  Eigen::MatrixXd correction;
  Eigen::VectorXd radius95_m;     ///< of each label, measured on bodies left out
  Eigen::VectorXd nominal_var_m2;  ///< of each label, the variance that a fit to a whole back leaves

  [[nodiscard]] Eigen::Index skin_points() const {
    return mean.cols() - static_cast<Eigen::Index>(labels.size());
  }
};

struct FitOptions {
  double sigma_m = 8e-3;  ///< of one skin point; larger than scan noise because neighbours err together
  int modes = 1000;       ///< at most
};

/// A model brought onto a scanned back.
struct ShapeFit {
  Transform couch_from_model = Transform::Identity();
  Eigen::VectorXd weights;       ///< of the modes, standard normal a priori
  Places skin_in_couch;          ///< skin points, moved onto the scan along its normals where it was seen
  Places labels_in_couch;
  Eigen::VectorXd label_var_m2;  ///< what the scan leaves open of each label, mean over the axes
  double seen = 0.0;             ///< share of the skin points that the scan answers
  double residual_m = 0.0;       ///< RMS over those, along the normals
  /// Mean square of the weights: about 1 or less for a back like those learned from.
  [[nodiscard]] double strangeness() const {
    return weights.size() > 0 ? weights.squaredNorm() / static_cast<double>(weights.size()) : 0.0;
  }
};

/// Fits pose and modes to the visible part, robustly; `couch_from_model` is about where to begin. Starts
/// shifted along the spine and turned are tried as well, and the one that explains the scan best goes on.
[[nodiscard]] ShapeFit fit_shape(const ShapeModel& model, const BackSurface& back,
                                 const Transform& couch_from_model, const FitOptions& options = {});

/// The rigid motion that brings `from` onto `to` with least squares.
[[nodiscard]] Transform align(const Places& from, const Places& to);

/// The fitted skin in the model's frame, as coefficients of the modes: what the correction looks at.
[[nodiscard]] Eigen::VectorXd skin_features(const ShapeModel& model, const Places& skin_in_model);

}  // namespace tuina::body
