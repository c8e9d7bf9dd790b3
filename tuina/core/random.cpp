// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/random.hpp"

namespace tuina {

Random make_random(std::uint64_t seed, std::string_view purpose) {
  // FNV-1a gives the same streams on every platform; std::hash does not promise that.
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char letter : purpose) {
    hash = (hash ^ static_cast<unsigned char>(letter)) * 1099511628211ULL;
  }
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                         static_cast<std::uint32_t>(hash), static_cast<std::uint32_t>(hash >> 32)};
  return Random(sequence);
}

double gaussian(Random& random, double standard_deviation) {
  return std::normal_distribution<double>(0.0, 1.0)(random) * standard_deviation;
}

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

}  // namespace tuina
