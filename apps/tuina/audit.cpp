// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/web/audit.hpp"

namespace tuina::app {
namespace {

/// Whether an audit log is as it was written.
class AuditCheck final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "audit check"; }
  [[nodiscard]] const char* summary() const override {
    return "whether the audit log of `tuina serve` is as it was written";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina audit check tuina-sessions/audit.log";
  }
  void describe(Options& options) override {
    options.add("file", file_, "audit.log in the folder of `tuina serve --out`").required();
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    const auto text = read_file(file_);
    if (!text) return tl::unexpected(text.error());
    const auto summary = web::check_audit(*text, file_);
    if (!summary) return tl::unexpected(summary.error());
    if (summary->lines == 0) {
      return fail(Fault::bad_input, "{}: is empty; a log begins with the line of its server",
                  file_);
    }
    const nlohmann::ordered_json json = {{"lines", summary->lines},
                                         {"last_hash", summary->last_hash}};
    return Answer{.json = json.dump(2),
                  .text = fmt::format("{}: {} lines, each as it was written; the last hash is {}",
                                      file_, summary->lines, summary->last_hash)};
  }

 private:
  std::string file_;
};

}  // namespace

std::unique_ptr<Verb> make_audit_check() {
  return std::make_unique<AuditCheck>();
}

}  // namespace tuina::app
