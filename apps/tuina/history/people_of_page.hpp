// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "apps/serve/known_people.hpp"

namespace tuina::app {

/// The people of a history for a page. Each call has a connection of its own. While a server is
/// away nobody is known, so that what was ruled out by hand is not forgotten.
[[nodiscard]] KnownPeople people_of_page(const std::string& address);

}  // namespace tuina::app
