// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>

#include "tuina/body/shape_model.hpp"

namespace tuina::body {

/// Weights and limits of the fit of a shape model to the skin.
struct FitOptions {
  double sigma_m = 8e-3;           ///< standard deviation of a skin point, above scan noise since
                                   ///< neighbours' errors correlate
  int modes = 1000;                ///< at most
  std::optional<Transform> begin;  ///< couch from model; absent: multi-start
};

/// A shape model fitted to a scanned back.
struct ShapeFit {
  Transform couch_from_model = Transform::Identity();
  Eigen::VectorXd weights;  ///< weights of the modes, standard normal a priori
  Places skin_in_couch;     ///< skin points, moved onto the scan along its normals where covered
  Places labels_in_couch;
  Eigen::VectorXd label_var_m2;  ///< posterior variance of each label, mean over the axes
  Eigen::VectorXd
      label_doubt_m;        ///< distance of each label to a nearly equally good solution; usually 0
  double coverage = 0.0;    ///< share of the skin points that the scan covers
  double residual_m = 0.0;  ///< RMS over those, along the normals
  /// Mean square of the weights of the ten strongest modes, the squared Mahalanobis distance per
  /// mode: 1 or less for a back like those learned from.
  [[nodiscard]] double mahalanobis2_per_mode() const {
    const Eigen::Index strongest = std::min<Eigen::Index>(10, weights.size());
    return strongest > 0 ? weights.head(strongest).squaredNorm() / static_cast<double>(strongest)
                         : 0.0;
  }
  /// Mahalanobis distance plus a penalty for low coverage. A model squeezed onto half a back is
  /// unusual or poorly covered.
  [[nodiscard]] double outlier_score() const {
    return mahalanobis2_per_mode() + 4.0 * (1.0 - coverage);
  }
};

/// Frames that move with the person on the couch, axes as `couch` in the usual pose, z = 0 on the
/// couch: one for a sitting person, two for a lying one (head at either end).
[[nodiscard]] std::vector<Transform> couch_from_person(const BackSurface& back);

/// Robust fit of pose and modes to the visible part. Multi-start: shifted along the spine, turned,
/// and lying with the head at either end; the best few starts are refined.
[[nodiscard]] ShapeFit fit_shape(const ShapeModel& model, const BackSurface& back,
                                 const FitOptions& options = {});

}  // namespace tuina::body
