// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace tuina::test {

/// A parser of a file that tuina reads, and good files to begin with.
struct Parser {
  std::string name;
  std::vector<std::string> good;
  /// Whether the content is accepted. Ends the program when it is and what was read is not sound.
  std::function<bool(std::string_view content)> accepts;
  std::function<long()> steps = {};  ///< milliseconds that were judged so far, where it judges such
};

/// Of the scanner and its calibration; of what is known of a person; of what a session is told; of
/// what devices say.
[[nodiscard]] std::vector<Parser> scanner_parsers();
[[nodiscard]] std::vector<Parser> person_parsers();
[[nodiscard]] std::vector<Parser> session_parsers();
[[nodiscard]] std::vector<Parser> device_parsers();
[[nodiscard]] std::vector<Parser> can_parsers();
/// No file, but what a guard sees: accepted where it stops nothing, and its torques must be sound.
[[nodiscard]] std::vector<Parser> guard_frames();
/// All of them.
[[nodiscard]] const std::vector<Parser>& parsers();

/// Ends the program where what was read is not sound.
void demand(bool sound, const char* what);

}  // namespace tuina::test
