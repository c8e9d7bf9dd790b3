// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room record: files of a session, written and read.

#include "tuina/record/acupoint_file.hpp"
#include "tuina/record/channel_sink.hpp"
#include "tuina/record/languages.hpp"
#include "tuina/record/plan_file.hpp"
#include "tuina/record/session_channels.hpp"
#include "tuina/record/session_file.hpp"
#include "tuina/record/session_folder.hpp"
#include "tuina/record/session_recorder.hpp"
#include "tuina/record/session_report.hpp"
#include "tuina/record/session_tables.hpp"
