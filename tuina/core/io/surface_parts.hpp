// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/result.hpp"

/// What the PLY and the PCD reader share. Only they include this; others use surface_file.hpp.
namespace tuina::surface_parts {

[[nodiscard]] Result<SurfaceFile> parse_ply(std::string_view content, std::string_view name);
[[nodiscard]] Result<SurfaceFile> parse_pcd(std::string_view content, std::string_view name);

enum class NumberType : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };
[[nodiscard]] std::size_t size_of(NumberType type);
[[nodiscard]] constexpr bool is_floating(NumberType type) {
  return type >= NumberType::f32;
}

/// The number in `size_of(type)` bytes of a file.
[[nodiscard]] double from_bytes(const char* bytes, NumberType type, bool big_endian);

/// The word as a number that fits the type.
[[nodiscard]] std::optional<double> from_word(std::string_view word, NumberType type);

/// Gathers points one by one, leaves out non-finite ones and knows afterwards which those were.
class PointGatherer {
 public:
  /// What a property of a point is to tuina, by its name; `none` for names that it does not know.
  enum class Slot : std::uint8_t {
    x,
    y,
    z,
    normal_x,
    normal_y,
    normal_z,
    amplitude,
    deviation,
    none
  };
  static constexpr std::size_t slots = static_cast<std::size_t>(Slot::none);
  [[nodiscard]] static Slot slot_of(std::string_view property);

  using Values = std::array<double, slots + 1>;  ///< the last one takes what has no slot

  /// `present[s]`: whether the file has slot s.
  PointGatherer(std::array<bool, slots + 1> present, std::size_t expected);

  /// False when the point cannot be in metres, however finite it is.
  [[nodiscard]] bool add(const Values& values);

  /// The triangle in the file's numbering, renumbered; left out when one of its points was.
  void add_triangle(std::array<int, 3> corners);

  [[nodiscard]] SurfaceFile take();

 private:
  SurfaceFile file_;
  bool normals_ = false;
  bool amplitude_ = false;
  bool deviation_ = false;
  std::vector<int>
      number_of_;  ///< new number of each point of the file, -1 when left out; empty while none is
  std::size_t added_ = 0;
};

}  // namespace tuina::surface_parts
