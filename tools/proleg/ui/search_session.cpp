#include "tools/proleg/ui/search_session.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include "shared/computer/algorithm_library/algorithm_library.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/store.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/scenario/sources.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/program_run.hpp"
#include "tools/proleg/ui/experiment_json.hpp"
#include "tools/proleg/ui/fast_simulation.hpp"
#include "tools/proleg/ui/gait_motion.hpp"
#include "tools/proleg/ui/scenario_copy.hpp"
#include "tools/proleg/ui/search_form.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using optimize::Evaluation;
using optimize::Experiment;

constexpr const char* searches_folder = "searches";
constexpr std::chrono::milliseconds look_period{50};
constexpr std::chrono::milliseconds reap_period{500};

json number_or_null(double value) { return std::isfinite(value) ? json(value) : json(); }

std::uint64_t inode_of(const fs::path& file) {
  struct stat status {};
  return ::stat(file.c_str(), &status) == 0 ? status.st_ino : 0;
}

std::string name_in(const json& arguments) {
  return argument<std::string>(arguments, "name", "the name of a search").value_or("");
}

optimize::ExperimentForm form_in(const json& arguments) {
  const auto experiment = arguments.find("experiment");
  if (experiment == arguments.end()) {
    throw InputError("experiment", 0, "nothing", "an object");
  }
  return read_experiment_json(*experiment);
}

/// The experiment of a form, or the refusal.
Experiment required_experiment(const optimize::ExperimentForm& form, const sim::Scenario& scenario) {
  std::variant<Experiment, FormProblem> judged = judge_form(form, scenario);
  if (const auto* const problem = std::get_if<FormProblem>(&judged)) {
    throw std::runtime_error((problem->field.empty() ? "" : problem->field + ": ") + problem->text);
  }
  return std::move(std::get<Experiment>(judged));
}

/// The options of `proleg optimise` that a start and an estimate have.
std::vector<std::string> options_in(const json& arguments) {
  std::vector<std::string> options;
  if (const auto engine = argument<std::string>(arguments, "engine", "the name of an engine, or null")) {
    options.insert(options.end(), {"--engine", *engine});
  }
  if (const auto workers = argument<std::uint32_t>(arguments, "workers", "a number of workers, or null")) {
    if (*workers == 0 || *workers > max_workers) {
      throw InputError("workers", 0, std::to_string(*workers), "1 to " + std::to_string(max_workers));
    }
    options.insert(options.end(), {"--workers", std::to_string(*workers)});
  }
  return options;
}

/// The last line that a program has printed, without its name.
std::string last_line_of(const std::string& output) {
  std::string last;
  TextLines lines(output);
  while (const std::optional<std::string_view> line = lines.next()) {
    if (!trimmed(*line).empty()) {
      last = one_line(trimmed(*line));
    }
  }
  constexpr std::string_view program = "proleg optimise: ";
  return last.starts_with(program) ? last.substr(program.size()) : last;
}

/// What `proleg optimise` has left of its result; null: nothing that is an object.
json result_of(const fs::path& search) {
  constexpr std::uintmax_t most = 1 << 20;
  std::error_code error;
  const fs::path file = search / "result.json";
  if (!fs::is_regular_file(file, error) || fs::file_size(file, error) > most) {
    return json();
  }
  std::ifstream stream(file);
  json result = json::parse(stream, nullptr, false);
  return result.is_object() ? result : json();
}

json names_of(const optimize::SearchSpace& space) {
  json names = json::array();
  for (const optimize::Dimension& dimension : space.dimensions) {
    names.push_back(dimension.name);
  }
  return names;
}

json dimensions_json(const optimize::SearchSpace& space) {
  json dimensions = json::array();
  for (std::size_t i = 0; i < space.dimensions.size(); ++i) {
    optimize::Candidate corner(space.dimensions.size(), 0);
    const double lowest = space.value(corner, i);
    corner[i] = static_cast<std::uint32_t>(space.dimensions[i].values.size() - 1);
    dimensions.push_back({{"name", space.dimensions[i].name},
                          {"unit", std::string(scale_of(space.dimensions[i].unit).symbol)},
                          {"count", space.dimensions[i].values.size()},
                          {"lowest", lowest},
                          {"highest", space.value(corner, i)}});
  }
  return dimensions;
}

/// Why the reduced engine cannot make the search; null: it can.
json refusal_of_reduced(Experiment experiment) {
  experiment.scenario.environment.engine = sim::PhysicsEngine::reduced;
  try {
    optimize::require_engine(experiment);
    return json();
  } catch (const InputError& error) {
    return one_line(error.what());
  }
}

}  // namespace

