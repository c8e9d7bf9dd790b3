// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room history: people over time.

#include "tuina/history/archive.hpp"
#include "tuina/history/change.hpp"
#include "tuina/history/history.hpp"
#include "tuina/history/person_history.hpp"
#include "tuina/history/remembered.hpp"
#include "tuina/history/visit.hpp"
