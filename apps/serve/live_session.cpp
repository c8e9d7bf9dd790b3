// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/live_session.hpp"

#include <algorithm>
#include <chrono>

#include "apps/cli/asked_to_end.hpp"
#include "apps/serve/shown_sentence.hpp"
#include "tuina/core/io/file.hpp"

namespace tuina::app {

namespace {

Sentence not_in_history(const Error& error) {
  return {.words = "not in the history: " + error.message, .key = "not_in_history"};
}

/// What has changed since the session before, or why this one did not join the others.
void add_changes(Result<std::vector<Sentence>> changes, std::vector<SentenceLine>& said) {
  if (!changes) return said.push_back({not_in_history(changes.error())});
  for (Sentence& one : *changes) said.push_back({std::move(one)});
}

}  // namespace

const char* name_of(LivePhase phase) noexcept {
  constexpr const char* names[] = {"idle",   "scan",    "map",    "plan",
                                   "review", "massage", "report", "ended"};
  return names[static_cast<std::size_t>(phase)];
}

LiveSession::~LiveSession() {
  stop();
  if (thread_.joinable()) thread_.join();
}

std::string LiveSession::next_number() const {
  // The number of a session that was not begun is not given again: a page knows sessions by it.
  constexpr std::size_t max_number_size = 6;  // as in page_files.cpp
  int last = number_.empty() ? 0 : std::stoi(number_);
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(options_.folder, none)) {
    const std::string name = entry.path().filename().string();
    const bool number = !name.empty() && name.size() <= max_number_size &&
                        std::all_of(name.begin(), name.end(),
                                    [](char letter) { return letter >= '0' && letter <= '9'; });
    if (number) last = std::max(last, std::stoi(name));
  }
  return fmt::format("{:04}", last + 1);
}

Result<void> LiveSession::start(StartOrder start) {
  if (options_.ordered)
    return fail(Fault::usage, "this page shows the one session that was ordered at the terminal");
  if (!start.who.empty() && !options_.people.begin)
    return fail(Fault::usage, "who: this server keeps no history of people (--history)");
  const std::lock_guard lock(mutex_);
  if (phase_ != LivePhase::idle && phase_ != LivePhase::ended)
    return fail(Fault::usage, "a session is running");
  const std::string number = next_number();
  const std::filesystem::path folder = folder_of(options_, number);
  std::error_code fault;
  if (!std::filesystem::create_directory(folder, fault))
    return fail(Fault::file, "{}: cannot be made: {}", folder.string(), fault.message());
  // The session before has ended, so its thread does at once.
  if (thread_.joinable()) thread_.join();
  begin(number);
  thread_ = std::thread(
      [this, folder, start = std::move(start)]() mutable { run(std::move(start), folder); });
  return {};
}

// The mutex is held, and no session runs.
void LiveSession::begin(const std::string& number) {
  commands_.clear();
  paused_ = false;
  review_.reset();
  by_hand_ = asked_by_hand_ = {};
  phase_ = LivePhase::scan;
  number_ = number;
  outcome_.clear(), said_.clear();
  recorded_ = false;
  view_ = std::make_shared<LiveView>(options_.robot_model);
}

void LiveSession::begin_ordered() {
  const std::lock_guard lock(mutex_);
  begin("0001");
}

Attendant LiveSession::attendant() {
  if (options_.channels != nullptr) options_.channels->begin_session();
  return {.watches = view_.get(),
          .channels = options_.channels,
          .commands = [this](double) { return commands_.next(); },
          .reviews = [this](const motion::ReadyPlan& plan,
                            const std::string& refused) { return wait_for_review(plan, refused); },
          .ends_scan = [this] { return commands_.stopped(); }};
}

// The mutex is held.
Result<void> LiveSession::waits_for(std::optional<std::uint64_t> review, const char* what) const {
  if (phase_ != LivePhase::review || review_)
    return fail(Fault::usage, "no plan waits to be {}", what);
  if (review && *review != reviews_) return fail(Fault::usage, "{}", another_plan);
  return {};
}

Result<void> LiveSession::approve(std::optional<std::uint64_t> review) {
  const std::lock_guard lock(mutex_);
  if (auto waits = waits_for(review, "approved"); !waits) return waits;
  review_ = session::Review{.answer = session::Review::Answer::go};
  answered_.notify_all();
  return {};
}

Result<void> LiveSession::change(session::ByHand wanted, std::optional<std::uint64_t> review) {
  const std::lock_guard lock(mutex_);
  if (auto waits = waits_for(review, "changed"); !waits) return waits;
  asked_by_hand_ = wanted;
  review_ = session::Review{.answer = session::Review::Answer::change, .wanted = std::move(wanted)};
  answered_.notify_all();
  return {};
}

Result<void> LiveSession::command(session::LiveCommand command) {
  const std::lock_guard lock(mutex_);
  if (phase_ != LivePhase::massage) return fail(Fault::usage, "no massage is running");
  if (!commands_.push(command)) return fail(Fault::usage, "too many commands at once");
  if (command == session::LiveCommand::pause) paused_ = true;
  if (command == session::LiveCommand::resume) paused_ = false;
  return {};
}

void LiveSession::stop() {
  commands_.stop();
  const std::lock_guard lock(mutex_);
  answered_.notify_all();
}

