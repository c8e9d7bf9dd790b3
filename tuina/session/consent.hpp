// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "tuina/core/result.hpp"

namespace tuina::session {

/// What has to be asked before an arm may touch a person: each is a reason not to.
struct HealthQuestion {
  const char* key;
  const char* text;
};
inline constexpr std::array<HealthQuestion, 10> health_questions = {{
    {"bleeding", "anticoagulants, or a bleeding disorder"},
    {"thrombosis", "thrombosis, now or suspected"},
    {"fracture", "a fracture, or severe osteoporosis"},
    {"surgery", "recent surgery of the back or chest"},
    {"pregnancy", "pregnancy"},
    {"infection", "fever, or an infection or wound of the skin"},
    {"tumour_or_hernia", "a tumour, or a hernia of the spine"},
    {"pacemaker", "a pacemaker or another active implant"},
    {"numbness", "loss of sensation on the back"},
    {"minor", "younger than 18 years"},
}};

/// Answers that let the arms be armed: every question was answered with no.
struct Consent {
  std::string answered_by;
};

/// Reads `answered_by` and, under `[answers]`, "yes", "no" or "unknown" to every question. An
/// answer that is missing or none of these is bad input; yes and unknown are a refusal
/// (Fault::stopped). All of it is named in the one message.
[[nodiscard]] Result<Consent> parse_consent(std::string_view text, std::string_view name);
/// Reads such a file; fails as parse_consent() does, and where there is no such file.
[[nodiscard]] Result<Consent> read_consent(const std::filesystem::path& file);

/// A consent file with the same answer everywhere; as it stands without arguments, it is for
/// filling in and is refused.
[[nodiscard]] std::string consent_form(std::string_view answered_by = "",
                                       std::string_view answer = "");

}  // namespace tuina::session
