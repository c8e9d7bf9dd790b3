// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "apps/tuina/history/open.hpp"
#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/history/archive.hpp"
#include "tuina/history/history_page.hpp"
#include "tuina/history/person_history.hpp"

namespace tuina::app {
namespace {

using Json = nlohmann::ordered_json;

Result<history::PersonHistory> known_of(history::History& history, const std::string& who) {
  if (const auto right = history::check_name(who); !right) return tl::unexpected(right.error());
  auto visits = history.visits_of(who);
  if (!visits) return tl::unexpected(visits.error());
  if (visits->empty()) {
    const auto people = history.people();
    if (!people) return tl::unexpected(people.error());
    std::string names;
    for (const history::Person& person : *people)
      names += (names.empty() ? "" : ", ") + person.name;
    return fail(Fault::bad_input, "nobody called {} is in the history; {}", who,
                names.empty() ? std::string("it is empty") : "there are " + names);
  }
  auto notes = history.notes_of(who);
  if (!notes) return tl::unexpected(notes.error());
  return history::PersonHistory{who, std::move(*visits), std::move(*notes)};
}

/// `--history` and a name, which most of the verbs take.
class HistoryVerb : public Verb {
 protected:
  void describe_person(Options& options) {
    add_history_option(options, address_);
    options.add("who", who_, "the pseudonym of `tuina massage --who`").required();
  }
  [[nodiscard]] Result<history::PersonHistory> known() const {
    auto history = open_known_history(address_);
    if (!history) return tl::unexpected(history.error());
    return known_of(*history, who_);
  }

  std::string address_, who_;
};

class HistoryShow final : public HistoryVerb {
 public:
  [[nodiscard]] const char* name() const override { return "history show"; }
  [[nodiscard]] const char* summary() const override {
    return "one person over time: sessions, tissue, what has really changed";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina history show anna --out anna.html\n  tuina history show    (who is in it)";
  }
  void describe(Options& options) override {
    add_history_option(options, address_);
    options.add("who", who_, "the pseudonym of `tuina massage --who`; without it all people");
    options.add("--out", out_, "one self-contained HTML page");
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    if (who_.empty()) return people();
    const auto known = this->known();
    if (!known) return tl::unexpected(known.error());
    std::string text = fmt::format("{}: {} sessions, the last at {}", who_, known->visits.size(),
                                   known->visits.back().began);
    for (const history::Note& note : known->notes)
      text += fmt::format("\nnote of {}: {}", note.at, note.words);
    if (const auto last = history::last_change(known->visits))
      text += "\n" + history::sentence_of(*last);
    if (!out_.empty()) {
      const auto page = history::history_page(*known);
      if (auto written = write_file(out_, page, Readers::owner); !written)
        return tl::unexpected(written.error());
      text += "\npage: " + out_;
    }
    return Answer{.json = history::to_json(*known), .text = text};
  }

 private:
  [[nodiscard]] Result<Answer> people() const {
    if (!out_.empty()) return fail(Fault::usage, "--out needs a name: a page is of one person");
    auto history = open_known_history(address_);
    if (!history) return tl::unexpected(history.error());
    const auto people = history->people();
    if (!people) return tl::unexpected(people.error());
    Json list = Json::array();
    std::string text;
    for (const history::Person& person : *people) {
      list.push_back(
          {{"name", person.name}, {"since", person.since}, {"sessions", person.sessions}});
      text += fmt::format("{}{}: {} sessions since {}", text.empty() ? "" : "\n", person.name,
                          person.sessions, person.since);
    }
    return Answer{.json = Json{{"people", list}}.dump(2),
                  .text = text.empty() ? "nobody yet" : text};
  }

  std::string out_;
};

class HistoryExport final : public HistoryVerb {
 public:
  [[nodiscard]] const char* name() const override { return "history export"; }
  [[nodiscard]] const char* summary() const override {
    return "what is kept of one person: all of it as an archive, the index as JSON, or the tissue "
           "as CSV";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina history export anna --out anna.zip";
  }
  void describe(Options& options) override {
    describe_person(options);
    options
        .add("--out", out_,
             "FILE.zip: everything, with the folders of the sessions; FILE.json: the index; "
             "FILE.csv: the tissue of all sessions")
        .required();
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    const auto kind = std::filesystem::path(out_).extension();
    if (kind != ".zip" && kind != ".json" && kind != ".csv")
      return fail(Fault::usage, "--out {}: the name is to end with .zip, .json or .csv", out_);
    const auto known = this->known();
    if (!known) return tl::unexpected(known.error());
    Json json = {{"who", who_}, {"sessions", known->visits.size()}, {"file", out_}};
    std::string text = fmt::format("{}: {} sessions in {}", who_, known->visits.size(), out_);
    if (kind == ".zip") {
      const auto archived = history::write_archive(*known, utc_now(), out_);
      if (!archived) return tl::unexpected(archived.error());
      json["files"] = archived->files;
      json["missing"] = archived->missing;
      text += fmt::format(", {} files", archived->files);
      for (const std::string& missing : archived->missing) text += "\nnot in it: " + missing;
      return Answer{.json = json.dump(2), .text = text};
    }
    const bool table = kind == ".csv";
    const std::string content = table ? history::to_csv(*known) : history::to_json(*known) + "\n";
    if (auto written = write_file(out_, content, Readers::owner); !written)
      return tl::unexpected(written.error());
    return Answer{.json = json.dump(2), .text = text};
  }

