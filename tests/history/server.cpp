// SPDX-License-Identifier: Apache-2.0
#include "tests/history/server.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "tests/folder.hpp"
#include "tuina/core/io/file.hpp"

namespace tuina::test {
namespace {

namespace fs = std::filesystem;

/// The server's programs, of the newest version.
fs::path programs() {
  fs::path newest;
  std::error_code none;
  for (const auto& version : fs::directory_iterator("/usr/lib/postgresql", none)) {
    const fs::path bin = version.path() / "bin";
    if (fs::exists(bin / "initdb") && bin > newest) newest = bin;
  }
  return newest;
}

class Server {
 public:
  Server() : programs_(programs()) {
    if (programs_.empty()) return;
    // The server refuses to run as root; Debian's package has made a user for it.
    if (::getuid() == 0) {
      as_ = "setpriv --reuid=postgres --regid=postgres --clear-groups ";
      REQUIRE(std::system(fmt::format("chown postgres {}", folder_.path().string()).c_str()) == 0);
    }
    up_ = call("initdb", "-A trust -U tuina --no-sync -D {}/data") == 0 &&
          call("pg_ctl",
               "-s -w -D {0}/data -l {0}/log -o \"-c listen_addresses= -k {0} -c fsync=off\" "
               "start") == 0;
    if (!up_) MESSAGE("no server starts here: ", *read_file(folder_ / "out"));
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server() {
    // The tests are over by now, so nothing is asserted.
    if (up_) static_cast<void>(call("pg_ctl", "-s -D {}/data -m immediate stop"));
  }

  std::optional<std::string> empty_database() {
    if (!up_) return std::nullopt;
    const std::string name = fmt::format("t{}", ++made_);
    REQUIRE(call("createdb", "-h {} -U tuina " + name) == 0);
    return fmt::format("postgresql:///{}?host={}&user=tuina", name, folder_.path().string());
  }

 private:
  [[nodiscard]] int call(const char* program, const std::string& arguments) const {
    const std::string folder = folder_.path().string();
    return std::system(fmt::format("cd {} && {}{}/{} {} >>{}/out 2>&1", folder, as_,
                                   programs_.string(), program,
                                   fmt::format(fmt::runtime(arguments), folder), folder)
                           .c_str());
  }
  fs::path programs_;
  Folder folder_;
  std::string as_;
  bool up_ = false;
  int made_ = 0;
};

}  // namespace

std::optional<std::string> empty_database() {
  static Server server;
  return server.empty_database();
}

}  // namespace tuina::test
