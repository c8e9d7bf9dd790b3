// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/installed.hpp"

#include <dlfcn.h>

namespace tuina::app {

namespace fs = std::filesystem;

fs::path installed_or(const char* name, fs::path built) {
  std::error_code fault;
  fs::path here = fs::read_symlink("/proc/self/exe", fault);
  // In an interpreter the program is somebody else's, and this a library that it has loaded.
  static const char inside = 0;
  Dl_info loaded;
  if (::dladdr(&inside, &loaded) != 0 && fs::path(loaded.dli_fname).extension() == ".so")
    here = fs::canonical(loaded.dli_fname, fault);
  // Who builds below /usr/local has what was built, not an older one that is installed there: the
  // prefix is above the nearest bin or lib, and nowhere else.
  for (fs::path folder = here.parent_path(); folder.has_relative_path();
       folder = folder.parent_path()) {
    const auto called = folder.filename();
    if (called != "bin" && called != "lib" && called != "lib64") continue;
    fs::path installed = folder.parent_path() / "share/tuina" / name;
    return fs::exists(installed, fault) ? installed : built;
  }
  return built;
}

fs::path shipped_atlas_path() {
  return installed_or("models/atlas.tuina", fs::path(TUINA_MODELS) / "atlas.tuina");
}

}  // namespace tuina::app
