// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room body: from a cloud to a back, and from an atlas to its acupoints.

#include "tuina/body/acupoints.hpp"
#include "tuina/body/atlas.hpp"
#include "tuina/body/back_surface.hpp"
#include "tuina/body/correction.hpp"
#include "tuina/body/field_morphing.hpp"
#include "tuina/body/learn/labelled_body.hpp"
#include "tuina/body/learn/learn_shape.hpp"
#include "tuina/body/palpation.hpp"
#include "tuina/body/shape_model.hpp"
