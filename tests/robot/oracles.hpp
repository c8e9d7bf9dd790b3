// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <cstring>
#include <kdl/chain.hpp>
#include <memory>
#include <stdexcept>
#include <string>

#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/description.hpp"

// Two independent judges of the arm model, built from the same table: a KDL chain and a MuJoCo
// model.
namespace tuina::robot {

inline KDL::Frame to_kdl(const Transform& t) {
  const Matrix3 r = t.linear();
  const Vector3 p = t.translation();
  return {KDL::Rotation(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1),
                        r(2, 2)),
          KDL::Vector(p.x(), p.y(), p.z())};
}

/// KDL wants the inertia of a segment in the frame at its end, the table gives it at its joint.
inline KDL::Chain kdl_chain(const ArmTable& table, const Transform& base_from_shoulder) {
  KDL::Chain chain;
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), to_kdl(base_from_shoulder)));
  for (int i = 0; i < table.joints; ++i) {
    const Link& link = table.links[static_cast<std::size_t>(i)];
    const KDL::Frame joint_from_end = KDL::Frame(KDL::Vector(0, 0, link.d_m)) *
                                      KDL::Frame(KDL::Vector(link.a_m, 0, 0)) *
                                      KDL::Frame(KDL::Rotation::RotX(link.alpha_rad));
    const auto& c = link.com_in_joint;
    const auto& inertia = link.inertia_kg_m2;
    const auto& products = link.inertia_products_kg_m2;
    const KDL::RigidBodyInertia at_joint(
        link.mass_kg, KDL::Vector(c[0], c[1], c[2]),
        KDL::RotationalInertia(inertia[0], inertia[1], inertia[2], products[0], products[1],
                               products[2]));
    const KDL::Joint joint(link.name, KDL::Joint::RotZ, 1, 0, link.rotor_inertia_kg_m2);
    chain.addSegment(
        KDL::Segment(joint, KDL::Frame::DH(link.a_m, link.alpha_rad, link.d_m, link.offset_rad),
                     joint_from_end.Inverse() * at_joint));
  }
  Transform end_from_tool = Transform::Identity();
  end_from_tool.linear() = table.end_from_tool_turn;
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), to_kdl(end_from_tool)));
  return chain;
}

struct MujocoFree {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
  void operator()(mjData* d) const { mj_deleteData(d); }
};

/// MuJoCo's model of the robot. Friction is taken out: it is no part of M, C and G.
inline std::unique_ptr<mjModel, MujocoFree> mujoco_model(const std::string& mjcf) {
  const auto files = std::make_unique<mjVFS>();  // in memory, and large for a stack
  mj_defaultVFS(files.get());
  if (mj_makeEmptyFileVFS(files.get(), "robot.xml", static_cast<int>(mjcf.size())) != 0)
    throw std::runtime_error("MuJoCo takes no file of this size");
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), "robot.xml")], mjcf.data(), mjcf.size());
  char error[500] = "";
  std::unique_ptr<mjModel, MujocoFree> model(
      mj_loadXML("robot.xml", files.get(), error, sizeof error));
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(error);
  for (int i = 0; i < model->nv; ++i) model->dof_damping[i] = model->dof_frictionloss[i] = 0.0;
  return model;
}

}  // namespace tuina::robot
