// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/history/person_history.hpp"

namespace tuina::history {

/// A person's page: sessions, what has changed since the last one, how hard each place was over
/// time, maps of the back side by side. One self-contained HTML file. Maps need the folders of the
/// sessions; one that is gone is named.
[[nodiscard]] std::string history_page(const PersonHistory& person);

}  // namespace tuina::history
