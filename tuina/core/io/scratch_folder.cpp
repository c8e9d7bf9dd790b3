// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/scratch_folder.hpp"

#include <stdlib.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace tuina {

Result<ScratchFolder> ScratchFolder::make() {
  std::error_code fault;
  const auto temporary = std::filesystem::temp_directory_path(fault);
  // mkdtemp puts letters that are taken by nobody else in place of the last six.
  std::string name = (temporary / "tuina-XXXXXX").string();
  if (fault || ::mkdtemp(name.data()) == nullptr) {
    return fail(Fault::file, "{}: no folder can be made here: {}", temporary.string(),
                fault ? fault.message() : std::strerror(errno));
  }
  return ScratchFolder(std::filesystem::path(name));
}

ScratchFolder::ScratchFolder(ScratchFolder&& other) noexcept
    : path_(std::exchange(other.path_, {})) {}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
}

}  // namespace tuina
