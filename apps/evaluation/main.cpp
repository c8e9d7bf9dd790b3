// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/program.hpp"
#include "apps/evaluation/verbs.hpp"

int main(int argc, char** argv) {
  using namespace tuina::app;
  return run_program(
      argc, argv,
      {.verbs = make_evaluations(), .summary_of_group = [](std::string_view) {
         return std::string("the tables of the documentation, judged against the truth");
       }});
}
