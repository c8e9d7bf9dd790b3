// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/surface_file.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>

#include "tests/core/mutation.hpp"
#include "tests/folder.hpp"
#include "tests/reason.hpp"
#include "tuina/core/io/file.hpp"

using namespace tuina;

namespace {

SurfaceFile read(std::string_view content) {
  auto file = parse_surface(content, "s.ply");
  INFO((file ? "" : file.error().message));
  REQUIRE(file.has_value());
  return *file;
}

std::string refusal(std::string_view content) {
  const auto file = parse_surface(content, "s.ply");
  REQUIRE_FALSE(file.has_value());
  CHECK(file.error().fault == Fault::bad_input);
  return file.error().message;
}

bool says(const std::string& message, std::string_view words) {
  INFO(message);
  return message.find(words) != std::string::npos;
}

template <typename Number>
std::string bytes_of(Number value, bool big_endian = false) {
  auto bytes = std::bit_cast<std::array<char, sizeof(Number)>>(value);
  if (big_endian) std::reverse(bytes.begin(), bytes.end());
  return {bytes.data(), bytes.size()};
}

const std::string square =
    "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nproperty uchar red\nelement face 1\nproperty list uchar int "
    "vertex_indices\nend_header\n"
    "0 0 0 255\n1 0 0 0\n1 1 0 0\n0 1 0.5 7\n4 0 1 2 3\n";

const std::string pcd_header =
    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z i\nSIZE 4 4 4 1\nTYPE F F F U\nCOUNT 1 1 1 1\n"
    "WIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\n";

std::string with(std::string text, std::string_view from, std::string_view to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

std::string crlf(const std::string& text) {
  std::string result;
  for (const char letter : text)
    result += letter == '\n' ? std::string("\r\n") : std::string(1, letter);
  return result;
}

}  // namespace

TEST_CASE("a cloud written as PLY comes back with its normals, amplitudes and deviations") {
  PointCloud cloud;
  for (int k = 0; k < 10; ++k) {
    cloud.points.push_back(Vector3(0.125 * k, -0.5, 1.0));
    cloud.normals.push_back(Vector3(0.0, 0.6, 0.8));
    cloud.amplitude.push_back(static_cast<float>(k));
    cloud.deviation_m.push_back(0.001F);
  }
  const SurfaceFile file = read(to_ply(cloud));
  CHECK(file.cloud.points == cloud.points);
  CHECK(file.cloud.normals[3].isApprox(cloud.normals[3], 1e-6));
  CHECK(file.cloud.amplitude == cloud.amplitude);
  CHECK(file.cloud.deviation_m == cloud.deviation_m);
}

TEST_CASE("a cloud written in any format comes back, and nothing is left of one that cannot be") {
  const test::Folder folder;
  Random random = make_random(4, "cloud formats");
  PointCloud cloud;
  for (int k = 0; k < 40000; ++k) {  // more than one piece
    const auto number = [&] { return static_cast<float>(gaussian(random, 0.3)); };
    cloud.points.emplace_back(number(), number(), number());
    cloud.amplitude.push_back(number());
  }
  for (const char* name : {"ply", "ply-ascii", "ply-big-endian", "pcd", "pcd-ascii"}) {
    CAPTURE(name);
    const auto format = cloud_format(name);
    REQUIRE(format.has_value());
    const auto path = folder / name;
    REQUIRE(write_cloud(path, cloud, *format).has_value());
    const auto file = read_surface(path);
    REQUIRE_MESSAGE(file.has_value(), test::reason(file));
    REQUIRE(file->cloud.size() == cloud.size());
    // Words are read as double, which the digits of a float give to a part in ten million.
    double worst_m = 0.0;
    for (std::size_t k = 0; k < cloud.size(); ++k) {
      worst_m = std::max(worst_m, (file->cloud.points[k] - cloud.points[k]).norm());
    }
    CHECK(worst_m < 2e-7);
    CHECK(file->cloud.amplitude == cloud.amplitude);
    CHECK(file->cloud.normals.empty());
  }
  CHECK(read_file(folder / "ply").value() == to_ply(cloud));
  CHECK_FALSE(cloud_format("stl").has_value());
  CHECK(write_cloud(folder / "no/cloud.ply", cloud).error().fault == Fault::file);
}

TEST_CASE("a mesh written as PLY comes back, and a polygon is read as a fan of triangles") {
  const Mesh mesh = {.vertices = {Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0)},
                     .triangles = {{0, 1, 2}}};
  CHECK(read(to_ply(mesh)).triangles == mesh.triangles);
  CHECK(read(square).triangles == std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 3}});
}

