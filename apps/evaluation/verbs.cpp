// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/verbs.hpp"

namespace tuina::app {

std::vector<std::unique_ptr<Verb>> make_evaluations() {
  std::vector<std::unique_ptr<Verb>> verbs;
  verbs.push_back(make_press());
#ifdef TUINA_CALIBRATION
  verbs.push_back(make_evaluate_calibration());
#endif
  verbs.push_back(make_evaluate_acupoints());
  verbs.push_back(make_evaluate_atlas());
  verbs.push_back(make_evaluate_tissue());
  verbs.push_back(make_evaluate_scanner());
  verbs.push_back(make_evaluate_control());
  verbs.push_back(make_evaluate_armlink());
  verbs.push_back(make_evaluate_all());
  verbs.push_back(make_evaluate_massage());
  verbs.push_back(make_evaluate_teach());
  verbs.push_back(make_evaluate_robots());
  verbs.push_back(make_evaluate_history());
  verbs.push_back(make_evaluate_processes());
  verbs.push_back(make_evaluate_safety());
  verbs.push_back(make_evaluate_merge());
  return verbs;
}

}  // namespace tuina::app
