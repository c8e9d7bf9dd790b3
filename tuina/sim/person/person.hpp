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

/// Name of a type, as in `phantom:slim`.
[[nodiscard]] constexpr const char* name_of(BodyType type) {
  return type == BodyType::slim ? "slim" : type == BodyType::medium ? "medium" : "hefty";
}
/// Type of a body mass index, kg/m^2.
[[nodiscard]] constexpr BodyType body_type_of(double bmi) {
  return bmi < 18.5 ? BodyType::slim : bmi <= 25.0 ? BodyType::medium : BodyType::hefty;
}

/// A simulated person in the `couch` frame, with ground truth.
struct Person {
  std::string name;
  BodyPosture position = BodyPosture::sitting;
  BodyType body_type = BodyType::medium;
  bool woman = false;
  double height_m = 0.0;     ///< standing; 0: unknown
  double bmi = 0.0;          ///< 0: unknown
  double three_cun_m = 0.0;  ///< midline to the medial border of the scapula, standing; 0: unknown
  Mesh skin_in_couch;
  std::vector<Landmark> landmarks;  ///< ground truth; names as in docs/bodies.md
  std::vector<Acupoint> acupoints;  ///< ground truth; the seven first, then the others
};

/// Loads a labelled body: FILE.ply and FILE.json beside it (docs/bodies.md). Fails when either is
/// missing or malformed, or lacks one of the seven acupoints.
[[nodiscard]] Result<Person> load_person(const std::filesystem::path& ply);

/// Writes `person.name`.ply and .json into an existing folder; load_person reads them back.
[[nodiscard]] Result<void> write_person(const Person& person, const std::filesystem::path& folder);

/// Parses the value of --person: `phantom:slim`, `phantom:medium` or `phantom:hefty` (drawn by the
/// seed; sitting unless `position` says prone), or the path of a labelled body. Fails when
/// `position` contradicts the file.
[[nodiscard]] Result<Person> parse_person(std::string_view words,
                                          std::optional<BodyPosture> position, std::uint64_t seed);

}  // namespace tuina::sim
