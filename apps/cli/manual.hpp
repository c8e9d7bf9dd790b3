// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace tuina::app {

/// The manual page of a program with verbs, for man(1), made of what --help says.
[[nodiscard]] std::string manual_page(const CLI::App& program, const std::string& version);

/// The script by which a shell completes verbs and options: `bash`, `zsh` or `fish`.
[[nodiscard]] std::string completion_script(const CLI::App& program, const std::string& shell);

}  // namespace tuina::app
