// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tuina/core/result.hpp"

struct ssl_ctx_st;  // of OpenSSL

namespace tuina::web {

/// A certificate with its key, as a server of TLS 1.2 or 1.3 shows it.
class Certificate {
 public:
  /// Reads one PEM file: the certificate, those that signed it if any, and the key. Fault::file: it
  /// cannot be read. Fault::bad_input: everybody may read it; there is no certificate or no key in
  /// it; the key is another's, or locked; the time of the certificate is over or yet to come; it
  /// names no host.
  [[nodiscard]] static Result<Certificate> read(const std::filesystem::path& file);

  /// Hosts that it is for, as a browser writes them (`[::1]`); names with a star are left out.
  [[nodiscard]] const std::vector<std::string>& hosts() const { return hosts_; }
  [[nodiscard]] ssl_ctx_st* context() const { return context_.get(); }

 private:
  using Context = std::shared_ptr<ssl_ctx_st>;
  Certificate(Context context, std::vector<std::string> hosts)
      : context_(std::move(context)), hosts_(std::move(hosts)) {}
  Context context_;
  std::vector<std::string> hosts_;
};

}  // namespace tuina::web