SearchSession::SearchSession(SearchSessionOptions options, const ProjectFiles& files, const PresentDraft& draft,
                             SessionRequests& requests, host::SessionOutput& output)
    : SessionThread(requests, output),
      options_(std::move(options)),
      files_(files),
      draft_(draft),
      folder_(options_.folder) {
  if (options_.program.empty()) {
    std::error_code error;
    options_.program = fs::read_symlink("/proc/self/exe", error).parent_path() / "proleg-optimise";
  }
  publish("search_methods", search_methods_json());
  begin_thread();
}

SearchSession::~SearchSession() { end_thread(); }

void SearchSession::serve() {
  take_operations();
  beginnings_.remove_if([this](Beginning& beginning) { return look_at(beginning); });
  running_.remove_if([](DetachedProgram& program) { return program.status().has_value(); });
  look_at_estimate();
  if (!beginnings_.empty() || estimate_) {
    requests_.wait_until(Clock::now() + look_period);
  } else if (!running_.empty()) {
    requests_.wait_until(Clock::now() + reap_period);
  } else {
    requests_.wait();
  }
}

void SearchSession::fail(const std::string& why) {
  for (const Beginning& beginning : beginnings_) {
    output_.refuse(beginning.request, why);
  }
  beginnings_.clear();
  end_estimate(why);
}

void SearchSession::close() { end_estimate("the program ends"); }

json SearchSession::carry_out(const host::OperationRequest& operation) {
  static const std::map<std::string_view, Handler> handlers{
      {"search.refresh", &SearchSession::refresh}, {"search.open", &SearchSession::open},
      {"search.rows", &SearchSession::rows},       {"search.candidate", &SearchSession::candidate},
      {"search.motion", &SearchSession::motion},   {"search.check", &SearchSession::check},
      {"search.read", &SearchSession::read},       {"search.estimate", &SearchSession::estimate},
      {"search.start", &SearchSession::start},     {"search.stop", &SearchSession::stop},
      {"search.resume", &SearchSession::resume}};
  return (this->*handler_of(handlers, operation.name))(operation);
}

json SearchSession::refresh(const host::OperationRequest& /*request*/) {
  json experiments = json::array();
  for (const ProjectFile& file : files_.experiments()) {
    experiments.push_back({{"file", file.file}, {"title", file.title}, {"is_shipped", file.is_shipped}});
  }
  publish("searches", {{"processors", parse_workers(std::nullopt)},
                       {"experiments", std::move(experiments)},
                       {"searches", folder_.list()}});
  return json::object();
}

std::shared_ptr<const sim::Scenario> SearchSession::draft() const {
  std::shared_ptr<const sim::Scenario> scenario = draft_.get().scenario;
  if (scenario == nullptr) {
    throw std::runtime_error("there is no draft; make or open a scenario first");
  }
  return scenario;
}

const Experiment& SearchSession::experiment_of(const fs::path& search) {
  constexpr std::size_t most = 4;
  const fs::path store = SearchFolder::store_of(search);
  const std::uint64_t inode = inode_of(store);
  const auto found =
      std::ranges::find_if(open_, [&](const Open& open) { return open.folder == search && open.inode == inode; });
  if (found != open_.end()) {
    open_.splice(open_.begin(), open_, found);
    return *open_.front().experiment;
  }
  open_.remove_if([&](const Open& open) { return open.folder == search; });
  open_.push_front({search, inode, std::make_unique<const Experiment>(optimize::read_experiment_of(store))});
  if (open_.size() > most) {
    open_.pop_back();
  }
  return *open_.front().experiment;
}

json SearchSession::open(const host::OperationRequest& request) {
  const std::string name = name_in(request.arguments);
  const fs::path search = folder_.find(name);
  const optimize::StoreSummary summary = optimize::read_store_summary(SearchFolder::store_of(search));
  const Experiment& experiment = experiment_of(search);
  json objectives = json::array();
  for (const optimize::Objective& objective : experiment.objectives) {
    objectives.push_back({{"name", objective.name},
                          {"unit", objective.unit()},
                          {"maximise", objective.goal == optimize::Goal::maximise}});
  }
  json measures = json::array();
  for (const sim::MeasureDeclaration& measure : sim::measures()) {
    measures.push_back(measure.name);
  }
  const bool has_ended = summary.ending && !optimize::is_being_written(SearchFolder::store_of(search));
  return {{"name", name},
          {"experiment", one_line(fs::path(experiment.path).filename().string())},
          {"method", optimize::method_name(experiment.method)},
          {"engine", std::string(sim::name_of(experiment.scenario.environment.engine))},
          {"seed", std::to_string(experiment.seed)},
          {"trials", experiment.trials.count},
          {"planned", summary.planned > 0 ? json(summary.planned) : json()},
          {"runs", summary.runs},
          {"joints", experiment.scenario.robot.joints.size()},
          {"objectives", std::move(objectives)},
          {"dimensions", dimensions_json(experiment.space)},
          {"measures", std::move(measures)},
          {"has_baseline", experiment.has_baseline},
          {"result", has_ended ? result_of(search) : json()}};
}

