// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/atlas_source.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>
#include <utility>

#include "apps/cli/installed.hpp"
#include "apps/simulated/scanned_people.hpp"

namespace tuina::app {

namespace fs = std::filesystem;

Result<std::vector<fs::path>> list_labelled(const std::vector<std::string>& places) {
  std::vector<fs::path> all;
  std::set<fs::path> named;  // a file that is named twice is one person
  for (const auto& place : places) {
    const auto paths = body::list_labelled_bodies(place);
    if (!paths) return tl::unexpected(paths.error());
    std::ranges::copy_if(*paths, std::back_inserter(all), [&](const fs::path& path) {
      std::error_code fault;
      const fs::path whole = fs::weakly_canonical(path, fault);
      return named.insert(fault ? path : whole).second;
    });
  }
  std::sort(all.begin(), all.end(), [](const fs::path& a, const fs::path& b) {
    return std::pair(a.filename(), a) < std::pair(b.filename(), b);
  });
  return all;
}

Result<std::vector<body::LabelledBody>> read_labelled(const std::vector<std::string>& places) {
  std::vector<body::LabelledBody> bodies;
  for (const auto& place : places) {
    const auto paths = body::list_labelled_bodies(place);
    if (!paths) return tl::unexpected(paths.error());
    for (const auto& path : *paths) {
      auto labelled = body::read_labelled_body(path);
      if (!labelled) return tl::unexpected(labelled.error());
      bodies.push_back(std::move(*labelled));
    }
  }
  return bodies;
}

Result<body::Atlas> open_atlas(const std::string& words, const Progress& progress) {
  if (words.empty()) return body::read_atlas(shipped_atlas_path());
  std::error_code fault;
  if (!fs::exists(words, fault)) return fail(Fault::file, "{}: there is no such atlas", words);
  if (!fs::is_directory(words, fault) && fs::path(words).extension() != ".ply")
    return body::read_atlas(words);
  auto bodies = read_labelled({words});
  if (!bodies) return tl::unexpected(bodies.error());
  scan_everybody(*bodies, 1, {});
  const auto shipped = body::read_atlas(shipped_atlas_path());
  if (!shipped) return tl::unexpected(shipped.error());
  return body::learn_atlas(*bodies, &*shipped, progress, nullptr);
}

}  // namespace tuina::app
