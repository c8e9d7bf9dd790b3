// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/acupoints.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <string>
#include <string_view>

#include "apps/simulated/labelled_phantom.hpp"
#include "tests/reason.hpp"
#include "tuina/baselines/acupoint_baselines.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

const Atlas& shipped() {
  static const Atlas atlas = [] {
    auto read = read_atlas(TUINA_SOURCE_DIR "/models/atlas.tuina");
    REQUIRE_MESSAGE(read.has_value(), test::reason(read));
    return std::move(*read);
  }();
  return atlas;
}

LabelledBody phantom(BodyPosture position, std::uint64_t seed = 77) {
  return app::labelled(sim::make_phantom(sim::draw_phantom(seed), position));
}

PointCloud scan_of(const LabelledBody& person) {
  return sample(person.skin_in_couch, 5_mm);
}

PointCloud moved(PointCloud cloud, const Transform& motion) {
  for (Vector3& p : cloud.points) p = motion * p;
  return cloud;
}

Transform turn(double angle_rad, const Vector3& shift = Vector3::Zero()) {
  Transform motion = Transform::Identity();
  motion.translate(shift);
  motion.rotate(Eigen::AngleAxisd(angle_rad, Vector3::UnitZ()));
  return motion;
}

Result<Mapping> map(const PointCloud& cloud, Method method = Method::surface) {
  const auto back = fit_back(cloud);
  if (!back) return tl::unexpected(back.error());
  return locate_acupoints(*back, shipped(), method);
}

/// Mean distance of the seven points found on a back from where they are.
double error_of_seven_mm(const BackSurface& back, const Atlas& atlas, const LabelledBody& person) {
  const auto found = locate_acupoints(back, atlas);
  REQUIRE(found);
  double sum = 0.0;
  for (std::size_t i = 0; i < 7; ++i) {
    sum += to_mm((found->acupoints[i].at_in_couch - person.acupoints[i].at_in_couch).norm());
  }
  return sum / 7.0;
}

template <typename Kept>
PointCloud only(const PointCloud& cloud, const Kept& kept) {
  PointCloud part;
  std::copy_if(cloud.points.begin(), cloud.points.end(), std::back_inserter(part.points), kept);
  return part;
}

}  // namespace

TEST_CASE("the points of a fresh phantom are found in both positions by both methods") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    for (const Method method : {Method::surface, Method::field_morphing}) {
      const LabelledBody person = phantom(position);
      const auto found = map(scan_of(person), method);
      REQUIRE_MESSAGE(found.has_value(), test::reason(found));
      CHECK(found->position == position);
      double sum_mm = 0.0;
      for (std::size_t i = 0; i < seven_acupoints.size(); ++i) {
        REQUIRE(found->acupoints[i].name == seven_acupoints[i]);
        CHECK(std::abs(found->acupoints[i].normal_in_couch.norm() - 1.0) < 1e-9);
        CHECK(found->acupoints[i].uncertainty_m > 1_mm);
        sum_mm +=
            to_mm((found->acupoints[i].at_in_couch - person.acupoints[i].at_in_couch).norm()) / 7.0;
      }
      CHECK(sum_mm < (method == Method::surface ? 12.0 : 30.0));
    }
  }
}

TEST_CASE(
    "where on the couch the person is carries no information: the points move with the cloud") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    const PointCloud cloud = scan_of(phantom(position));
    const auto here = map(cloud);
    const Transform motion = turn(12_deg, Vector3(0.08, -0.06, 0.0));
    const auto there = map(moved(cloud, motion));
    REQUIRE(here);
    REQUIRE(there);
    for (std::size_t i = 0; i < here->acupoints.size(); ++i) {
      CHECK((motion * here->acupoints[i].at_in_couch - there->acupoints[i].at_in_couch).norm() <
            0.5_mm);
    }
  }
}

TEST_CASE("a lying person may have the head at either end of the bed") {
  const PointCloud cloud = scan_of(phantom(BodyPosture::prone));
  const auto usual = map(cloud);
  const Transform half_turn = turn(pi);
  const auto other = map(moved(cloud, half_turn));
  REQUIRE(usual);
  REQUIRE(other);
  for (std::size_t i = 0; i < usual->acupoints.size(); ++i) {
    CHECK((half_turn * usual->acupoints[i].at_in_couch - other->acupoints[i].at_in_couch).norm() <
          0.5_mm);
  }
}

