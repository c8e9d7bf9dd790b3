// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/classification.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace tuina;
using namespace tuina::tissue;

namespace {

TissueEstimate measured(const TangentTissue& tissue, double share = 0.03) {
  return {.tissue = tissue,
          .alpha_ci95_n = share * tissue.alpha_n,
          .beta_ci95_per_m = share * tissue.beta_per_m,
          .presses = 2,
          .converged = true};
}

std::vector<Subject> all_but(std::size_t left_out) {
  std::vector<Subject> rest;
  for (std::size_t i = 0; i < table_6_2().size(); ++i) {
    if (i != left_out) rest.push_back(table_6_2()[i]);
  }
  return rest;
}

}  // namespace

TEST_CASE("a person left out of Table 6-2 is classified by the others") {
  int right = 0;
  for (std::size_t i = 0; i < 7; ++i) {
    const auto rest = all_but(i);
    for (std::size_t k = 0; k < 3; ++k) {
      const TissueEstimate estimate = measured(table_6_2()[i].tissue[k]);
      const Classification found = classify(estimate, 1.0, nothing_known, rest);
      const auto best = std::max_element(found.of.begin(), found.of.end());
      right += static_cast<std::size_t>(best - found.of.begin()) == k;
    }
  }
  MESSAGE("Table 6-2, one person left out: " << right << " of 21");
  CHECK(right >= 14);
}

TEST_CASE("an estimate that is not converged, or not of this law, is unknown") {
  TissueEstimate estimate = measured({11.0, 230.0});
  CHECK(classify(estimate).label == TissueClass::hard);
  CHECK(classify(estimate, 5.0).label == TissueClass::unknown);
  estimate.converged = false;
  CHECK(classify(estimate).label == TissueClass::unknown);
}

TEST_CASE(
    "every tissue of the thesis' two tables is most likely what the thesis calls it, or a close "
    "second") {
  int right = 0;
  for (const Subject& subject : tables_6_1_and_6_2()) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Classification found = classify(measured(subject.tissue[k]));
      right += found.label == static_cast<TissueClass>(k);
      CHECK(found.of[k] > 0.1);
    }
  }
  MESSAGE("Tables 6-1 and 6-2, not left out: " << right << " of 24 named and right");
  CHECK(right >= 14);
}

TEST_CASE("a tissue unlike any of the three is not forced into one of them") {
  const Classification found = classify(measured({60.0, 900.0}));
  CHECK(found.label == TissueClass::unknown);
}

TEST_CASE(
    "bone and soft muscle are close in the table, and the place on the body decides between them") {
  const TissueEstimate between = measured({4.3, 250.0});
  const Classification open = classify(between);
  CHECK(open.of[1] < 0.05);
  const Classification over_a_rib = classify(between, 1.0, {0.9, 0.05, 0.05});
  const Classification at_the_loin = classify(between, 1.0, {0.05, 0.05, 0.9});
  CHECK(over_a_rib.label == TissueClass::bone);
  CHECK(at_the_loin.of[2] > open.of[2]);
}

TEST_CASE("probabilities sum to one, whatever the estimate") {
  for (double alpha = 0.1; alpha < 300.0; alpha *= 2.0) {
    for (double beta = 20.0; beta < 3000.0; beta *= 2.0) {
      const Classification found = classify(measured({alpha, beta}));
      CHECK(found.of[0] + found.of[1] + found.of[2] == doctest::Approx(1.0));
      CHECK(found.probability >= 0.0);
      CHECK(found.probability <= 1.0);
    }
  }
}
