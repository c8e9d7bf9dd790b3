// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/tuina/scanner_trials.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::app {

/// Scans of backs over one condition that is made worse and worse.
struct Curve {
  std::string name;     ///< key in JSON
  std::string x_label;  ///< with its unit
  std::vector<double> x = {};
  std::vector<BackTrial> y = {};
};

/// All that `tuina evaluate scanner` measures; what was not asked for is empty.
struct ScannerProof {
  int people = 0;
  std::vector<WallTrial> walls = {};
  std::vector<WallTrial> speckled_walls = {};
  std::map<std::string, BackTrial> backs = {};  ///< by condition
  std::vector<Curve> curves = {};
  std::optional<BoxTrial> box = {};
  std::optional<SphereTrial> sphere = {};
  PointCloud back_in_couch = {};  ///< of one person who sits, to be looked at
};

struct ProofOptions {
  bool walls = true, backs = true, curves = true, bodies = true;
  int people = 6;
  int scanners = 6;
};

[[nodiscard]] Result<ScannerProof> prove_scanner(const ProofOptions& options, std::uint64_t seed,
                                                 const Progress& progress);

/// One self-contained page.
[[nodiscard]] std::string page_of(const ScannerProof& proof);

}  // namespace tuina::app
