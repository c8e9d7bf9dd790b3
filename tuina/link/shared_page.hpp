// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstring>
#include <optional>
#include <string>

#include "tuina/core/result.hpp"
#include "tuina/link/wire.hpp"

namespace tuina::link {

/// One frame in shared memory, written by one process and read by any. A reader never waits for the
/// writer: a frame that is being written, or that was torn or spoilt, is none (a sequence lock with
/// a check sum).
template <typename Frame>
class Slot {
 public:
  /// Puts a frame in place of the one before. One writer only; never waits.
  void write(const Frame& frame) noexcept {
    const std::uint64_t count = count_.load(std::memory_order_relaxed) | 1U;
    count_.store(count, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_release);
    frame_ = frame;
    crc_ = wire::crc_of(reinterpret_cast<const std::byte*>(&frame_), sizeof frame_);
    std::atomic_thread_fence(std::memory_order_release);
    count_.store(count + 1, std::memory_order_release);
  }

  /// The newest whole frame; nothing before the first one, or where each try met a new one.
  [[nodiscard]] std::optional<Frame> read() const noexcept {
    constexpr int tries = 16;
    for (int i = 0; i < tries; ++i) {
      const std::uint64_t before = count_.load(std::memory_order_acquire);
      if (before == 0 || before % 2 != 0) continue;
      Frame frame;
      std::memcpy(&frame, &frame_, sizeof frame);
      const std::uint32_t crc = crc_;
      std::atomic_thread_fence(std::memory_order_acquire);
      if (count_.load(std::memory_order_relaxed) != before) continue;
      if (crc != wire::crc_of(reinterpret_cast<const std::byte*>(&frame), sizeof frame)) continue;
      return frame;
    }
    return std::nullopt;
  }

 private:
  std::atomic<std::uint64_t> count_ = 0;  ///< odd while the frame is being written
  std::uint32_t crc_ = 0;
  Frame frame_ = {};
};

/// Memory that processes share under a name, mapped for writing or for reading only; whoever has
/// made it takes it away with its end, and nobody else meanwhile: the maker holds a lock on it.
class SharedMemory {
 public:
  /// Whether the memory is made anew, or one that is there is opened.
  enum class Use : std::uint8_t { make, write, read };
  /// Fails with Fault::device where there is none of this size, where whoever made it is gone, and
  /// where one of this name is to be made while its maker lives.
  [[nodiscard]] static Result<SharedMemory> map(const std::string& name, std::size_t bytes,
                                                Use use);
  SharedMemory() = default;
  SharedMemory(SharedMemory&& other) noexcept { *this = std::move(other); }
  SharedMemory& operator=(SharedMemory&& other) noexcept;
  ~SharedMemory();
  [[nodiscard]] void* begin() const noexcept { return begin_; }  ///< first byte
  /// Whether the process that has made it still lives.
  [[nodiscard]] bool maker_lives() const noexcept;
  /// Takes away memory of this name whose maker was killed; that of a living one stays.
  static void clear_left(const std::string& name) noexcept;

 private:
  std::string name_;
  void* begin_ = nullptr;
  std::size_t bytes_ = 0;
  bool made_ = false;
  int file_ = -1;  ///< kept open, for the lock of whoever has made it ends with it
};

/// Some `Content` in shared memory, with the version of its layout before it.
template <typename Content>
class SharedPage {
 public:
  /// Maps the page of this name. Fails with Fault::device where there is none of this layout.
  [[nodiscard]] static Result<SharedPage> map(const std::string& name, SharedMemory::Use use) {
    auto memory = SharedMemory::map(name, sizeof(Page), use);
    if (!memory) return tl::unexpected(memory.error());
    SharedPage shared;
    shared.page_ = static_cast<Page*>(memory->begin());
    if (use == SharedMemory::Use::make) new (shared.page_) Page{.layout = wire::layout};
    if (shared.page_->layout != wire::layout)
      return fail(Fault::device, "the link {} is one of another version of tuina", name);
    shared.memory_ = std::move(*memory);
    return shared;
  }
  /// What the processes share.
  [[nodiscard]] Content* operator->() const noexcept { return &page_->content; }
  /// As `SharedMemory::maker_lives`.
  [[nodiscard]] bool maker_lives() const noexcept { return memory_.maker_lives(); }

 private:
  struct Page {
    std::uint64_t layout = 0;
    Content content = {};
  };
  SharedMemory memory_;
  Page* page_ = nullptr;
};

}  // namespace tuina::link
