// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/verbs.hpp"

namespace tuina::app {

std::vector<std::unique_ptr<Verb>> make_verbs() {
  std::vector<std::unique_ptr<Verb>> verbs;
  verbs.push_back(make_massage());
  verbs.push_back(make_scan());
  verbs.push_back(make_line());
#ifdef TUINA_CALIBRATION
  verbs.push_back(make_calibrate());
#endif
  verbs.push_back(make_plan());
  verbs.push_back(make_map());
  verbs.push_back(make_atlas_learn());
  verbs.push_back(make_atlas_show());
  verbs.push_back(make_evaluate_acupoints());
  verbs.push_back(make_tissue_fit());
  verbs.push_back(make_tissue_estimate());
  verbs.push_back(make_evaluate_tissue());
  verbs.push_back(make_evaluate_scanner());
  verbs.push_back(make_press());
  verbs.push_back(make_config_show());
  verbs.push_back(make_config_check());
  verbs.push_back(make_doctor());
  return verbs;
}

}  // namespace tuina::app
