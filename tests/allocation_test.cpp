// SPDX-License-Identifier: Apache-2.0
#include "tests/allocation.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <memory>

TEST_CASE("the allocation counter sees new, malloc and Eigen's own memory") {
  const auto count = [](auto&& work) {
    const std::size_t before = tuina::test::allocations();
    work();
    return tuina::test::allocations() - before;
  };
  volatile int size = 7;
  CHECK(count([&] { const auto box = std::make_unique<int[]>(static_cast<std::size_t>(size)); }) ==
        1);
  CHECK(count([&] { const Eigen::VectorXd vector = Eigen::VectorXd::Zero(size); }) == 1);
  CHECK(count([&] {
          using AtMostSeven = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 7, 1>;
          size = static_cast<int>(AtMostSeven::Zero(size).size());
        }) == 0);
}
