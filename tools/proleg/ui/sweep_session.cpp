#include "tools/proleg/ui/sweep_session.hpp"

#include <cmath>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include "shared/computer/algorithm_library/algorithm_library.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/store_file.hpp"
#include "sim/optimize/experiment/trials.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/installation.hpp"
#include "tools/proleg/ui/fast_simulation.hpp"
#include "tools/proleg/ui/gait_motion.hpp"
#include "tools/proleg/ui/scenario_copy.hpp"
#include "tools/proleg/ui/search_form.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using optimize::Sweep;
using optimize::SweptQuantity;

constexpr const char* sweeps_folder = "sweeps";
constexpr const char* scenario_folder = ".scenario";  // where lists of scenarios do not look
constexpr std::chrono::milliseconds look_period{50};
constexpr std::chrono::milliseconds reap_period{500};

/// What a form asks for.
struct SweepForm {
  std::vector<std::string> over;
  std::string measure;
  std::optional<std::string> engine;
  std::optional<std::uint32_t> workers;
};

std::string name_in(const json& arguments) {
  return argument<std::string>(arguments, "name", "the name of a sweep").value_or("");
}

std::uint64_t cell_in(const json& arguments) {
  return required_argument<std::uint64_t>(arguments, "cell", "the number of a cell");
}

std::optional<std::uint32_t> workers_in(const json& arguments) {
  return argument<std::uint32_t>(arguments, "workers", "a number of workers, or null");
}

SweepForm form_in(const json& arguments) {
  return {argument<std::vector<std::string>>(arguments, "over", "quantities such as \"amplitude=10:50:5\"")
              .value_or(std::vector<std::string>()),
          argument<std::string>(arguments, "measure", "the name of a measure").value_or("distance"),
          argument<std::string>(arguments, "engine", "the name of an engine, or null"), workers_in(arguments)};
}

/// The sweep of the form, or the field that is wrong and why.
std::variant<Sweep, FormProblem> judge_sweep(const SweepForm& form, const sim::Scenario& draft) {
  if (!sim::find_measure(form.measure)) {
    return FormProblem{"measure",
                       "found " + in_quotes(form.measure) + ", expected one of " + listed(sim::measure_names())};
  }
  sim::Scenario scenario = draft;
  if (form.engine) {
    sim::OverrideWords words;
    words.engine = form.engine;
    try {
      scenario.environment.engine = *sim::read_overrides(words).engine;
    } catch (const InputError& error) {
      return FormProblem{"engine", error.problem()};
    }
  }
  if (const std::optional<std::string> refusal = refusal_of_engine(scenario)) {
    return FormProblem{"engine", *refusal};
  }
  if (form.over.empty()) {
    return FormProblem{"over", "found no quantity, expected one at least"};
  }
  // Which quantity is wrong: the last one of the shortest list that is refused.
  for (std::size_t count = 1; count <= form.over.size(); ++count) {
    const std::vector<std::string> first(form.over.begin(), form.over.begin() + static_cast<std::ptrdiff_t>(count));
    try {
      Sweep sweep = optimize::read_sweep(scenario, first);
      if (count == form.over.size()) {
        return sweep;
      }
    } catch (const InputError& error) {
      return FormProblem{"over." + std::to_string(count - 1), one_line(error.problem())};
    }
  }
  return FormProblem{};
}

Sweep required_sweep(const SweepForm& form, const sim::Scenario& draft) {
  std::variant<Sweep, FormProblem> judged = judge_sweep(form, draft);
  if (const auto* const problem = std::get_if<FormProblem>(&judged)) {
    throw std::runtime_error(problem->field + ": " + problem->text);
  }
  return std::move(std::get<Sweep>(judged));
}

/// Why the reduced engine cannot simulate it; null: it can.
json refusal_of_reduced(sim::Scenario scenario) {
  scenario.environment.engine = sim::PhysicsEngine::reduced;
  const std::optional<std::string> refusal = refusal_of_engine(scenario);
  return refusal ? json(*refusal) : json();
}

bool has_runs(const fs::path& sweep) {
  std::error_code error;
  return fs::exists(SweepFolder::table_of(sweep), error);
}

/// Whether several seeds would give equal runs.
bool has_equal_seeds(const Sweep& sweep) {
  bool has_seeds = false;
  for (const SweptQuantity& quantity : sweep.quantities) {
    if (quantity.name.find("noise") != std::string::npos) {
      return false;
    }
    has_seeds = has_seeds || (quantity.kind == SweptQuantity::Kind::seed && quantity.values.size() > 1);
  }
  return has_seeds && !optimize::depends_on_seed(sweep.scenario, {}, {});
}

}  // namespace

