// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "apps/cli/options.hpp"
#include "tuina/core/result.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::app {

/// A ball and a box of known size that stand in a scene: a scan that shows them otherwise is not to
/// be trusted. Nothing is checked unless it was asked for.
class KnownBodies {
 public:
  void describe(Options& options);
  /// Reads the size of the box. Fails with Fault::usage.
  [[nodiscard]] Result<void> begin();
  /// Fails where the cloud shows them hollow, askew or of another size. Else adds to an answer what
  /// they measure.
  [[nodiscard]] Result<void> check(const PointCloud& cloud, nlohmann::json& json,
                                   std::string& text) const;

 private:
  double ball_mm_ = 0.0;
  std::string box_;
  Vector3 box_m_ = Vector3::Zero();
};

}  // namespace tuina::app
