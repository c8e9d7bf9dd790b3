// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/devices/device_session.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>

#include "apps/cli/asked_to_end.hpp"
#include "apps/cli/say.hpp"
#include "apps/simulated/devices/device_arms.hpp"
#include "apps/simulated/devices/device_scanner.hpp"
#include "apps/simulated/devices/felt_recorder.hpp"
#include "apps/simulated/watched_session.hpp"

namespace tuina::app {
namespace {

constexpr const char* word_to_begin = "go";

/// Camera and turntable of a file that names arms, too.
Result<hardware::DeviceFile> read_devices(const std::string& device_file) {
  auto file = read_arms(device_file);
  if (!file || (file->camera && file->turntable)) return file;
  return fail(Fault::config, "{}: a scanner needs [camera] and [turntable]; [{}] is missing",
              device_file, file->camera ? "turntable" : "camera");
}

/// Shows the plan at the terminal, and waits for a word; whatever else is said, or an end of the
/// input, is a no.
session::Review review_at_terminal(const motion::ReadyPlan& ready, const std::string& refused) {
  using Answer = session::Review::Answer;
  double max_force_n = 0.0;
  for (const auto& planned : ready.plan.paths)
    max_force_n = std::max(max_force_n, planned.ordered_n());
  std::string text = fmt::format("plan: {} paths in {:.0f} s, at most {:.1f} N\n",
                                 ready.plan.paths.size(), ready.plan.duration_s, max_force_n);
  for (const auto& planned : ready.plan.paths)
    text += fmt::format("  {}, {:.1f} N\n", planned.path.name, planned.ordered_n());
  for (const Sentence& note : ready.plan.notes) text += fmt::format("  {}\n", note.words);
  if (!refused.empty()) text += refused + "\n";
  say(fmt::format("{}the arms move once you type `{}`; anything else ends here: ", text,
                  word_to_begin));
  // Ctrl-C is a no, too, and does not end the reading of a line.
  pollfd typed{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  while (!asked_to_end() && ::poll(&typed, 1, 50) <= 0) continue;
  if (asked_to_end()) return {.answer = Answer::no};
  std::string said;
  std::getline(std::cin, said);
  return {.answer = said == word_to_begin ? Answer::go : Answer::no};
}

}  // namespace

Result<SessionResult> run_device_session(const SessionOrder& order, const session::Config& config,
                                         const CommonOptions& common,
                                         const std::filesystem::path& record_file,
                                         const Attendant& attendant) {
  const auto file = read_devices(order.device);
  if (!file) return tl::unexpected(file.error());
  auto room = make_device_room(order, config);
  if (!room) return tl::unexpected(room.error());
  auto scanner = open_scanner(*file, room->order.calibration.camera);
  if (!scanner) return tl::unexpected(scanner.error());
  auto arms = DeviceArms::open(order.device, room->placement, "");
  if (!arms) return tl::unexpected(arms.error());
  room->order.review = review_at_terminal;

  SessionResult result{.simulated = false,
                       .person = {},
                       .consent = room->order.consent,
                       .consent_toml = room->consent_toml,
                       .realism = "real"};
  FeltRecorder felt(room->placement.arm, room->placement.mount);
  const auto done =
      run_watched({*scanner->camera, *scanner->turntable, (*arms)->robot(), arms->get()},
                  {.given = order,
                   .read = room->order,
                   .consent_toml = room->consent_toml,
                   .config = config,
                   .common = common,
                   .record_file = record_file,
                   .attendant = attendant,
                   .real_pace = !(*arms)->lock_step()},
                  {&felt}, result);
  if (!done) return tl::unexpected(done.error());
  result.devices = (*arms)->record(0);
  result.devices->scanner = scanner->called;
  result.truth = felt.finish();
  return result;
}

}  // namespace tuina::app
