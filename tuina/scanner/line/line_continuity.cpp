// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/line/line_continuity.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::scanner {
namespace {

constexpr int max_gap = 3;
constexpr float max_step_px = 2.0F;

// True when a line may run from one place to another some rows below.
bool continues(int rows, float aside_px) {
  return rows <= max_gap && std::abs(aside_px) <= 1.0F + max_step_px * static_cast<float>(rows);
}

}  // namespace

void keep_what_continues(std::vector<LinePoint>& clear, std::vector<CandidateRow>& unclear,
                         int height) {
  struct Seen {
    int row;
    float column_px;
    bool doubtful;
  };
  std::vector<Seen> seen;
  seen.reserve(clear.size());
  for (const LinePoint& point : clear) seen.push_back({point.row, point.column_px, false});
  for (const CandidateRow& row : unclear)
    seen.push_back({row.y, row.candidates.front().column_px, row.candidates.size() > 1});
  std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) { return a.row < b.row; });

  // Texture shows ridges as long as its own grain, up to some twenty rows of a usual picture, or a
  // few that run beside each other; a line with its reflection runs through the picture.
  const auto min_length = static_cast<std::size_t>(std::max(12, height / 20));
  const auto surely_long = static_cast<std::size_t>(height / 4);
  std::vector<bool> kept(static_cast<std::size_t>(height), false);
  for (std::size_t begin = 0, end = 0; begin < seen.size(); begin = end) {
    std::size_t doubtful = seen[begin].doubtful ? 1 : 0;
    for (end = begin + 1; end < seen.size(); ++end) {
      if (!continues(seen[end].row - seen[end - 1].row,
                     seen[end].column_px - seen[end - 1].column_px))
        break;
      doubtful += seen[end].doubtful ? 1 : 0;
    }
    const std::size_t length = end - begin;
    if (length < min_length || (2 * doubtful > length && length < surely_long)) continue;
    for (std::size_t k = begin; k < end; ++k) kept[static_cast<std::size_t>(seen[k].row)] = true;
  }
  std::erase_if(clear, [&](const LinePoint& p) { return !kept[static_cast<std::size_t>(p.row)]; });
  std::erase_if(unclear,
                [&](const CandidateRow& r) { return !kept[static_cast<std::size_t>(r.y)]; });
}

void drop_lone_rows(std::vector<LinePoint>& points, int height) {
  constexpr std::size_t hardly_any = 50;  // times fewer than the picture's rows
  if (points.size() * hardly_any > static_cast<std::size_t>(height)) return;
  std::vector<LinePoint> kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto joins = [&](std::size_t upper) {
      return continues(points[upper + 1].row - points[upper].row,
                       points[upper + 1].column_px - points[upper].column_px);
    };
    if ((i > 0 && joins(i - 1)) || (i + 1 < points.size() && joins(i))) kept.push_back(points[i]);
  }
  points.swap(kept);
}

void choose_by_continuity(const std::vector<LinePoint>& clear, std::vector<CandidateRow>& unclear) {
  // Viterbi: the cheapest path through all rows. A lateral step costs up to 2, the dimmer of two
  // lines up to 0.1 per row, so that a reflection wins only if brighter over a large part of the
  // image.
  struct Stage {
    int y;
    std::vector<Candidate> candidates;
    std::vector<float> cost;
    std::vector<int> from;
    CandidateRow* row;
  };
  std::vector<Stage> stages;
  stages.reserve(clear.size() + unclear.size());
  for (const LinePoint& point : clear) {
    stages.push_back({point.row, {{point.column_px, point.amplitude_dn}}, {}, {}, nullptr});
  }
  for (CandidateRow& row : unclear) stages.push_back({row.y, row.candidates, {}, {}, &row});
  std::sort(stages.begin(), stages.end(), [](const Stage& a, const Stage& b) { return a.y < b.y; });

  for (std::size_t s = 0; s < stages.size(); ++s) {
    Stage& stage = stages[s];
    const float best = stage.candidates.front().height_dn;
    for (const Candidate& candidate : stage.candidates) {
      float cheapest = 0.0F;
      int from = -1;
      if (s > 0) {
        const Stage& before = stages[s - 1];
        const float reach = 2.0F + 1.5F * static_cast<float>(stage.y - before.y);
        for (std::size_t k = 0; k < before.candidates.size(); ++k) {
          const float aside =
              std::abs(candidate.column_px - before.candidates[k].column_px) / reach;
          const float cost = before.cost[k] + std::min(2.0F, aside);
          if (from < 0 || cost < cheapest) {
            cheapest = cost;
            from = static_cast<int>(k);
          }
        }
      }
      stage.cost.push_back(cheapest + 0.1F * (1.0F - candidate.height_dn / best));
      stage.from.push_back(from);
    }
  }
  if (stages.empty()) return;
  const auto& ends = stages.back().cost;
  auto chosen = static_cast<int>(std::min_element(ends.begin(), ends.end()) - ends.begin());
  for (auto stage = stages.rbegin(); stage != stages.rend(); ++stage) {
    if (stage->row != nullptr) {
      std::swap(stage->row->candidates.front(),
                stage->row->candidates[static_cast<std::size_t>(chosen)]);
    }
    chosen = stage->from[static_cast<std::size_t>(chosen)];
  }
}

}  // namespace tuina::scanner