SweepSession::SweepSession(SweepSessionOptions options, ProgramShare& share, const PresentDraft& draft,
                           SessionRequests& requests, host::SessionOutput& output)
    : SessionThread(requests, output),
      options_(std::move(options)),
      draft_(draft),
      folder_(options_.folder),
      begun_({"sweep", optimize::sweep_table_name, SweepFolder::log_of({}).string(), SweepFolder::failure_of, has_runs,
              options_.longest_start},
             share, output) {
  if (options_.programs.empty()) {
    options_.programs = program_folder();
  }
  begin_thread();
}

SweepSession::~SweepSession() { end_thread(); }

void SweepSession::serve() {
  static_cast<void>(take_operations());
  if (begun_.look()) {
    folder_.look_again();
  }
  look_at_estimate();
  if (estimate_ || begun_.has_waiting()) {
    requests_.wait_until(Clock::now() + look_period);
  } else if (!begun_.is_empty()) {
    requests_.wait_until(Clock::now() + reap_period);
  } else {
    requests_.wait();
  }
}

void SweepSession::fail(const std::string& why) {
  begun_.refuse_all(why);
  end_estimate(why);
}

void SweepSession::close() {
  end_estimate("the program ends");
  begun_.close();
}

json SweepSession::carry_out(const host::OperationRequest& operation) {
  static const std::map<std::string_view, Handler> handlers{
      {"sweep.refresh", &SweepSession::refresh},   {"sweep.open", &SweepSession::open},
      {"sweep.cells", &SweepSession::cells},       {"sweep.cell", &SweepSession::cell},
      {"sweep.motion", &SweepSession::motion},     {"sweep.check", &SweepSession::check},
      {"sweep.estimate", &SweepSession::estimate}, {"sweep.start", &SweepSession::start},
      {"sweep.stop", &SweepSession::stop},         {"sweep.resume", &SweepSession::resume}};
  return (this->*handler_of(handlers, operation.name))(operation);
}

std::shared_ptr<const sim::Scenario> SweepSession::draft() const {
  std::shared_ptr<const sim::Scenario> scenario = draft_.get().scenario;
  if (scenario == nullptr) {
    throw std::runtime_error("there is no draft; make or open a scenario first");
  }
  return scenario;
}

std::vector<std::string> SweepSession::command(const std::string& program,
                                               const std::vector<std::string>& words) const {
  std::vector<std::string> command{(options_.programs / ("proleg-" + program)).string()};
  command.insert(command.end(), words.begin(), words.end());
  for (const std::string& library : loaded_libraries()) {
    command.insert(command.end(), {"--algorithms", library});
  }
  return command;
}

json SweepSession::refresh(const host::OperationRequest& /*request*/) {
  json document{{"processors", begun_.share().processors()}, {"sweeps", folder_.list()}};
  if (document != published_) {
    published_ = document;
    output_.publish("sweeps", std::move(document));
  }
  return json::object();
}

json SweepSession::open(const host::OperationRequest& request) {
  const std::string name = name_in(request.arguments);
  json description = results_.describe(folder_.find(name));
  description["name"] = name;
  return description;
}

json SweepSession::cells(const host::OperationRequest& request) {
  const auto from = argument<std::uint64_t>(request.arguments, "from", "the number of a cell").value_or(0);
  const auto measure = argument<std::string>(request.arguments, "measure", "the name of a measure, or null");
  return results_.cells(folder_.find(name_in(request.arguments)), measure, from);
}

json SweepSession::cell(const host::OperationRequest& request) {
  return results_.cell(folder_.find(name_in(request.arguments)), cell_in(request.arguments));
}

json SweepSession::motion(const host::OperationRequest& request) {
  constexpr std::chrono::milliseconds longest{2000};
  const sim::Scenario scenario =
      results_.scenario_of(folder_.find(name_in(request.arguments)), cell_in(request.arguments));
  return json::binary(gait_motion(scenario, longest, [this] { return requests_.interrupts(); }));
}

json SweepSession::check(const host::OperationRequest& request) {
  const std::shared_ptr<const sim::Scenario> scenario = draft();
  const SweepForm form = form_in(request.arguments);
  static_cast<void>(begun_.share().workers(form.workers));
  const std::variant<Sweep, FormProblem> judged = judge_sweep(form, *scenario);
  if (const auto* const problem = std::get_if<FormProblem>(&judged)) {
    return {{"problem", {{"field", problem->field}, {"text", problem->text}}},
            {"engine", std::string(sim::name_of(scenario->environment.engine))},
            {"reduced", refusal_of_reduced(*scenario)}};
  }
  const auto& sweep = std::get<Sweep>(judged);
  json counts = json::array();
  for (const SweptQuantity& quantity : sweep.quantities) {
    counts.push_back(quantity.values.size());
  }
  return {{"runs", sweep.size()},
          {"counts", std::move(counts)},
          {"has_equal_seeds", has_equal_seeds(sweep)},
          {"engine", std::string(sim::name_of(scenario->environment.engine))},
          {"reduced", refusal_of_reduced(*scenario)}};
}

