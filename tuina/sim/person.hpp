// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/contact.hpp"
#include "tuina/core/result.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::sim {

enum class BodyType : std::uint8_t { slim, medium, hefty };

/// A simulated person in the `couch` frame, with what only a simulation knows.
struct Person {
  std::string name;
  Position position = Position::sitting;
  BodyType body_type = BodyType::medium;
  Mesh skin_in_couch;
  std::vector<Landmark> landmarks;  ///< truth; names as in docs/bodies.md
  std::vector<Acupoint> acupoints;  ///< truth; the seven first, then the further ones
};

/// A labelled body: FILE.ply with FILE.json beside it (docs/bodies.md).
[[nodiscard]] Result<Person> load_person(const std::filesystem::path& ply);

/// Breathing as motion of the back along its mean outward normal: amplitude * (1 - cos(2 pi f t))
/// / 2.
struct Breathing {
  double amplitude_m = 0.0;
  double frequency_hz = 0.25;
};

}  // namespace tuina::sim
