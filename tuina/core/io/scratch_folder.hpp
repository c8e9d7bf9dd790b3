// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "tuina/core/result.hpp"

namespace tuina {

/// An empty folder among the system's temporary ones, which only its owner can read. It goes with
/// the object, and what is in it.
class ScratchFolder {
 public:
  /// Makes an empty folder. Fails with Fault::file.
  [[nodiscard]] static Result<ScratchFolder> make();
  ScratchFolder(ScratchFolder&& other) noexcept;
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ScratchFolder& operator=(ScratchFolder&&) = delete;
  ~ScratchFolder();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }  ///< where it is

 private:
  explicit ScratchFolder(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_;  // empty once it is moved from
};

}  // namespace tuina
