// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tuina::web {

/// A body that is read has so many bytes at most.
inline constexpr std::int64_t max_form_bytes = 2048;

/// What a browser asks for, as far as somebody looks at it.
struct Request {
  std::string method;
  std::string path;   ///< decoded, without the query
  std::string query;  ///< as it was sent
  std::string host;
  std::string origin;  ///< empty: not sent
  std::string cookie;
  std::int64_t body_bytes = 0;  ///< as announced; -1: not announced
  bool upgrade = false;         ///< to a WebSocket
  std::string subprotocols;     ///< of the WebSocket, as they were offered
  std::string encodings;        ///< of the content, as the browser takes them
  /// Where the browser comes from, header Sec-Fetch-Site: `cross-site` for a link in another page.
  std::string fetch_site = {};
  std::string known_tags;  ///< of contents that the browser has kept
  std::string from = {};   ///< machine, where it came through the door to the network
  std::string body = {};   ///< of a POST with max_form_bytes at most
};

/// What a browser gets.
struct Reply {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body = {};
  std::string cache = "no-store";  ///< what a browser may keep: Cache-Control
  std::vector<std::pair<std::string, std::string>> headers = {};
};

}  // namespace tuina::web
