// proleg ui: a page in the browser that shows and drives a simulated robot.

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "host/server/session_requests.hpp"
#include "host/server/web_server.hpp"
#include "host/transport/bus_address.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/build_id.hpp"
#include "tools/proleg/bus_access.hpp"
#include "tools/proleg/command_line.hpp"
#include "tools/proleg/interrupt.hpp"
#include "tools/proleg/robot_files.hpp"
#include "tools/proleg/scenario_run.hpp"
#include "tools/proleg/ui/browser.hpp"
#include "tools/proleg/ui/bus_session.hpp"
#include "tools/proleg/ui/lan_access.hpp"
#include "tools/proleg/ui/simulated_session.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct UiOptions {
  ScenarioOptions scenario;
  BusOptions bus;
  LanOptions lan;
  std::string port = "0";
  std::string recordings = ".";
  std::optional<std::string> page;
  bool no_browser = false;
  bool paused = false;
};

/// The files of a robot with five joints, for those who give none.
class NewRobot final : public sim::FileSource {
 public:
  [[nodiscard]] std::optional<std::string> read(const std::filesystem::path& path) override {
    for (const NewFile& file : files_) {
      if (path.lexically_normal() == std::filesystem::path(file.name)) {
        return file.text;
      }
    }
    return std::nullopt;
  }
  [[nodiscard]] const std::string& name() const { return files_.front().name; }

 private:
  std::vector<NewFile> files_ = robot_files("ppppp");
};

ScenarioRun prepare(ScenarioOptions& options) {
  if (!options.file.empty()) {
    return prepare_run(options);
  }
  NewRobot files;
  options.file = files.name();
  return prepare_run(options, files);
}

/// In quotes for a shell, if it needs them.
std::string shell_word(const std::string& word) {
  constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:=,@%+";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) {
    return word;
  }
  std::string quoted = "'";
  for (const char character : word) {
    quoted += character == '\'' ? std::string("'\\''") : std::string(1, character);
  }
  return quoted + "'";
}

/// The command that simulates the same scenario.
std::string simulate_command(const UiOptions& options, bool has_file) {
  const ScenarioOptions& scenario = options.scenario;
  std::string command = has_file ? "proleg simulate " + shell_word(scenario.file)
                                 : "proleg new robot --joints 5 && proleg simulate robot/" + scenario.file;
  const std::pair<const char*, const std::optional<std::string>&> overrides[] = {
      {"--seed", scenario.overrides.seed},
      {"--friction", scenario.overrides.friction},
      {"--at", scenario.overrides.at},
      {"--heading", scenario.overrides.heading}};
  for (const auto& [option, value] : overrides) {
    if (value) {
      command += std::string(" ") + option + ' ' + shell_word(*value);
    }
  }
  for (const std::string& word : scenario.settings) {
    command += " --set " + shell_word(word);
  }
  return command;
}

/// The page as tools/page builds it, beside the build of this program.
std::filesystem::path page_folder(const UiOptions& options) {
  if (options.page) {
    return *options.page;
  }
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path folder = (self.parent_path() / "../../page").lexically_normal();
  if (!std::filesystem::exists(folder / "index.html", error)) {
    throw BadInput("found no page in " + folder.string() + ", expected one that tools/page has built");
  }
  return folder;
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

void refuse_what_only_a_simulation_has(const UiOptions& options) {
  const sim::OverrideWords& overrides = options.scenario.overrides;
  const std::pair<const char*, bool> given[] = {{"--paused", options.paused},
                                                {"--friction", overrides.friction.has_value()},
                                                {"--at", overrides.at.has_value()},
                                                {"--heading", overrides.heading.has_value()}};
  for (const auto& [option, is_given] : given) {
    if (is_given) {
      throw InputError(option, 0, "an option for simulated worlds", "none of them: the robot is where it is");
    }
  }
}

int serve(UiOptions& options) {
  const bool has_file = !options.scenario.file.empty();
  const std::uint16_t port = parse_port(options.port);
  require_folder(options.recordings);
  std::shared_ptr<const host::ServerCertificate> certificate = open_certificate(options.lan, "proleg ui");
  const ScenarioRun run = prepare(options.scenario);
  print_warnings("proleg ui", run.scenario);
  const host::AccessToken token = host::AccessToken::make();
  host::ServerOptions server{token, host::PageFiles(page_folder(options)), std::string("proleg ") + build_id, {}, port};
  server.certificate = std::move(certificate);
  for (const std::string& operation :
       options.bus.bus ? BusSession::free_operations() : SimulatedSession::free_operations()) {
    server.free_operations.insert(operation);
  }
  std::optional<BusAccess> bus;
  if (options.bus.bus) {
    refuse_what_only_a_simulation_has(options);
    bus.emplace(options.bus);
  }
  catch_interrupts();
  boost::asio::io_context context{1};
  host::SessionRequests requests;
  host::WebServer page(context, std::move(server), requests);
  std::optional<SimulatedSession> simulated;
  std::optional<BusSession> driven;
  if (bus) {
    driven.emplace(run.scenario, *bus, options.bus.address(), BusSessionOptions{options.recordings, build_id}, requests,
                   page);
  } else {
    simulated.emplace(
        run.scenario, &run.losses,
        SimulatedSessionOptions{options.recordings, simulate_command(options, has_file), build_id, options.paused},
        requests, page);
  }
  const PageAddress address(page.origin(), page.port(), token.text());
  std::cout << "page: " << address.url() << "\nThe address is a secret: who has it can drive the robot. Ctrl-C ends.\n"
            << std::flush;
  if (!options.no_browser && !address.open()) {
    std::cerr << "proleg ui: there is no desktop with a browser here; open the address yourself\n";
  }
  constexpr std::chrono::milliseconds signal_period{100};
  while (!interrupted()) {
    context.restart();
    context.run_for(signal_period);
  }
  page.stop();
  constexpr std::chrono::seconds goodbye{2};
  context.restart();
  context.run_for(goodbye);
  return exit_success;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg ui",
      "Serves a page on this computer that shows a simulated robot, drives it and changes its parameters while it "
      "moves, and opens it in the browser. Without FILE: a caterpillar with five joints. Ends with Ctrl-C.");
  UiOptions options;
  command_line.add_option("FILE", options.scenario.file, "scenario, a *.simulation.xml file");
  add_override_options(command_line, options.scenario);
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
  command_line.add_flag("--paused", options.paused, "begin at tick 0, paused");
  return command_line.run(argc, argv, [&] { return serve(options); });
}
