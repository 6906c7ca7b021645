// proleg ui: a page in the browser that shows and drives a simulated robot, and shows recordings.

#include <malloc.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <filesystem>
#include <initializer_list>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "host/remote/binding.hpp"
#include "host/server/robot_session.hpp"
#include "host/server/web_server.hpp"
#include "host/transport/bus_address.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/new_scenario.hpp"
#include "sim/record/recording_file.hpp"
#include "sim/scenario/actuation_reader.hpp"
#include "sim/scenario/robot_move.hpp"
#include "sim/scenario/sources.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/installation.hpp"
#include "tools/proleg/common/program_run.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/common/shipped_scenarios.hpp"
#include "tools/proleg/document/robot_document.hpp"
#include "tools/proleg/robot/bus_access.hpp"
#include "tools/proleg/robot/gait_run.hpp"
#include "tools/proleg/run/simulation_texts.hpp"
#include "tools/proleg/ui/algorithm_folders.hpp"
#include "tools/proleg/ui/algorithm_session.hpp"
#include "tools/proleg/ui/bus_session.hpp"
#include "tools/proleg/ui/class_program.hpp"
#include "tools/proleg/ui/desktop_start.hpp"
#include "tools/proleg/ui/draft_session.hpp"
#include "tools/proleg/ui/fast_simulation.hpp"
#include "tools/proleg/ui/gallery.hpp"
#include "tools/proleg/ui/mesh_session.hpp"
#include "tools/proleg/ui/modules_session.hpp"
#include "tools/proleg/ui/page_access.hpp"
#include "tools/proleg/ui/program_watch.hpp"
#include "tools/proleg/ui/project_files.hpp"
#include "tools/proleg/ui/recent_files.hpp"
#include "tools/proleg/ui/recorded_session.hpp"
#include "tools/proleg/ui/remote_session.hpp"
#include "tools/proleg/ui/search_session.hpp"
#include "tools/proleg/ui/seat_input.hpp"
#include "tools/proleg/ui/seat_limits.hpp"
#include "tools/proleg/ui/simulated_session.hpp"
#include "tools/proleg/ui/sweep_session.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

constexpr const char* recording_extension = ".proleg";
constexpr const char* default_recordings = ".";
constexpr const char* default_class_folder = "class";

struct UiOptions {
  ScenarioOptions scenario;
  BusOptions bus;
  LanOptions lan;
  std::string port = "0";
  std::string recordings = default_recordings;
  std::optional<std::string> page;
  bool no_browser = false;
  bool paused = false;
  bool allow_code = false;
  bool is_desktop = false;
  std::optional<std::string> learners;  ///< of a class
  std::string seats_per_address = "3";
  bool is_seat = false;  ///< started by a class
  std::optional<SeatSettings> seat;
};

/// The files of a robot with five joints, for those who give none.
class NewRobot final : public sim::FileSource {
 public:
  [[nodiscard]] std::optional<sim::SharedText> read(const std::filesystem::path& path) override {
    for (const sim::SourceFile& file : files_) {
      if (path.lexically_normal() == std::filesystem::path(file.path)) {
        return file.text;
      }
    }
    return std::nullopt;
  }
  [[nodiscard]] const std::string& name() const { return files_.front().path; }

 private:
  std::vector<sim::SourceFile> files_ = sim::new_scenario_files(sim::robot_kinds().front(), "ppppp");
};

/// The scenario; for a simulation as its files have it, because the session applies the settings.
ScenarioRun prepare(ScenarioOptions& options, NewRobot& new_robot, bool is_simulated) {
  const bool has_file = !options.file.empty();
  if (!has_file) {
    options.file = new_robot.name();
  }
  ScenarioOptions as_file = options;
  if (is_simulated) {
    as_file.settings.clear();
  }
  as_file.moves.clear();
  ScenarioRun run = has_file ? prepare_run(as_file) : prepare_run(as_file, new_robot);
  for (const std::string& move : options.moves) {
    sim::add_move(run.scenario, move);  // also after the duration in the file: the run has no end
  }
  return run;
}

