// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/tls_link.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <limits>
#include <new>

namespace tuina::web {
namespace {

constexpr double patience_s = 10.0, forever_s = std::numeric_limits<double>::infinity();

sockaddr_in loopback(int port) {
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(static_cast<std::uint16_t>(port));
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return at;
}

void set(int socket, int level, int option, int value) {
  ::setsockopt(socket, level, option, &value, sizeof value);
}

bool would_block() {
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

}  // namespace

TlsDoor::Link::Link(const Certificate& certificate, int outer, std::string caller, double now_s)
    : tls_(SSL_new(certificate.context()), &SSL_free),
      outer_(outer),
      caller_(std::move(caller)),
      until_s_(now_s + patience_s) {
  if (!tls_) throw std::bad_alloc();
  SSL_set_fd(tls_.get(), outer_);
  SSL_set_accept_state(tls_.get());
  set(outer_, IPPROTO_TCP, TCP_NODELAY, 1);
}

TlsDoor::Link::~Link() {
  ::close(outer_);
  if (inner_ >= 0) ::close(inner_);
}

std::array<pollfd, 2> TlsDoor::Link::waits_for() const {
  short outer = 0, inner = 0;
  if (state_ == State::shaking) outer = wants_write_ ? POLLOUT : POLLIN;
  if (state_ == State::open) {
    if (inwards_.empty() && !outer_ended_) outer |= POLLIN;
    if (!outwards_.empty()) outer |= POLLOUT;
    if (outwards_.empty() && !inner_ended_) inner |= POLLIN;
    if (!inwards_.empty()) inner |= POLLOUT;
  }
  // A socket that waits for nothing is not asked, or its end would be told again and again.
  return {{{.fd = outer != 0 ? outer_ : -1, .events = outer, .revents = 0},
           {.fd = inner != 0 ? inner_ : -1, .events = inner, .revents = 0}}};
}

// Whoever speaks HTTP here is told why nobody answers.
void TlsDoor::Link::answer_plain() {
  constexpr std::string_view answer =
      "HTTP/1.1 400 Bad Request\r\nConnection: close\r\nContent-Type: text/plain; "
      "charset=utf-8\r\nContent-Length: 30\r\n\r\nthe address begins with https\n";
  (void)::send(outer_, answer.data(), answer.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  // What is left unread when a socket closes takes the answer with it.
  (void)::recv(outer_, inwards_.bytes.data(), inwards_.bytes.size(), MSG_DONTWAIT);
}

void TlsDoor::Link::shake() {
  ERR_clear_error();
  const int done = SSL_do_handshake(tls_.get());
  if (done == 1) {
    state_ = State::shaken;
    return;
  }
  const int why = SSL_get_error(tls_.get(), done);
  wants_write_ = why == SSL_ERROR_WANT_WRITE;
  if (wants_write_ || why == SSL_ERROR_WANT_READ) return;
  if (why == SSL_ERROR_SSL && ERR_GET_REASON(ERR_peek_error()) == SSL_R_HTTP_REQUEST)
    answer_plain();
  state_ = State::over;
}

bool TlsDoor::Link::reserve() {
  inner_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (inner_ < 0) return false;
  // Little waits between the server and a page that reads slowly, so that it gets what is new.
  set(inner_, SOL_SOCKET, SO_RCVBUF, static_cast<int>(outwards_.bytes.size()));
  set(inner_, IPPROTO_TCP, TCP_NODELAY, 1);
  sockaddr_in from = loopback(0);
  socklen_t size = sizeof from;
  if (::bind(inner_, reinterpret_cast<const sockaddr*>(&from), size) != 0 ||
      ::getsockname(inner_, reinterpret_cast<sockaddr*>(&from), &size) != 0)
    return false;
  source_port_ = ntohs(from.sin_port);
  return true;
}

bool TlsDoor::Link::connect(int inner_port) {
  const sockaddr_in to = loopback(inner_port);
  const bool begun = ::connect(inner_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0 ||
                     errno == EINPROGRESS;
  state_ = begun ? State::open : State::over;
  until_s_ = forever_s;
  return begun;
}

bool TlsDoor::Link::read_outer() {
  if (outer_ended_ || !inwards_.empty()) return false;
  ERR_clear_error();
  std::size_t read = 0;
  if (SSL_read_ex(tls_.get(), inwards_.bytes.data(), inwards_.bytes.size(), &read) == 1) {
    inwards_.begin = 0;
    inwards_.end = read;
    return true;
  }
  const int why = SSL_get_error(tls_.get(), 0);
  if (why == SSL_ERROR_WANT_READ || why == SSL_ERROR_WANT_WRITE) return false;
  outer_ended_ = true;
  if (why != SSL_ERROR_ZERO_RETURN) state_ = State::over;
  ::shutdown(inner_, SHUT_WR);
  return false;
}

bool TlsDoor::Link::write_inner() {
  if (inwards_.empty()) return false;
  const auto sent = ::send(inner_, inwards_.bytes.data() + inwards_.begin,
                           inwards_.end - inwards_.begin, MSG_NOSIGNAL);
  if (sent > 0) inwards_.begin += static_cast<std::size_t>(sent);
  if (sent < 0 && !would_block()) {
    inner_ended_ = true;
    inwards_.begin = inwards_.end;
  }
  return sent > 0;
}

bool TlsDoor::Link::read_inner() {
  if (inner_ended_ || !outwards_.empty()) return false;
  const auto got = ::recv(inner_, outwards_.bytes.data(), outwards_.bytes.size(), 0);
  if (got == 0 || (got < 0 && !would_block())) inner_ended_ = true;
  outwards_.begin = 0;
  outwards_.end = got > 0 ? static_cast<std::size_t>(got) : 0;
  return got > 0;
}

bool TlsDoor::Link::write_outer() {
  if (outwards_.empty()) return false;
  ERR_clear_error();
  std::size_t written = 0;
  if (SSL_write_ex(tls_.get(), outwards_.bytes.data() + outwards_.begin,
                   outwards_.end - outwards_.begin, &written) == 1) {
    outwards_.begin += written;
    return true;
  }
  const int why = SSL_get_error(tls_.get(), 0);
  if (why != SSL_ERROR_WANT_READ && why != SSL_ERROR_WANT_WRITE) state_ = State::over;
  return false;
}

bool TlsDoor::Link::move(double now_s) {
  constexpr int pieces_a_turn = 4;
  bool more = true, told = false;
  for (int i = 0; i < pieces_a_turn && more && state_ == State::open; ++i) {
    more = read_outer();
    more = write_inner() || more;
    more = read_inner() || more;
    if (write_outer()) more = told = true;
  }
  const bool waits = !outwards_.empty() || outer_ended_ || inner_ended_;
  if (!waits || told) until_s_ = forever_s;
  if (waits && until_s_ == forever_s) until_s_ = now_s + patience_s;
  if (inner_ended_ && outwards_.empty() && state_ == State::open) {
    SSL_shutdown(tls_.get());
    state_ = State::over;
  }
  return more && state_ == State::open;
}

}  // namespace tuina::web
