// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/config.hpp"

#include <nlohmann/json.hpp>

#include "apps/tuina/verbs.hpp"

namespace tuina::app {
namespace {

/// Shows what every key is at, after --config and --set.
class ConfigShow final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "config show"; }
  [[nodiscard]] const char* summary() const override {
    return "print the whole effective configuration";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina config show --set scan.method=likelihood > my.toml";
  }
  void describe(Options&) override {}
  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    Answer answer;
    answer.product = session::to_toml(*config);
    answer.json = nlohmann::json{{"config", answer.product}}.dump(2);
    return answer;
  }
};

/// Reads a file as every other verb would and says what is wrong with it.
class ConfigCheck final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "config check"; }
  [[nodiscard]] const char* summary() const override { return "check a configuration file"; }
  [[nodiscard]] const char* example() const override { return "tuina config check my.toml"; }
  void describe(Options& options) override { options.add("file", file_, "a TOML file").required(); }
  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    const auto config = session::load_config(file_);
    if (!config) return tl::unexpected(config.error());
    return Answer{.json = nlohmann::json{{"file", file_}, {"valid", true}}.dump(2),
                  .text = fmt::format("{}: good", file_)};
  }

 private:
  std::string file_;
};

}  // namespace

std::unique_ptr<Verb> make_config_show() {
  return std::make_unique<ConfigShow>();
}
std::unique_ptr<Verb> make_config_check() {
  return std::make_unique<ConfigCheck>();
}

}  // namespace tuina::app
