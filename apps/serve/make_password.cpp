// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/make_password.hpp"

#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "tuina/core/io/file.hpp"
#include "tuina/web/password.hpp"

namespace tuina::app {
namespace {

// A terminal shows nothing of what is typed while this lives.
class Unseen {
 public:
  Unseen() : terminal_(::tcgetattr(STDIN_FILENO, &before_) == 0) {
    termios unseen = before_;
    unseen.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    if (terminal_) ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &unseen);
  }
  ~Unseen() {
    if (terminal_) ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_);
  }
  Unseen(const Unseen&) = delete;
  Unseen& operator=(const Unseen&) = delete;

  [[nodiscard]] std::string ask(const char* words) const {
    if (terminal_) std::fputs(words, stderr);
    std::string line;
    std::getline(std::cin, line);
    if (terminal_) std::fputc('\n', stderr);
    return line;
  }
  [[nodiscard]] bool terminal() const { return terminal_; }

 private:
  termios before_{};
  bool terminal_;
};

}  // namespace

Result<void> make_password_file(const std::filesystem::path& file, web::Role role) {
  std::optional<web::Passwords> before;
  std::error_code fault;
  if (role == web::Role::watch || std::filesystem::exists(file, fault)) {
    auto read = web::Passwords::read(file);
    if (!read) return tl::unexpected(read.error());
    before = std::move(*read);
  }
  const Unseen input;
  const std::string typed = input.ask("password: ");
  auto password = web::Password::make(typed);
  if (!password) return tl::unexpected(password.error());
  if (before && before->role_of(typed))
    return fail(Fault::usage, "{} has this password already: take another one", file.string());
  if (input.terminal() && input.ask("once more: ") != typed)
    return fail(Fault::usage, "the two passwords are not the same: {} was not written",
                file.string());
  web::Passwords after = before.value_or(web::Passwords{.operators = *password});
  if (role == web::Role::watch)
    after.viewers = std::move(*password);
  else
    after.operators = std::move(*password);
  ::umask(S_IRWXG | S_IRWXO);
  return write_file(file, after.text());
}

}  // namespace tuina::app
