// SPDX-License-Identifier: Apache-2.0
#pragma once

#define PLUGINLIB_EXPORT_CLASS(made, base) \
  static_assert(std::is_base_of_v<base, made> && std::is_default_constructible_v<made>);
