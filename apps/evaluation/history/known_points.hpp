// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "tuina/body/acupoints.hpp"
#include "tuina/body/learn/labelled_body.hpp"

namespace tuina::app {

/// Points that a finger shows in a first session, one set after another; the first set is empty: a
/// stranger.
inline const std::array<std::vector<std::string>, 5> shown_sets = {
    {{}, {"GV4"}, {"BL18_L"}, {"BL18_L", "BL23_R"}, {"BL18_L", "BL23_R", "BL13_L"}}};

/// A second session of somebody with the history of the first, and with those of others.
struct PointsOutcome {
  std::string refused = {};  ///< why there was no second session; the rest is then empty
  double misfit_mm = 0.0;    ///< of the acupoints in both scans
  std::vector<double> error_mm =
      {};                        ///< of the seven, mean, by shown set; NaN: the history was refused
  std::vector<int> within = {};  ///< how many of the seven lie within their radius
  int others = 0;                ///< histories of other people
  int noticed = 0;               ///< of these
  std::vector<double> harm_mm = {};  ///< of the others: error with such a history less that without
  int beyond = 0;                    ///< points of these that only then lie beyond their radius
};

/// People who come back, in another posture, before the simulated scanner.
class ReturningPeople {
 public:
  ReturningPeople(std::vector<body::LabelledBody> people, body::Atlas atlas, std::uint64_t seed);
  ReturningPeople(ReturningPeople&&) noexcept;
  ~ReturningPeople();

  [[nodiscard]] std::size_t size() const { return people_.size(); }
  [[nodiscard]] const std::string& id(std::size_t who) const { return people_[who].id; }
  /// May be called from many threads.
  [[nodiscard]] PointsOutcome come_back(std::size_t who);

 private:
  struct FirstSession;
  [[nodiscard]] const FirstSession& first_session(std::size_t who);

  std::vector<body::LabelledBody> people_;
  body::Atlas atlas_;
  std::uint64_t seed_;
  std::vector<std::unique_ptr<FirstSession>> first_;
  std::vector<std::once_flag> had_first_;
};

}  // namespace tuina::app
