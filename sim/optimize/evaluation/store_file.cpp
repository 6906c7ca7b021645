#include "sim/optimize/evaluation/store_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <random>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "shared/computer/sqlite/sqlite.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/store_schema.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {
namespace {

/// So that Database::require_own_file() notices another store in the place of this one.
std::uint32_t random_schema_version() {
  std::random_device device;
  return std::uniform_int_distribution<std::uint32_t>(1, 0x7FFFFFFF)(device);
}

std::int64_t pragma(Database& database, const char* sql) {
  Statement statement(database, sql);
  return statement.step() ? statement.integer(0) : 0;
}

void write_experiment(Database& database, const Experiment& experiment, const StoreColumns& columns,
                      const std::string& result_key) {
  Statement entry(database, "INSERT INTO experiment VALUES(?1, ?2)");
  const auto write = [&entry](std::string_view key, const std::string& value) {
    entry.run(key, std::string_view(value));
  };
  write("fingerprint", experiment.fingerprint());
  write("result_key", result_key);
  write("path", experiment.path);
  write("scenario", experiment.scenario.path);
  write("method", method_name(experiment.method));
  write("seed", std::to_string(experiment.seed));
  write("evaluations", std::to_string(experiment.evaluations));
  write("started", universal_time());

  Statement part(database, "INSERT INTO part VALUES(?1, ?2)");
  for (const ExperimentPart& its : parts_of(experiment)) {
    part.run(std::string_view(its.name), std::string_view(its.text));
  }
  Statement source(database, "INSERT INTO source(path, text) VALUES(?1, ?2)");
  for (const sim::SourceFile& its : experiment.sources) {
    source.run(std::string_view(its.path), std::string_view(its.text));
  }
  Statement objective(database, "INSERT INTO objective VALUES(?1, ?2, ?3, ?4, ?5, ?6)");
  for (std::size_t i = 0; i < experiment.objectives.size(); ++i) {
    const Objective& its = experiment.objectives[i];
    const std::string terms = terms_text(its);
    objective.run(i, std::string_view(its.name), std::string_view(columns.scores[i]),
                  std::string_view(its.goal == Goal::maximise ? "maximise" : "minimise"), std::string_view(terms),
                  its.failed);
  }
  Statement dimension(database, "INSERT INTO dimension VALUES(?1, ?2, nullif(?3, ''), ?4, ?5, ?6, ?7)");
  for (std::size_t i = 0; i < experiment.space.dimensions.size(); ++i) {
    const Dimension& its = experiment.space.dimensions[i];
    Candidate candidate(experiment.space.dimensions.size(), 0);
    const double lowest = experiment.space.value(candidate, i);
    candidate[i] = static_cast<std::uint32_t>(its.values.size() - 1);
    dimension.run(i, std::string_view(its.name),
                  columns.values.empty() ? std::string_view() : std::string_view(columns.values[i]),
                  std::string_view(scale_of(its.unit).symbol), its.values.size(), lowest,
                  experiment.space.value(candidate, i));
  }
  Statement measure(database, "INSERT INTO measure VALUES(?1, ?2, ?3)");
  for (const sim::MeasureDeclaration& its : sim::measures()) {
    measure.run(its.name, its.unit, its.help);
  }
}

std::filesystem::path unfinished_path(const std::filesystem::path& path) { return path.string() + ".new"; }
std::filesystem::path stop_path(const std::filesystem::path& store) { return store.string() + ".stop"; }

/// Names of what differs between the experiment of a store and this one.
std::vector<std::string> differences(Database& database, const Experiment& experiment) {
  std::vector<std::string> names;
  const std::vector<ExperimentPart> parts = parts_of(experiment);
  Statement part(database, "SELECT text FROM part WHERE name = ?1");
  for (const ExperimentPart& its : parts) {
    part.bind_all(std::string_view(its.name));
    if (!part.step() || part.text(0) != its.text) {
      names.push_back(its.name);
    }
  }
  Statement stored(database, "SELECT name FROM part");
  while (stored.step()) {
    if (std::ranges::count(parts, stored.text(0), &ExperimentPart::name) == 0) {
      names.push_back(stored.text(0));
    }
  }
  // The parts above cover the experiment's own file.
  Statement source(database, "SELECT text FROM source ORDER BY position LIMIT -1 OFFSET ?1");
  source.bind_all(experiment.sources.size() - experiment.scenario.sources.size());
  for (const sim::SourceFile& its : experiment.scenario.sources) {
    if (!source.step() || source.text(0) != its.text) {
      names.push_back("file " + std::filesystem::path(its.path).filename().string());
    }
  }
  if (source.step()) {
    names.emplace_back("number of files");
  }
  return names;
}

}  // namespace