json SweepSession::estimate(const host::OperationRequest& request) {
  const std::shared_ptr<const sim::Scenario> scenario = draft();
  const SweepForm form = form_in(request.arguments);
  const std::uint64_t runs = required_sweep(form, *scenario).size();
  end_estimate("another estimate was asked for");
  auto program = std::make_unique<JsonProgram>();
  const std::string top = scenario->sources.front().path;
  std::vector<std::string> words{copy_sources(scenario->sources, program->folder() / "scenario").at(top), "--json"};
  if (form.engine) {
    words.insert(words.end(), {"--engine", *form.engine});
  }
  program->start(command("simulate", words), options_.longest_estimate);
  estimate_.emplace(Estimate{request.request, std::move(program), runs, begun_.share().workers(form.workers)});
  return answered_later();
}

void SweepSession::look_at_estimate() {
  const std::optional<JsonProgram::End> end = estimate_ ? estimate_->program->look() : std::nullopt;
  if (!end) {
    return;
  }
  if (!end->object.is_object()) {
    end_estimate(end->error);
    return;
  }
  const double simulated_s = end->object.value("simulated_s", 0.0);
  const double factor = end->object.value("real_time_factor", 0.0);
  const double run_s = factor > 0.0 ? simulated_s / factor : 0.0;
  output_.answer(estimate_->request,
                 {{"run_s", run_s},
                  {"seconds", run_s * static_cast<double>(estimate_->runs) / static_cast<double>(estimate_->workers)}});
  estimate_.reset();
}

void SweepSession::end_estimate(const std::string& refusal) {
  if (estimate_) {
    output_.refuse(estimate_->request, refusal);
    estimate_.reset();
  }
}

json SweepSession::start(const host::OperationRequest& request) {
  const std::string name = name_in(request.arguments);
  const fs::path parent = folder_.folder() / sweeps_folder;
  static_cast<void>(new_folder_in(parent, name, "name"));
  const std::shared_ptr<const sim::Scenario> scenario = draft();
  const SweepForm form = form_in(request.arguments);
  static_cast<void>(required_sweep(form, *scenario));
  const std::string workers = std::to_string(begun_.share().workers(form.workers));
  const fs::path folder = make_new_folder(parent, name);
  try {
    const std::string top = scenario->sources.front().path;
    const fs::path copy = copy_sources(scenario->sources, folder / scenario_folder).at(top);
    std::vector<std::string> words{fs::weakly_canonical(copy).lexically_relative(folder).string(), "--measure",
                                   form.measure, "--out", "."};
    for (const std::string& over : form.over) {
      words.insert(words.end(), {"--over", over});
    }
    if (form.engine) {
      words.insert(words.end(), {"--engine", *form.engine});
    }
    words.insert(words.end(), {"--workers", workers});
    begun_.begin(request.request, std::string(sweeps_folder) + "/" + name, folder, true, command("sweep", words),
                 folder);
  } catch (...) {
    std::error_code error;
    fs::remove_all(folder, error);
    throw;
  }
  return answered_later();
}

json SweepSession::stop(const host::OperationRequest& request) {
  const std::string name = name_in(request.arguments);
  if (begun_.stop(name)) {
    return json::object();
  }
  optimize::request_stop(SweepFolder::table_of(folder_.find(name)));
  return json::object();
}

json SweepSession::resume(const host::OperationRequest& request) {
  const std::string name = name_in(request.arguments);
  const fs::path folder = folder_.find(name);
  if (begun_.begins(folder) || optimize::is_being_written(SweepFolder::table_of(folder))) {
    throw std::runtime_error("this sweep is running");
  }
  const NotedSweep note = SweepFolder::note_of(folder);
  const fs::path directory = (folder / note.request.folder).lexically_normal();
  std::error_code error;
  if (!fs::is_directory(directory, error)) {
    throw InputError(directory.string(), 0, "no folder", "that in which the sweep was started");
  }
  std::vector<std::string> words = optimize::words_of(note.request);
  // One that was killed before its first run has nothing that could be resumed.
  words.insert(words.end(), {has_runs(folder) ? "--resume" : "--out", folder.string()});
  words.insert(words.end(), {"--workers", std::to_string(begun_.share().workers(workers_in(request.arguments)))});
  begun_.begin(request.request, name, folder, false, command("sweep", words), directory);
  return answered_later();
}

}  // namespace proleg::tools
