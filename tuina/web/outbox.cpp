// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/outbox.hpp"

#include <utility>

namespace tuina::web {
namespace {

Frame take_front(std::deque<Frame>& frames) {
  Frame frame = std::move(frames.front());
  frames.pop_front();
  return frame;
}

}  // namespace

void Outbox::put(Slot slot, Frame frame, std::size_t keep) {
  const std::lock_guard lock(mutex_);
  std::deque<Frame>& waiting = slots_[slot];
  waiting.push_back(std::move(frame));
  if (waiting.size() > keep) waiting.pop_front();
  changed_.notify_one();
}

void Outbox::drop(Slot slot) {
  const std::lock_guard lock(mutex_);
  slots_.erase(slot);
}

bool Outbox::reply(Frame frame) {
  const std::lock_guard lock(mutex_);
  if (replies_.size() == max_replies) return false;
  replies_.push_back(std::move(frame));
  changed_.notify_one();
  return true;
}

std::optional<Frame> Outbox::take() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return closed_ || !replies_.empty() || !slots_.empty(); });
  if (closed_) return std::nullopt;
  if (!replies_.empty()) return take_front(replies_);
  // A slot that is filled faster than it is sent does not keep the others waiting.
  auto next = slots_.upper_bound(last_);
  if (next == slots_.end()) next = slots_.begin();
  last_ = next->first;
  Frame frame = take_front(next->second);
  if (next->second.empty()) slots_.erase(next);
  return frame;
}

void Outbox::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_one();
}

}  // namespace tuina::web
