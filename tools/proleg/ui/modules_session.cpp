#include "tools/proleg/ui/modules_session.hpp"

#include <algorithm>
#include <stdexcept>
#include <thread>
#include <utility>

#include "host/transport/bus_address.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/program_run.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Output = ModuleJobPlan::Output;

constexpr std::chrono::milliseconds look_period{20};
constexpr std::chrono::milliseconds draft_period{1000};
/// What does the same as these words in a shell.
std::string shown_command(const std::vector<std::string>& words, const std::string& address) {
  std::string text = "proleg";
  for (const std::string& word : words) {
    if (word != "--json" && word != "--json-lines") {
      text += " " + shell_argument(word);
    }
  }
  return text + " --bus " + shell_argument(address);
}

/// Whether several programs of this computer can open such a bus at the same time.
bool is_for_several(const std::string& address) {
  const host::BusAddress::Kind kind = host::parse_bus_address(address).kind;
  return kind == host::BusAddress::Kind::can || kind == host::BusAddress::Kind::tcp;
}

}  // namespace

ModulesSession::ModulesSession(ModulesSessionOptions options, const PresentDraft& draft, BusSharing& sharing,
                               SessionRequests& requests, host::SessionOutput& output)
    : SessionThread(requests, output),
      options_(std::move(options)),
      draft_(draft),
      sharing_(sharing),
      files_(options_.folder),
      plans_(files_) {
  publish();
  publish_job();
  begin_thread();
}

ModulesSession::~ModulesSession() { end_thread(); }

void ModulesSession::serve() {
  stop_at_once();
  look_at_holder();
  take_operations();
  look_at_job();
  if (sharing_.must_give_way()) {
    quiet_.reset();
  }
  look_at_quiet_job();
  if (is_watched_ && draft_.get().revision != draft_revision_) {
    publish();
  }
  if (quiet_ || (job_ && !job_->has_ended())) {
    requests_.wait_until(Clock::now() + look_period);
  } else if (is_watched_) {
    requests_.wait_until(Clock::now() + draft_period);
  } else {
    requests_.wait();
  }
}

void ModulesSession::fail(const std::string& why) {
  end_job(why);
  if (quiet_ && quiet_->request) {
    output_.refuse(*quiet_->request, why);
  }
  quiet_.reset();
}

void ModulesSession::close() {
  end_job("the program ends");
  job_.reset();
  quiet_.reset();
  table_.reset();
}

json ModulesSession::carry_out(const host::OperationRequest& operation) {
  if (!options_.refusal.empty()) {
    throw std::runtime_error(options_.refusal);
  }
  static const std::map<std::string_view, Handler> handlers{{"modules.look", &ModulesSession::look},
                                                            {"modules.open", &ModulesSession::open},
                                                            {"modules.close", &ModulesSession::close_bus},
                                                            {"modules.scan", &ModulesSession::begin_planned},
                                                            {"modules.examine", &ModulesSession::examine},
                                                            {"modules.read", &ModulesSession::read},
                                                            {"modules.set", &ModulesSession::set},
                                                            {"modules.save", &ModulesSession::begin_planned},
                                                            {"modules.compare", &ModulesSession::begin_planned},
                                                            {"modules.load", &ModulesSession::begin_planned},
                                                            {"modules.assign", &ModulesSession::assign},
                                                            {"modules.calibrate", &ModulesSession::begin_planned},
                                                            {"modules.flash", &ModulesSession::begin_planned},
                                                            {"modules.recover", &ModulesSession::begin_planned},
                                                            {"modules.answer", &ModulesSession::answer},
                                                            {"modules.cancel", &ModulesSession::cancel}};
  return (this->*handler_of(handlers, operation.name))(operation);
}

std::string ModulesSession::address() const {
  return options_.bus ? options_.bus->address : table_ ? table_->address() : std::string();
}

std::shared_ptr<const sim::Scenario> ModulesSession::robot() const {
  // The robot of the bus outlives the session.
  return options_.bus ? std::shared_ptr<const sim::Scenario>(std::shared_ptr<void>(), &options_.bus->robot)
                      : draft_.get().scenario;
}

json ModulesSession::look(const host::OperationRequest& /*request*/) {
  is_watched_ = true;
  files_.look();
  offers_ = present_buses();
  publish();
  return json::object();
}

json ModulesSession::open(const host::OperationRequest& request) {
  const std::string wanted = word_in(request.arguments, "bus", "the address of a bus");
  if (options_.bus || table_) {
    throw std::runtime_error("the bus " + address() + " is open");
  }
  require_openable(wanted);
  table_ = std::make_unique<TableBus>(wanted, sharing_, output_);
  found_ = json();
  publish();
  begin_unasked(plan_of_look());  // modules without a host say nothing of themselves
  return json::object();
}

