// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tuina/body/back_surface.hpp"
#include "tuina/body/learn/labelled_body.hpp"
#include "tuina/body/shape_model.hpp"

namespace tuina::body {

/// A labelled back as a scan shows it, for learning.
struct Example {
  BackSurface back;
  std::vector<Acupoint> acupoints;
  std::vector<Landmark> landmarks;
  std::optional<BackSurface> scanned;  ///< with holes and noise, if the person was scanned

  /// The surface that a fit to such a person sees.
  [[nodiscard]] const BackSurface& shown() const { return scanned ? *scanned : back; }
};
[[nodiscard]] Result<Example> make_example(const LabelledBody& body);
/// The example reflected, left and right exchanged.
[[nodiscard]] Example mirrored(const Example& example);

[[nodiscard]] std::map<std::string, Vector3> labels_of(const Example& example);
/// The labels with these names that the example has.
[[nodiscard]] Places labels_in_couch(const Example& example, const std::vector<std::string>& names);

/// Index of the example whose labels are nearest to the mean: the standard model of the thesis.
[[nodiscard]] std::size_t medium_of(const std::vector<Example>& examples,
                                    const std::vector<std::string>& names);

}  // namespace tuina::body