/// The command that simulates the same scenario.
std::string command_of(const ScenarioOptions& scenario, const std::string& file) {
  return simulate_command(file, scenario.overrides, scenario.settings, scenario.moves);
}
std::string command_of(const UiOptions& options, bool has_file) {
  const ScenarioOptions& scenario = options.scenario;
  return has_file ? command_of(scenario, scenario.file)
                  : "proleg new robot --joints 5 && " + command_of(scenario, "robot/" + scenario.file);
}

std::uint16_t parse_port(const std::string& word) {
  const std::optional<std::uint16_t> port = parse_whole<std::uint16_t>(word);
  if (!port) {
    throw InputError("--port", 0, in_quotes(word), "0 to 65535; 0: any free one");
  }
  return *port;
}

void require_folder(const std::string& folder) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    throw InputError("--recordings", 0, in_quotes(folder), "a folder");
  }
}

/// The bindings of gamepads that were saved for the scenario. Throws InputError if the robot has no such parameters.
host::BindingStore bindings_beside(const UiOptions& options, bool has_file, const sim::Scenario& scenario) {
  if (!has_file) {
    return {};
  }
  const std::filesystem::path path = host::binding_file_of(options.scenario.file);
  host::BindingStore store(path);
  ParameterWords words;
  words.set_robot(robot_document(scenario, "simulation"));
  words.set_parameters(parameters_document(scenario, ParameterTable(scenario, scenario)));
  std::size_t number = 0;
  for (const host::Binding& binding : store.read_bindings()) {
    check_binding(binding, words, path.string() + ": binding " + std::to_string(++number));
  }
  return store;
}

/// What the page shows besides the robot that FILE describes; FILE may also be a recording or a folder.
RecordedSessionOptions recordings_of(const UiOptions& options) {
  const std::filesystem::path file(options.scenario.file);
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    return {file, std::nullopt, true};
  }
  if (sim::is_recording(file)) {
    if (file.extension() != recording_extension) {
      throw InputError(file.string(), 0, "a recording with another name", "a name that ends in .proleg");
    }
    return {file.has_parent_path() ? file.parent_path() : ".", file.filename().string(), true};
  }
  if (file.extension() == recording_extension) {
    throw InputError(file.string(), 0, std::filesystem::exists(file, error) ? "no recording" : "no file",
                     "a recording, as the option --record makes it");
  }
  require_folder(options.recordings);
  return {options.recordings, std::nullopt, false};
}

/// The scenarios of a project, besides its recordings.
void print_scenarios(const std::filesystem::path& folder) {
  constexpr std::size_t max_lines = 60;
  const std::vector<std::string> scenarios = ProjectFiles::scenarios_in(folder);
  if (scenarios.empty()) {
    return;
  }
  std::cout << "\nThe page Make opens the " << (scenarios.size() == 1 ? "scenario" : "scenarios")
            << " of this folder:\n";
  for (std::size_t i = 0; i < scenarios.size() && i < max_lines; ++i) {
    std::cout << "  " << one_line(scenarios[i]) << '\n';
  }
  if (scenarios.size() > max_lines) {
    std::cout << "  ... and " << scenarios.size() - max_lines << " more\n";
  }
  std::cout << std::flush;
}

/// Keeps what was opened for the list of another start. The program works without that list.
void note_as_recent(const RecentFiles& recent, const std::filesystem::path& path) {
  std::error_code error;
  const bool is_project = std::filesystem::is_directory(path, error);
  if (is_shipped(path) || (!is_project && !path.string().ends_with(scenario_extension))) {
    return;
  }
  try {
    recent.note(path);
  } catch (const std::exception& problem) {
    print_warning("proleg ui", std::string("the list of what was opened cannot be kept: ") + problem.what());
  }
}

/// Whether there are options of the robot of FILE, beside --paused.
bool has_robot_option(const UiOptions& options) {
  const ScenarioOptions& scenario = options.scenario;
  const sim::OverrideWords& overrides = scenario.overrides;
  const bool has_override = std::ranges::any_of(
      sim::override_declarations(), [&](const auto& declaration) { return (overrides.*declaration.word).has_value(); });
  return options.bus.bus || !scenario.settings.empty() || !scenario.moves.empty() || has_override;
}

