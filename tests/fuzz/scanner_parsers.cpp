// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/parsers.hpp"

#include <zlib.h>

#include <algorithm>
#include <cmath>

#include "tuina/core/io/csv.hpp"
#include "tuina/core/io/png.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/scanner/calibration.hpp"
#ifdef TUINA_CALIBRATION
#include "tests/folder.hpp"
#include "tuina/calibration/board/shots.hpp"
#endif

namespace tuina::test {
namespace {

std::string picture(int width, int height, int channels) {
  Image image(width, height, channels);
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    image.data[i] = static_cast<std::uint8_t>(37 * i % 251);
  }
  return to_png(image);
}

// The same picture with every checksum made right, or faults would never come past them.
std::string mended(std::string_view content) {
  std::string png(content);
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(png[at]); };
  for (std::size_t at = 8; at + 12 <= png.size();) {
    const std::size_t length = std::size_t{byte(at)} << 24 | std::size_t{byte(at + 1)} << 16 |
                               std::size_t{byte(at + 2)} << 8 | byte(at + 3);
    if (length > png.size() - at - 12) break;
    const auto* type = reinterpret_cast<const Bytef*>(png.data() + at + 4);
    const unsigned long crc = crc32(0, type, static_cast<uInt>(length + 4));
    for (std::size_t i = 0; i < 4; ++i) {
      png[at + 8 + length + i] = static_cast<char>(crc >> (24 - 8 * i) & 0xff);
    }
    at += length + 12;
  }
  return png;
}

bool accepts_png(std::string_view content) {
  const auto as_it_is = parse_png(content, "f.png");
  const auto file = as_it_is ? as_it_is : parse_png(mended(content), "f.png");
  if (!file) return false;
  const auto& image = file->image;
  demand(image.data.size() == static_cast<std::size_t>(image.width) *
                                  static_cast<std::size_t>(image.height) *
                                  static_cast<std::size_t>(image.channels),
         "a picture has the samples of its size");
  return true;
}

std::string table(std::string_view header) {
  std::string text(header);
  for (int k = 0; k < 12; ++k) text += fmt::format("\n{},{}", k, 0.25 * k * k - 3.0);
  return text + "\n";
}

bool accepts_table(std::string_view content, const std::vector<std::string>& columns) {
  const auto file = parse_csv(content, "f.csv", columns);
  if (!file) return false;
  for (const auto& column : file->columns) {
    demand(column.size() == file->rows(), "columns are equally long");
    demand(std::all_of(column.begin(), column.end(), [](double x) { return std::isfinite(x); }),
           "numbers of a table are finite");
  }
  return true;
}

bool accepts_calibration(std::string_view content) {
  const auto read = scanner::parse_calibration(content, "f.toml");
  if (!read) return false;
  demand(std::abs(read->laser_normal_in_camera.norm() - 1.0) < 1e-9, "a normal is unit");
  demand(std::abs(read->couch_from_camera.linear().determinant() - 1.0) < 1e-9,
         "a rotation is one");
  demand(std::isfinite(read->errors.value_or(scanner::CalibrationErrors{}).range_at_m(1.0)),
         "an expected error is finite");
  demand(scanner::parse_calibration(scanner::to_toml(*read), "again").has_value(),
         "what is written is read");
  return true;
}

bool accepts_surface(std::string_view content) {
  const auto file = parse_surface(content, "f.ply");
  if (!file) return false;
  const auto& cloud = file->cloud;
  demand(cloud.size() > 0, "a cloud has points");
  demand(cloud.normals.empty() || cloud.normals.size() == cloud.size(), "one normal each");
  for (const Vector3& point : cloud.points) demand(point.allFinite(), "points are finite");
  for (const auto& triangle : file->triangles) {
    for (const int corner : triangle) {
      demand(corner >= 0 && corner < static_cast<int>(cloud.size()), "triangles have corners");
    }
  }
  return true;
}

