// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/web/request.hpp"

struct mg_connection;  // of CivetWeb

namespace tuina::web {

/// What is asked on a connection; of a form as much as has come when the server's patience ends.
[[nodiscard]] Request read_request(mg_connection* connection);
/// Answers it, after which the connection closes. Of one that came by TLS the browser is told to
/// come by that always.
void send(mg_connection* connection, const Reply& reply, bool by_tls);

}  // namespace tuina::web