/// Options of a robot have no effect without one.
void refuse_robot_options(const UiOptions& options) {
  if (options.paused || has_robot_option(options)) {
    throw BadInput("found an option of a robot with " + options.scenario.file + ", expected a scenario");
  }
}

/// Why viewers may not write code; empty: they may. Who writes an algorithm can do all that this program can do.
std::string code_refusal(const UiOptions& options) {
  if (options.seat && !options.seat->may_write_code) {
    return "algorithms of a class are those of the teacher; the option --allow-code of 'proleg ui --class' lets all "
           "write them";
  }
  return options.lan.lan && !options.allow_code
             ? "other computers may open this page, so it takes no code; the option --allow-code lets it"
             : "";
}

/// The source of an algorithm in the folder of a scenario, in those around it, or in a folder of these.
std::optional<AlgorithmFolder> algorithm_near(const std::filesystem::path& scenario, const std::string& name) {
  constexpr int most_levels = 3;
  std::error_code error;
  std::filesystem::path folder = std::filesystem::weakly_canonical(scenario, error).parent_path();
  for (int level = 0; level < most_levels && folder.has_relative_path(); ++level) {
    if (std::optional<AlgorithmFolder> found = AlgorithmFolders(folder).with_name(name)) {
      return found;
    }
    folder = folder.parent_path();
  }
  return std::nullopt;
}

/// What keeps a scenario from being shown at the start, if the person can build it on the page: the sources of all
/// missing algorithms are in the project. Else throws the error; it names a source that is near the scenario.
MissingAlgorithms offer_to_build(const UiOptions& options, const sim::UnknownAlgorithms& error) {
  const std::string& file = options.scenario.file;
  const AlgorithmFolders project(options.recordings);
  const bool has_all =
      std::ranges::all_of(error.names(), [&](const auto& name) { return project.with_name(name).has_value(); });
  if (has_all && code_refusal(options).empty() && !has_robot_option(options)) {
    return {file, "start", error.what(), error.names()};
  }
  if (const std::optional<AlgorithmFolder> found = algorithm_near(file, error.names().front())) {
    throw InputError(std::string(error.what()) + "; its source is in " + found->path.string() +
                     ": build it, then add --algorithms " + shell_argument(found->library().string()));
  }
  throw error;
}

/// draft: of the session that reads its files again for a new version of an algorithm.
AlgorithmSessionOptions code_options(const UiOptions& options, const std::filesystem::path& folder,
                                     SessionRequests& draft) {
  return {folder, code_refusal(options), [&draft] {
            draft.operate({0, "draft.refresh", nlohmann::json::object(), 0, ""});
          }};
}

/// The folder of the page: the one that was built, or another one.
std::filesystem::path page_folder(const UiOptions& options) {
  return options.page ? std::filesystem::path(*options.page) : folder_of_page("page", "index.html");
}

/// Options that belong to one robot have no meaning for a class.
void refuse_options_with_class(const UiOptions& options) {
  if (options.paused || options.is_seat || has_robot_option(options)) {
    throw BadInput("--class: found an option of one robot, expected a scenario or a folder, and options of the page");
  }
}

/// Whether FILE is the folder of a new class: neither is there anything with this name, nor is it that of a scenario or
/// a recording, or similar to one that ships.
bool is_new_class_folder(const std::string& file) {
  std::error_code error;
  if (file.empty() || std::filesystem::exists(std::filesystem::symlink_status(file, error))) {
    return false;
  }
  std::vector<std::string> known;
  for (const ShippedScenario& scenario : shipped_scenarios()) {
    known.emplace_back(scenario.name);
    known.emplace_back(scenario.file);
    known.push_back(known.back() + scenario_extension);
  }
  return !file.ends_with(".xml") && !file.ends_with(recording_extension) &&
         std::ranges::find(known, file) == known.end() &&
         (file.find('/') != std::string::npos || !most_similar(file, known));
}

