// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace tuina::test {

/// A fresh folder that goes with the object. No other test program has the same one, so the same
/// test may run several times at once.
class Folder {
 public:
  Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder();
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::string operator/(const std::string& name) const { return path_ / name; }
  /// Writes a file into it and gives its path.
  [[nodiscard]] std::string with(const std::string& name, const std::string& content) const;

 private:
  std::filesystem::path path_;
};

}  // namespace tuina::test