json SearchSession::rows(const host::OperationRequest& request) {
  constexpr std::size_t most_rows = 1000;
  constexpr std::size_t most_numbers = 20'000;
  const fs::path search = folder_.find(name_in(request.arguments));
  const auto run = argument<std::uint32_t>(request.arguments, "run", "the number of a run").value_or(0);
  const auto from = argument<std::uint64_t>(request.arguments, "from", "the number of an evaluation").value_or(0);
  const Experiment& experiment = experiment_of(search);
  const std::size_t width = experiment.objectives.size() + experiment.space.dimensions.size();
  const std::size_t most = std::clamp<std::size_t>(most_numbers / std::max<std::size_t>(width, 1), 1, most_rows);
  optimize::Store store(SearchFolder::store_of(search), experiment, {}, optimize::Store::Opening::look);
  json scores = json::array();
  json values = json::array();
  json flags = json::array();
  for (const Evaluation& evaluation : store.evaluations(run, from, most)) {
    json its_scores = json::array();
    for (const double score : evaluation.scores) {
      its_scores.push_back(number_or_null(score));
    }
    json its_values = json::array();
    for (std::size_t i = 0; i < experiment.space.dimensions.size(); ++i) {
      its_values.push_back(experiment.space.value(evaluation.candidate, i));
    }
    scores.push_back(std::move(its_scores));
    values.push_back(std::move(its_values));
    flags.push_back((optimize::has_own_score(experiment, evaluation, 0) ? 0 : 1) + (evaluation.given_up ? 2 : 0) +
                    (evaluation.reused ? 4 : 0));
  }
  return {{"from", from},
          {"made", store.evaluation_count(run)},
          {"scores", std::move(scores)},
          {"values", std::move(values)},
          {"flags", std::move(flags)}};
}

Evaluation SearchSession::evaluation_of(const json& arguments, const Experiment& experiment,
                                        const fs::path& search) const {
  const auto run = argument<std::uint32_t>(arguments, "run", "the number of a run").value_or(0);
  const auto number = argument<std::uint64_t>(arguments, "number", "the number of an evaluation");
  optimize::Store store(SearchFolder::store_of(search), experiment, {}, optimize::Store::Opening::look);
  std::vector<Evaluation> found = store.evaluations(run, number.value_or(0), 1);
  if (!number || found.empty() || found.front().number != *number) {
    throw InputError("number", 0, number ? std::to_string(*number) : "nothing", "the number of an evaluation");
  }
  return std::move(found.front());
}

json SearchSession::candidate(const host::OperationRequest& request) {
  const fs::path search = folder_.find(name_in(request.arguments));
  const Experiment& experiment = experiment_of(search);
  const Evaluation evaluation = evaluation_of(request.arguments, experiment, search);
  json scores = json::array();
  for (const double score : evaluation.scores) {
    scores.push_back(number_or_null(score));
  }
  json words = json::array();
  for (std::size_t i = 0; i < experiment.space.dimensions.size(); ++i) {
    // `--set` takes one joint or all of them, a dimension also some.
    const std::string value = experiment.space.value_text(evaluation.candidate, i);
    const std::string& name = experiment.space.dimensions[i].name;
    const std::size_t colon = name.find(':');
    const std::string joints = colon == std::string::npos ? std::string() : name.substr(colon + 1);
    if (joints.find(',') == std::string::npos) {
      words.push_back(name + "=" + value);
      continue;
    }
    for (const Setting& target : experiment.space.dimensions[i].targets) {
      words.push_back(name.substr(0, colon) + ":" + experiment.scenario.robot.joints[target.joint].name + "=" + value);
    }
  }
  json measures = json::object();
  for (const sim::MeasureDeclaration& measure : sim::measures()) {
    measures[std::string(measure.name)] = number_or_null(evaluation.measures[measure.measure]);
  }
  return {{"number", evaluation.number},
          {"scores", std::move(scores)},
          {"words", std::move(words)},
          {"measures", std::move(measures)},
          {"failure", text_or_null(one_line(evaluation.failure))},
          {"given_up", evaluation.given_up},
          {"reused", evaluation.reused}};
}

