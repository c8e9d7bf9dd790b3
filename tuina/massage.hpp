// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room massage: from a programme to the contact paths of two arms.

#include "tuina/massage/no_go.hpp"
#include "tuina/massage/plan.hpp"
#include "tuina/massage/programme.hpp"
#include "tuina/massage/schedule.hpp"
#include "tuina/massage/targets.hpp"
#include "tuina/massage/technique/contact_path.hpp"
#include "tuina/massage/technique/knead.hpp"
#include "tuina/massage/technique/press.hpp"
#include "tuina/massage/technique/rub.hpp"
#include "tuina/massage/technique/stroke.hpp"
#include "tuina/massage/technique/tap.hpp"
#include "tuina/massage/zones.hpp"