TEST_CASE(
    "PLY of doubles, of big-endian numbers, with CRLF, a byte-order mark or no last newline is "
    "read") {
  CHECK(read(crlf(square)).cloud.points[3] == Vector3(0, 1, 0.5));
  CHECK(read("\xEF\xBB\xBF" + square).cloud.size() == 4);
  CHECK(read(square.substr(0, square.size() - 1)).triangles.size() == 2);
  for (const bool big : {false, true}) {
    std::string content =
        std::string("ply\nformat binary_") + (big ? "big" : "little") +
        "_endian 1.0\nelement camera 1\nproperty list uchar short view\nelement vertex 2\n"
        "property double x\nproperty double y\nproperty short k\nproperty double z\nend_header\n";
    content += '\2' + bytes_of<std::int16_t>(1, big) + bytes_of<std::int16_t>(2, big);
    for (const double k : {1.0, 2.0}) {
      content += bytes_of(k, big) + bytes_of(-k, big) + bytes_of<std::int16_t>(9, big) +
                 bytes_of(0.1 * k, big);
    }
    const SurfaceFile file = read(content);
    CHECK(file.cloud.points == std::vector<Vector3>{Vector3(1, -1, 0.1), Vector3(2, -2, 0.2)});
  }
}

TEST_CASE("a mesh whose triangles meet fewer than half of its points is read by its points") {
  Mesh mesh;
  for (int i = 0; i < 7; ++i) mesh.vertices.emplace_back(i, i % 2, 0.0);
  mesh.triangles = {{0, 1, 2}};
  CHECK(read(to_ply(mesh)).triangles.empty());
  CHECK(read(to_ply(mesh)).cloud.size() == 7);
  mesh.triangles.push_back({2, 3, 4});
  CHECK(read(to_ply(mesh)).triangles == mesh.triangles);
}

TEST_CASE("numbers with a plus sign are read from PLY and PCD as text") {
  CHECK(read(with(square, "1 0 0 0", "+1 +0.0 0 +0")).cloud.points[1] == Vector3(1, 0, 0));
  const std::string pcd =
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n"
      "+0.5 -1 +2e-1\n";
  CHECK(read(pcd).cloud.points[0] == Vector3(0.5, -1, 0.2));
}

TEST_CASE("points that are not finite are dropped and counted, with the triangles that used them") {
  const SurfaceFile file = read(with(square, "1 0 0 0", "nan 0 -inf 0"));
  CHECK(file.dropped_points == 1);
  CHECK(file.cloud.size() == 3);
  CHECK(file.triangles == std::vector<std::array<int, 3>>{{0, 1, 2}});
}

TEST_CASE("a normal without a direction takes the normals away, not the points") {
  PointCloud cloud;
  cloud.points = {Vector3(0, 0, 0), Vector3(1, 0, 0)};
  cloud.normals = {Vector3(0, 0, 1), Vector3(0, 0, 0)};
  const SurfaceFile file = read(to_ply(cloud));
  CHECK(file.cloud.size() == 2);
  CHECK(file.cloud.normals.empty());
}

