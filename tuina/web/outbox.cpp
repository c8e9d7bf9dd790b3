// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/outbox.hpp"

#include <utility>

namespace tuina::web {

void Outbox::put(Channel channel, std::string text) {
  const std::lock_guard lock(mutex_);
  newest_[static_cast<std::size_t>(channel)] = std::move(text);
  changed_.notify_one();
}

bool Outbox::reply(std::string text) {
  const std::lock_guard lock(mutex_);
  if (replies_.size() == max_replies) return false;
  replies_.push_back(std::move(text));
  changed_.notify_one();
  return true;
}

std::optional<std::string> Outbox::take() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return closed_ || !replies_.empty() || newest_[0] || newest_[1]; });
  if (closed_) return std::nullopt;
  if (!replies_.empty()) {
    std::string text = std::move(replies_.front());
    replies_.pop_front();
    return text;
  }
  return std::exchange(newest_[0] ? newest_[0] : newest_[1], std::nullopt);
}

void Outbox::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_one();
}

}  // namespace tuina::web
