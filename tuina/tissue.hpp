// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room tissue: how hard and how thick tissue is, from presses; needs no other room but core.

#include "tuina/tissue/body_condition.hpp"
#include "tuina/tissue/classification.hpp"
#include "tuina/tissue/creep_estimator.hpp"
#include "tuina/tissue/curve_fit.hpp"
#include "tuina/tissue/estimator.hpp"
#include "tuina/tissue/press_estimator.hpp"
#include "tuina/tissue/press_forecast.hpp"
#include "tuina/tissue/press_record.hpp"
#include "tuina/tissue/record_estimate.hpp"
#include "tuina/tissue/stiffness_map.hpp"
#include "tuina/tissue/tangent_model.hpp"