TEST_CASE("every departure from PLY is refused with its place and what would be right") {
  CHECK(says(refusal(""), "s.ply: is empty"));
  CHECK(says(refusal("solid cube\n"), "s.ply:1: begins with `solid cube`"));
  CHECK(says(refusal("ply\nformat ascii 1.0\n"), "no end_header"));
  CHECK(says(refusal(with(square, "ascii 1.0", "ascii 2.0")), "s.ply:2:"));
  CHECK(says(refusal(with(square, "vertex 4", "vertex 5")), "s.ply:16:"));
  CHECK(says(refusal(with(square, "vertex 4", "vertex 3")), "s.ply:15:"));
  CHECK(says(refusal(with(square, "vertex 4", "vertex 4000000000")),
             "the header claims 4000000000 rows"));
  CHECK(says(refusal(with(square, "vertex 4", "vertex 0")), "holds no vertex"));
  CHECK(says(refusal(with(square, "vertex 4", "vertex -4")), "element NAME COUNT"));
  CHECK(says(refusal(with(square, "face 1", "face 99999999")),
             "the header claims 99999999 rows of `face`"));
  CHECK(says(refusal(with(square, "float y", "int y")), "property float y"));
  CHECK(says(refusal(with(square, "float y", "float x")), "s.ply:6: property `x` stands twice"));
  CHECK(says(refusal(with(square, "float y", "real y")), "s.ply:6:"));
  CHECK(says(refusal(with(square, "0 0 0 255", "0 0 0 256")),
             "s.ply:12: `256` is not a number of the declared type"));
  CHECK(says(refusal(with(square, "1 0 0 0", "1 0 0")), "s.ply:13: too few"));
  CHECK(says(refusal(with(square, "1 0 0 0", "1 0 0 0 0")), "s.ply:13: too many"));
  CHECK(says(refusal(with(square, "1 0 0 0", "1e30 0 0 0")), "s.ply:13: a coordinate beyond"));
  CHECK(says(refusal(with(square, "4 0 1 2 3", "4 0 1 2 4")), "s.ply:16: vertex 4 does not exist"));
  CHECK(says(refusal(with(square, "4 0 1 2 3", "2 0 1")), "s.ply:16: a face of 2 corners"));
  CHECK(says(refusal(square + "1 2 3\n"), "6 bytes follow the last row"));
  CHECK(read(square + " \n\n").cloud.size() == 4);
  const std::string binary = to_ply(read(square).cloud);
  CHECK(says(refusal(binary.substr(0, binary.size() - 1)), "the header claims 4 rows"));
  CHECK(says(refusal(binary + "x"), "1 bytes follow the last row"));
}

TEST_CASE("PCD is read as text, as binary and compressed") {
  const SurfaceFile text = read(pcd_header + "DATA ascii\n1 2 3 4\nnan nan nan 0\n4 5 6 7");
  CHECK(text.cloud.points == std::vector<Vector3>{Vector3(1, 2, 3), Vector3(4, 5, 6)});
  CHECK(text.dropped_points == 1);

  std::string rows;
  std::string columns;
  for (const float k : {1.F, 2.F, 3.F})
    rows += bytes_of(k) + bytes_of(2.F * k) + bytes_of(-k) + '\1';
  for (const float factor : {1.F, 2.F, -1.F}) {
    for (const float k : {1.F, 2.F, 3.F}) columns += bytes_of(factor * k);
  }
  columns += "\1\1\1";
  const std::vector<Vector3> expected = {Vector3(1, 2, -1), Vector3(2, 4, -2), Vector3(3, 6, -3)};
  CHECK(read(pcd_header + "DATA binary\n" + rows).cloud.points == expected);
  CHECK(read(crlf(pcd_header) + "DATA binary\r\n" + rows).cloud.points == expected);

  // 36 bytes as two runs of literals, then the three ones as a literal and a reference that
  // overlaps itself.
  const std::string packed = '\x1f' + columns.substr(0, 32) + '\3' + columns.substr(32, 4) +
                             std::string("\0\1", 2) + std::string("\x00\1", 2) +
                             std::string("\x00\1", 2);
  const auto compressed = [&](const std::string& data, std::uint32_t size) {
    return pcd_header + "DATA binary_compressed\n" +
           bytes_of(static_cast<std::uint32_t>(data.size())) + bytes_of(size) + data;
  };
  CHECK(read(compressed(packed, 39)).cloud.points == expected);
  const std::string repeated =
      '\x1f' + columns.substr(0, 32) + '\3' + columns.substr(32, 4) + std::string("\0\1", 2);
  CHECK(says(refusal(compressed(repeated, 39)), "compressed data are damaged"));
  CHECK(says(refusal(compressed(packed, 40)), "cannot come from"));
}

TEST_CASE("a compressed PCD whose references overlap what they make is unrolled") {
  // 40 points at one place: x, y and z are each one float of zeros repeated, 160 zeros, 480 in all.
  const std::string header =
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 40\nHEIGHT 1\nDATA "
      "binary_compressed\n";
  const std::string zero(1, '\0');
  // One literal zero, then 264 and 215 copies of the byte before.
  const std::string packed =
      zero + zero + "\xe0\xff" + zero + "\xe0" + static_cast<char>(215 - 9) + zero;
  const std::string content = header + bytes_of(static_cast<std::uint32_t>(packed.size())) +
                              bytes_of(std::uint32_t{480}) + packed;
  const SurfaceFile file = read(content);
  CHECK(file.cloud.size() == 40);
  CHECK(file.cloud.points[39] == Vector3::Zero());
}