json SearchSession::motion(const host::OperationRequest& request) {
  constexpr std::chrono::milliseconds longest{2000};
  const auto is_outdated = [this] { return requests_.interrupts(); };
  const auto name = argument<std::string>(request.arguments, "name", "the name of a search, or null");
  if (!name) {
    return json::binary(gait_motion(*draft(), longest, is_outdated));
  }
  const fs::path search = folder_.find(*name);
  const Experiment& experiment = experiment_of(search);
  const Evaluation evaluation = evaluation_of(request.arguments, experiment, search);
  return json::binary(gait_motion(optimize::own_world(experiment, evaluation), longest, is_outdated));
}

json SearchSession::check(const host::OperationRequest& request) {
  const std::shared_ptr<const sim::Scenario> scenario = draft();
  const optimize::ExperimentForm form = form_in(request.arguments);
  const std::variant<Experiment, FormProblem> judged = judge_form(form, *scenario);
  if (const auto* const problem = std::get_if<FormProblem>(&judged)) {
    return {{"problem", {{"field", problem->field}, {"text", problem->text}}}};
  }
  const auto& experiment = std::get<Experiment>(judged);
  const std::uint64_t planned = optimize::planned_evaluations(experiment);
  const std::string simulation = fs::path(scenario->path).filename().string();
  return {{"names", names_of(experiment.space)},
          {"candidates", number_or_null(experiment.space.size())},
          {"planned", planned > 0 ? json(planned) : json()},
          {"text", optimize::experiment_text(form, *scenario, simulation).text},
          {"engine", std::string(sim::name_of(scenario->environment.engine))},
          {"reduced", refusal_of_reduced(experiment)}};
}

json SearchSession::read(const host::OperationRequest& request) {
  const auto file = argument<std::string>(request.arguments, "file", "a file of `searches`").value_or("");
  if (!files_.has_experiment(file)) {
    throw InputError("file", 0, in_quotes(one_line(shortened(file))), "an experiment of the project");
  }
  sim::DiskFiles disk;
  return {{"experiment", experiment_json(optimize::read_experiment_form(file, disk, *draft()))}};
}

std::vector<std::string> SearchSession::command(const std::vector<std::string>& words) const {
  std::vector<std::string> command{options_.program.string()};
  command.insert(command.end(), words.begin(), words.end());
  for (const std::string& library : loaded_libraries()) {
    command.insert(command.end(), {"--algorithms", library});
  }
  return command;
}

json SearchSession::estimate(const host::OperationRequest& request) {
  end_estimate("another estimate was asked for");
  const std::shared_ptr<const sim::Scenario> scenario = draft();
  const optimize::ExperimentForm form = form_in(request.arguments);
  static_cast<void>(required_experiment(form, *scenario));
  std::string folder = (fs::temp_directory_path() / "proleg_estimate_XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) {
    throw std::runtime_error("cannot make a folder in " + fs::temp_directory_path().string());
  }
  estimate_.emplace(Estimate{request.request, folder, nullptr});
  try {
    std::vector<std::string> words{write_search_files(form, *scenario, folder, "estimate").string(), "--estimate",
                                   "--json"};
    const std::vector<std::string> options = options_in(request.arguments);
    words.insert(words.end(), options.begin(), options.end());
    estimate_->program =
        std::make_unique<CommandSequence>(std::vector<std::vector<std::string>>{command(words)}, folder,
                                          options_.longest_estimate, ChildProgram::Errors::apart);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    estimate_.reset();
    throw;
  }
  return answered_later();
}

void SearchSession::look_at_estimate() {
  if (!estimate_) {
    return;
  }
  const std::optional<CommandSequence::End> end = estimate_->program->look();
  if (!end) {
    return;
  }
  const json result = json::parse(estimate_->program->output(), nullptr, false);
  if (end->status != 0 || !result.is_object()) {
    const std::string line = last_line_of(estimate_->program->errors());
    end_estimate(line.empty() ? "the estimate failed" : line);
    return;
  }
  output_.answer(estimate_->request, {{"evaluation_s", result.value("evaluation_s", json())},
                                      {"planned", result.value("planned", json())},
                                      {"seconds", result.value("seconds", json())},
                                      {"engine", result.value("engine", json())}});
  std::error_code ignored;
  fs::remove_all(estimate_->folder, ignored);
  estimate_.reset();
}

void SearchSession::end_estimate(const std::string& refusal) {
  if (!estimate_) {
    return;
  }
  output_.refuse(estimate_->request, refusal);
  estimate_->program.reset();
  std::error_code ignored;
  fs::remove_all(estimate_->folder, ignored);
  estimate_.reset();
}

