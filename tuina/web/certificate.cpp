// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/certificate.hpp"

#include <arpa/inet.h>
#include <openssl/bio.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <array>

#include "tuina/core/io/file.hpp"
#include "tuina/web/password.hpp"

namespace tuina::web {
namespace {

constexpr std::size_t max_bytes = 1 << 20;
using Text = std::unique_ptr<BIO, decltype(&BIO_free)>;
using Key = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;
using Signed = std::unique_ptr<X509, decltype(&X509_free)>;

Text text_of(const std::string& pem) {
  return {BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())), &BIO_free};
}

// A key that is locked is not asked for at the terminal.
int no_passphrase(char*, int, int, void*) {
  return -1;
}

std::string day_of(const ASN1_TIME* time) {
  std::tm at{};
  if (ASN1_TIME_to_tm(time, &at) != 1) return "?";
  return fmt::format("{:04}-{:02}-{:02}", at.tm_year + 1900, at.tm_mon + 1, at.tm_mday);
}

std::string host_of(const GENERAL_NAME* name) {
  const auto text = [](const ASN1_STRING* one) {
    return std::string(reinterpret_cast<const char*>(ASN1_STRING_get0_data(one)),
                       static_cast<std::size_t>(ASN1_STRING_length(one)));
  };
  if (name->type == GEN_DNS) return text(name->d.dNSName);
  if (name->type != GEN_IPADD) return "";
  const std::string bytes = text(name->d.iPAddress);
  std::array<char, INET6_ADDRSTRLEN> shown{};
  constexpr std::size_t bytes_of_v4 = 4, bytes_of_v6 = 16;
  if (bytes.size() == bytes_of_v4)
    return inet_ntop(AF_INET, bytes.data(), shown.data(), shown.size());
  if (bytes.size() != bytes_of_v6) return "";
  return fmt::format("[{}]", inet_ntop(AF_INET6, bytes.data(), shown.data(), shown.size()));
}

std::vector<std::string> hosts_of(X509* certificate) {
  std::vector<std::string> hosts;
  auto* names = static_cast<GENERAL_NAMES*>(
      X509_get_ext_d2i(certificate, NID_subject_alt_name, nullptr, nullptr));
  for (int i = 0; i < sk_GENERAL_NAME_num(names); ++i) {
    std::string host = host_of(sk_GENERAL_NAME_value(names, i));
    const bool is_one =
        host.find_first_not_of(
            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-[]:") ==
        std::string::npos;
    if (!host.empty() && is_one) hosts.push_back(std::move(host));
  }
  GENERAL_NAMES_free(names);
  return hosts;
}

// Nothing older than TLS 1.2, nothing that forgets its keys' secrecy, no second handshake; nothing
// is kept of who has gone.
std::shared_ptr<SSL_CTX> make_context() {
  std::shared_ptr<SSL_CTX> context(SSL_CTX_new(TLS_server_method()), &SSL_CTX_free);
  if (!context) throw std::bad_alloc();
  SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION);
  SSL_CTX_set_cipher_list(context.get(), "ECDHE+AESGCM:ECDHE+CHACHA20");
  SSL_CTX_set_options(context.get(), SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION |
                                         SSL_OP_CIPHER_SERVER_PREFERENCE | SSL_OP_NO_TICKET);
  SSL_CTX_set_session_cache_mode(context.get(), SSL_SESS_CACHE_OFF);
  SSL_CTX_set_mode(context.get(), SSL_MODE_RELEASE_BUFFERS | SSL_MODE_ENABLE_PARTIAL_WRITE |
                                      SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
  return context;
}

Result<void> check_time(X509* certificate, const std::string& name) {
  const ASN1_TIME* begin = X509_get0_notBefore(certificate);
  const ASN1_TIME* end = X509_get0_notAfter(certificate);
  if (X509_cmp_current_time(end) < 0)
    return fail(Fault::bad_input, "{}: the certificate ended on {}: a new one is needed", name,
                day_of(end));
  if (X509_cmp_current_time(begin) > 0)
    return fail(Fault::bad_input,
                "{}: the certificate begins on {}: is the clock of this machine right?", name,
                day_of(begin));
  return {};
}

}  // namespace

Result<Certificate> Certificate::read(const std::filesystem::path& file) {
  const std::string name = file.string();
  auto pem = read_file(file, max_bytes);
  if (!pem) return tl::unexpected(pem.error());
  if (auto closed = check_not_open_to_all(file); !closed) return tl::unexpected(closed.error());
  const Text certificates = text_of(*pem), keys = text_of(*pem);
  const Signed own(PEM_read_bio_X509(certificates.get(), nullptr, &no_passphrase, nullptr),
                   &X509_free);
  if (!own)
    return fail(Fault::bad_input,
                "{}: no certificate is in it: it has to be PEM, with -----BEGIN "
                "CERTIFICATE-----",
                name);
  const Key key(PEM_read_bio_PrivateKey(keys.get(), nullptr, &no_passphrase, nullptr),
                &EVP_PKEY_free);
  if (!key)
    return fail(Fault::bad_input,
                "{}: no key is in it, or one that is locked by a passphrase: "
                "append the unlocked key to the certificate",
                name);
  if (X509_check_private_key(own.get(), key.get()) != 1)
    return fail(Fault::bad_input, "{}: the key is not that of the certificate", name);
  if (auto timely = check_time(own.get(), name); !timely) return tl::unexpected(timely.error());
  auto hosts = hosts_of(own.get());
  if (hosts.empty())
    return fail(Fault::bad_input, "{}: the certificate names no host: make it with subjectAltName",
                name);
  auto context = make_context();
  bool taken = SSL_CTX_use_certificate(context.get(), own.get()) == 1 &&
               SSL_CTX_use_PrivateKey(context.get(), key.get()) == 1;
  while (taken) {
    const Signed above(PEM_read_bio_X509(certificates.get(), nullptr, &no_passphrase, nullptr),
                       &X509_free);
    if (!above) break;
    taken = SSL_CTX_add1_chain_cert(context.get(), above.get()) == 1;
  }
  if (!taken)
    return fail(Fault::bad_input, "{}: TLS does not take this certificate: is its key too short?",
                name);
  return Certificate(std::move(context), std::move(hosts));
}

}  // namespace tuina::web
