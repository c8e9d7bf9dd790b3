// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/scanner/board_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "tuina/core/grid.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/triangulation.hpp"

namespace tuina::sim {
namespace {

constexpr double blur_px = 0.75;  // lens of a webcam and its square pixels together
constexpr double line_width_px = 2.2;
constexpr double rim_squares = 0.5;  // white paper around the squares
constexpr double wall_m = 2.6;
constexpr double laser_reference_m = 1.1;
constexpr double black_share = 0.15;  // share of the laser light that printed black reflects

// Board point of a pixel in squares, and the spacing of its neighbours.
struct Place {
  Vector2 at = Vector2::Zero();
  Vector2 blur = Vector2::Ones();
};

// From -1 before an edge to 1 behind it, blurred.
double edge(double squares, double blur) {
  if (std::abs(squares) > 4.0 * blur) return squares < 0.0 ? -1.0 : 1.0;
  return std::erf(squares / (blur * std::numbers::sqrt2));
}

// 1 in one colour, -1 in the other, changing at the inner corners.
double stripes(double x, int corners, double blur) {
  const double nearest = std::clamp(std::round(x), 0.0, corners - 1.0);
  const double sign = std::fmod(std::abs(nearest), 2.0) < 0.5 ? 1.0 : -1.0;
  return sign * edge(x - nearest, blur);
}

class Scene {
 public:
  Scene(const scanner::ScannerCalibration& truth, const scanner::Board& board,
        const Transform& camera_from_board)
      : truth_(truth), board_(board), board_from_camera_(camera_from_board.inverse()) {
    if (!board.has_markers()) return;
    black_cells_.resize(grid_cells(board.rows + 1, board.columns + 1));
    for (const scanner::Marker& marker : scanner::markers_of(board)) {
      black_cells_[square_at(marker.column, marker.row)] = ~marker.cells;
    }
  }

  [[nodiscard]] Vector2 on_board(double column_px, double row_px) const {
    const Vector3 ray =
        board_from_camera_.linear() * scanner::ray_through(truth_.camera, column_px, row_px);
    const Vector3 eye = board_from_camera_.translation();
    return (eye - ray * (eye.z() / ray.z())).head<2>() / board_.square_m;
  }

  // 1 on the board with its rim, 0 beside it.
  [[nodiscard]] double paper(const Place& place) const { return within(place, 1.0 + rim_squares); }

  // 1 on white, 0 on black; the rim is white.
  [[nodiscard]] double white(const Place& place) const {
    const double colour = stripes(place.at.x(), board_.columns, place.blur.x()) *
                          stripes(place.at.y(), board_.rows, place.blur.y());
    // A chessboard begins with a white square, a board with markers with a black one.
    const double black = 0.5 * (board_.has_markers() ? 1.0 + colour : 1.0 - colour);
    return (1.0 - within(place, 1.0) * black) * (1.0 - marker(place));
  }

  // Column in which a row sees the light plane on the board or the wall.
  struct Light {
    double column_px = 0.0;
    double range_m = 1.0;
  };
  [[nodiscard]] std::optional<Light> light_in(double row_px) const {
    const auto on = solve(row_px, board_plane());
    if (on && paper({.at = on_board(on->column_px, row_px), .blur = {0.05, 0.05}}) > 0.5) return on;
    const auto beyond = solve(row_px, {0.0, 0.0, 1.0 / wall_m});
    if (!beyond) return std::nullopt;
    const Place hidden{.at = on_board(beyond->column_px, row_px), .blur = {0.05, 0.05}};
    return paper(hidden) > 0.5 ? std::nullopt : beyond;
  }

 private:
  // 1 on the board up to `squares` around its inner corners, 0 beyond.
  [[nodiscard]] double within(const Place& place, double squares) const {
    const auto between = [](double x, double last, double blur) {
      return 0.25 * (1.0 + edge(x, blur)) * (1.0 + edge(last - x, blur));
    };
    return between(place.at.x() + squares, board_.columns - 1 + 2.0 * squares, place.blur.x()) *
           between(place.at.y() + squares, board_.rows - 1 + 2.0 * squares, place.blur.y());
  }

  [[nodiscard]] std::size_t square_at(int column, int row) const {
    return grid_index(row, board_.columns + 1, column);
  }

  // Blackness of the marker of this square: black cells and frame.
  [[nodiscard]] double marker(const Place& place) const {
    if (!board_.has_markers()) return 0.0;
    const auto column = static_cast<int>(std::floor(place.at.x())) + 1;
    const auto row = static_cast<int>(std::floor(place.at.y())) + 1;
    if (column < 0 || column > board_.columns || row < 0 || row > board_.rows) return 0.0;
    const std::uint64_t black = black_cells_[square_at(column, row)];
    if (black == 0) return 0.0;
    const int cells = board_.marker_cells + 2;
    const double scale = cells * board_.square_m / board_.marker_m;
    const Vector2 at =
        scale * (place.at - Vector2(column - 0.5, row - 0.5)) + 0.5 * cells * Vector2::Ones();
    const Vector2 blur = scale * place.blur;
    const auto share = [](double x, double width) {
      return 0.5 * (edge(x, width) - edge(x - 1.0, width));
    };
    double sum = 0.0;
    for (int y = 0; y < cells; ++y) {
      const double share_y = share(at.y() - y, blur.y());
      if (share_y == 0.0) continue;
      for (int x = 0; x < cells; ++x) {
        const bool frame = x == 0 || y == 0 || x == cells - 1 || y == cells - 1;
        const int bit = board_.marker_cells * (cells - 2 - y) + cells - 2 - x;
        if (frame || ((black >> bit) & 1U) != 0U) sum += share_y * share(at.x() - x, blur.x());
      }
    }
    return sum;
  }

