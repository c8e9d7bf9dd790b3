// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/live_view.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cstring>

namespace tuina::app {
namespace {

using Place = std::array<float, 3>;

std::vector<Place> shown(const LiveView& view) {
  const std::string bytes = view.cloud();
  std::vector<Place> places(bytes.size() / sizeof(Place));
  std::memcpy(places.data(), bytes.data(), bytes.size());
  return places;
}

scanner::LiveProfile profile(int number, int points) {
  scanner::LiveProfile one{.number = number};
  for (int i = 0; i < points; ++i) one.points_in_couch.emplace_back(number, i, 0.0);
  return one;
}

TEST_CASE("a page is shown every point of a usual scan, and an even share of three million") {
  LiveView view(robot::RobotModel{});
  for (int i = 0; i < 100; ++i) view.on_profile(profile(i, 200));
  CHECK(view.progress().cloud_points == 20000);
  CHECK(shown(view).size() == 20000);

  view.on_profile(profile(0, 0));  // another scan begins
  CHECK(shown(view).empty());
  constexpr int profiles = 3000;
  for (int i = 0; i < profiles; ++i) view.on_profile(profile(i, 1000));
  CHECK(view.progress().cloud_points == 3'000'000);
  const auto places = shown(view);
  CHECK(places.size() > 30'000);
  CHECK(places.size() <= 65'536);
  // Every tenth of the back has its share of them.
  std::array<int, 10> tenths{};
  for (const auto& place : places)
    ++tenths.at(static_cast<std::size_t>(10.0F * place[0] / profiles));
  for (const int share : tenths)
    CHECK(share == doctest::Approx(static_cast<double>(places.size()) / 10.0).epsilon(0.02));
}

}  // namespace
}  // namespace tuina::app
