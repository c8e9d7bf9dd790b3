// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/program.hpp"
#include "apps/tuina/verbs.hpp"

int main(int argc, char** argv) {
  using namespace tuina::app;
  // Experiments are a program of their own: who wants a massage need not build them.
  return run_program(
      argc, argv,
      {.verbs = make_verbs(),
       .beside = {{"press", "one contact experiment: one arm, one technique, a patch of tissue",
                   "tuina-evaluate"},
                  {"evaluate", "the tables of the documentation, judged against the truth",
                   "tuina-evaluate"}},
       .summary_of_group = summary_of_group});
}