TEST_CASE(
    "half a metre of a lying person with raised arms, wider than long, is laid along the bed") {
  const LabelledBody person = phantom(BodyPosture::prone);
  double waist = 0.0;
  double neck = 0.0;
  for (const Landmark& landmark : person.landmarks) {
    if (landmark.name == "C7") neck = landmark.at_in_couch.y();
    if (landmark.name == "sacrum_S2") waist = landmark.at_in_couch.y();
  }
  const PointCloud part = only(scan_of(person), [&](const Vector3& p) {
    return p.y() > neck - 20_mm && p.y() < std::min(waist, neck + 0.5);
  });
  const auto found = map(part);
  REQUIRE_MESSAGE(found.has_value(), test::reason(found));
  for (std::size_t i = 0; i < seven_acupoints.size(); ++i) {
    CHECK((found->acupoints[i].at_in_couch - person.acupoints[i].at_in_couch).norm() <
          found->acupoints[i].uncertainty_m + 2_mm);
  }
}

TEST_CASE("a noisy scan with flying pixels and the couch in view gives the same points") {
  const LabelledBody person = phantom(BodyPosture::sitting);
  PointCloud cloud = scan_of(person);
  Random random = make_random(5, "camera");
  for (Vector3& p : cloud.points) p += Vector3(0.0, gaussian(random, 3_mm), 0.0);
  for (int i = 0; i < 300; ++i) {
    cloud.points.emplace_back(uniform(random, -0.4, 0.4), uniform(random, -0.4, 0.4),
                              uniform(random, 0.0, 1.0));
  }
  for (int i = 0; i < 8000; ++i) {
    cloud.points.emplace_back(uniform(random, -0.3, 0.3), uniform(random, -0.3, 0.3),
                              gaussian(random, 3_mm));
  }
  const auto clean = map(scan_of(person));
  const auto noisy = map(cloud);
  REQUIRE(clean);
  REQUIRE_MESSAGE(noisy.has_value(), test::reason(noisy));
  for (std::size_t i = 0; i < 7; ++i) {
    CHECK((clean->acupoints[i].at_in_couch - noisy->acupoints[i].at_in_couch).norm() < 8_mm);
  }
}

TEST_CASE("the less of a back is in view, the wider are the radii of what is") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    CAPTURE(name_of(position));
    const LabelledBody person = phantom(position);
    const PointCloud whole = scan_of(person);
    const auto height = [&](const Vector3& p) {
      return position == BodyPosture::sitting ? p.z() : -p.y();
    };
    const double gv4 = height(person.acupoints[6].at_in_couch);
    REQUIRE(person.acupoints[6].name == "GV4");
    const auto all = map(whole);
    const auto part = map(only(whole, [&](const Vector3& p) { return height(p) > gv4 - 0.02; }));
    REQUIRE_MESSAGE(all.has_value(), test::reason(all));
    REQUIRE_MESSAGE(part.has_value(), test::reason(part));
    CHECK(all->coverage > 0.97);
    CHECK(part->coverage < 0.90);
    for (std::size_t i = 0; i < 7; ++i) {
      CAPTURE(all->acupoints[i].name);
      CHECK(part->acupoints[i].uncertainty_m > 1.15 * all->acupoints[i].uncertainty_m);
    }
  }
}