  // A plane as n with n . X = 1.
  [[nodiscard]] Vector3 board_plane() const {
    const Vector3 normal = board_from_camera_.linear().row(2);
    return -normal / board_from_camera_.translation().z();
  }

  // Light plane and board intersect where (light - plane) . ray = 0; linear in the column but for
  // distortion.
  [[nodiscard]] std::optional<Light> solve(double row_px, const Vector3& plane) const {
    const Vector3 across = truth_.laser_normal_in_camera / truth_.laser_distance_m - plane;
    double column_px = truth_.camera.cx_px;
    Vector3 ray = Vector3::UnitZ();
    for (int i = 0; i < 8; ++i) {
      ray = scanner::ray_through(truth_.camera, column_px, row_px);
      column_px -= across.dot(ray) * truth_.camera.fx_px / across.x();
    }
    const double range_m = 1.0 / plane.dot(ray);
    if (!(range_m > 0.0) || !(column_px > -20.0 && column_px < truth_.camera.width_px + 20.0)) {
      return std::nullopt;
    }
    return Light{.column_px = column_px, .range_m = range_m};
  }

  const scanner::ScannerCalibration& truth_;
  const scanner::Board& board_;
  Transform board_from_camera_;
  std::vector<std::uint64_t> black_cells_;  ///< marker in each square; 0: none
};

}  // namespace

Image photograph(const scanner::ScannerCalibration& truth, const scanner::Board& board,
                 const Transform& camera_from_board, const BoardLight& light, Random& random) {
  const Scene scene(truth, board, camera_from_board);
  const int width = truth.camera.width_px;
  const int height = truth.camera.height_px;
  std::vector<Vector2> above(static_cast<std::size_t>(width) + 1);
  for (int x = 0; x <= width; ++x) above[static_cast<std::size_t>(x)] = scene.on_board(x - 1, -1);
  Image image(width, height);
  for (int y = 0; y < height; ++y) {
    const auto line = light.laser_dn > 0.0 ? scene.light_in(y) : std::optional<Scene::Light>();
    Vector2 left = scene.on_board(-1, y);
    above[0] = left;
    for (int x = 0; x < width; ++x) {
      auto& up = above[static_cast<std::size_t>(x) + 1];
      Place place{.at = scene.on_board(x, y)};
      const Vector2 along = place.at - left;
      const Vector2 down = place.at - up;
      place.blur = blur_px * (along.array().square() + down.array().square()).sqrt().matrix();
      const double paper = scene.paper(place);
      const double white = scene.white(place);
      // A window to the left lights the board a little from the side.
      const double side = 1.12 - 0.24 * x / width;
      double value = side * (paper * (light.black_dn + white * (light.white_dn - light.black_dn)) +
                             (1.0 - paper) * light.behind_dn);
      if (line) {
        const double u = (x - line->column_px) / line_width_px;
        const double nearer = laser_reference_m / line->range_m;
        const double back = 1.0 - paper * (1.0 - white) * (1.0 - black_share);
        value += light.laser_dn * nearer * nearer * back * std::exp(-0.5 * u * u);
      }
      value += gaussian(random, light.noise_dn) + 0.5;
      image.row(y)[x] = static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0));
      left = place.at;
      up = place.at;
    }
  }
  return image;
}

bool in_view(const scanner::CameraModel& camera, const scanner::Board& board,
             const Transform& camera_from_board) {
  constexpr double margin_px = 4.0;
  const auto seen = [&](double x, double y) {
    const Vector3 at = camera_from_board * Vector3(x * board.square_m, y * board.square_m, 0.0);
    if (at.z() < 0.2) return false;
    const Vector2 pixel = scanner::project(camera, at);
    return pixel.x() > margin_px && pixel.x() < camera.width_px - 1 - margin_px &&
           pixel.y() > margin_px && pixel.y() < camera.height_px - 1 - margin_px;
  };
  if (camera_from_board.linear().col(2).dot(camera_from_board.translation()) <= 0.0) return false;
  if (board.has_markers()) {
    int corners = 0;
    for (int i = 0; i < board.corners(); ++i) {
      const int column = i % board.columns, row = i / board.columns;
      corners += seen(column, row) ? 1 : 0;
    }
    return 3 * corners >= 2 * board.corners();
  }
  const double rim = 1.0 + rim_squares;
  for (const double x : {-rim, board.columns - 1 + rim}) {
    for (const double y : {-rim, board.rows - 1 + rim}) {
      if (!seen(x, y)) return false;
    }
  }
  return true;
}

}  // namespace tuina::sim
