// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <iterator>
#include <vector>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/surface_file.hpp"

namespace tuina {
namespace {

constexpr std::size_t piece_bytes = std::size_t{1} << 20;

bool is_pcd(CloudFormat format) {
  return format == CloudFormat::pcd_ascii || format == CloudFormat::pcd_binary;
}

bool is_ascii(CloudFormat format) {
  return format == CloudFormat::ply_ascii || format == CloudFormat::pcd_ascii;
}

// Property names of a cloud, common to both formats.
std::vector<std::string_view> properties(const PointCloud& cloud, bool pcd) {
  std::vector<std::string_view> names = {"x", "y", "z"};
  if (!cloud.normals.empty()) {
    const auto normal = pcd ? std::array<std::string_view, 3>{"normal_x", "normal_y", "normal_z"}
                            : std::array<std::string_view, 3>{"nx", "ny", "nz"};
    names.insert(names.end(), normal.begin(), normal.end());
  }
  if (!cloud.amplitude.empty()) names.emplace_back("amplitude_dn");
  if (!cloud.deviation_m.empty()) names.emplace_back("deviation_m");
  return names;
}

std::string ply_header(const PointCloud& cloud, CloudFormat format) {
  const char* encoding = format == CloudFormat::ply_ascii    ? "ascii"
                         : format == CloudFormat::ply_binary ? "binary_little_endian"
                                                             : "binary_big_endian";
  std::string header = fmt::format("ply\nformat {} 1.0\ncomment metres\nelement vertex {}\n",
                                   encoding, cloud.size());
  for (const auto name : properties(cloud, false)) {
    header += fmt::format("property float {}\n", name);
  }
  return header + "end_header\n";
}

std::string pcd_header(const PointCloud& cloud, CloudFormat format) {
  const auto names = properties(cloud, true);
  std::string sizes, types, counts;
  for (std::size_t i = 0; i < names.size(); ++i) {
    sizes += " 4";
    types += " F";
    counts += " 1";
  }
  return fmt::format(
      "# .PCD v0.7, metres\nVERSION 0.7\nFIELDS {}\nSIZE{}\nTYPE{}\nCOUNT{}\nWIDTH {}\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA {}\n",
      fmt::join(names, " "), sizes, types, counts, cloud.size(), cloud.size(),
      is_ascii(format) ? "ascii" : "binary");
}

std::string header_of(const PointCloud& cloud, CloudFormat format) {
  return is_pcd(format) ? pcd_header(cloud, format) : ply_header(cloud, format);
}

void append_number(std::string& content, float value, CloudFormat format) {
  if (is_ascii(format)) {
    // The shortest digits that read back as the same float.
    fmt::format_to(std::back_inserter(content), "{} ", value);
    return;
  }
  auto bytes = std::bit_cast<std::array<char, 4>>(value);
  const bool big_endian = format == CloudFormat::ply_big_endian;
  if (big_endian != (std::endian::native == std::endian::big)) {
    std::reverse(bytes.begin(), bytes.end());
  }
  content.append(bytes.data(), bytes.size());
}

void append_point(std::string& content, const PointCloud& cloud, std::size_t k,
                  CloudFormat format) {
  for (const auto* vectors : {&cloud.points, &cloud.normals}) {
    for (int i = 0; i < 3 && !vectors->empty(); ++i) {
      append_number(content, static_cast<float>((*vectors)[k][i]), format);
    }
  }
  for (const auto* numbers : {&cloud.amplitude, &cloud.deviation_m}) {
    if (!numbers->empty()) append_number(content, (*numbers)[k], format);
  }
  if (is_ascii(format)) content.back() = '\n';
}

}  // namespace

std::optional<CloudFormat> cloud_format(std::string_view name) {
  if (name == "ply") return CloudFormat::ply_binary;
  if (name == "ply-ascii") return CloudFormat::ply_ascii;
  if (name == "ply-big-endian") return CloudFormat::ply_big_endian;
  if (name == "pcd") return CloudFormat::pcd_binary;
  if (name == "pcd-ascii") return CloudFormat::pcd_ascii;
  return std::nullopt;
}

Result<void> write_cloud(const std::filesystem::path& path, const PointCloud& cloud,
                         CloudFormat format) {
  auto file = FileWriter::open(path);
  if (!file) return tl::unexpected(file.error());
  std::string piece = header_of(cloud, format);
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    append_point(piece, cloud, k, format);
    if (piece.size() < piece_bytes) continue;
    if (auto written = file->append(piece); !written) return written;
    piece.clear();
  }
  if (auto written = file->append(piece); !written) return written;
  return file->finish();
}

std::string to_ply(const PointCloud& cloud) {
  std::string content = header_of(cloud, CloudFormat::ply_binary);
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    append_point(content, cloud, k, CloudFormat::ply_binary);
  }
  return content;
}

}  // namespace tuina
