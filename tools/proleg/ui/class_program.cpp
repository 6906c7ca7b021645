#include "tools/proleg/ui/class_program.hpp"

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/server/web_server.hpp"
#include "host/transport/open_transport.hpp"
#include "shared/computer/algorithm_library/algorithm_library.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/errors/secret_file.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/installation.hpp"
#include "tools/proleg/common/shipped_scenarios.hpp"
#include "tools/proleg/ui/class_files.hpp"
#include "tools/proleg/ui/class_room.hpp"
#include "tools/proleg/ui/class_session.hpp"
#include "tools/proleg/ui/program_watch.hpp"
#include "tools/proleg/ui/project_files.hpp"

namespace proleg::tools {
namespace {

constexpr unsigned most_robots = 100;

unsigned robots_in(const std::string& word) {
  const std::optional<unsigned> count = parse_whole<unsigned>(word);
  if (!count || *count == 0 || *count > most_robots) {
    throw InputError("--class", 0, in_quotes(word), "a number of learners, 1 to " + std::to_string(most_robots));
  }
  return *count;
}

std::size_t seats_per_address_in(const std::string& word) {
  const std::optional<std::size_t> count = parse_whole<std::size_t>(word);
  if (!count || *count == 0 || *count > ClassRegister::most_learners) {
    throw InputError("--seats-per-address", 0, in_quotes(word),
                     "a number of names, 1 to " + std::to_string(ClassRegister::most_learners));
  }
  return *count;
}

ClassRoomOptions room_options(const ClassOptions& options) {
  ClassRoomOptions room;
  room.most_robots = robots_in(options.learners);
  room.folder = options.folder;
  room.limits = limits_of_learner(room.most_robots, parse_workers(std::nullopt));
  room.most_seats_of_address = seats_per_address_in(options.seats_per_address);
  room.command = {(program_folder() / "proleg-ui").string(), "--seat", "--no-browser", "--recordings", "."};
  for (const std::string& library : loaded_libraries()) {
    room.command.insert(room.command.end(), {"--algorithms", std::filesystem::absolute(library).string()});
  }
  if (options.scenario) {
    room.first_scenario.emplace(*options.scenario);
  }
  room.is_open_to_network = options.lan.lan;
  room.may_write_code = options.allow_code;
  room.page_program = build_id;
  room.may_teacher_write_code = options.allow_code || !options.lan.lan;
  return room;
}

std::filesystem::path teacher_folder(const ClassRoom& room) { return room.folders().front().path; }

}  // namespace

int serve_class(const ClassOptions& options) {
  std::shared_ptr<const host::ServerCertificate> certificate = open_certificate(options.lan, "proleg ui");
  host::PageFiles page_files(options.page);
  if (const auto warning = warning_on_secret(options.folder / ClassRegister::file_name)) {
    print_warning("proleg ui", *warning);
  }
  ClassRoom room(room_options(options));  // before the context, whose connections use it until they end
  catch_interrupts();
  boost::asio::io_context context{1};
  SessionRequests file_requests;
  SessionRequests requests;
  ClassRouter router(room, file_requests, requests);
  const host::AccessToken token = host::AccessToken::make();
  host::ServerOptions server{token, std::move(page_files), std::string("proleg ") + build_id, {}, options.port};
  server.certificate = std::move(certificate);
  server.seats = &room;
  server.refused = warn_of_refusal;
  server.documents = served_documentation();
  for (const std::vector<std::string>& operations : {ClassFiles::operations(), ClassSession::operations()}) {
    server.free_operations.insert(operations.begin(), operations.end());
  }
  host::WebServer page(context, std::move(server), router);
  const ProjectFiles projects(teacher_folder(room), shipped_folder(), RecentFiles(std::nullopt));
  const ClassFiles files(room, projects, file_requests, page);
  const ClassSession session(room, page.origin() + "/", requests, page);
  const PageAddress address(page.origin(), page.port(), token.text());
  std::cout << "teacher: " << address.url() << "\nlearners: " << page.origin() << "/ with the code "
            << room.document().at("code").get<std::string>() << "\nfolder: " << one_line(room.folder().string())
            << "\nThe teacher's address is a secret: who has it can drive every robot. Ctrl-C ends.\n"
            << std::flush;
  if (!options.no_browser) {
    address.open();
  }
  constexpr std::chrono::milliseconds signal_period{100};
  constexpr std::chrono::seconds goodbye{2};
  ProgramWatch watch(build_id, page);
  while (!interrupted()) {
    context.restart();
    context.run_for(signal_period);
    watch.look(std::chrono::steady_clock::now());
  }
  page.stop();
  context.restart();
  context.run_for(goodbye);
  room.forget_joins();
  return exit_success;
}

}  // namespace proleg::tools
