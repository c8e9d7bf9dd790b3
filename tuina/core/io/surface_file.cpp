// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/surface_file.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/surface_parts.hpp"
#include "tuina/core/io/text_lines.hpp"

namespace tuina {
namespace surface_parts {
namespace {

// Coordinates beyond 1000 km are no person in metres and would overflow later.
constexpr double max_distance_m = 1e6;

template <typename Number>
double number_at(const char* bytes, bool big_endian) {
  std::array<char, sizeof(Number)> own;
  std::memcpy(own.data(), bytes, own.size());
  if (big_endian != (std::endian::native == std::endian::big)) std::reverse(own.begin(), own.end());
  return static_cast<double>(std::bit_cast<Number>(own));
}

template <typename Number>
std::optional<double> number_of(std::string_view word) {
  const auto value = to_number<Number>(word);
  return value ? std::optional<double>(static_cast<double>(*value)) : std::nullopt;
}

}  // namespace

std::size_t size_of(NumberType type) {
  constexpr std::array<std::size_t, 10> sizes = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

double from_bytes(const char* bytes, NumberType type, bool big_endian) {
  switch (type) {
    case NumberType::i8:
      return number_at<std::int8_t>(bytes, big_endian);
    case NumberType::u8:
      return number_at<std::uint8_t>(bytes, big_endian);
    case NumberType::i16:
      return number_at<std::int16_t>(bytes, big_endian);
    case NumberType::u16:
      return number_at<std::uint16_t>(bytes, big_endian);
    case NumberType::i32:
      return number_at<std::int32_t>(bytes, big_endian);
    case NumberType::u32:
      return number_at<std::uint32_t>(bytes, big_endian);
    case NumberType::i64:
      return number_at<std::int64_t>(bytes, big_endian);
    case NumberType::u64:
      return number_at<std::uint64_t>(bytes, big_endian);
    case NumberType::f32:
      return number_at<float>(bytes, big_endian);
    case NumberType::f64:
      return number_at<double>(bytes, big_endian);
  }
  return 0.0;
}

std::optional<double> from_word(std::string_view word, NumberType type) {
  switch (type) {
    case NumberType::i8:
      return number_of<std::int8_t>(word);
    case NumberType::u8:
      return number_of<std::uint8_t>(word);
    case NumberType::i16:
      return number_of<std::int16_t>(word);
    case NumberType::u16:
      return number_of<std::uint16_t>(word);
    case NumberType::i32:
      return number_of<std::int32_t>(word);
    case NumberType::u32:
      return number_of<std::uint32_t>(word);
    case NumberType::i64:
      return number_of<std::int64_t>(word);
    case NumberType::u64:
      return number_of<std::uint64_t>(word);
    case NumberType::f32:
    case NumberType::f64:
      return number_of<double>(word);
  }
  return std::nullopt;
}

PointGatherer::Slot PointGatherer::slot_of(std::string_view property) {
  constexpr std::array<std::string_view, slots> ply = {
      "x", "y", "z", "nx", "ny", "nz", "amplitude_dn", "deviation_m"};
  constexpr std::array<std::string_view, slots> pcd = {
      "x", "y", "z", "normal_x", "normal_y", "normal_z", "amplitude_dn", "deviation_m"};
  for (std::size_t s = 0; s < slots; ++s) {
    if (property == ply[s] || property == pcd[s]) return static_cast<Slot>(s);
  }
  return Slot::none;
}

PointGatherer::PointGatherer(std::array<bool, slots + 1> present, std::size_t expected)
    : normals_(present[3] && present[4] && present[5]),
      amplitude_(present[6]),
      deviation_(present[7]) {
  file_.cloud.points.reserve(expected);
  if (normals_) file_.cloud.normals.reserve(expected);
  if (amplitude_) file_.cloud.amplitude.reserve(expected);
  if (deviation_) file_.cloud.deviation_m.reserve(expected);
}

bool PointGatherer::add(const Values& values) {
  const Vector3 point(values[0], values[1], values[2]);
  const bool finite = point.allFinite();
  if (finite && point.cwiseAbs().maxCoeff() > max_distance_m) return false;
  auto& cloud = file_.cloud;
  if (!finite && number_of_.empty()) {
    for (std::size_t k = 0; k < added_; ++k) number_of_.push_back(static_cast<int>(k));
  }
  if (!finite || !number_of_.empty())
    number_of_.push_back(finite ? static_cast<int>(cloud.size()) : -1);
  ++added_;
  if (!finite) {
    ++file_.dropped_points;
    return true;
  }
  cloud.points.push_back(point);
  if (normals_) {
    const Vector3 normal(values[3], values[4], values[5]);
    const double length = normal.norm();
    // A property exists for all points or for none: one normal of zero length drops all normals.
    normals_ = std::isfinite(length) && length > 1e-9;
    if (normals_) cloud.normals.emplace_back(normal / length);
  }
  amplitude_ = amplitude_ && std::isfinite(values[6]);
  if (amplitude_) cloud.amplitude.push_back(static_cast<float>(values[6]));
  deviation_ = deviation_ && std::isfinite(values[7]);
  if (deviation_) cloud.deviation_m.push_back(static_cast<float>(values[7]));
  return true;
}

void PointGatherer::add_triangle(std::array<int, 3> corners) {
  for (int& corner : corners) {
    if (number_of_.empty()) continue;
    corner = number_of_[static_cast<std::size_t>(corner)];
    if (corner < 0) return;
  }
  file_.triangles.push_back(corners);
}

bool PointGatherer::triangles_cover_the_points() const {
  std::vector<bool> met(file_.cloud.size(), false);
  for (const auto& corners : file_.triangles) {
    for (const int corner : corners) met[static_cast<std::size_t>(corner)] = true;
  }
  return 2 * static_cast<std::size_t>(std::count(met.begin(), met.end(), true)) >= met.size();
}

SurfaceFile PointGatherer::take() {
  if (!triangles_cover_the_points()) file_.triangles.clear();
  if (!normals_) file_.cloud.normals.clear();
  if (!amplitude_) file_.cloud.amplitude.clear();
  if (!deviation_) file_.cloud.deviation_m.clear();
  return std::move(file_);
}

}  // namespace surface_parts

namespace {

constexpr std::size_t max_surface_bytes = std::size_t{384} << 20;

void append(std::string& content, double value) {
  const auto bytes = std::bit_cast<std::array<char, 4>>(static_cast<float>(value));
  content.append(bytes.data(), bytes.size());
}

void append(std::string& content, const Vector3& value) {
  for (int k = 0; k < 3; ++k) append(content, value[k]);
}

}  // namespace

Result<SurfaceFile> parse_surface(std::string_view content, std::string_view name) {
  TextLines lines(content);
  const auto first = lines.next();
  if (!first) return fail(Fault::bad_input, "{}: is empty; a PLY or PCD file is needed", name);
  std::string_view rest = *first;
  const std::string_view word = take_word(rest);
  if (word == "ply") return surface_parts::parse_ply(content, name);
  // A PCD file may begin with comments, so any of its header words identifies it.
  for (const char* known : {"#", "VERSION", "FIELDS", "SIZE", "WIDTH", "POINTS"}) {
    if (word == known || (word.starts_with('#') && *known == '#')) {
      return surface_parts::parse_pcd(content, name);
    }
  }
  return fail(Fault::bad_input,
              "{}:1: begins with {}; a PLY file begins with `ply`, a PCD file with `VERSION`", name,
              in_quotes(*first));
}

Result<SurfaceFile> read_surface(const std::filesystem::path& path) {
  const auto content = read_file(path, max_surface_bytes);
  if (!content) return tl::unexpected(content.error());
  return parse_surface(*content, path.string());
}

std::string to_ply(const Mesh& mesh) {
  static_assert(std::endian::native == std::endian::little,
                "the numbers are written as they lie in memory");
  std::string content = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment metres\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.vertices.size(), mesh.triangles.size());
  for (const Vector3& vertex : mesh.vertices) append(content, vertex);
  for (const auto& triangle : mesh.triangles) {
    content += '\3';
    const auto bytes = std::bit_cast<std::array<char, 12>>(triangle);
    content.append(bytes.data(), bytes.size());
  }
  return content;
}

}  // namespace tuina
