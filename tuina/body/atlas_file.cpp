// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "tuina/body/atlas.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

// Layout, all little-endian (docs/acupoints.md): 8 bytes "TUINAATL", u32 version, u64 length of the
// rest, u64 FNV-1a of the rest, the rest. Numbers are f32. Modes have one f32 scale per column and
// integers of one byte, or of two where one byte would round by more than 0.04 mm.
static_assert(std::endian::native == std::endian::little);
constexpr std::string_view magic = "TUINAATL";
constexpr std::uint32_t version = 4;
constexpr double max_in_a_byte_m = 10_mm;
constexpr std::uint32_t max_entries = 1U << 22;

std::uint64_t fnv1a(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3ULL;
  return hash;
}

class Writer {
 public:
  std::string bytes;
  template <typename T>
  void plain(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes.append(raw, sizeof(T));
  }
  void count(std::size_t n) { plain(static_cast<std::uint32_t>(n)); }
  void text(std::string_view words) {
    count(words.size());
    bytes += words;
  }
  void matrix(const Eigen::MatrixXd& m) {
    count(static_cast<std::size_t>(m.rows()));
    count(static_cast<std::size_t>(m.cols()));
    for (Eigen::Index j = 0; j < m.cols(); ++j) {
      for (Eigen::Index i = 0; i < m.rows(); ++i) plain(static_cast<float>(m(i, j)));
    }
  }
  void quantised(const Eigen::MatrixXd& m) {
    count(static_cast<std::size_t>(m.rows()));
    count(static_cast<std::size_t>(m.cols()));
    for (Eigen::Index j = 0; j < m.cols(); ++j) {
      const double most = std::max(1e-12, m.col(j).cwiseAbs().maxCoeff());
      const bool two = most > max_in_a_byte_m;
      const auto scale = static_cast<float>(most / (two ? 32766.0 : 127.0));
      plain(static_cast<std::uint8_t>(two ? 2 : 1));
      plain(scale);
      for (Eigen::Index i = 0; i < m.rows(); ++i) {
        const auto whole = std::lround(m(i, j) / static_cast<double>(scale));
        if (two) {
          plain(static_cast<std::int16_t>(whole));
        } else {
          plain(static_cast<std::int8_t>(whole));
        }
      }
    }
  }
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : left_(bytes) {}
  template <typename T>
  T plain() {
    if (left_.size() < sizeof(T)) throw std::runtime_error("it ends too early");
    T value;
    std::memcpy(&value, left_.data(), sizeof(T));
    left_.remove_prefix(sizeof(T));
    return value;
  }
  double number() {
    const double value = static_cast<double>(plain<float>());
    if (!std::isfinite(value)) throw std::runtime_error("a number is not finite");
    return value;
  }
  std::size_t count(std::size_t bytes_each) {
    const auto n = plain<std::uint32_t>();
    if (n > max_entries || n * bytes_each > left_.size())
      throw std::runtime_error("a count exceeds the file");
    return n;
  }
  std::string text() {
    const std::size_t n = count(1);
    std::string words(left_.substr(0, n));
    left_.remove_prefix(n);
    return words;
  }
  Eigen::MatrixXd matrix() {
    const auto rows = static_cast<Eigen::Index>(count(0));
    const auto cols = static_cast<Eigen::Index>(count(4 * static_cast<std::size_t>(rows)));
    Eigen::MatrixXd m(rows, cols);
    for (Eigen::Index j = 0; j < cols; ++j) {
      for (Eigen::Index i = 0; i < rows; ++i) m(i, j) = number();
    }
    return m;
  }
  Eigen::MatrixXd quantised() {
    const auto rows = static_cast<Eigen::Index>(count(0));
    const auto cols = static_cast<Eigen::Index>(count(static_cast<std::size_t>(rows) + 5));
    Eigen::MatrixXd m(rows, cols);
    for (Eigen::Index j = 0; j < cols; ++j) {
      const auto bytes_each = plain<std::uint8_t>();
      if (bytes_each != 1 && bytes_each != 2)
        throw std::runtime_error("a number of bytes is unknown");
      const double scale = number();
      for (Eigen::Index i = 0; i < rows; ++i) {
        m(i, j) = scale * (bytes_each == 2 ? plain<std::int16_t>() : plain<std::int8_t>());
      }
    }
    return m;
  }
  [[nodiscard]] bool finished() const { return left_.empty(); }

 private:
  std::string_view left_;
};

void expect(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(what);
}

void write(Writer& out, const PositionAtlas& atlas) {
  const ShapeModel& shape = atlas.shape;
  out.plain(static_cast<std::uint32_t>(shape.position));
  out.count(static_cast<std::size_t>(shape.bodies));
  out.count(static_cast<std::size_t>(shape.acupoints));
  out.count(shape.labels.size());
  for (const auto& label : shape.labels) out.text(label);
  out.matrix(shape.mean);
  out.matrix(shape.normals);
  out.matrix(shape.person_from_model.matrix());
  out.quantised(shape.modes);
  out.matrix(shape.correction);
  out.matrix(shape.radius95_m);
  out.matrix(shape.nominal_var_m2 * 1e6);
  out.plain(static_cast<float>(shape.usual_residual_m));
  out.plain(static_cast<float>(shape.max_outlier_score));
  out.count(atlas.standard.lines.size());
  for (const auto& line : atlas.standard.lines) {
    out.matrix(line.p);
    out.matrix(line.q);
  }
  for (const auto& mark : atlas.standard.marks) out.matrix(mark);
  out.plain(static_cast<float>(atlas.standard.radius95_m));
}

