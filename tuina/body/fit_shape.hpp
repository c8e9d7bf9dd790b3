// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>

#include "tuina/body/shape_model.hpp"

namespace tuina::body {

struct FitOptions {
  double sigma_m =
      8e-3;          ///< of one skin point; larger than scan noise because neighbours err together
  int modes = 1000;  ///< at most
  std::optional<Transform> begin;  ///< couch from model; else it begins at many places
};

/// A model brought onto a scanned back.
struct ShapeFit {
  Transform couch_from_model = Transform::Identity();
  Eigen::VectorXd weights;  ///< of the modes, standard normal a priori
  Places skin_in_couch;  ///< skin points, moved onto the scan along its normals where it was seen
  Places labels_in_couch;
  Eigen::VectorXd label_var_m2;  ///< what the scan leaves open of each label, mean over the axes
  Eigen::VectorXd
      label_doubt_m;  ///< how far off each is in another solution that is nearly as good; usually 0
  double seen = 0.0;  ///< share of the skin points that the scan answers
  double residual_m = 0.0;  ///< RMS over those, along the normals
  /// Mean square of the weights of the ten strongest modes: 1 or less for a back like those
  /// learned from.
  [[nodiscard]] double strangeness() const {
    const Eigen::Index strongest = std::min<Eigen::Index>(10, weights.size());
    return strongest > 0 ? weights.head(strongest).squaredNorm() / static_cast<double>(strongest)
                         : 0.0;
  }
  /// Strangeness, and what is unseen. A model squeezed onto half a back is strange or sees little
  /// of itself.
  [[nodiscard]] double unusualness() const { return strangeness() + 4.0 * (1.0 - seen); }
};

/// Frames that turn and move with the person on the couch, axes as of `couch` for the usual pose, z
/// = 0 on the couch: one of a person who sits; lying, one for each end of the bed where the head
/// may be.
[[nodiscard]] std::vector<Transform> couch_from_person(const BackSurface& back);

/// Fits pose and modes to the visible part, robustly. It begins at many places: shifted along the
/// spine, turned, and lying with the head at either end; the few that explain the scan best are
/// followed to the end.
[[nodiscard]] ShapeFit fit_shape(const ShapeModel& model, const BackSurface& back,
                                 const FitOptions& options = {});

}  // namespace tuina::body
