// SPDX-License-Identifier: Apache-2.0
#include "tests/folder.hpp"

#include <stdlib.h>

#include <fstream>
#include <stdexcept>

namespace tuina::test {

Folder::Folder() {
  std::string name = std::filesystem::temp_directory_path() / "tuina_test_XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder like " + name);
  path_ = name;
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string Folder::with(const std::string& name, const std::string& content) const {
  const std::filesystem::path path = path_ / name;
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

}  // namespace tuina::test
