// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "tuina/body/back_surface.hpp"
#include "tuina/body/learn/body_source.hpp"
#include "tuina/body/shape_model.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::body {

/// A labelled back for learning.
struct Example {
  BackSurface back;
  std::vector<Acupoint> acupoints;
  std::vector<Landmark> landmarks;
};
/// Of the skin, or, where it is needed, of what a scan shows of it.
[[nodiscard]] Result<Example> make_example(const LabelledBody& body,
                                           BodySource::Needs needs = BodySource::Needs::skin);
/// The example reflected, left and right exchanged.
[[nodiscard]] Example mirrored(const Example& example);

/// All acupoints and landmarks of the example by their names, in couch.
[[nodiscard]] std::map<std::string, Vector3> labels_of(const Example& example);
/// The labels with these names that the example has.
[[nodiscard]] Places labels_in_couch(const Example& example, const std::vector<std::string>& names);

/// People of one position with the same labels. Only their labels are kept, a kilobyte each; backs
/// are made when they are looked at.
struct Examples {
  const BodySource* source = nullptr;
  BodyPosture position = BodyPosture::sitting;
  std::vector<std::string> acupoints;  ///< names of the labels, in the order of the first person
  std::vector<std::string> landmarks;
  std::vector<std::size_t> numbers;     ///< in the source
  std::vector<Places> labels_in_couch;  ///< acupoints, then landmarks

  [[nodiscard]] std::size_t size() const { return numbers.size(); }  ///< people
  /// Whether a label of that name is among theirs.
  [[nodiscard]] bool have(const std::string& name) const;
  /// One of them with the back, which the source reads now; fails as that does.
  [[nodiscard]] Result<Example> make(std::size_t i, BodySource::Needs needs) const;
  /// Forgets one of them.
  void leave_out(std::size_t i);
};
/// The labels with these names of person `i`, in couch.
[[nodiscard]] Places labels_in_couch(const Examples& examples, std::size_t i,
                                     const std::vector<std::string>& names);

/// Reads the labels of all bodies, those who sit first in the answer, and refuses a body that lacks
/// a label of the first in its position, has one more, or has the labels of another.
[[nodiscard]] Result<std::array<Examples, 2>> read_examples(const BodySource& source,
                                                            const Progress& progress);

/// Index of the example whose labels are nearest to the mean: the standard model of the thesis.
[[nodiscard]] std::size_t medium_of(const Examples& examples,
                                    const std::vector<std::string>& names);

}  // namespace tuina::body
