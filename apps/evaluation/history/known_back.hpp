// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/simulated/simulated_session.hpp"

namespace tuina::app {

/// How a person comes back: with what tissue, and whether the session before counts.
struct Return {
  const char* name;
  double tissue_change_share;
  bool known;
};
inline constexpr std::array<Return, 6> returns = {{{"as before, as a stranger", 0.0, false},
                                                   {"as before, known", 0.0, true},
                                                   {"alpha + 50 %, as a stranger", 0.5, false},
                                                   {"alpha + 50 %, known", 0.5, true},
                                                   {"alpha - 50 %, as a stranger", -0.5, false},
                                                   {"alpha - 50 %, known", -0.5, true}}};

/// One session of a person who has come back, judged by what only the simulation knows.
struct ReturnOutcome {
  std::string refused;  ///< why there was no session; the rest is then empty
  int places = 0;       ///< probed
  int known = 0;        ///< of the session before
  int spared = 0;       ///< probed by one press
  int dropped = 0;      ///< the first press came otherwise
  double probing_s = 0.0, massage_s = 0.0;
  std::vector<double> given;   ///< true peak of each working press as a share of the plan
  std::vector<double> probed;  ///< true peak of each probing press as a share of the plan
  double over_cap_n = 0.0;     ///< largest true force beyond what the true zone may be asked for
  double over_trip_n = 0.0;    ///< beyond where an arm has to give way
};

/// A first session of a person, and then each of `returns` on another day: with noise, breath and
/// grain of the tissue of their own. `folder` takes the person and the programme as files.
[[nodiscard]] Result<std::array<ReturnOutcome, returns.size()>> come_back(
    const sim::Person& person, std::uint64_t seed, const session::Config& config,
    const std::filesystem::path& folder);

}  // namespace tuina::app