void SearchSession::begin(const host::OperationRequest& request, const std::string& name, const fs::path& folder,
                          const std::vector<std::string>& words, bool is_new) {
  beginnings_.push_back({request.request, name, folder,
                         DetachedProgram(command(words), folder.string(), SearchFolder::log_of(folder)),
                         Clock::now() + options_.longest_start, is_new});
}

json SearchSession::start(const host::OperationRequest& request) {
  const json& arguments = request.arguments;
  const std::string name = name_in(arguments);
  const fs::path parent = folder_.folder() / searches_folder;
  const fs::path folder = folder_of_copy(parent, name);
  const auto file = argument<std::string>(arguments, "file", "a file of `searches`, or null");
  std::vector<std::string> words;
  std::shared_ptr<const sim::Scenario> scenario;
  optimize::ExperimentForm form;
  if (file) {
    if (!files_.has_experiment(*file)) {
      throw InputError("file", 0, in_quotes(one_line(shortened(*file))), "an experiment of the project");
    }
    words.push_back(fs::absolute(*file).string());
  } else {
    scenario = draft();
    form = form_in(arguments);
    static_cast<void>(required_experiment(form, *scenario));
  }
  const std::vector<std::string> options = options_in(arguments);
  std::error_code error;
  fs::create_directory(parent, error);
  if (!fs::create_directory(folder, error)) {
    if (error) {
      throw FileError(folder, "cannot be created: " + error.message());
    }
    throw InputError("name", 0, in_quotes(name) + ", which exists", "a new name");
  }
  try {
    if (!file) {
      words.push_back(write_search_files(form, *scenario, folder, name).string());
    }
    words.insert(words.end(), {"--out", folder.string()});
    words.insert(words.end(), options.begin(), options.end());
    begin(request, std::string(searches_folder) + "/" + name, folder, words, true);
  } catch (...) {
    fs::remove_all(folder, error);
    throw;
  }
  return answered_later();
}

json SearchSession::resume(const host::OperationRequest& request) {
  const json& arguments = request.arguments;
  const std::string name = name_in(arguments);
  const fs::path folder = folder_.find(name);
  const bool begins = std::ranges::any_of(beginnings_, [&](const auto& its) { return its.folder == folder; });
  if (begins || optimize::is_being_written(SearchFolder::store_of(folder))) {
    throw std::runtime_error("this search is running");
  }
  std::vector<std::string> words{"--resume", folder.string()};
  if (const auto evaluations = argument<std::string>(arguments, "evaluations", "a number as a text");
      evaluations && !trimmed(*evaluations).empty()) {
    words.insert(words.end(), {"--evaluations", std::string(trimmed(*evaluations))});
  }
  const std::vector<std::string> options = options_in(arguments);
  words.insert(words.end(), options.begin(), options.end());
  std::error_code ignored;
  fs::remove(SearchFolder::log_of(folder), ignored);  // it tells of the time before
  begin(request, name, folder, words, false);
  return answered_later();
}

bool SearchSession::look_at(Beginning& beginning) {
  const fs::path store = SearchFolder::store_of(beginning.folder);
  const std::optional<int> status = beginning.program.status();
  std::error_code error;
  const bool has_begun = fs::exists(store, error) && (optimize::is_being_written(store) || status == exit_success);
  if (has_begun) {
    folder_.look_again();
    output_.answer(beginning.request, {{"name", beginning.name}});
    running_.push_back(std::move(beginning.program));
    return true;
  }
  const bool is_late = Clock::now() >= beginning.until;
  if (!status && !is_late) {
    return false;
  }
  const std::string line = SearchFolder::failure_of(beginning.folder);
  output_.refuse(beginning.request, is_late        ? "the search has not begun in time; it may begin later"
                                    : line.empty() ? "the search has ended with status " + std::to_string(*status)
                                                   : line);
  if (status && beginning.is_new && !fs::exists(store, error)) {
    fs::remove_all(beginning.folder, error);
  }
  if (!status) {
    running_.push_back(std::move(beginning.program));
  }
  return true;
}

json SearchSession::stop(const host::OperationRequest& request) {
  const fs::path folder = folder_.find(name_in(request.arguments));
  optimize::request_stop(SearchFolder::store_of(folder));
  return json::object();
}

void SearchSession::publish(const std::string& name, json document) {
  json& before = published_[name];
  if (before != document) {
    before = std::move(document);
    output_.publish(name, before);
  }
}

}  // namespace proleg::tools