std::string universal_time() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  std::array<char, 32> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts)};
}

StoreLock::StoreLock(const std::filesystem::path& store, const std::string& failure)
    : descriptor_(open((store.string() + ".lock").c_str(), O_RDWR | O_CLOEXEC | O_CREAT, 0666)) {
  if (descriptor_ < 0) {
    throw StoreError(store.string() + ": " + failure + ": " + std::strerror(errno));
  }
  // On a file system without such locks the store is not locked. A program that looks whether the store is locked has
  // the lock for a moment.
  constexpr int attempts = 10;
  constexpr std::chrono::milliseconds pause{20};
  bool is_locked = flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  for (int i = 1; i < attempts && is_locked; ++i) {
    std::this_thread::sleep_for(pause);
    is_locked = flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  }
  if (is_locked) {
    close(descriptor_);
    throw StoreError(store.string() + ": " + std::string(another_writer) + "; wait until it ends, or stop it");
  }
}

StoreLock::~StoreLock() {
  if (descriptor_ >= 0) {
    flock(descriptor_, LOCK_UN);  // children of this process that have inherited the file would keep the lock
    close(descriptor_);
  }
}

StoreLock::StoreLock(StoreLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

void StoreLock::note_writer() const {
  // Always as long: it needs no further room on a disk that is full. Without it only writer_of() has no answer.
  std::array<char, 16> number{};
  const int length = std::snprintf(number.data(), number.size(), "%-10d\n", getpid());
  static_cast<void>(pwrite(descriptor_, number.data(), static_cast<std::size_t>(length), 0));
}

bool is_being_written(const std::filesystem::path& store) {
  const int descriptor = open((store.string() + ".lock").c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) {
    return false;
  }
  const bool is_locked = flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  close(descriptor);  // releases the lock
  return is_locked;
}

std::optional<pid_t> writer_of(const std::filesystem::path& store) {
  if (!is_being_written(store)) {
    return std::nullopt;
  }
  std::ifstream lock(store.string() + ".lock");
  std::string number;
  lock >> number;
  return parse_whole<pid_t>(number);
}

void request_stop(const std::filesystem::path& store) {
  if (!is_being_written(store)) {
    throw StoreError(store.string() + ": no program is writing to it, so there is nothing to stop");
  }
  const int descriptor = open(stop_path(store).c_str(), O_WRONLY | O_CLOEXEC | O_CREAT, 0666);
  if (descriptor < 0) {
    throw StoreError(stop_path(store).string() + ": cannot be created: " + std::strerror(errno));
  }
  close(descriptor);
}

bool is_stop_requested(const std::filesystem::path& store) {
  std::error_code error;
  return std::filesystem::exists(stop_path(store), error);
}

void forget_stop_request(const std::filesystem::path& store) {
  std::error_code ignored;
  std::filesystem::remove(stop_path(store), ignored);
}

/// Writes under another name first, so that a killed process never leaves half a store under this name.
StoreLock create_store(const std::filesystem::path& path, const Experiment& experiment, const StoreColumns& columns,
                       const std::string& result_key) {
  StoreLock lock(path, "cannot be created");
  if (std::filesystem::exists(std::filesystem::symlink_status(path))) {
    throw StoreError(path.string() + ": exists already; continue that search with --resume " +
                     path.parent_path().string() + ", or choose another folder with --out");
  }
  try {
    std::filesystem::remove(unfinished_path(path));  // left by a process that was killed here
    Database database(unfinished_path(path), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    database.execute("PRAGMA journal_mode = MEMORY; BEGIN IMMEDIATE");
    database.execute(("PRAGMA application_id = " + std::to_string(store_application_id) +
                      "; PRAGMA user_version = " + std::to_string(store_format))
                         .c_str());
    database.execute(store_schema(experiment, columns).c_str());
    write_experiment(database, experiment, columns, result_key);
    database.execute(("PRAGMA schema_version = " + std::to_string(random_schema_version())).c_str());
    database.execute("COMMIT");
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(unfinished_path(path), ignored);
    throw;
  }
  std::filesystem::rename(unfinished_path(path), path);
  return lock;
}

void require_store_file(const std::filesystem::path& path) {
  const std::filesystem::file_status status = std::filesystem::status(path);
  if (!std::filesystem::exists(status)) {
    throw StoreError(path.string() + ": does not exist; there is nothing to resume");
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw StoreError(path.string() + ": is not a file; expected the store of an experiment");
  }
}

StoreLock claim_store(const std::filesystem::path& path) {
  require_store_file(path);
  return {path, "cannot be opened for writing"};
}

std::string described_value(Database& database, std::string_view key) {
  Statement statement(database, "SELECT value FROM experiment WHERE key = ?1");
  statement.bind_all(key);
  return statement.step() ? statement.text(0) : "";
}

std::string reason_of(const SqliteError& error, int system) {
  const bool refused = error.code() == SQLITE_IOERR && (system == ENOSPC || system == EDQUOT || system == EFBIG);
  if (error.code() == SQLITE_FULL || refused) {
    return "no space left on the disk; all evaluations until now are kept";
  }
  if (error.code() == SQLITE_NOTADB) {
    return "is not the store of an experiment";
  }
  const std::string what = error.what();
  if (error.code() == SQLITE_CORRUPT && !what.starts_with("another program")) {  // Database says who damaged it
    return "found a damaged database (" + what + "), expected the store of a search";
  }
  return what;
}

void require_store(const std::filesystem::path& path, Database& database) {
  if (pragma(database, "PRAGMA application_id") != std::int64_t{store_application_id}) {
    throw StoreError(path.string() + ": is not the store of an experiment");
  }
  if (const std::int64_t format = pragma(database, "PRAGMA user_version"); format != std::int64_t{store_format}) {
    throw StoreError(path.string() + ": has format " + std::to_string(format) + ", this program reads format " +
                     std::to_string(store_format));
  }
}

StoredExperiment read_description(const std::filesystem::path& path, Database& database) {
  require_store(path, database);
  StoredExperiment stored;
  stored.path = described_value(database, "path");
  stored.scenario = described_value(database, "scenario");
  stored.seed = parse_whole<std::uint64_t>(described_value(database, "seed")).value_or(0);
  stored.evaluations = parse_whole<std::uint64_t>(described_value(database, "evaluations")).value_or(0);
  stored.trials = parse_whole<std::uint32_t>(described_value(database, "trials"));
  Statement part(database, "SELECT text FROM part WHERE name = ?1");
  for (const auto& [name, text] : {std::pair{std::string_view("engine"), &stored.engine},
                                   std::pair{std::string_view(simulated_robot_part), &stored.simulated_robot}}) {
    part.bind_all(name);
    *text = part.step() ? part.text(0) : std::string();
  }
  Statement source(database, "SELECT path, text FROM source ORDER BY position");
  while (source.step()) {
    stored.sources.push_back({source.text(0), source.text(1)});
  }
  return stored;
}

void require_same_fingerprint(const std::filesystem::path& path, Database& database, const Experiment& experiment) {
  const std::string fingerprint = described_value(database, "fingerprint");
  if (fingerprint != experiment.fingerprint()) {
    const std::vector<std::string> names = differences(database, experiment);
    throw StoreError(path.string() + ": is the store of another experiment, with fingerprint " +
                     fingerprint.substr(0, 12) + ", expected " + experiment.fingerprint().substr(0, 12) +
                     (names.empty() ? "" : "; differences: " + listed(names)));
  }
}

void require_same_experiment(const std::filesystem::path& path, Database& database, const Experiment& experiment,
                             const std::string& result_key) {
  require_store(path, database);
  require_same_fingerprint(path, database, experiment);
  const std::string build_id = described_value(database, "build_id");
  if (described_value(database, "result_key") != result_key) {
    throw StoreError(path.string() + ": was made by a program with other sources, compiler or libraries" +
                     (build_id.empty() ? "" : " (build " + build_id + ")") +
                     "; its results may differ, so this program cannot resume it");
  }
}

}  // namespace proleg::optimize
