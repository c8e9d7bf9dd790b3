// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "tuina/body/acupoints.hpp"
#include "tuina/core/acupoint.hpp"
#include "tuina/core/result.hpp"

namespace tuina::record {

/// What acupoints.json says of one scan, in the scan's frame.
struct MappedBack {
  std::optional<BodyPosture> position;
  std::vector<Acupoint> acupoints;
  std::vector<Landmark> landmarks;
};

/// Reads the object that `tuina map` writes. Further keys are left alone; a missing point of the
/// seven, a place that is not three numbers in metres or a normal that is not of length one is
/// refused with its name.
[[nodiscard]] Result<MappedBack> read_acupoints(const std::filesystem::path& file);
/// The same of a text; `name` stands for the file in what is wrong.
[[nodiscard]] Result<MappedBack> parse_acupoints(std::string_view text, std::string_view name);

/// Answer of `map`, and content of acupoints.json.
struct MapFile {
  body::Mapping mapping;
  std::size_t points = 0;          ///< points of the scan
  std::size_t dropped_points = 0;  ///< points of the scan that were not finite
  double compute_ms = 0.0;
};
/// The JSON object of acupoints.json; places in `couch`, metres.
[[nodiscard]] std::string to_json(const MapFile& map);

}  // namespace tuina::record
