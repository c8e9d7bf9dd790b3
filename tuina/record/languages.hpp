// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "tuina/core/language.hpp"
#include "tuina/core/result.hpp"

namespace tuina::record {

/// A language in which reports are written, by its BCP 47 tag: "en", or Traditional Chinese as
/// "zh-Hant" or "zh-TW". The messages are those of the live page. Refused, with those that there
/// are: any other.
[[nodiscard]] Result<Language> find_language(std::string_view tag);

}  // namespace tuina::record