void ModulesSession::require_openable(const std::string& bus) const {
  const host::BusAddress::Kind kind = host::parse_bus_address(bus).kind;
  if (kind == host::BusAddress::Kind::automatic || kind == host::BusAddress::Kind::descriptor) {
    throw InputError("bus", 0, in_quotes(bus), "the address of one bus that this program can open");
  }
  if (!options_.opens_any_address && std::ranges::find(offers_, bus) == offers_.end()) {
    throw InputError("bus", 0, in_quotes(bus),
                     "an adapter of this computer: other computers may open this page, so it opens no other address");
  }
}

json ModulesSession::close_bus(const host::OperationRequest& /*request*/) {
  if (options_.bus) {
    throw std::runtime_error("the program was started with this bus");
  }
  wait_for_quiet_job();
  if (sharing_.has_job()) {
    throw std::runtime_error("a job goes on");
  }
  table_.reset();
  found_ = json();
  output_.publish("bus", json());
  publish();
  return json::object();
}

std::unique_ptr<ModuleJob> ModulesSession::make_job(ModuleJobPlan plan, const std::string& bus) {
  if (bus.empty()) {
    throw std::runtime_error("no bus is open");
  }
  wait_for_quiet_job();
  if (job_ && !job_->has_ended()) {
    throw std::runtime_error("another job goes on: " + job_->kind());
  }
  if (plan.shown_words.empty()) {
    plan.shown_words = plan.words;
  }
  plan.shown = shown_command(plan.shown_words, bus);
  if (!plan.files && plan.folder.empty()) {
    plan.folder = fs::absolute(options_.folder).string();
  }
  return std::make_unique<ModuleJob>(last_job_ + 1, std::move(plan), bus, sharing_);
}

json ModulesSession::begin(ModuleJobPlan plan) { return begin(std::move(plan), address()); }

json ModulesSession::begin(ModuleJobPlan plan, const std::string& bus) {
  job_ = make_job(std::move(plan), bus);
  last_job_ = job_->number();
  publish_job();
  return {{"job", job_->number()}};
}

json ModulesSession::begin_quietly(const host::OperationRequest& request, ModuleJobPlan plan,
                                   std::vector<std::string> then) {
  std::unique_ptr<ModuleJob> job = make_job(std::move(plan), address());
  quiet_.emplace(QuietJob{std::move(job), request.request, std::move(then)});
  return answered_later();
}

void ModulesSession::wait_for_quiet_job() {
  while (quiet_ && !requests_.interrupts()) {
    look_at_quiet_job();
    if (quiet_) {
      std::this_thread::sleep_for(look_period);
    }
  }
  if (quiet_) {
    throw std::runtime_error("STOP came first");
  }
}

json ModulesSession::begin_planned(const host::OperationRequest& request) {
  using Plan = ModuleJobPlan (ModulePlans::*)(const host::OperationRequest&) const;
  static const std::map<std::string_view, Plan> plans{
      {"modules.scan", &ModulePlans::scan},      {"modules.save", &ModulePlans::save},
      {"modules.load", &ModulePlans::load},      {"modules.compare", &ModulePlans::compare},
      {"modules.flash", &ModulePlans::flash},    {"modules.calibrate", &ModulePlans::calibrate},
      {"modules.recover", &ModulePlans::recover}};
  return begin((plans_.*plans.at(request.name))(request));
}

json ModulesSession::examine(const host::OperationRequest& request) {
  ModuleJobPlan plan = plans_.examine(request);
  if (address().empty()) {
    const std::string bus = word_in(request.arguments, "bus", "the address of a bus, since none is open");
    require_openable(bus);
    plan.opens_bus = true;
    return begin(std::move(plan), bus);
  }
  plan.opens_bus = is_for_several(address());
  return begin(std::move(plan));
}

json ModulesSession::read(const host::OperationRequest& request) {
  return begin_quietly(request, plans_.read(request));
}

json ModulesSession::set(const host::OperationRequest& request) {
  const bool stores = argument<bool>(request.arguments, "store", "true or false").value_or(false);
  return begin_quietly(request, plans_.set(request),
                       stores ? store_words(request.arguments) : std::vector<std::string>());
}

json ModulesSession::assign(const host::OperationRequest& request) {
  const std::shared_ptr<const sim::Scenario> scenario = robot();
  if (scenario == nullptr) {
    throw std::runtime_error("there is no robot whose places the modules can get; open a scenario in Make first");
  }
  look_at_holder();  // whoever asks may have taken control since the last look
  if (!driver_.has_driver()) {
    throw std::runtime_error("nobody drives");
  }
  return begin(plans_.assign(request, *scenario));
}

json ModulesSession::answer(const host::OperationRequest& request) {
  const auto number = required_argument<std::uint32_t>(request.arguments, "job", "the number of a job");
  const auto question = required_argument<std::uint64_t>(request.arguments, "question", "the number of a question");
  const std::string word = word_in(request.arguments, "word", "an answer");
  if (!job_ || job_->has_ended() || job_->number() != number) {
    throw std::runtime_error("this job has ended");
  }
  job_->answer(question, word);
  publish_job();
  return json::object();
}