/// FILE is a scenario with which all begin, or the folder of the class.
int serve_class(const UiOptions& options) {
  refuse_options_with_class(options);
  ClassOptions of_class;
  const std::string& file = options.scenario.file;
  std::error_code error;
  if (std::filesystem::is_directory(file, error) || is_new_class_folder(file)) {
    of_class.folder = file;
  } else {
    of_class.folder = options.recordings == default_recordings ? default_class_folder : options.recordings;
    if (!file.empty()) {
      of_class.scenario = file;
    }
  }
  of_class.learners = *options.learners;
  of_class.seats_per_address = options.seats_per_address;
  of_class.page = page_folder(options);
  of_class.port = parse_port(options.port);
  of_class.lan = options.lan;
  of_class.allow_code = options.allow_code;
  of_class.no_browser = options.no_browser;
  return tools::serve_class(of_class);
}

/// Serves the page until the program is to end. with_last_page: it ends when the last page has been closed, too.
/// moving: requests to the sessions that can move something, in the order of their end.
void serve_until_end(boost::asio::io_context& context, host::WebServer& page, bool with_last_page, ProgramWatch& watch,
                     std::initializer_list<SessionRequests*> moving) {
  constexpr std::chrono::milliseconds signal_period{100};
  constexpr std::chrono::seconds trim_period{10};
  LastPage last_page(std::chrono::steady_clock::now());
  for (auto trim_at = std::chrono::steady_clock::now() + trim_period; !interrupted();) {
    if (with_last_page && last_page.is_gone(std::chrono::steady_clock::now(), page.viewers())) {
      break;
    }
    context.restart();
    context.run_for(signal_period);
    const auto now = std::chrono::steady_clock::now();
    watch.look(now);
    if (now >= trim_at) {
      malloc_trim(0);  // the place of many small parts, such as those of a large world, goes back to the system
      trim_at = now + trim_period;
    }
  }
  // A robot stops before the goodbye, which may take its time, and viewers see it stop.
  constexpr std::chrono::milliseconds look_period{10};
  for (SessionRequests* const requests : moving) {
    requests->end();
    while (!requests->have_ended()) {
      context.restart();
      context.run_for(look_period);
    }
  }
  page.stop();
  constexpr std::chrono::seconds goodbye{2};
  context.restart();
  context.run_for(goodbye);
}

bool opens_any_address(const UiOptions& options) {
  return !(options.seat ? options.seat->is_open_to_network : options.lan.lan);
}

/// The modules on the table are for the teacher.
std::string modules_refusal(const UiOptions& options) {
  return options.seat && !options.seat->is_teacher ? "modules: they are for the teacher of a class" : "";
}

