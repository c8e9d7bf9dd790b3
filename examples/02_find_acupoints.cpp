// SPDX-License-Identifier: Apache-2.0
// Where are the acupoints of this back? Give it a scan (PLY or PCD, metres, z up from the couch),
// or nothing for a phantom whose true points are known.
#include <fmt/core.h>

#include "tuina/body.hpp"
#include "tuina/core.hpp"
#include "tuina/sim.hpp"

using namespace tuina;

namespace {

/// The seven points of the thesis, each with the radius that holds the true one in 95 % of cases.
Result<body::Mapping> find_acupoints(const PointCloud& scan_in_couch) {
  const auto atlas = body::read_atlas(TUINA_MODELS "/atlas.tuina");
  if (!atlas) return tl::unexpected(atlas.error());
  const auto back = body::fit_back(scan_in_couch);
  if (!back) return tl::unexpected(back.error());
  return body::locate_acupoints(*back, *atlas);
}

Result<void> run(const char* file) {
  PointCloud scan_in_couch;
  std::vector<Acupoint> truth;
  if (file != nullptr) {
    auto surface = read_surface(file);
    if (!surface) return tl::unexpected(surface.error());
    scan_in_couch = std::move(surface->cloud);
  } else {
    const auto person = sim::parse_person("phantom:medium", BodyPosture::sitting, 1);
    if (!person) return tl::unexpected(person.error());
    scan_in_couch.points = person->skin_in_couch.vertices;
    truth = person->acupoints;
  }

  const auto found = find_acupoints(scan_in_couch);
  if (!found) return tl::unexpected(found.error());
  fmt::print("a person {}\n",
             found->position == BodyPosture::sitting ? "who sits" : "who lies prone");
  for (std::size_t i = 0; i < seven_acupoints.size(); ++i) {
    const Acupoint& point = found->acupoints[i];
    const Vector3 at_mm = 1e3 * point.at_in_couch;
    fmt::print("{:<7} at ({:6.1f}, {:6.1f}, {:6.1f}) mm, within {:4.1f} mm", point.name, at_mm.x(),
               at_mm.y(), at_mm.z(), to_mm(point.uncertainty_m));
    if (!truth.empty()) {
      fmt::print("; truly {:.1f} mm off", (truth[i].at_in_couch - point.at_in_couch).norm() * 1e3);
    }
    fmt::print("\n");
  }
  return {};
}

}  // namespace

int main(int count, char** words) {
  const auto done = run(count > 1 ? words[1] : nullptr);
  if (!done) fmt::print(stderr, "{}\n", done.error().message);
  return done ? 0 : 2;
}
