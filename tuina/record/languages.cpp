// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/languages.hpp"

#include <nlohmann/json.hpp>

#include "tuina/record/shipped_messages.hpp"

namespace tuina::record {

Result<Language> find_language(std::string_view tag) {
  if (tag == "en") return Language();
  if (tag == "zh-TW") tag = "zh-Hant";
  for (const ShippedMessages& shipped : shipped_messages()) {
    if (shipped.tag != tag) continue;
    return Language(std::string(tag),
                    nlohmann::json::parse(shipped.json).get<Language::Messages>());
  }
  return fail(Fault::usage, "language {}: there are en (English) and zh-Hant (Traditional Chinese)",
              tag);
}

}  // namespace tuina::record
