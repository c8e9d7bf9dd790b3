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

/// A labelled back as a scan shows it: what learning looks at.
struct Example {
  BackSurface back;
  std::vector<Acupoint> acupoints;
  std::vector<Landmark> landmarks;
  std::optional<BackSurface> scanned;  ///< with holes and noise, when somebody scanned the person

  /// What a model will be shown of a person like this.
  [[nodiscard]] const BackSurface& shown() const { return scanned ? *scanned : back; }
};
[[nodiscard]] Result<Example> make_example(const LabelledBody& body);
/// The same person seen in a mirror, left and right exchanged.
[[nodiscard]] Example mirrored(const Example& example);

[[nodiscard]] std::map<std::string, Vector3> labels_of(const Example& example);
/// The labels of these names, which the example has.
[[nodiscard]] Places labels_in_couch(const Example& example, const std::vector<std::string>& names);

/// The example whose labels are nearest to the mean of all: the standard model of the thesis.
[[nodiscard]] std::size_t medium_of(const std::vector<Example>& examples,
                                    const std::vector<std::string>& names);

}  // namespace tuina::body