TEST_CASE("every departure from PCD is refused with its place and what would be right") {
  const std::string good = pcd_header + "DATA ascii\n1.250 2.125 3 4\n1 2 3 4\n4 5 6 7\n";
  CHECK(says(refusal(with(good, "VERSION 0.7", "VERSION 0.3")), "`VERSION 0.7` is needed"));
  CHECK(says(refusal(with(good, "FIELDS x y z i", "FIELDS x y w i")), "a field z"));
  CHECK(says(refusal(with(good, "FIELDS x y z i", "FIELDS x y z z")), "stands twice"));
  CHECK(says(refusal(with(good, "SIZE 4 4 4 1", "SIZE 4 4 4")), "SIZE has 3 values for 4 fields"));
  CHECK(says(refusal(with(good, "TYPE F F F U", "TYPE F F F X")), "TYPE"));
  CHECK(says(refusal(with(good, "WIDTH 3", "WIDTH 4")), "is not WIDTH"));
  CHECK(says(refusal(with(good, "DATA ascii", "DATA zip")), "s.ply:11:"));
  CHECK(says(refusal(with(good, "4 5 6 7", "4 5 6 -7")), "s.ply:14: `i` is `-7`"));
  CHECK(says(refusal(with(good, "4 5 6 7", "4 5 6")), "s.ply:14:"));
  CHECK(says(refusal(with(good, "4 5 6 7\n", "")), "s.ply:13: the file ends after 2 of 3"));
  CHECK(says(refusal(good + "8 9 10 11\n"), "s.ply:15: 10 bytes follow"));
  CHECK(says(
      refusal(with(with(good, "WIDTH 3", "WIDTH 2000000000"), "POINTS 3", "POINTS 2000000000")),
      "claims 2000000000"));
  CHECK(says(refusal(with(good, "DATA ascii", "DATA binary")), "the header claims 3 points"));
}

TEST_CASE("a cloud file with random faults is read or refused, whichever format it is in") {
  std::string binary_pcd = pcd_header + "DATA binary\n";
  for (int k = 0; k < 3; ++k)
    binary_pcd += bytes_of(0.1F * static_cast<float>(k)) + bytes_of(1.F) + bytes_of(2.F) + '\1';
  const std::string zero(1, '\0');
  const std::string compressed =
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 40\nHEIGHT 1\nDATA "
      "binary_compressed\n" +
      bytes_of(std::uint32_t{8}) + bytes_of(std::uint32_t{480}) + zero + zero + "\xe0\xff" + zero +
      "\xe0" + static_cast<char>(215 - 9) + zero;
  PointCloud cloud = read(square).cloud;
  cloud.normals.assign(4, Vector3::UnitZ());
  const std::vector<std::string> good = {square,
                                         crlf(square),
                                         to_ply(cloud),
                                         to_ply(Mesh{cloud.points, {{0, 1, 2}, {0, 2, 3}}}),
                                         pcd_header + "DATA ascii\n1 2 3 4\n1 2 3 4\n4 5 6 7\n",
                                         binary_pcd,
                                         compressed};
  Random random = make_random(1, "surface faults");
  for (const std::string& content : good) {
    REQUIRE(parse_surface(content, "good").has_value());
    int refused = 0;
    for (int k = 0; k < 2000; ++k) {
      const auto file = parse_surface(tests::mutated(content, random), "faulty");
      if (!file) {
        ++refused;
        REQUIRE(file.error().message.find("faulty") == 0);
        continue;
      }
      REQUIRE(file->cloud.size() > 0);
      REQUIRE((file->cloud.normals.empty() || file->cloud.normals.size() == file->cloud.size()));
      for (const Vector3& point : file->cloud.points) REQUIRE(point.allFinite());
      for (const auto& triangle : file->triangles) {
        for (const int corner : triangle)
          REQUIRE((corner >= 0 && corner < static_cast<int>(file->cloud.size())));
      }
    }
    CHECK(refused > 500);
  }
}