PositionAtlas read(Reader& in) {
  PositionAtlas atlas;
  ShapeModel& shape = atlas.shape;
  const auto position = in.plain<std::uint32_t>();
  expect(position <= 1, "a position is unknown");
  shape.position = static_cast<BodyPosture>(position);
  shape.bodies = static_cast<int>(in.plain<std::uint32_t>());
  const auto acupoints = in.plain<std::uint32_t>();
  const std::size_t labels = in.count(4);
  expect(acupoints >= 7 && acupoints <= labels, "acupoints are missing");
  shape.acupoints = static_cast<int>(acupoints);
  for (std::size_t i = 0; i < labels; ++i) shape.labels.push_back(in.text());
  const Eigen::MatrixXd mean = in.matrix();
  const Eigen::MatrixXd normals = in.matrix();
  const Eigen::MatrixXd start = in.matrix();
  const auto count = static_cast<Eigen::Index>(labels);
  expect(mean.rows() == 3 && mean.cols() > count + 50 && normals.rows() == 3 &&
             normals.cols() == mean.cols() - count && start.rows() == 4 && start.cols() == 4,
         "a table has the wrong size");
  shape.mean = mean;
  shape.normals = normals;
  shape.person_from_model.matrix() = start;
  shape.person_from_model.linear() =
      Eigen::Quaterniond(Matrix3(start.topLeftCorner<3, 3>())).normalized().toRotationMatrix();
  shape.modes = in.quantised();
  shape.correction = in.matrix();
  // A vector has one column; Eigen checks that in builds with assertions only.
  const Eigen::MatrixXd radius95_m = in.matrix();
  const Eigen::MatrixXd nominal_var_mm2 = in.matrix();
  expect(radius95_m.cols() == 1 && nominal_var_mm2.cols() == 1, "a table has the wrong size");
  shape.radius95_m = radius95_m;
  shape.nominal_var_m2 = nominal_var_mm2 * 1e-6;
  shape.usual_residual_m = in.number();
  shape.max_outlier_score = in.number();
  expect(shape.modes.rows() == 3 * mean.cols() && shape.radius95_m.size() == count &&
             shape.nominal_var_m2.size() == count &&
             (shape.correction.size() == 0 || (shape.correction.rows() == 3 * count &&
                                               shape.correction.cols() == shape.modes.cols() + 1)),
         "a table has the wrong size");
  const std::size_t lines = in.count(32);
  const auto point = [&]() -> Vector2 {
    const Eigen::MatrixXd m = in.matrix();
    expect(m.size() == 2, "a table has the wrong size");
    return {m(0), m(1)};
  };
  for (std::size_t i = 0; i < lines; ++i) {
    const Vector2 p = point();
    atlas.standard.lines.push_back({p, point()});
  }
  for (std::size_t i = 0; i < labels; ++i) atlas.standard.marks.push_back(point());
  atlas.standard.radius95_m = in.number();
  return atlas;
}

}  // namespace

std::string to_bytes(const Atlas& atlas) {
  Writer rest;
  rest.text(atlas.made);
  rest.count(atlas.positions.size());
  for (const auto& position : atlas.positions) write(rest, position);
  Writer file;
  file.bytes = magic;
  file.plain(version);
  file.plain(static_cast<std::uint64_t>(rest.bytes.size()));
  file.plain(fnv1a(rest.bytes));
  return file.bytes + rest.bytes;
}

Result<Atlas> parse_atlas(std::string_view content, std::string_view name) {
  constexpr std::size_t header = 28;
  if (content.size() < header || content.substr(0, magic.size()) != magic) {
    return fail(Fault::bad_input, "{}: not an atlas (it does not begin with {})", name, magic);
  }
  Reader head(content.substr(magic.size(), header - magic.size()));
  const auto found = head.plain<std::uint32_t>();
  if (found != version)
    return fail(Fault::bad_input, "{}: atlas version {}, {} is understood", name, found, version);
  const std::string_view rest = content.substr(header);
  const auto length = head.plain<std::uint64_t>();
  if (length != rest.size()) {
    return fail(Fault::bad_input, "{}: {} bytes follow the header, {} are announced", name,
                rest.size(), length);
  }
  if (head.plain<std::uint64_t>() != fnv1a(rest)) {
    return fail(Fault::bad_input, "{}: the checksum is wrong, the file is damaged", name);
  }
  try {
    Reader in(rest);
    Atlas atlas;
    atlas.made = in.text();
    const std::size_t positions = in.count(4);
    for (std::size_t i = 0; i < positions; ++i) atlas.positions.push_back(read(in));
    expect(in.finished() && !atlas.positions.empty(), "its length does not fit its content");
    return atlas;
  } catch (const std::exception& fault) {
    return fail(Fault::bad_input, "{}: not an atlas: {}", name, fault.what());
  }
}

Result<Atlas> read_atlas(const std::filesystem::path& path) {
  const auto content = read_file(path);
  if (!content) return tl::unexpected(content.error());
  return parse_atlas(*content, path.string());
}

}  // namespace tuina::body