json ModulesSession::cancel(const host::OperationRequest& request) {
  const auto number = required_argument<std::uint32_t>(request.arguments, "job", "the number of a job");
  if (!job_ || job_->has_ended() || job_->number() != number) {
    throw std::runtime_error("this job has ended");
  }
  end_job(request.client_name);
  return json::object();
}

void ModulesSession::stop_at_once() {
  const Stops stops = take_stops();
  if (stops.empty()) {
    return;
  }
  if (table_) {
    table_->stop_modules();
  }
  if (job_ && !job_->has_ended() && (job_->kind() == "assign" || job_->kind() == "calibrate")) {
    end_job("STOP by " + stops.back().by);
  }
}

/// A joint that moves needs somebody who looks at it.
void ModulesSession::look_at_holder() {
  const bool is_absent = driver_.look(requests_.take_holder(), Clock::now());
  if (is_absent && job_ && !job_->has_ended() && job_->kind() == "assign") {
    end_job("nobody drives");
  }
}

void ModulesSession::end_job(const std::string& by) {
  if (job_ && !job_->has_ended()) {
    job_->end(by);
    publish_job();
  }
}

void ModulesSession::look_at_job() {
  if (!job_ || !job_->look()) {
    return;
  }
  if (job_->has_ended()) {
    if (job_->kind() == "scan") {
      take_found(job_->result());
    }
    files_.look();  // it may have written settings
    publish();      // who sees the end of the job finds its files
  }
  publish_job();
  if (job_->has_ended() && job_->kind() == "assign" && !job_->status()) {
    begin_unasked(plan_of("nmt", {"nmt", "pre-operational", "all"}, {},
                          Output::text));  // it did not take the power from its joint
  } else if (job_->has_ended() && job_->kind() != "scan") {
    begin_unasked(plan_of_look());
  }
}

/// A job may have given modules other node ids or programs, or may have left a joint with power.
void ModulesSession::begin_unasked(ModuleJobPlan plan) {
  if (quiet_ || address().empty()) {
    return;
  }
  try {
    quiet_.emplace(QuietJob{make_job(std::move(plan), address()), std::nullopt, {}});
  } catch (const std::runtime_error&) {
    // The robot has got power meanwhile.
  }
}

void ModulesSession::take_found(const json& result) {
  if (result.is_object()) {
    found_ = {{"nodes", result.value("nodes", json::array())},
              {"fresh_modules", result.value("modules_without_node_id", false)},
              {"duplicate_node_ids", result.value("duplicate_node_ids", json::array())}};
  }
}

void ModulesSession::look_at_quiet_job() {
  if (!quiet_) {
    return;
  }
  quiet_->job->look();
  if (!quiet_->job->has_ended()) {
    return;
  }
  const QuietJob quiet = std::move(*quiet_);
  quiet_.reset();
  if (!quiet.request) {
    take_found(quiet.job->result());
    publish();
    if (quiet.job->kind() != "scan") {
      begin_unasked(plan_of_look());
    }
  } else if (quiet.job->status() != 0) {
    output_.refuse(*quiet.request, quiet.job->failure());
  } else if (quiet.then.empty()) {
    const json& result = quiet.job->result();
    output_.answer(*quiet.request, result.is_string() ? json{{"text", result}} : result);
  } else {
    go_on_quietly(quiet);
  }
}

void ModulesSession::go_on_quietly(const QuietJob& before) {
  try {
    quiet_.emplace(QuietJob{make_job(plan_of("set", before.then, {}, Output::text), address()), before.request, {}});
  } catch (const std::runtime_error& error) {
    output_.refuse(*before.request, error.what());
  }
}

json ModulesSession::robot_json() const {
  const std::shared_ptr<const sim::Scenario> scenario = robot();
  if (scenario == nullptr) {
    return {};
  }
  json joints = json::array();
  for (std::size_t joint = 0; joint < scenario->robot.joints.size(); ++joint) {
    const sim::ModulePlace& module = scenario->modules[joint];
    joints.push_back({{"name", scenario->robot.joints[joint].name},
                      {"node", module.node},
                      {"serial", module.serial ? json(*module.serial) : json()}});
  }
  return {{"document", options_.bus ? "robot" : "draft_robot"},
          {"name", scenario->robot.name},
          {"joints", std::move(joints)}};
}

void ModulesSession::publish() {
  draft_revision_ = draft_.get().revision;
  json offers = json::array();
  for (const std::string& offer : offers_) {
    offers.push_back({{"address", offer}, {"text", offer.starts_with("serial:") ? "serial adapter" : "CAN interface"}});
  }
  output_.publish("modules", {{"bus", text_or_null(address())},
                              {"is_fixed", options_.bus.has_value()},
                              {"description", options_.bus ? text_or_null(options_.bus->description)
                                              : table_     ? json(table_->description())
                                                           : json()},
                              {"offers", std::move(offers)},
                              {"robot", robot_json()},
                              {"images", files_.images()},
                              {"settings", files_.settings()},
                              {"found", found_}});
}

void ModulesSession::publish_job() { output_.publish("module_job", job_ ? job_->document() : json()); }

}  // namespace proleg::tools
