// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>
#include <string_view>

namespace tuina {

/// The random engine, always passed in by the caller: same seed, same result.
using Random = std::mt19937_64;

/// An independent stream per purpose, so that drawing more numbers for the camera never changes the
/// tissue: `make_random(seed, "camera noise")`.
[[nodiscard]] Random make_random(std::uint64_t seed, std::string_view purpose);

/// A normally distributed number about zero.
[[nodiscard]] double gaussian(Random& random, double standard_deviation);
/// An evenly distributed number from low to high.
[[nodiscard]] double uniform(Random& random, double low, double high);

}  // namespace tuina