 private:
  std::string out_;
};

class HistoryForget final : public HistoryVerb {
 public:
  [[nodiscard]] const char* name() const override { return "history forget"; }
  [[nodiscard]] const char* summary() const override {
    return "remove somebody: from the history, and the files of their sessions";
  }
  [[nodiscard]] const char* example() const override { return "tuina history forget anna --yes"; }
  void describe(Options& options) override {
    describe_person(options);
    options.flag("--yes", yes_, "it is meant: nothing brings it back");
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    auto history = open_known_history(address_);
    if (!history) return tl::unexpected(history.error());
    const auto known = known_of(*history, who_);
    if (!known) return tl::unexpected(known.error());
    if (!yes_) {
      std::string folders;
      for (const history::Visit& visit : known->visits) folders += "\n  " + visit.folder;
      return fail(Fault::usage,
                  "--yes is needed: {} sessions of {} go for ever, with their files in:{}",
                  known->visits.size(), who_, folders);
    }
    const auto kept = history->forget(who_, utc_now());
    if (!kept) return tl::unexpected(kept.error());
    std::string text = fmt::format("{} is forgotten: {} sessions", who_, known->visits.size());
    Json folders = Json::array();
    for (const history::KeptFolder& one : *kept) {
      text += fmt::format(
          "\n{}: stays, with {} in it", one.folder,
          one.other_session ? "another session, or none that is whole," : "other files");
      folders.push_back(one.folder);
    }
    const Json json = {
        {"who", who_}, {"sessions", known->visits.size()}, {"folders_kept", folders}};
    return Answer{.json = json.dump(2), .text = text};
  }

 private:
  bool yes_ = false;
};

class HistoryRebuild final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "history rebuild"; }
  [[nodiscard]] const char* summary() const override {
    return "make the index anew of the session folders below a folder";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina history rebuild sessions --history new.sqlite";
  }
  void describe(Options& options) override {
    add_history_option(options, address_);
    options.add("folder", folder_, "in or below it lie folders of `tuina massage --who`")
        .required();
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    std::error_code fault;
    if (!std::filesystem::is_directory(folder_, fault))
      return fail(Fault::file, "{}: there is no such folder", folder_);
    auto history = open_history(address_);
    if (!history) return tl::unexpected(history.error());
    const auto rebuilt = history->rebuild(folder_);
    if (!rebuilt) return tl::unexpected(rebuilt.error());
    std::string text = fmt::format("{} sessions", rebuilt->sessions);
    for (const std::string& words : rebuilt->left_out) text += "\nleft out: " + words;
    const Json json = {{"sessions", rebuilt->sessions}, {"left_out", rebuilt->left_out}};
    return Answer{.json = json.dump(2), .text = text};
  }

 private:
  std::string address_, folder_;
};

class HistoryNote final : public HistoryVerb {
 public:
  [[nodiscard]] const char* name() const override { return "history note"; }
  [[nodiscard]] const char* summary() const override { return "write a note about somebody"; }
  [[nodiscard]] const char* example() const override {
    return "tuina history note anna \"left shoulder hurts since Monday\"";
  }
  void describe(Options& options) override {
    describe_person(options);
    options.add("words", words_, "the note").required();
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    auto history = open_known_history(address_);
    if (!history) return tl::unexpected(history.error());
    if (const auto known = known_of(*history, who_); !known) return tl::unexpected(known.error());
    const history::Note note{.at = utc_now(), .words = words_};
    if (const auto added = history->add_note(who_, note); !added)
      return tl::unexpected(added.error());
    return Answer{.json = Json{{"who", who_}, {"at", note.at}, {"words", note.words}}.dump(2),
                  .text = "noted"};
  }

 private:
  std::string words_;
};

}  // namespace

std::unique_ptr<Verb> make_history_show() {
  return std::make_unique<HistoryShow>();
}
std::unique_ptr<Verb> make_history_export() {
  return std::make_unique<HistoryExport>();
}
std::unique_ptr<Verb> make_history_forget() {
  return std::make_unique<HistoryForget>();
}
std::unique_ptr<Verb> make_history_rebuild() {
  return std::make_unique<HistoryRebuild>();
}
std::unique_ptr<Verb> make_history_note() {
  return std::make_unique<HistoryNote>();
}

}  // namespace tuina::app
