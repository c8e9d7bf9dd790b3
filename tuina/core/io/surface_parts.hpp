// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/result.hpp"

/// Shared by the PLY and the PCD reader; all others include surface_file.hpp.
namespace tuina::surface_parts {

/// @{
/// Reads one format; `name` stands for the file in what is wrong.
[[nodiscard]] Result<SurfaceFile> parse_ply(std::string_view content, std::string_view name);
[[nodiscard]] Result<SurfaceFile> parse_pcd(std::string_view content, std::string_view name);
/// @}

/// Types of numbers in a file: integers by sign and bits, then floats.
enum class NumberType : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };
[[nodiscard]] std::size_t size_of(NumberType type);  ///< bytes of one number
/// Whether numbers of the type have a point.
[[nodiscard]] constexpr bool is_floating(NumberType type) {
  return type >= NumberType::f32;
}

/// Decodes `size_of(type)` bytes.
[[nodiscard]] double from_bytes(const char* bytes, NumberType type, bool big_endian);

/// Parses a word; nothing if it does not fit the type.
[[nodiscard]] std::optional<double> from_word(std::string_view word, NumberType type);

/// Collects points, leaves out non-finite ones and renumbers triangles accordingly.
class PointGatherer {
 public:
  /// Meaning of a point property, by its name; `none` for an unknown name.
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
  /// Slot of a property of this name; `none` where it has no meaning here.
  [[nodiscard]] static Slot slot_of(std::string_view property);

  using Values = std::array<double, slots + 1>;  ///< the last entry takes values without a slot

  /// `present[s]`: the file has slot s.
  PointGatherer(std::array<bool, slots + 1> present, std::size_t expected);

  /// False when a coordinate is too large to be in metres.
  [[nodiscard]] bool add(const Values& values);

  /// Renumbers a triangle of the file and keeps it unless one of its points was left out.
  void add_triangle(std::array<int, 3> corners);

  /// What was collected; the gatherer is empty afterwards.
  [[nodiscard]] SurfaceFile take();

 private:
  [[nodiscard]] bool triangles_cover_the_points() const;

  SurfaceFile file_;
  bool normals_ = false;
  bool amplitude_ = false;
  bool deviation_ = false;
  std::vector<int>
      number_of_;  ///< new number of each point of the file, -1: left out; empty while none is
  std::size_t added_ = 0;
};

}  // namespace tuina::surface_parts