int serve(UiOptions& options) {
  if (options.is_desktop && (options.learners || options.is_seat || options.bus.bus)) {
    throw BadInput("--desktop: found an option of a class or a bus, which need a terminal, expected none");
  }
  if (options.learners) {
    return serve_class(options);
  }
  if (options.is_desktop && options.recordings == default_recordings) {
    options.recordings = desktop_folder();
  }
  InputLines input;
  if (options.is_seat) {
    options.seat = read_seat_settings(input);
  }
  // By itself the C library keeps the place of large texts, such as meshes, after their use (mallopt(3)).
  constexpr int large = 1 << 18;
  mallopt(M_MMAP_THRESHOLD, large);
  mallopt(M_ARENA_MAX, 2);
  const bool has_file = !options.scenario.file.empty();
  const std::uint16_t port = parse_port(options.port);
  RecordedSessionOptions recordings = recordings_of(options);
  if (options.allow_code && !options.lan.lan) {
    throw InputError("--allow-code", 0, "no --lan", "--lan beside it; this computer may write code without it");
  }
  std::shared_ptr<const host::ServerCertificate> certificate = open_certificate(options.lan, "proleg ui");
  NewRobot new_robot;
  std::optional<ScenarioRun> run;
  std::optional<MissingAlgorithms> missing;
  if (recordings.is_alone) {
    refuse_robot_options(options);
  } else {
    try {
      run = prepare(options.scenario, new_robot, !options.bus.bus);
      print_warnings("proleg ui", run->scenario);
    } catch (const sim::UnknownAlgorithms& error) {
      missing = offer_to_build(options, error);
      recordings.is_alone = true;  // until the person has built them
    }
  }
  const host::AccessToken token = options.seat ? options.seat->token : host::AccessToken::make();
  // The class serves the page of its seats.
  host::ServerOptions server{token,
                             options.seat ? host::PageFiles() : host::PageFiles(page_folder(options)),
                             std::string("proleg ") + build_id,
                             {},
                             port};
  server.certificate = std::move(certificate);
  server.is_seat = options.is_seat;
  server.refused = warn_of_refusal;
  if (!options.seat) {
    server.documents = served_documentation();
  }
  for (const std::vector<std::string>& operations :
       {options.bus.bus ? BusSession::free_operations() : SimulatedSession::free_operations(),
        RecordedSession::free_operations(), DraftSession::free_operations(), Gallery::free_operations(),
        AlgorithmSession::free_operations(), SearchSession::free_operations(), SweepSession::free_operations(),
        ModulesSession::free_operations(), RemoteSession::free_operations()}) {
    server.free_operations.insert(operations.begin(), operations.end());
  }
  std::optional<BusAccess> bus;
  if (options.bus.bus) {
    refuse_world_options(options.scenario, {{"--paused", options.paused}, {"--move", !options.scenario.moves.empty()}});
    bus.emplace(options.bus);
  }
  catch_interrupts();
  boost::asio::io_context context{1};
  SessionRequests recording_requests;
  SessionRequests draft_requests;
  SessionRequests mesh_requests;
  SessionRequests gallery_requests;
  SessionRequests algorithm_requests;
  SessionRequests search_requests;
  SessionRequests sweep_requests;
  SessionRequests module_requests;
  SessionRequests requests;
  RemoteSession remote(
      requests, run ? bindings_beside(options, has_file, run->scenario) : host::BindingStore(),
      options.seat && !options.seat->is_teacher ? RemoteSession::no_devices : RemoteSession::kernel_devices);
  const std::optional<SeatLimits> limits = options.seat ? options.seat->limits : std::nullopt;
  ProgramShare share(recordings.folder, limits);
  SessionRouter router(recording_requests, draft_requests, mesh_requests, gallery_requests, algorithm_requests,
                       search_requests, sweep_requests, module_requests, remote, requests);
  DiskGuard guard(recordings.folder, limits, router);
  host::WebServer page(context, std::move(server), guard);
  const DiskWatch disk(guard, page);
  const RecordedSession recorded(recordings, recording_requests, page);
  const RecentFiles recent(options.seat ? std::nullopt : recent_list_path());
  const ProjectFiles project_files(recordings.folder, shipped_folder(), recent);
  const Gallery gallery(project_files, gallery_requests, page);
  SentMeshes sent_meshes;
  const MeshSession meshes(sent_meshes, mesh_requests, page);
  PresentDraft present_draft;
  const DraftSession draft(
      run ? std::optional(run->scenario) : std::nullopt,
      {recordings.folder, has_file,
       [&](const std::string& file) { return (missing && file == missing->file) || project_files.has(file); },
       [&recent](const std::string& file) { note_as_recent(recent, file); }, &sent_meshes, missing},
      draft_requests, present_draft, page);
  const AlgorithmSession algorithms(code_options(options, recordings.folder, draft_requests), algorithm_requests, page);
  const SearchSession searches({recordings.folder}, share, project_files, present_draft, search_requests, page);
  const SweepSession sweeps({recordings.folder}, share, present_draft, sweep_requests, page);
  const RemoteThread remote_thread(remote, page);
  BusSharing sharing;
  std::optional<RobotBus> robot_bus;
  if (bus) {
    if (const auto line = fit_servo_period(run->scenario, options.bus.address())) {
      print_warning("proleg ui", *line);
      page.notice(host::NoticeLevel::warning, *line);
    }
    robot_bus.emplace(RobotBus{options.bus.address(), bus->connection().description(), run->scenario});
  }
  std::optional<SimulatedSession> simulated;
  std::optional<BusSession> driven;
  if (bus) {
    driven.emplace(run->scenario, *bus, options.bus.address(), BusSessionOptions{options.recordings, build_id}, sharing,
                   requests, remote);
  } else {
    std::unique_ptr<LiveSimulation> live;
    std::optional<std::string> refusal;
    if (run && has_file && !options.scenario.overrides.engine) {
      refusal = refusal_of_engine(run->scenario);
    }
    if (refusal) {  // Make can change what the engine refuses
      const std::string text = "there is no simulation: " + *refusal;
      print_warning("proleg ui", text);
      page.notice(host::NoticeLevel::error, text);
    } else if (run) {
      live = std::make_unique<LiveSimulation>(run->scenario, options.scenario.settings, &run->losses);
    }
    simulated.emplace(
        std::move(live),
        SimulatedSessionOptions{recordings.folder, run ? command_of(options, has_file) : std::string(),
                                [&](const std::string& file) { return command_of(options.scenario, file); }, has_file,
                                build_id, options.paused, &present_draft},
        requests, remote);
  }
  const ModulesSession modules({recordings.folder, robot_bus, opens_any_address(options), modules_refusal(options)},
                               present_draft, sharing, module_requests, page);
  ProgramWatch watch(options.seat ? options.seat->page_program : build_id, page);
  if (options.seat) {
    const SeatInput seat(*options.seat, input, page);
    serve_until_end(context, page, false, watch, {&module_requests, &requests});
    return exit_success;
  }
  const PageAddress address(page.origin(), page.port(), token.text());
  std::cout << "page: " << address.url() << "\nThe address is a secret: who has it can drive the robot. Ctrl-C ends.\n"
            << std::flush;
  if (missing) {
    std::cout << "\nThis scenario needs " << (missing->names.size() == 1 ? "an algorithm" : "algorithms")
              << " of this folder: " << one_line(listed(missing->names)) << ". The page Make offers to build "
              << (missing->names.size() == 1 ? "it" : "them") << ".\n"
              << std::flush;
  }
  if (std::error_code error; has_file && std::filesystem::is_directory(options.scenario.file, error)) {
    print_scenarios(options.scenario.file);
  }
  if (has_file) {
    note_as_recent(recent, options.scenario.file);
  }
  if (!options.no_browser) {
    address.open();
  }
  serve_until_end(context, page, options.is_desktop, watch, {&module_requests, &requests});
  return exit_success;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg ui",
      "Serves a page on this computer that shows a simulated robot, drives it and changes its parameters while it "
      "moves, and opens it in the browser. With a recording or a folder it shows recordings, also those that still "
      "grow; the page Make opens the scenarios of the folder. "
      "Without FILE: a caterpillar with five joints. Ends with Ctrl-C.");
  UiOptions options;
  add_scenario(command_line, options.scenario.file, "a recording, the folder of a project, or a scenario");
  command_line.prepare_with([&options] {
    if (!options.learners || !is_new_class_folder(options.scenario.file)) {
      options.scenario.file = scenario_file(options.scenario.file);
    }
  });
  add_override_options(command_line, options.scenario);
  add_move_option(command_line, options.scenario);
  command_line
      .add_option("--bus", options.bus.bus,
                  "show and drive the robot on this bus instead of a simulated one: " + host::bus_address_syntax())
      .value_name("BUS");
  command_line.add_option("--port", options.port, "TCP port; 0: any free one").shows_default();
  add_lan_options(command_line, options.lan);
  command_line.add_option("--recordings", options.recordings, "folder for recordings")
      .value_name("FOLDER")
      .shows_default();
  command_line.add_option("--page", options.page, "another page, a folder with index.html").value_name("FOLDER");
  command_line.add_flag("--no-browser", options.no_browser, "only print the address");
  command_line.add_flag("--desktop", options.is_desktop,
                        "as the menu of a desktop starts it: the folder for recordings is Proleg in your home, and the "
                        "program ends a minute after the last page was closed");
  command_line.add_flag("--allow-code", options.allow_code,
                        "with --lan or --class: let others write and run algorithms, which can do all that you can do");
  command_line
      .add_option("--class", options.learners,
                  "serve a class: a robot for each learner, at most this many at a time; FILE is a scenario with "
                  "which all begin, or the folder of the class, which is made if there is none; by default ./class")
      .value_name("LEARNERS");
  command_line
      .add_option("--seats-per-address", options.seats_per_address,
                  "with --class: learners that may get a name from one address; more where a router gives all of them "
                  "the same one (NAT)")
      .value_name("COUNT")
      .shows_default();
  command_line.add_flag("--seat", options.is_seat, "for 'proleg ui --class': the robot of one learner");
  command_line.add_flag("--paused", options.paused, "begin at tick 0, paused");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return serve(options); });
}
