// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/mcap/compression.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <new>

namespace tuina::telemetry::mcap {

std::uint32_t crc32(std::string_view bytes, std::uint32_t before) {
  return static_cast<std::uint32_t>(
      ::crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

Compressor::Compressor(Search search)
    : context_(ZSTD_createCCtx(),
               [](void* context) { ZSTD_freeCCtx(static_cast<ZSTD_CCtx*>(context)); }) {
  if (!context_) throw std::bad_alloc();
  auto* context = static_cast<ZSTD_CCtx*>(context_.get());
  ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, search.level);
  ZSTD_CCtx_setParameter(context, ZSTD_c_minMatch, search.min_match);
}

std::string_view Compressor::compress(std::string_view bytes) {
  frame_.resize(std::max(frame_.size(), ZSTD_compressBound(bytes.size())));
  const std::size_t size = ZSTD_compress2(static_cast<ZSTD_CCtx*>(context_.get()), frame_.data(),
                                          frame_.size(), bytes.data(), bytes.size());
  // With room for the worst case, only memory can be missing.
  if (ZSTD_isError(size) != 0) throw std::bad_alloc();
  return std::string_view(frame_).substr(0, size);
}

std::optional<std::uint64_t> stated_size(std::string_view frame) {
  const unsigned long long size = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR) return std::nullopt;
  return size;
}

std::optional<std::string> decompress(std::string_view frame, std::uint64_t size) {
  // Writers that compress in a stream state no size; then the record around the frame is believed.
  if (stated_size(frame).value_or(size) != size) return std::nullopt;
  std::string bytes(size, '\0');
  const std::size_t got = ZSTD_decompress(bytes.data(), size, frame.data(), frame.size());
  if (ZSTD_isError(got) != 0 || got != size) return std::nullopt;
  return bytes;
}

}  // namespace tuina::telemetry::mcap
