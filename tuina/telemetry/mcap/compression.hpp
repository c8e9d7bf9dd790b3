// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace tuina::telemetry::mcap {

/// CRC-32 of zlib, which MCAP uses; `before` goes on with that of the bytes before.
[[nodiscard]] std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0);

/// How zstd looks for what repeats. Rows of numbers, of which some bytes change and some do not,
/// are told well by matches of four bytes: `rows`. Its fastest search makes them a sixth larger;
/// beyond level 6 a core has much to do for little.
struct Search {
  int level = 1;
  int min_match = 0;  ///< bytes; 0: as the level has it
};
inline constexpr Search rows{.level = 6, .min_match = 4}, texts{.level = 9};

/// Compresses with zstd; its memory is used again each time.
class Compressor {
 public:
  /// How hard it looks for repetitions.
  explicit Compressor(Search search);
  /// One frame, which states the size of its content. It lives until the next call.
  [[nodiscard]] std::string_view compress(std::string_view bytes);

 private:
  std::unique_ptr<void, void (*)(void*)> context_;
  std::string frame_;
};

/// The content of a zstd frame that says that it has `size` bytes; nothing where it has not.
[[nodiscard]] std::optional<std::string> decompress(std::string_view frame, std::uint64_t size);
/// The size that a zstd frame states of its content; nothing where it states none.
[[nodiscard]] std::optional<std::uint64_t> stated_size(std::string_view frame);

}  // namespace tuina::telemetry::mcap