LiveSession::State LiveSession::state() const {
  const std::lock_guard lock(mutex_);
  State state{.phase = phase_,
              .paused = paused_,
              .session = number_,
              .outcome = outcome_,
              .said = said_,
              .recorded = recorded_,
              .reviews = reviews_,
              .progress = {}};
  if (view_) state.progress = view_->progress();
  if (phase_ == LivePhase::scan && state.progress.stage == session::Stage::map)
    state.phase = LivePhase::map;
  if (phase_ == LivePhase::scan && state.progress.stage == session::Stage::plan)
    state.phase = LivePhase::plan;
  return state;
}

session::ByHand LiveSession::by_hand() const {
  const std::lock_guard lock(mutex_);
  return by_hand_;
}

std::shared_ptr<LiveView> LiveSession::view() const {
  const std::lock_guard lock(mutex_);
  return view_;
}

session::Review LiveSession::wait_for_review(const motion::ReadyPlan& plan,
                                             const std::string& refused) {
  view_->show_plan(plan);
  std::unique_lock lock(mutex_);
  phase_ = LivePhase::review;
  said_.clear();
  if (!refused.empty()) said_.push_back({{.words = refused, .key = "change_refused"}});
  if (refused.empty()) by_hand_ = asked_by_hand_;
  ++reviews_;
  review_.reset();
  // A signal wakes nobody who waits here.
  const auto answered = [&] { return review_ || commands_.stopped() || asked_to_end(); };
  while (!answered_.wait_for(lock, std::chrono::milliseconds(50), answered)) continue;
  if (commands_.stopped() || asked_to_end()) return {};
  if (review_->answer == session::Review::Answer::go) phase_ = LivePhase::massage;
  return *review_;
}

void LiveSession::end_ordered(const std::string& outcome, std::vector<SentenceLine> said) {
  const bool failed = outcome == "failed";
  const bool stopped = commands_.stopped() || (failed && view_->progress().drives);
  end(stopped ? "stopped" : outcome, std::move(said), !failed);
}

void LiveSession::end(std::string outcome, std::vector<SentenceLine> said, bool recorded) {
  const std::lock_guard lock(mutex_);
  recorded_ = recorded;
  outcome_ = std::move(outcome);
  said_ = std::move(said);
  paused_ = false;
  phase_ = LivePhase::ended;
}

// A session that has moved the arms leaves its record, whatever it came to.
void LiveSession::give_up(const Error& error, const std::filesystem::path& folder,
                          const std::optional<record::VisitLabel>& visit) {
  std::error_code none;
  const bool moved = view_->progress().drives;
  if (!moved) std::filesystem::remove_all(folder, none);
  if (!moved && visit) options_.people.take_back(*visit);
  if (options_.has_failed) options_.has_failed(error);
  std::vector<SentenceLine> said = {{sentence_of(error)}};
  // Whoever answers the questions or ends what moves hears that, not of a fault.
  if (error.fault == Fault::stopped && !moved)
    said[0][0].key = commands_.stopped() ? "stopped_before" : "not_begun";
  if (moved && std::filesystem::exists(folder / "session.mcap", none)) {
    said.push_back({sentence("record_kept", "recorded until then: {}/session.mcap",
                             folder.filename().string())});
  }
  end(commands_.stopped() || moved ? "stopped" : "failed", std::move(said), false);
}

void LiveSession::run(StartOrder start, std::filesystem::path folder) {
  std::optional<record::VisitLabel> visit;
  const auto give_up = [&](const Error& error) { this->give_up(error, folder, visit); };
  const std::filesystem::path consent = folder / "consent.toml";
  if (auto written = write_file(consent, start.consent_toml); !written)
    return give_up(written.error());
  start.order.consent = consent.string();
  start.order.pace = options_.pace;
  start.order.robot = options_.robot;
  session::Config config = options_.config;
  config.massage.force_scale *= massage::force_scale_of(start.intensity);
  CommonOptions common = options_.common;
  common.seed = start.seed;
  common.quiet = true;

  if (options_.begins) {
    if (auto noted = options_.begins(); !noted) return give_up(noted.error());
  }
  if (!start.who.empty()) {
    auto begun = options_.people.begin(start.who, start.confirmed, start.order, folder);
    if (!begun) return give_up(begun.error());
    visit = std::move(*begun);
  }
  auto result = run_session(start.order, config, common, folder / "session.mcap", attendant());
  if (!result) return give_up(result.error());
  {
    const std::lock_guard lock(mutex_);
    phase_ = LivePhase::report;
  }
  record::SessionFile file = session_file(*result, start.order, start.seed);
  file.visit = visit;
  if (auto written = write_session(*result, config, record::to_json(file), folder); !written)
    return give_up(written.error());
  if (auto kept = finish_record(*result, folder); !kept) return give_up(kept.error());
  std::vector<SentenceLine> said = session_lines(file);
  if (options_.has_ended) {
    if (auto noted = options_.has_ended(*result, file); !noted)
      said.push_back({not_in_history(noted.error())});
  }
  if (visit) add_changes(options_.people.end(file, folder), said);
  const bool stopped = commands_.stopped() || !result->session.stops.empty();
  end(stopped ? "stopped" : "done", std::move(said), true);
}

}  // namespace tuina::app
