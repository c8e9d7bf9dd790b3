// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fstream>
#include <functional>

#include "tuina/body/learn/correspondence.hpp"

namespace tuina::body {

/// The template registered to one back, and the frame that moves with the person.
struct Registered {
  Places shape_in_couch;
  Transform couch_from_person;
};
/// Registers the template to the back of an example by the labels with these names.
[[nodiscard]] Registered registered(const Template& standard, const Example& example,
                                    const std::vector<std::string>& names);

/// Registered backs one after another, as often as statistics go over them. `each` is called in the
/// order of their numbers, so that sums are the same to the last bit.
struct Backs {
  std::size_t count = 0;
  std::function<Result<void>(const std::function<void(const Registered&)>& each)> visit;
};

/// Registered backs in a file, for there are more than memory holds. It has no name any more, so
/// that it goes with the program in any case.
class RegisteredBacks {
 public:
  /// A file among the system's temporary ones, for backs of so many points.
  [[nodiscard]] static Result<RegisteredBacks> make(Eigen::Index points);
  /// Fails where the disk is full.
  [[nodiscard]] Result<void> add(const Registered& back);
  [[nodiscard]] std::size_t size() const { return count_; }  ///< backs that were added
  /// Those whose number is chosen. They last no longer than this.
  [[nodiscard]] Backs chosen(const std::function<bool(std::size_t number)>& wanted);

 private:
  RegisteredBacks(std::fstream file, Eigen::Index points);
  [[nodiscard]] Result<void> read(std::size_t number, Registered& back);

  std::fstream file_;
  Eigen::Index points_;
  std::size_t count_ = 0;
};

}  // namespace tuina::body
