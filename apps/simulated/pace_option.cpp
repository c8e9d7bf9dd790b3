// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/pace_option.hpp"

#include <fmt/format.h>

#include <charconv>

namespace tuina::app {
namespace {

constexpr double min_pace = 0.1, max_pace = 20.0;

std::optional<double> number_in(const std::string& word) {
  double number = 0.0;
  const char* end = word.data() + word.size();
  const auto read = std::from_chars(word.data(), end, number);
  const bool whole = read.ec == std::errc() && read.ptr == end;
  return whole && number >= min_pace && number <= max_pace ? std::optional(number) : std::nullopt;
}

}  // namespace

Option PaceOption::describe(Options& options, const std::string& usual) {
  const auto check = [](const std::string& word) {
    const bool known = word == "max" || word == "real" || number_in(word);
    return known ? std::string()
                 : fmt::format("`{}` is none of max, real, or a number from {} to {}", word,
                               min_pace, max_pace);
  };
  return options
      .add(
          "--pace", word_,
          fmt::format("of the simulation: real, max (as fast as it is computed), or so many of its "
                      "seconds in one of the clock, {} to {}; {}",
                      min_pace, max_pace, usual))
      .check(check);
}

std::optional<double> PaceOption::pace(std::optional<double> usual) const {
  if (word_.empty()) return usual;
  return word_ == "real" ? 1.0 : number_in(word_);
}

Result<void> suits_other_arms(const std::optional<double>& pace) {
  if (!pace || *pace == 1.0) return {};
  return fail(Fault::usage, "--pace: arms that are not simulated in this program keep real pace");
}

}  // namespace tuina::app
