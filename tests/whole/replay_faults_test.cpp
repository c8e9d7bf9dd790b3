// SPDX-License-Identifier: Apache-2.0
// Recordings as a bad cable, camera or motor leaves them. None gives a scan.
#include <doctest/doctest.h>

#include <filesystem>
#include <functional>
#include <sstream>

#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/png.hpp"

namespace fs = std::filesystem;
using tuina::test::Folder;
using tuina::test::run_tuina;

namespace {

fs::path picture(const fs::path& sweep, int frame) {
  return sweep / "frames" / fmt::format("{:06}.png", frame);
}

// The rows of a table, each as it is or changed or, when empty, left out.
void edit(const fs::path& table,
          const std::function<std::string(int, const std::string&)>& change) {
  std::istringstream in(tuina::read_file(table).value());
  std::string row;
  std::getline(in, row);
  std::string out = row + "\n";
  for (int i = 0; std::getline(in, row); ++i) {
    const std::string changed = change(i, row);
    if (!changed.empty()) out += changed + "\n";
  }
  REQUIRE(tuina::write_file(table, out).has_value());
}

int rows_of(const fs::path& table) {
  int rows = 0;
  edit(table, [&rows](int, const std::string& row) {
    ++rows;
    return row;
  });
  return rows;
}

}  // namespace

TEST_CASE("what camera and motor do wrong is found in the recording and named") {
  const Folder folder;
  const fs::path good = folder.path() / "good";
  const auto scanned = run_tuina({"scan", "--person", "phantom:slim", "--record", good.string(),
                                  "--out", folder / "good.ply", "--quiet"});
  REQUIRE_MESSAGE(scanned.exit_code == 0, scanned.err);
  const int frames = rows_of(good / "frames.csv");
  const int readings = rows_of(good / "yaw.csv");
  REQUIRE(frames > 80);
  const int middle = frames / 2;

  struct Fault {
    const char* said;
    std::function<void(const fs::path&)> make;
  };
  const Fault faults[] = {
      {"repeat the one before",  // a frozen camera
       [&](const fs::path& sweep) {
         for (int i = 1; i < 15; ++i) {
           fs::copy_file(picture(sweep, middle), picture(sweep, middle + i),
                         fs::copy_options::overwrite_existing);
         }
       }},
      {"frames are cut",  // the lower half never came
       [&](const fs::path& sweep) {
         for (int i = 0; i < 15; ++i) {
           auto image = tuina::read_png(picture(sweep, middle + i)).value().image;
           REQUIRE(image.channels == 1);
           tuina::Image cut(image.width, image.height);
           for (int y = 0; y < image.height; ++y) {
             for (int x = 0; x < image.width; ++x) {
               cut.row(y)[x] = y < image.height / 2 ? static_cast<std::uint8_t>(image.row(y)[x])
                                                    : std::uint8_t{128};
             }
           }
           REQUIRE(tuina::write_file(picture(sweep, middle + i), tuina::to_png(cut)).has_value());
         }
       }},
      {"not in the order in which they were taken",
       [&](const fs::path& sweep) {
         for (int i = 10; i + 1 < frames - 10; i += 2) {
           fs::rename(picture(sweep, i), sweep / "aside.png");
           fs::rename(picture(sweep, i + 1), picture(sweep, i));
           fs::rename(sweep / "aside.png", picture(sweep, i + 1));
         }
       }},
      {"frames are lost",
       [&](const fs::path& sweep) {
         edit(sweep / "frames.csv", [&](int i, const std::string& row) {
           if (i % 10 != 5) return row;
           fs::remove(picture(sweep, i));
           return std::string();
         });
       }},
      {"the motor stood still",  // stalls for a third of the time and then catches up
       [&](const fs::path& sweep) {
         std::string angle;
         edit(sweep / "yaw.csv", [&](int i, const std::string& row) {
           if (i < readings / 3 || i > 2 * readings / 3) return row;
           if (angle.empty()) angle = row.substr(row.find(','));
           return row.substr(0, row.find(',')) + angle;
         });
       }},
      {"the motor turns at most",  // one reading that the motor cannot have reached
       [&](const fs::path& sweep) {
         edit(sweep / "yaw.csv", [&](int i, const std::string& row) {
           return i == readings / 2 ? row.substr(0, row.find(',')) + ",140" : row;
         });
       }},
  };
  for (const Fault& fault : faults) {
    CAPTURE(fault.said);
    const fs::path bad = folder.path() / "bad";
    fs::remove_all(bad);
    fs::copy(good, bad, fs::copy_options::recursive);
    fault.make(bad);
    const auto outcome = run_tuina(
        {"scan", "--replay", bad.string(), "--out", folder / "bad.ply", "--json", "--quiet"});
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.out.empty());
    CHECK_FALSE(fs::exists(folder / "bad.ply"));
    CHECK_MESSAGE(outcome.err.find(fault.said) != std::string::npos, outcome.err);
  }
}