PointCloud little_cloud() {
  PointCloud cloud;
  for (int i = 0; i < 9; ++i) {
    cloud.points.emplace_back(0.1 * i, 0.2, -0.3 * i);
    cloud.normals.push_back(Vector3::UnitZ());
    cloud.amplitude.push_back(100.0F);
    cloud.deviation_m.push_back(2e-4F);
  }
  return cloud;
}

}  // namespace

std::vector<Parser> scanner_parsers() {
  const PointCloud cloud = little_cloud();
  PointCloud bare;
  bare.points = cloud.points;
  const Mesh mesh{.vertices = cloud.points, .triangles = {{0, 1, 2}, {2, 3, 4}, {6, 7, 8}}};
  const std::string ascii_ply =
      "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 nan\n4 0 1 2 3\n";
  const std::string pcd =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\n"
      "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ";
  const std::string binary_pcd = pcd + "binary\n" + std::string(36, '\1');
  // Twelve bytes (1, 1, 1) literally, then 24 that repeat the twelve before them.
  const std::string one = {0, 0, '\x80', '\x3f'};
  const std::string packed =
      std::string(1, 11) + one + one + one + std::string({'\xe0', '\x0f', '\x0b'});
  const auto le32 = [](std::size_t n) {
    return std::string({static_cast<char>(n & 0xff), static_cast<char>(n >> 8 & 0xff), 0, 0});
  };
  const std::string compressed_pcd =
      pcd + "binary_compressed\n" + le32(packed.size()) + le32(36) + packed;

  scanner::ScannerCalibration calibration;
  calibration.couch_from_camera.translation() = Vector3(0.0, 1.1, 0.35);
  scanner::ScannerCalibration with_errors = calibration;
  with_errors.errors.emplace();

  std::vector<Parser> all = {
      {"png", {picture(17, 11, 1), picture(9, 5, 3)}, accepts_png},
      {"frames.csv",
       {table("frame,time_s")},
       [](std::string_view content) {
         return accepts_table(content, {"frame", "time_s"});
       }},
      {"yaw.csv",
       {table("time_s,yaw_deg")},
       [](std::string_view content) {
         return accepts_table(content, {"time_s", "yaw_deg"});
       }},
      {"calibration.toml",
       {scanner::to_toml(calibration), scanner::to_toml(with_errors)},
       accepts_calibration},
      {"ply", {ascii_ply, to_ply(cloud), to_ply(bare), to_ply(mesh)}, accepts_surface},
      {"pcd", {pcd + "ascii\n1 2 3\n4 5 6\n7 8 9\n", binary_pcd, compressed_pcd}, accepts_surface}};
#ifdef TUINA_CALIBRATION
  all.push_back({"board.toml",
                 {"[board]\nkind = \"chessboard\"\ncolumns = 7\nrows = 10\nsquare_m = 0.025\n",
                  "[board]\nkind = \"charuco\"\ncolumns = 4\nrows = 6\nsquare_m = 0.035\n"
                  "marker_m = 0.026\ndictionary = \"DICT_5X5_100\"\n"},
                 [](std::string_view content) {
                   const auto board = calibration::parse_board(content, "board.toml");
                   if (board) demand(board->square_m > 0.0 && board->columns > 2, "a board");
                   return board.has_value();
                 }});
  // The pictures that the table names must be there.
  static const Folder shots;
  std::filesystem::create_directories(shots.path() / "frames");
  for (const char* name : {"000000.png", "000001.png", "000002.png"}) {
    (void)shots.with(std::string("frames/") + name, "");
  }
  all.push_back({"shots.csv",
                 {"frame,kind,pose,time_s,yaw_deg\n0,board,0,0.0,0.0\n1,laser,0,0.5,0.0\n"
                  "2,board,1,1.0,-5.859\n"},
                 [](std::string_view content) {
                   const auto read = calibration::parse_frames(std::string(content), shots.path());
                   if (read) demand(!read->empty(), "shots");
                   return read.has_value();
                 }});
#endif
  return all;
}

}  // namespace tuina::test
