// SPDX-License-Identifier: Apache-2.0
// Where the boards of a rehearsal were, as the report of `tuina calibrate` draws it.
#include <cstdio>
#include <filesystem>
#include <string>

#include "apps/tuina/calibrate/figures.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/sim/scanner/synthetic_shots.hpp"

using namespace tuina;
namespace fs = std::filesystem;

namespace {

Result<void> draw(const fs::path& shots, const std::string& folder) {
  const auto taken =
      sim::render_calibration_shots(sim::built_scanner(1), 1, shots, {.sweeps = false});
  if (!taken) return taken;
  calibration::Views views;
  const auto found = calibration::calibrate_folder(shots, views);
  if (!found) return tl::unexpected(found.error());
  const auto written =
      write_file(folder + "/boards_in_image.svg", app::boards_in_image(*found, views));
  if (!written) return written;
  return write_file(folder + "/boards_from_above.svg", app::boards_from_above(*found, views));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 1;
  const auto drawn = draw(argv[1], argv[2]);
  std::error_code error;
  fs::remove_all(argv[1], error);
  if (!drawn) std::fprintf(stderr, "%s\n", drawn.error().message.c_str());
  return drawn ? 0 : 1;
}
