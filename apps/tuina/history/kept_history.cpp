// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/history/kept_history.hpp"

#include "apps/tuina/history/open.hpp"

namespace tuina::app {

Result<KeptHistory> KeptHistory::open(const std::string& address) {
  if (!history::is_server(address)) {
    auto own = open_history(address);
    if (!own) return tl::unexpected(own.error());
    return KeptHistory(std::move(*own), {}, {});
  }
  const auto name = history::name_of_server(address);
  if (!name) return tl::unexpected(name.error());
  const auto folder = data_folder();
  if (!folder) return tl::unexpected(folder.error());
  const std::string outbox = *folder / ("outbox-" + *name + ".sqlite");
  auto own = history::History::open(outbox);
  if (!own) return tl::unexpected(own.error());
  return KeptHistory(std::move(*own), address, outbox);
}

Result<history::History*> KeptHistory::whole() {
  if (server_.empty()) return &own_;
  if (!reached_) {
    auto server = history::History::open(server_);
    if (!server) return tl::unexpected(server.error());
    reached_ = std::move(*server);
  }
  return &*reached_;
}

void KeptHistory::take_back(const record::VisitLabel& label) {
  static_cast<void>(own_.take_back(label));
  if (const auto server = whole()) static_cast<void>((*server)->take_back(label));
}

Result<history::Delivered> KeptHistory::catch_up() {
  if (server_.empty()) return history::Delivered{};
  const auto server = whole();
  if (!server) return tl::unexpected(server.error());
  auto delivered = history::deliver(own_, **server);
  if (!delivered) reached_.reset();
  return delivered;
}

}  // namespace tuina::app