TEST_CASE("what is no whole back is refused, with the cause") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    CAPTURE(name_of(position));
    const PointCloud cloud = scan_of(phantom(position));
    const bool sitting = position == BodyPosture::sitting;
    double head = -1e9;
    double centre = 0.0;
    const auto height = [&](const Vector3& p) { return sitting ? p.z() : -p.y(); };
    for (const Vector3& p : cloud.points) {
      head = std::max(head, height(p));
      centre += p.x() / static_cast<double>(cloud.size());
    }
    const auto cause = [](const PointCloud& scan) {
      const auto found = map(scan);
      return found ? std::string("answered") : found.error().message;
    };
    const auto says = [&](const PointCloud& scan, std::string_view words) {
      const std::string message = cause(scan);
      CAPTURE(words);
      CHECK_MESSAGE(message.find(words) != std::string::npos, message);
    };
    const auto changed = [&](const auto& change) {
      PointCloud other = cloud;
      for (Vector3& p : other.points) change(p);
      return other;
    };
    says(PointCloud{}, "no person found");
    for (const double side : {-1.0, 1.0}) {
      const std::string half =
          cause(only(cloud, [&](const Vector3& p) { return side * (p.x() - centre) > 0.0; }));
      CHECK_MESSAGE((half.starts_with("less than a back") || half.starts_with("no whole back") ||
                     half.starts_with("no shoulders found")),
                    half);
    }
    const auto says_less = [&](const PointCloud& scan) {
      const std::string less = cause(scan);
      CHECK_MESSAGE((less.starts_with("less than a back") || less.starts_with("no whole back")),
                    less);
    };
    says_less(only(cloud, [&](const Vector3& p) { return height(p) < head - 0.50; }));
    says_less(only(cloud, [&](const Vector3& p) { return height(p) > head - 0.38; }));
    says(changed([](Vector3& p) { p *= 1000.0; }), "millimetres");
    says(changed([](Vector3& p) { p *= 100.0; }), "centimetres");
    const auto hollow = [&](Vector3& p) {
      if (sitting) {
        p.y() = -p.y();
      } else {
        p.z() = 0.35 - p.z();
      }
    };
    says(changed(hollow), "mirrored");
    says(changed([](Vector3& p) { p.z() -= 0.6; }),
         sitting ? "less than a back" : "no person found");
    for (const double angle : {50_deg, 90_deg, -70_deg}) {
      // Somebody who sits and is seen from the side shows no more than half a back.
      if (sitting && angle != 50_deg) {
        says_less(moved(cloud, turn(angle)));
      } else {
        says(moved(cloud, turn(angle)), "turned by");
      }
    }
    PointCloud two = cloud;
    for (const Vector3& p : cloud.points) two.points.push_back(p + Vector3(1.1, 0.0, 0.0));
    says(two, "two people");
    // The couch in view changes no cause.
    PointCloud bed = cloud;
    for (double x = -0.45; x < 0.45; x += 0.01) {
      for (double y = -0.9; y < 0.9; y += 0.01)
        bed.points.emplace_back(x, sitting ? 0.3 * y : y, 0.0);
    }
    CHECK(map(bed));
    for (Vector3& p : bed.points) hollow(p);
    says(bed, "mirrored");
  }
}

TEST_CASE("the scan of a sitting person with z down is refused as what it is") {
  for (const std::uint64_t seed : {77U, 78U, 79U, 80U}) {
    CAPTURE(seed);
    PointCloud cloud = scan_of(phantom(BodyPosture::sitting, seed));
    CHECK(map(cloud).has_value());
    // Half round about the line of sight, which is no mirror.
    for (Vector3& p : cloud.points) p = Vector3(-p.x(), p.y(), 1.05 - p.z());
    const auto found = map(cloud);
    REQUIRE_FALSE(found.has_value());
    INFO(found.error().message);
    CHECK(found.error().message.find("the back is upside down") != std::string::npos);
  }
}

TEST_CASE("a rucksack, long hair or an arm across the back is refused or said in the radius") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    const LabelledBody person = phantom(position);
    const bool sitting = position == BodyPosture::sitting;
    std::map<std::string, Vector3> at;
    for (const Landmark& landmark : person.landmarks) at[landmark.name] = landmark.at_in_couch;
    const Vector3 along = (at["C7"] - at["sacrum_S2"]).normalized();
    const Vector3 across = (at["scapula_root_L"] - at["scapula_root_R"]).normalized();
    const Vector3 out = sitting ? Vector3::UnitY() : Vector3::UnitZ();
    // What lies on the skin hides it: the points there are seen nearer to the scanner.
    const auto covered = [&](const Vector3& middle, double half_wide_m, double half_high_m,
                             double thick_m) {
      PointCloud cloud = scan_of(person);
      for (Vector3& p : cloud.points) {
        const Vector3 off = p - middle;
        if (std::abs(off.dot(across)) > half_wide_m || std::abs(off.dot(along)) > half_high_m)
          continue;
        p += thick_m * out;
      }
      return cloud;
    };
    const std::map<std::string, PointCloud> scans = {
        {"rucksack", covered(at["T7"], 0.14, 0.2, 0.12)},
        {"hair", covered(at["C7"] + 0.05 * along, 0.11, 0.15, 0.03)},
        {"arm across", covered(at["T12"], 0.4, 0.045, 0.07)}};
    for (const auto& [what, cloud] : scans) {
      const auto found = map(cloud);
      CAPTURE(what);
      CAPTURE(name_of(position));
      if (!found) {
        CHECK_MESSAGE(found.error().message.find_first_of("0123456789") != std::string::npos,
                      found.error().message);
        continue;
      }
      for (std::size_t i = 0; i < seven_acupoints.size(); ++i) {
        // Of what covers a point only the height is wrong: the place on the back counts.
        Vector3 off = found->acupoints[i].at_in_couch - person.acupoints[i].at_in_couch;
        off -= off.dot(out) * out;
        CAPTURE(seven_acupoints[i]);
        CHECK(off.norm() < 3.0 * found->acupoints[i].uncertainty_m);
      }
    }
  }
}

