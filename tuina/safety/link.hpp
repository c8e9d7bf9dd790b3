// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstring>
#include <memory>
#include <optional>
#include <string>

#include "tuina/core/result.hpp"
#include "tuina/safety/wire.hpp"

namespace tuina::safety {

/// Which process of a robot somebody is; each writes one kind of frame and reads the others.
enum class Role : std::uint8_t { drives, guard, controller };
inline constexpr std::size_t roles = 3;
[[nodiscard]] constexpr const char* name_of(Role role) {
  constexpr const char* names[] = {"drives", "guard", "controller"};
  return names[static_cast<std::size_t>(role)];
}

/// One frame in shared memory, written by one process and read by any. A reader never waits for the
/// writer: a frame that is being written, or that was torn or spoilt, is none (a sequence lock with
/// a check sum).
template <typename Frame>
class Slot {
 public:
  void write(const Frame& frame) noexcept {
    const std::uint64_t count = count_.load(std::memory_order_relaxed) | 1U;
    count_.store(count, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_release);
    frame_ = frame;
    crc_ = wire::crc_of(reinterpret_cast<const std::byte*>(&frame_), sizeof frame_);
    std::atomic_thread_fence(std::memory_order_release);
    count_.store(count + 1, std::memory_order_release);
  }

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

/// The shared memory of the processes of one robot, by its name. Each maps what it may write, its
/// own frames, and all else for reading only. Bells wake who waits; nobody trusts them, so a
/// process that rings them wildly or never delays the others by their deadlines at most.
class Link {
 public:
  /// Makes the memory anew; the process that does so takes it away when it ends.
  [[nodiscard]] static Result<Link> create(const std::string& name, Role role);
  /// Fails with Fault::device when there is none, or one of another layout.
  [[nodiscard]] static Result<Link> open(const std::string& name, Role role);
  Link(Link&&) noexcept;
  Link& operator=(Link&&) noexcept;
  ~Link();

  void write(const wire::SensorFrame& frame) noexcept;
  void write(const wire::ProposalFrame& frame) noexcept;
  void write(const wire::DriveFrame& frame) noexcept;

  [[nodiscard]] std::optional<wire::SensorFrame> sensors() const noexcept;
  [[nodiscard]] std::optional<wire::ProposalFrame> proposal() const noexcept;
  [[nodiscard]] std::optional<wire::DriveFrame> drive() const noexcept;

  /// Waits until somebody writes or until the deadline; may return sooner.
  void wait(std::chrono::steady_clock::time_point deadline) noexcept;

 private:
  struct Memory;
  explicit Link(std::unique_ptr<Memory> memory);
  std::unique_ptr<Memory> memory_;
};

}  // namespace tuina::safety
