// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/tuina/mount/plate.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

/// Lines of a STEP file, each an entity with a number of its own.
class StepData {
 public:
  int add(const std::string& entity) {
    text_ += fmt::format("#{}={};\n", ++last_, entity);
    return last_;
  }
  int point(const Vector3& at_m) {
    return add(fmt::format("CARTESIAN_POINT('',({:.5f},{:.5f},{:.5f}))", to_mm(at_m.x()),
                           to_mm(at_m.y()), to_mm(at_m.z())));
  }
  int direction(const Vector3& unit) {
    return add(fmt::format("DIRECTION('',({:.9f},{:.9f},{:.9f}))", unit.x(), unit.y(), unit.z()));
  }
  int axes(int point, const Vector3& z, const Vector3& x) {
    const int up = direction(z), right = direction(x);
    return add(fmt::format("AXIS2_PLACEMENT_3D('',#{},#{},#{})", point, up, right));
  }
  int loop(const std::vector<int>& points) {
    return add(fmt::format("POLY_LOOP('',({}))", list(points)));
  }
  /// A plane face between these loops, the outer one first.
  int face(const std::vector<int>& loops, int axes) {
    std::vector<int> bounds;
    bounds.reserve(loops.size());
    for (const int loop : loops)
      bounds.push_back(
          add(fmt::format("FACE_{}BOUND('',#{},.T.)", bounds.empty() ? "OUTER_" : "", loop)));
    const int plane = add(fmt::format("PLANE('',#{})", axes));
    return add(fmt::format("FACE_SURFACE('',({}),#{},.T.)", list(bounds), plane));
  }
  [[nodiscard]] static std::string list(const std::vector<int>& numbers) {
    return fmt::format("#{}", fmt::join(numbers, ",#"));
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
  int last_ = 0;
};

Vector3 lifted(const Vector2& at, double z_m) {
  return {at.x(), at.y(), z_m};
}

/// The solid: its lid, its bottom, and a face for each edge of its outline and windows.
int solid_of(const Plate& plate, StepData& step) {
  std::vector<int> faces, lids, bottoms;
  std::vector<Outline> outlines = {plate.outline};
  outlines.insert(outlines.end(), plate.windows.begin(), plate.windows.end());
  for (const Outline& outline : outlines) {
    std::vector<int> low, high;
    for (const Vector2& at : outline) {
      low.push_back(step.point(lifted(at, 0.0)));
      high.push_back(step.point(lifted(at, plate.thickness_m)));
    }
    lids.push_back(step.loop(high));
    bottoms.push_back(step.loop({low.rbegin(), low.rend()}));
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const std::size_t k = (i + 1) % outline.size();
      const Vector2 along = (outline[k] - outline[i]).normalized();
      const int axes = step.axes(low[i], Vector3(along.y(), -along.x(), 0.0),
                                 Vector3(along.x(), along.y(), 0.0));
      faces.push_back(step.face({step.loop({low[i], low[k], high[k], high[i]})}, axes));
    }
  }
  const auto lid = [&](const std::vector<int>& loops, double z_m, double up) {
    const int origin = step.point(Vector3(0.0, 0.0, z_m));
    faces.push_back(step.face(loops, step.axes(origin, up * Vector3::UnitZ(), Vector3::UnitX())));
  };
  lid(lids, plate.thickness_m, 1.0);
  lid(bottoms, 0.0, -1.0);
  const int shell = step.add(fmt::format("CLOSED_SHELL('',({}))", StepData::list(faces)));
  return step.add(fmt::format("FACETED_BREP('{}',#{})", plate.name, shell));
}

}  // namespace

std::string to_stl(const Plate& plate) {
  std::string text = fmt::format("solid {}\n", plate.name);
  const auto facet = [&](const Vector3& a, const Vector3& b, const Vector3& c) {
    const Vector3 normal = (b - a).cross(c - a).normalized();
    text += fmt::format("facet normal {:.6f} {:.6f} {:.6f}\nouter loop\n", normal.x(), normal.y(),
                        normal.z());
    for (const Vector3& corner : {a, b, c})
      text += fmt::format("vertex {:.5f} {:.5f} {:.5f}\n", to_mm(corner.x()), to_mm(corner.y()),
                          to_mm(corner.z()));
    text += "endloop\nendfacet\n";
  };
  const Covered covered = cover(plate);
  for (const auto& triangle : covered.triangles) {
    const auto corner = [&](std::size_t i, double z_m) {
      return lifted(covered.corners[static_cast<std::size_t>(triangle.at(i))], z_m);
    };
    const double lid_m = plate.thickness_m;
    facet(corner(0, lid_m), corner(1, lid_m), corner(2, lid_m));
    facet(corner(2, 0.0), corner(1, 0.0), corner(0, 0.0));
  }
  std::vector<Outline> outlines = {plate.outline};
  outlines.insert(outlines.end(), plate.windows.begin(), plate.windows.end());
  for (const Outline& outline : outlines) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Vector2& a = outline[i];
      const Vector2& b = outline[(i + 1) % outline.size()];
      const Vector3 high_b = lifted(b, plate.thickness_m);
      facet(lifted(a, 0.0), lifted(b, 0.0), high_b);
      facet(lifted(a, 0.0), high_b, lifted(a, plate.thickness_m));
    }
  }
  return text + fmt::format("endsolid {}\n", plate.name);
}

std::string to_step(const Plate& plate) {
  StepData step;
  const int solid = solid_of(plate, step);
  const int world = step.axes(step.point(Vector3::Zero()), Vector3::UnitZ(), Vector3::UnitX());
  const int mm = step.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
  const int radian = step.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
  const int steradian = step.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
  const int exact = step.add(fmt::format(
      "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-04),#{},'distance_accuracy_value','')",
      mm));
  const int context = step.add(
      fmt::format("(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{}))"
                  "GLOBAL_UNIT_ASSIGNED_CONTEXT((#{},#{},#{}))REPRESENTATION_CONTEXT('',''))",
                  exact, mm, radian, steradian));
  const int shape = step.add(fmt::format("FACETED_BREP_SHAPE_REPRESENTATION('{}',(#{},#{}),#{})",
                                         plate.name, world, solid, context));
  const int application = step.add("APPLICATION_CONTEXT('automotive design')");
  (void)step.add(fmt::format(
      "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#{})",
      application));
  const int part = step.add(fmt::format("PRODUCT_CONTEXT('',#{},'mechanical')", application));
  const int product = step.add(fmt::format("PRODUCT('{0}','{0}','',(#{1}))", plate.name, part));
  const int version = step.add(fmt::format("PRODUCT_DEFINITION_FORMATION('','',#{})", product));
  const int design = step.add(
      fmt::format("PRODUCT_DEFINITION_CONTEXT('part definition',#{},'design')", application));
  const int definition =
      step.add(fmt::format("PRODUCT_DEFINITION('','',#{},#{})", version, design));
  const int its_shape = step.add(fmt::format("PRODUCT_DEFINITION_SHAPE('','',#{})", definition));
  (void)step.add(fmt::format("SHAPE_DEFINITION_REPRESENTATION(#{},#{})", its_shape, shape));
  return fmt::format(
      "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
      "FILE_NAME('{}.step','',(''),(''),'','tuina','');\n"
      "FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));\nENDSEC;\nDATA;\n{}"
      "ENDSEC;\nEND-ISO-10303-21;\n",
      plate.name, step.text());
}

}  // namespace tuina::app
