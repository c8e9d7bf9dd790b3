// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tuina::test {

struct Outcome {
  int exit_code = -1;
  std::string out;  ///< stdout
  std::string err;  ///< stderr
};

/// Runs the tuina binary as a user would, without a terminal.
[[nodiscard]] Outcome run_tuina(const std::vector<std::string>& arguments);

/// A fresh folder that goes with the object.
class Folder {
 public:
  Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder();
  [[nodiscard]] std::string operator/(const std::string& name) const { return path_ / name; }
  /// Writes a file into it and gives its path.
  [[nodiscard]] std::string with(const std::string& name, const std::string& content) const;

 private:
  std::filesystem::path path_;
};

}  // namespace tuina::test