TEST_CASE("an atlas survives its file, and a damaged file is refused") {
  const std::string bytes = to_bytes(shipped());
  const auto again = parse_atlas(bytes, "atlas");
  REQUIRE(again);
  CHECK(to_bytes(*again).size() == bytes.size());
  CHECK(again->positions.size() == 2);
  std::string damaged = bytes;
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 1);
  CHECK(parse_atlas(damaged, "atlas").error().message.find("checksum") != std::string::npos);
  CHECK_FALSE(parse_atlas(bytes.substr(0, bytes.size() - 1), "atlas"));
  CHECK_FALSE(parse_atlas("ply", "atlas"));
}

TEST_CASE("one labelled body makes an atlas of one that finds its own points") {
  const LabelledBody person = phantom(BodyPosture::sitting, 5);
  const auto atlas = learn_atlas({person}, nullptr, {}, nullptr);
  REQUIRE(atlas);
  for (const Method method : {Method::surface, Method::field_morphing}) {
    const auto back = fit_back(scan_of(person));
    REQUIRE(back);
    const auto found = locate_acupoints(*back, *atlas, method);
    REQUIRE(found);
    for (std::size_t i = 0; i < 7; ++i) {
      CHECK((found->acupoints[i].at_in_couch - person.acupoints[i].at_in_couch).norm() < 4_mm);
    }
  }
}

TEST_CASE("a few labelled people teach the shipped atlas what a therapist marks differently") {
  // This therapist marks everything 12 mm nearer to the head.
  const auto marked = [](std::uint64_t seed) {
    LabelledBody person = phantom(BodyPosture::sitting, seed);
    for (Acupoint& point : person.acupoints) point.at_in_couch.z() += 12_mm;
    return person;
  };
  std::vector<LabelledBody> people;
  for (std::uint64_t seed = 400; seed < 405; ++seed) people.push_back(marked(seed));
  const auto adapted = learn_atlas(people, &shipped(), {}, nullptr);
  REQUIRE(adapted);
  const LabelledBody another = marked(77);
  const auto back = fit_back(scan_of(another));
  REQUIRE(back);
  CHECK(error_of_seven_mm(*back, *adapted, another) <
        0.7 * error_of_seven_mm(*back, shipped(), another));
  CHECK(adapted->of(BodyPosture::sitting)->shape.bodies == 45);
}

TEST_CASE("five people who all look alike do not spoil the shipped atlas for others") {
  // All five are heavy and built alike, as nobody among the others is.
  std::vector<LabelledBody> people;
  for (std::uint64_t seed = 400; seed < 405; ++seed) {
    sim::PhantomShape shape = sim::draw_phantom(seed);
    shape.bmi = 30.0;
    shape.build.fill(2.0);
    people.push_back(app::labelled(sim::make_phantom(shape, BodyPosture::sitting)));
  }
  const auto adapted = learn_atlas(people, &shipped(), {}, nullptr);
  REQUIRE(adapted);
  double shipped_mm = 0.0;
  double adapted_mm = 0.0;
  for (std::uint64_t seed = 77; seed < 81; ++seed) {
    const LabelledBody other = phantom(BodyPosture::sitting, seed);
    const auto back = fit_back(scan_of(other));
    REQUIRE(back);
    shipped_mm += error_of_seven_mm(*back, shipped(), other) / 4.0;
    adapted_mm += error_of_seven_mm(*back, *adapted, other) / 4.0;
  }
  CAPTURE(shipped_mm);
  CHECK(adapted_mm < shipped_mm + 1.5);
}

TEST_CASE("simpler methods find the seven points of a phantom, less well than the surface does") {
  const LabelledBody person = phantom(BodyPosture::sitting, 31);
  const auto back = fit_back(scan_of(person));
  REQUIRE(back);
  const auto error_mm = [&](const Result<Mapping>& found) {
    REQUIRE_MESSAGE(found.has_value(), test::reason(found));
    double sum = 0.0;
    for (std::size_t i = 0; i < seven_acupoints.size(); ++i) {
      REQUIRE(found->acupoints[i].name == seven_acupoints[i]);
      sum += to_mm((found->acupoints[i].at_in_couch - person.acupoints[i].at_in_couch).norm());
    }
    return sum / 7.0;
  };
  const double surface = error_mm(locate_acupoints(*back, shipped()));
  for (const double simpler : {error_mm(baselines::rigid_icp(*back, shipped())),
                               error_mm(baselines::scale_axes(*back, shipped())),
                               error_mm(baselines::cun_rule(*back, shipped()))}) {
    CHECK(simpler < 50.0);
    CHECK(simpler > surface);
  }
}

}  // namespace tuina::body
