// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/evaluation/cells.hpp"
#include "apps/evaluation/scanner/trials.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::app {

/// Scans of backs over one condition that is made worse and worse.
struct Curve {
  std::string name;     ///< key in JSON
  std::string x_label;  ///< quantity and unit
  std::vector<double> x = {};
  std::vector<BackTrial> y = {};
};

/// A quantity that the scanner should reach, and what was measured.
struct Target {
  std::string name;  ///< quantity and unit
  double wanted = 0.0;
  double measured = 0.0;
  bool at_least = false;  ///< true: at least; false: at most
  [[nodiscard]] bool reached() const { return at_least ? measured >= wanted : measured <= wanted; }
};

/// All that `tuina evaluate scanner` measures; what was not asked for is empty.
struct ScannerProof {
  int people = 0;
  std::vector<Target> targets = {};
  std::vector<WallTrial> walls = {};
  std::vector<WallTrial> speckled_walls = {};
  std::map<std::string, BackTrial> backs = {};  ///< keyed by condition
  std::vector<Curve> curves = {};
  std::optional<BoxTrial> box = {};
  std::optional<SphereTrial> sphere = {};
  std::optional<double> worst_latency_s = {};  ///< error of it, of scanners that were calibrated
  PointCloud back_in_couch = {};               ///< scan of one sitting person, to be looked at
};

struct ProofOptions {
  bool walls = true, backs = true, curves = true, bodies = true;
  int people = 6;
  /// @{
  /// Scanners for walls, and for backs with either mount, made when they are first asked for. Of
  /// backs none: errors are drawn.
  std::function<Result<std::span<const BuiltScanner>>()> of_walls = {};
  std::function<Result<std::span<const BuiltScanner>>(bool upright)> of_backs = {};
  /// @}
};

/// Targets for the walls and backs that were measured, and for the latency of the scanners.
[[nodiscard]] std::vector<Target> targets_of(const ScannerProof& proof);

/// Walls and each condition of backs are cells; the two bodies are no cells, and left out of a
/// shard.
[[nodiscard]] Result<ScannerProof> prove_scanner(const ProofOptions& options, Cells& cells,
                                                 std::uint64_t seed, const Progress& progress);

/// One self-contained page.
[[nodiscard]] std::string page_of(const ScannerProof& proof);

}  // namespace tuina::app
