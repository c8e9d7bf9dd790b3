// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/contact.hpp"
#include "tuina/core/result.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::sim {

/// By body mass index: slim below 18.5, medium to 25, hefty above.
enum class BodyType : std::uint8_t { slim, medium, hefty };

[[nodiscard]] constexpr const char* name_of(BodyType type) {
  return type == BodyType::slim ? "slim" : type == BodyType::medium ? "medium" : "hefty";
}
[[nodiscard]] constexpr BodyType body_type_of(double bmi) {
  return bmi < 18.5 ? BodyType::slim : bmi <= 25.0 ? BodyType::medium : BodyType::hefty;
}

/// A simulated person in the `couch` frame, with what only a simulation knows.
struct Person {
  std::string name;
  Position position = Position::sitting;
  BodyType body_type = BodyType::medium;
  bool woman = false;
  double height_m = 0.0;     ///< standing; 0 where a file does not say
  double bmi = 0.0;          ///< 0 where a file does not say
  double three_cun_m = 0.0;  ///< midline to the medial border of the scapula, standing; 0: not said
  Mesh skin_in_couch;
  std::vector<Landmark> landmarks;  ///< truth; names as in docs/bodies.md
  std::vector<Acupoint> acupoints;  ///< truth; the seven first, then the further ones
};

/// A labelled body: FILE.ply with FILE.json beside it (docs/bodies.md). Fails when either is
/// missing, malformed, or lacks one of the seven acupoints.
[[nodiscard]] Result<Person> load_person(const std::filesystem::path& ply);

/// Writes NAME.ply and NAME.json of `person.name` into a folder that exists; load_person reads them
/// back.
[[nodiscard]] Result<void> write_person(const Person& person, const std::filesystem::path& folder);

/// What every verb accepts after --person: `phantom:slim`, `phantom:medium` or `phantom:hefty`
/// (another person for another seed; sitting unless `position` says prone), or the path of a
/// labelled body. A `position` that contradicts the file's is refused.
[[nodiscard]] Result<Person> parse_person(std::string_view words, std::optional<Position> position,
                                          std::uint64_t seed);

/// Breathing as motion of the back along its mean outward normal: amplitude * (1 - cos(2 pi f t))
/// / 2.
struct Breathing {
  double amplitude_m = 0.0;
  double frequency_hz = 0.25;
};

}  // namespace tuina::sim
