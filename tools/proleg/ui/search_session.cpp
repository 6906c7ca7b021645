#include "tools/proleg/ui/search_session.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include "shared/computer/algorithm_library/algorithm_library.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/store_file.hpp"
#include "sim/optimize/evaluation/store_summary.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/scenario/sources.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/installation.hpp"
#include "tools/proleg/ui/experiment_json.hpp"
#include "tools/proleg/ui/fast_simulation.hpp"
#include "tools/proleg/ui/gait_motion.hpp"
#include "tools/proleg/ui/scenario_copy.hpp"
#include "tools/proleg/ui/search_form.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using optimize::Experiment;

constexpr const char* searches_folder = "searches";
constexpr std::chrono::milliseconds look_period{50};
constexpr std::chrono::milliseconds reap_period{500};

std::string name_in(const json& arguments) {
  return argument<std::string>(arguments, "name", "the name of a search").value_or("");
}

std::uint32_t run_in(const json& arguments) {
  return argument<std::uint32_t>(arguments, "run", "the number of a run").value_or(0);
}

std::uint64_t number_in(const json& arguments) {
  const auto number = argument<std::uint64_t>(arguments, "number", "the number of an evaluation");
  if (!number) {
    throw InputError("number", 0, "nothing", "the number of an evaluation");
  }
  return *number;
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

json names_of(const optimize::SearchSpace& space) {
  json names = json::array();
  for (const optimize::Dimension& dimension : space.dimensions) {
    names.push_back(dimension.name);
  }
  return names;
}

/// The engine of the search whose experiment file this is; nothing: it is no file of a search, or one without an
/// engine.
std::optional<std::string> engine_of_search(SearchResults& results, const fs::path& file) {
  const fs::path search = file.parent_path();
  std::error_code error;
  if (!fs::exists(SearchFolder::store_of(search), error)) {
    return std::nullopt;
  }
  try {
    const auto engine = results.describe(search).at("engine").get<std::string>();
    const bool is_known =
        std::ranges::any_of(sim::physics_engines, [&](const auto& its) { return its.word == engine; });
    return is_known ? std::optional(engine) : std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;
  } catch (const optimize::StoreError&) {
    return std::nullopt;
  }
}

/// Whether a search has left anything that is worth keeping.
bool has_evaluations(const fs::path& search) {
  try {
    return optimize::read_store_summary(SearchFolder::store_of(search)).made > 0;
  } catch (const optimize::StoreError&) {
    return false;
  }
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

SearchSession::SearchSession(SearchSessionOptions options, ProgramShare& share, const ProjectFiles& files,
                             const PresentDraft& draft, SessionRequests& requests, host::SessionOutput& output)
    : SessionThread(requests, output),
      options_(std::move(options)),
      files_(files),
      draft_(draft),
      folder_(options_.folder),
      begun_({"search", SearchFolder::store_of({}).string(), SearchFolder::log_of({}).string(),
              SearchFolder::failure_of, has_evaluations, options_.longest_start},
             share, output) {
  if (options_.programs.empty()) {
    options_.programs = program_folder();
  }
  publish("search_methods", search_methods_json());
  begin_thread();
}

SearchSession::~SearchSession() { end_thread(); }

void SearchSession::serve() {
  if (!take_operations()) {
    read_searches();
  }
  if (begun_.look()) {
    folder_.look_again();
  }
  look_at_job();
  if (folder_.has_unread() || !are_read_) {
    return;
  }
  if (job_ || begun_.has_waiting()) {
    requests_.wait_until(Clock::now() + look_period);
  } else if (!begun_.is_empty()) {
    requests_.wait_until(Clock::now() + reap_period);
  } else {
    requests_.wait();
  }
}

/// Reads some more searches. They are read before a page asks for them, so that their list comes at once.
void SearchSession::read_searches() {
  if (folder_.has_unread() && is_list_shown_) {
    publish_searches();
  } else if (!are_read_) {
    static_cast<void>(folder_.list());
  }
  are_read_ = are_read_ || !folder_.has_unread();
}

void SearchSession::fail(const std::string& why) {
  begun_.refuse_all(why);
  end_job(why);
}

void SearchSession::close() {
  end_job("the program ends");
  begun_.close();
}

json SearchSession::carry_out(const host::OperationRequest& operation) {
  static const std::map<std::string_view, Handler> handlers{{"search.refresh", &SearchSession::refresh},
                                                            {"search.open", &SearchSession::open},
                                                            {"search.rows", &SearchSession::rows},
                                                            {"search.candidate", &SearchSession::candidate},
                                                            {"search.motion", &SearchSession::motion},
                                                            {"search.check", &SearchSession::check},
                                                            {"search.read", &SearchSession::read},
                                                            {"search.estimate", &SearchSession::estimate},
                                                            {"search.adaptations", &SearchSession::adaptations},
                                                            {"search.confirm", &SearchSession::confirm},
                                                            {"search.start", &SearchSession::start},
                                                            {"search.stop", &SearchSession::stop},
                                                            {"search.resume", &SearchSession::resume}};
  return (this->*handler_of(handlers, operation.name))(operation);
}

json SearchSession::refresh(const host::OperationRequest& /*request*/) {
  is_list_shown_ = true;
  publish_searches();
  return json::object();
}

void SearchSession::publish_searches() {
  json experiments = json::array();
  for (const ProjectFile& file : files_.experiments()) {
    experiments.push_back({{"file", file.file}, {"title", file.title}, {"is_shipped", file.is_shipped}});
  }
  publish("searches", {{"processors", begun_.share().processors()},
                       {"experiments", std::move(experiments)},
                       {"searches", folder_.list()}});
}

std::shared_ptr<const sim::Scenario> SearchSession::draft() const {
  std::shared_ptr<const sim::Scenario> scenario = draft_.get().scenario;
  if (scenario == nullptr) {
    throw std::runtime_error("there is no draft; make or open a scenario first");
  }
  return scenario;
}

json SearchSession::open(const host::OperationRequest& request) {
  const std::string name = name_in(request.arguments);
  json description = results_.describe(folder_.find(name));
  description["name"] = name;
  return description;
}

json SearchSession::rows(const host::OperationRequest& request) {
  const auto from = argument<std::uint64_t>(request.arguments, "from", "the number of an evaluation").value_or(0);
  return results_.rows(folder_.find(name_in(request.arguments)), run_in(request.arguments), from);
}

json SearchSession::candidate(const host::OperationRequest& request) {
  return results_.candidate(folder_.find(name_in(request.arguments)), run_in(request.arguments),
                            number_in(request.arguments));
}

json SearchSession::adaptations(const host::OperationRequest& request) {
  return results_.adaptations(folder_.find(name_in(request.arguments)), folder_.folder());
}

json SearchSession::motion(const host::OperationRequest& request) {
  constexpr std::chrono::milliseconds longest{2000};
  const auto is_outdated = [this] { return requests_.interrupts(); };
  const auto name = argument<std::string>(request.arguments, "name", "the name of a search, or null");
  if (!name) {
    return json::binary(gait_motion(*draft(), longest, is_outdated));
  }
  const sim::Scenario scenario =
      results_.scenario_of(folder_.find(*name), run_in(request.arguments), number_in(request.arguments));
  return json::binary(gait_motion(scenario, longest, is_outdated));
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
          {"candidates", std::isfinite(experiment.space.size()) ? json(experiment.space.size()) : json()},
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

std::vector<std::string> SearchSession::command(const std::string& program,
                                                const std::vector<std::string>& words) const {
  std::vector<std::string> command{(options_.programs / ("proleg-" + program)).string()};
  command.insert(command.end(), words.begin(), words.end());
  for (const std::string& library : loaded_libraries()) {
    command.insert(command.end(), {"--algorithms", library});
  }
  return command;
}

std::vector<std::string> SearchSession::options_in(const json& arguments) const {
  std::vector<std::string> options;
  if (const auto engine = argument<std::string>(arguments, "engine", "the name of an engine, or null")) {
    options.insert(options.end(), {"--engine", *engine});
  }
  const std::uint32_t workers =
      begun_.share().workers(argument<std::uint32_t>(arguments, "workers", "a number of workers, or null"));
  options.insert(options.end(), {"--workers", std::to_string(workers)});
  return options;
}

json SearchSession::estimate(const host::OperationRequest& request) {
  const std::shared_ptr<const sim::Scenario> scenario = draft();
  const optimize::ExperimentForm form = form_in(request.arguments);
  static_cast<void>(required_experiment(form, *scenario));
  auto program = std::make_unique<JsonProgram>();
  std::vector<std::string> words{write_search_files(form, *scenario, program->folder(), "estimate").string(),
                                 "--estimate", "--json"};
  const std::vector<std::string> options = options_in(request.arguments);
  words.insert(words.end(), options.begin(), options.end());
  return begin_job(request, std::move(program), command("optimise", words),
                   {"evaluation_s", "planned", "seconds", "engine"});
}

json SearchSession::confirm(const host::OperationRequest& request) {
  const auto name = argument<std::string>(request.arguments, "name", "the name of a search, or null");
  std::vector<std::string> words;
  std::optional<sim::Scenario> scenario;
  if (name) {
    const fs::path search = folder_.find(*name);
    const std::uint32_t run = run_in(request.arguments);
    const std::uint64_t number = number_in(request.arguments);
    scenario = results_.scenario_of(search, run, number);
    const json candidate = results_.candidate(search, run, number);
    for (const json& word : candidate["words"]) {
      words.insert(words.end(), {"--set", word.get<std::string>()});
    }
  } else {
    scenario = *draft();
  }
  auto program = std::make_unique<JsonProgram>();
  const std::string top = scenario->sources.front().path;
  words.insert(words.end(), {"--engine", std::string(sim::name_of(scenario->environment.engine)), "--seed",
                             std::to_string(scenario->kernel.seed), "--json",
                             copy_sources(scenario->sources, program->folder() / "scenario").at(top)});
  return begin_job(request, std::move(program), command("confirm", words),
                   {"nothing_speaks_against", "findings", "runs"});
}

json SearchSession::begin_job(const host::OperationRequest& request, std::unique_ptr<JsonProgram> program,
                              const std::vector<std::string>& words, std::vector<const char*> members) {
  end_job("another estimate or confirmation was asked for");
  program->start(words, options_.longest_job);
  job_.emplace(Job{request.request, std::move(program), std::move(members)});
  return answered_later();
}

void SearchSession::look_at_job() {
  if (!job_) {
    return;
  }
  const std::optional<JsonProgram::End> end = job_->program->look();
  if (!end) {
    return;
  }
  if (!end->object.is_object()) {
    end_job(end->error);
    return;
  }
  json value = json::object();
  for (const char* member : job_->members) {
    value[member] = end->object.value(member, json());
  }
  if (value.contains("findings") && value["findings"].is_array()) {
    const std::string folder = (job_->program->folder() / "scenario").string() + "/";
    for (json& finding : value["findings"]) {  // its files have gone when a person reads this
      std::string text = finding.value("text", std::string());
      for (std::size_t at = text.find(folder); at != std::string::npos; at = text.find(folder, at)) {
        text.erase(at, folder.size());
      }
      finding["text"] = text;
    }
  }
  output_.answer(job_->request, value);
  job_.reset();
}

void SearchSession::end_job(const std::string& refusal) {
  if (job_) {
    output_.refuse(job_->request, refusal);
    job_.reset();
  }
}

json SearchSession::start(const host::OperationRequest& request) {
  const json& arguments = request.arguments;
  const std::string name = name_in(arguments);
  const fs::path parent = folder_.folder() / searches_folder;
  static_cast<void>(new_folder_in(parent, name, "name"));
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
  std::vector<std::string> options = options_in(arguments);
  if (file && !argument<std::string>(arguments, "engine", "the name of an engine, or null")) {
    if (const auto engine = engine_of_search(results_, *file)) {  // it is started again
      options.insert(options.end(), {"--engine", *engine});
    }
  }
  const fs::path folder = make_new_folder(parent, name);
  try {
    if (!file) {
      words.push_back(write_search_files(form, *scenario, folder, name).string());
    }
    words.insert(words.end(), {"--out", folder.string()});
    words.insert(words.end(), options.begin(), options.end());
    begun_.begin(request.request, std::string(searches_folder) + "/" + name, folder, true, command("optimise", words),
                 folder);
  } catch (...) {
    std::error_code error;
    fs::remove_all(folder, error);
    throw;
  }
  return answered_later();
}

json SearchSession::resume(const host::OperationRequest& request) {
  const json& arguments = request.arguments;
  const std::string name = name_in(arguments);
  const fs::path folder = folder_.find(name);
  if (begun_.begins(folder) || optimize::is_being_written(SearchFolder::store_of(folder))) {
    throw std::runtime_error("this search is running");
  }
  std::vector<std::string> words{"--resume", folder.string()};
  if (const auto evaluations = argument<std::string>(arguments, "evaluations", "a number as a text");
      evaluations && !trimmed(*evaluations).empty()) {
    words.insert(words.end(), {"--evaluations", std::string(trimmed(*evaluations))});
  }
  const std::vector<std::string> options = options_in(arguments);
  words.insert(words.end(), options.begin(), options.end());
  begun_.begin(request.request, name, folder, false, command("optimise", words), folder);
  return answered_later();
}

json SearchSession::stop(const host::OperationRequest& request) {
  const std::string name = name_in(request.arguments);
  if (begun_.stop(name)) {
    return json::object();
  }
  const fs::path folder = folder_.find(name);
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
