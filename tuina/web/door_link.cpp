// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/door_link.hpp"

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

constexpr std::size_t piece_bytes = 16384;
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

Door::Link::Link(const std::optional<Certificate>& certificate, int outer, std::string caller,
                 double now_s)
    : tls_(certificate ? SSL_new(certificate->context()) : nullptr, &SSL_free),
      outer_(outer),
      caller_(std::move(caller)),
      until_s_(now_s + patience_s),
      state_(certificate ? State::shaking : State::heading) {
  set(outer_, IPPROTO_TCP, TCP_NODELAY, 1);
  if (!certificate) return;
  if (!tls_) throw std::bad_alloc();
  SSL_set_fd(tls_.get(), outer_);
  SSL_set_accept_state(tls_.get());
}

Door::Link::~Link() {
  ::close(outer_);
  if (inner_ >= 0) ::close(inner_);
}

std::array<pollfd, 2> Door::Link::waits_for() const {
  short outer = 0, inner = 0;
  if (state_ == State::shaking || state_ == State::heading) outer = wants_write_ ? POLLOUT : POLLIN;
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
void Door::Link::answer_plain() {
  constexpr std::string_view answer =
      "HTTP/1.1 400 Bad Request\r\nConnection: close\r\nContent-Type: text/plain; "
      "charset=utf-8\r\nContent-Length: 30\r\n\r\nthe address begins with https\n";
  (void)::send(outer_, answer.data(), answer.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  // What is left unread when a socket closes takes the answer with it.
  std::array<char, piece_bytes> unread;
  (void)::recv(outer_, unread.data(), unread.size(), MSG_DONTWAIT);
}

void Door::Link::shake() {
  ERR_clear_error();
  const int done = SSL_do_handshake(tls_.get());
  if (done == 1) {
    state_ = State::heading;
    return;
  }
  const int why = SSL_get_error(tls_.get(), done);
  wants_write_ = why == SSL_ERROR_WANT_WRITE;
  if (wants_write_ || why == SSL_ERROR_WANT_READ) return;
  if (why == SSL_ERROR_SSL && ERR_GET_REASON(ERR_peek_error()) == SSL_R_HTTP_REQUEST)
    answer_plain();
  state_ = State::over;
}

bool Door::Link::reserve() {
  inner_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (inner_ < 0) return false;
  // Little waits between the server and a page that reads slowly, so that it gets what is new.
  set(inner_, SOL_SOCKET, SO_RCVBUF, static_cast<int>(piece_bytes));
  set(inner_, IPPROTO_TCP, TCP_NODELAY, 1);
  sockaddr_in from = loopback(0);
  socklen_t size = sizeof from;
  if (::bind(inner_, reinterpret_cast<const sockaddr*>(&from), size) != 0 ||
      ::getsockname(inner_, reinterpret_cast<sockaddr*>(&from), &size) != 0)
    return false;
  source_port_ = ntohs(from.sin_port);
  return true;
}

bool Door::Link::connect(int inner_port) {
  const sockaddr_in to = loopback(inner_port);
  const bool begun = ::connect(inner_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0 ||
                     errno == EINPROGRESS;
  state_ = begun ? State::open : State::over;
  until_s_ = forever_s;
  return begun;
}

std::string_view Door::Link::hear_outer(std::span<char> bytes) {
  bool fails = false;
  if (tls_) {
    ERR_clear_error();
    std::size_t read = 0;
    if (SSL_read_ex(tls_.get(), bytes.data(), bytes.size(), &read) == 1)
      return {bytes.data(), read};
    const int why = SSL_get_error(tls_.get(), 0);
    if (why == SSL_ERROR_WANT_READ || why == SSL_ERROR_WANT_WRITE) return {};
    fails = why != SSL_ERROR_ZERO_RETURN;
  } else {
    const auto got = ::recv(outer_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (got > 0) return {bytes.data(), static_cast<std::size_t>(got)};
    if (got < 0 && would_block()) return {};
    fails = got < 0;
  }
  outer_ended_ = true;
  if (fails) state_ = State::over;
  return {};
}

std::size_t Door::Link::tell_outer(std::string_view bytes) {
  if (tls_) {
    ERR_clear_error();
    std::size_t written = 0;
    if (SSL_write_ex(tls_.get(), bytes.data(), bytes.size(), &written) == 1) return written;
    const int why = SSL_get_error(tls_.get(), 0);
    if (why != SSL_ERROR_WANT_READ && why != SSL_ERROR_WANT_WRITE) state_ = State::over;
    return 0;
  }
  const auto sent = ::send(outer_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent < 0 && !would_block()) state_ = State::over;
  return sent > 0 ? static_cast<std::size_t>(sent) : 0;
}

void Door::Link::hear_head() {
  wants_write_ = false;
  std::string& said = inwards_.bytes;
  std::array<char, piece_bytes> room;
  while (state_ == State::heading) {
    const std::string_view more = hear_outer(room);
    if (more.empty()) {
      if (outer_ended_) state_ = State::over;
      return;
    }
    said.append(more);
    const HeadEnd end = find_head_end(said);
    if (end.broken) {
      state_ = State::over;
    } else if (end.at) {
      state_ = State::ready;
      posts_ = said.starts_with("POST ");
      if (posts_) return;
      const std::string behind = said.substr(*end.at);
      said.resize(*end.at);
      gate_.pass(behind, said);
    } else if (said.size() > max_head_bytes) {
      state_ = State::ready;  // for the server to refuse
      gate_.shut();
    }
  }
}

bool Door::Link::read_outer() {
  if (outer_ended_ || !inwards_.empty()) return false;
  inwards_.bytes.clear();
  inwards_.sent = 0;
  std::array<char, piece_bytes> room;
  const std::string_view more = hear_outer(room);
  if (outer_ended_) ::shutdown(inner_, SHUT_WR);
  if (posts_)
    inwards_.bytes.assign(more);
  else
    gate_.pass(more, inwards_.bytes);
  return !more.empty();
}

bool Door::Link::write_inner() {
  if (inwards_.empty()) return false;
  const std::string_view left = inwards_.left();
  const auto sent = ::send(inner_, left.data(), left.size(), MSG_NOSIGNAL);
  if (sent > 0) inwards_.sent += static_cast<std::size_t>(sent);
  if (sent < 0 && !would_block()) {
    inner_ended_ = true;
    inwards_ = {};
  }
  return sent > 0;
}

bool Door::Link::read_inner() {
  if (inner_ended_ || !outwards_.empty()) return false;
  outwards_.sent = 0;
  outwards_.bytes.resize(piece_bytes);
  const auto got = ::recv(inner_, outwards_.bytes.data(), outwards_.bytes.size(), 0);
  if (got == 0 || (got < 0 && !would_block())) inner_ended_ = true;
  outwards_.bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  return got > 0;
}

bool Door::Link::write_outer() {
  if (outwards_.empty()) return false;
  const std::size_t written = tell_outer(outwards_.left());
  outwards_.sent += written;
  return written > 0;
}

bool Door::Link::move(double now_s) {
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
    if (tls_) SSL_shutdown(tls_.get());
    state_ = State::over;
  }
  return more && state_ == State::open;
}

}  // namespace tuina::web
