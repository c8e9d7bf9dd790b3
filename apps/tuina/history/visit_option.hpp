// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/cli/options.hpp"
#include "apps/tuina/history/kept_history.hpp"
#include "apps/tuina/history/remember.hpp"

namespace tuina::app {

/// The option `--who` of a session: it joins the history of a person, and begins with what earlier
/// ones say for it.
class VisitOption {
 public:
  /// `--who`, and the options that go with it.
  Option describe(Options& options);

  /// Puts into the order what is remembered, and enters that a session of `folder` begins. Nothing
  /// without `--who`. Refused while a server does not answer, unless nothing is to be remembered.
  [[nodiscard]] Result<void> begin(record::SessionOrder& order,
                                   const std::filesystem::path& folder);
  /// Whether `--who` names somebody.
  [[nodiscard]] bool of_somebody() const { return !who_.empty(); }
  /// What was remembered, a line each.
  [[nodiscard]] const std::string& remembered() const { return remembered_.lines; }
  /// Whose session it is; nothing without `--who`.
  [[nodiscard]] const std::optional<record::VisitLabel>& label() const { return label_; }
  /// Why a session could not begin, with what was remembered.
  [[nodiscard]] Error with_remembered(Error error) const;
  /// Takes back that a session has begun: it was refused and has left nothing.
  void take_back();
  /// Adds the session that has ended, and tells what has changed since the one before.
  [[nodiscard]] Result<std::string> end(const record::SessionFile& file);

 private:
  std::string who_, address_;
  TakenOver taken_over_;
  bool anew_ = false;
  std::filesystem::path folder_;
  Remembered remembered_;
  std::optional<KeptHistory> history_;
  std::optional<record::VisitLabel> label_;
};

}  // namespace tuina::app
