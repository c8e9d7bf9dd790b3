// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/board/views.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "tuina/calibration/board/find_board.hpp"
#include "tuina/calibration/board/line_on_print.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/picture.hpp"

namespace tuina::calibration {
namespace {

constexpr double min_share_found = 0.5;

// Detections in one picture.
struct Detection {
  Image image;
  std::optional<SeenBoard> board;
  scanner::LaserLine line;
};

Result<Detection> detect(const Shot& shot, const Board& board) {
  auto image = shot.both ? scanner::read_part(shot.picture, shot.laser ? scanner::Part::laser
                                                                       : scanner::Part::scene)
                         : scanner::read_picture(shot.picture);
  if (!image) return tl::unexpected(image.error());
  Detection seen{.image = std::move(*image), .board = {}, .line = {}};
  if (shot.laser) {
    seen.line = scanner::find_laser_line(seen.image, {.method = scanner::LineMethod::likelihood});
  } else {
    seen.board = find_board(seen.image, board);
  }
  return seen;
}

// Detects in all pictures in parallel; results are independent of each other.
Result<std::vector<Detection>> detect_all(const Shots& shots, const Progress& progress,
                                          int threads) {
  std::vector<Result<Detection>> all(shots.shots.size(), Detection{});
  std::atomic<std::size_t> next = 0;
  std::size_t done = 0;
  std::mutex telling;
  const auto work = [&] {
    for (std::size_t i = next++; i < all.size(); i = next++) {
      all[i] = detect(shots.shots[i], shots.board);
      const std::scoped_lock lock(telling);
      ++done;
      if (progress) progress(static_cast<double>(done) / static_cast<double>(all.size()));
    }
  };
  {
    std::vector<std::jthread> others;
    for (int i = 1; i < threads; ++i) others.emplace_back(work);
    work();
  }
  std::vector<Detection> seen;
  for (auto& one : all) {
    if (!one) return tl::unexpected(one.error());
    seen.push_back(std::move(*one));
  }
  return seen;
}

Result<void> check_sizes(const Shots& shots, const std::vector<Detection>& seen) {
  for (std::size_t i = 1; i < seen.size(); ++i) {
    const Image& image = seen[i].image;
    const Image& first = seen[0].image;
    if (image.width == first.width && image.height == first.height) continue;
    return fail(Fault::bad_input, "{}: {} x {} pixels, {} has {} x {}; all come from one camera",
                shots.shots[i].picture.string(), image.width, image.height,
                shots.shots[0].picture.string(), first.width, first.height);
  }
  return {};
}

// Index of the picture without laser at the pose and yaw of a laser picture.
Result<std::size_t> board_of(const Shot& shot, const std::vector<Shot>& all) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].laser || all[i].pose != shot.pose) continue;
    if (std::abs(all[i].yaw_rad - shot.yaw_rad) < same_yaw_rad) return i;
  }
  return fail(Fault::bad_input,
              "{}: no picture of the bare board was taken at its pose {} and yaw {:.2f} deg",
              shot.picture.string(), shot.pose, to_deg(shot.yaw_rad));
}

}  // namespace

Result<Views> measure_views(const Shots& shots, const Progress& progress, int threads) {
  const auto seen = detect_all(shots, progress, threads);
  if (!seen) return tl::unexpected(seen.error());
  if (const auto good = check_sizes(shots, *seen); !good) return tl::unexpected(good.error());

  Views result{.board = shots.board,
               .width_px = seen->front().image.width,
               .height_px = seen->front().image.height,
               .board_pictures = 0,
               .views = {}};
  std::map<int, View> views;  // by frame
  for (std::size_t i = 0; i < seen->size(); ++i) {
    const Shot& shot = shots.shots[i];
    if (shot.laser) continue;
    ++result.board_pictures;
    const auto& found_board = (*seen)[i].board;
    if (!found_board) continue;
    views[shot.frame] = {.frame = shot.frame,
                         .pose = shot.pose,
                         .yaw_rad = shot.yaw_rad,
                         .corners_px = found_board->corners_px,
                         .which = found_board->which,
                         .line = {}};
  }
  const auto found = static_cast<double>(views.size());
  if (found < min_share_found * result.board_pictures || views.empty()) {
    return fail(
        Fault::bad_input,
        "{}: a board with {} x {} inner corners{} is found in {} of {} pictures of it; count "
        "the corners between squares, show {} board, sharp and evenly lit",
        shots.folder.string(), shots.board.columns, shots.board.rows,
        shots.board.has_markers() ? " and such markers" : "", views.size(), result.board_pictures,
        shots.board.has_markers() ? "most of the" : "the whole");
  }
  for (std::size_t i = 0; i < seen->size(); ++i) {
    if (!shots.shots[i].laser) continue;
    const auto of = board_of(shots.shots[i], shots.shots);
    if (!of) return tl::unexpected(of.error());
    const Detection& board = (*seen)[*of];
    if (!board.board) continue;
    View& view = views[shots.shots[*of].frame];
    view.laser_on = true;
    const auto line =
        line_on_print((*seen)[i].image, board.image, board.board->outline_px, (*seen)[i].line);
    view.line.insert(view.line.end(), line.begin(), line.end());
  }
  for (auto& [frame, view] : views) result.views.push_back(std::move(view));
  return result;
}

}  // namespace tuina::calibration
