// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "python/module/parts.hpp"

namespace tuina::python {

/// Messages of ROS 2, in CDR, as values of Python: a dict of arrays where each message is a row,
/// else a list of dicts. Returns the index of the first message that is not of that schema, if any;
/// a schema that is not known gives a list of bytes.
[[nodiscard]] std::optional<std::size_t> columns_of(const std::string& schema,
                                                    const std::vector<double>& time_s,
                                                    const std::vector<std::string>& messages,
                                                    py::object& values);

}  // namespace tuina::python
