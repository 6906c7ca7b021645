// proleg flash: brings an image to the modules of a robot.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/flash/image_file.hpp"
#include "host/flash/key_file.hpp"
#include "host/robot/object_word.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/program_report.hpp"
#include "tools/proleg/flash/flash_bare.hpp"
#include "tools/proleg/flash/flash_key.hpp"
#include "tools/proleg/flash/flash_modules.hpp"
#include "tools/proleg/flash/update_run.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;
using host::FlashAction;
using host::FlashCandidate;
using host::UpdateOutcome;
namespace flag = broadcast::module_flag;

struct FlashOptions : BusOptions {
  std::optional<std::string> image_file;
  std::optional<std::string> public_key;
  std::string image;  ///< name of the file with the image
  bool is_bare = false;
  BareOptions bare;
  std::optional<std::string> nodes;
  bool all = false;
  bool canary = false;
  bool dry_run = false;
  bool force_board = false;
  bool allow_downgrade = false;
  std::optional<std::string> settings;
  ProgramReport report;
};

/// A module, and what becomes of it.
struct Module {
  FlashCandidate found;
  host::FlashVerdict verdict;
  std::optional<host::UpdatedModule> result;  ///< nothing: it was not flashed
  std::optional<host::ModuleParameters> settings;
  std::vector<std::string> changed_settings;

  [[nodiscard]] bool is_to_be_flashed() const { return verdict.action == FlashAction::install; }
  [[nodiscard]] bool is_good() const {
    return verdict.action == FlashAction::nothing || (result && result->outcome == UpdateOutcome::runs);
  }
  /// The program that the module reported last; nothing if it was flashed and does not answer since.
  [[nodiscard]] const host::ModuleProgram* program() const {
    if (result && result->outcome == UpdateOutcome::vanished) {
      return nullptr;
    }
    return result && result->program.has_answered ? &result->program : &found.program;
  }
};

class Flashing {
 public:
  Flashing(const FlashOptions& options, BusAccess& bus, const host::ImageFile& image)
      : options_(options), bus_(bus), image_(image) {}

  int run();

 private:
  void judge_all();
  void report_verdicts() const;
  void print_verdicts() const;
  void save_settings();
  void flash_all();
  /// False: at least one of them does not run the image.
  bool flash(const std::vector<Module*>& modules, bool through_its_line);
  void check_settings();
  void print_table() const;
  [[nodiscard]] Json result_json() const;

  const FlashOptions& options_;
  BusAccess& bus_;
  const host::ImageFile& image_;
  std::vector<Module> modules_;
  std::vector<std::uint8_t> foreign_;
  std::vector<std::uint8_t> silent_;
  std::string settings_file_;  ///< empty: none was written
  UpdateDurations durations_;  ///< of the longest update
};

std::string digits_of_hash(const image::Header& header) {
  constexpr std::size_t shown = 8;
  return hexadecimal_digits(header.hash).substr(0, shown);
}

const char* word_of(FlashAction action) {
  return action == FlashAction::install ? "flash" : action == FlashAction::nothing ? "same" : "refuse";
}

void Flashing::judge_all() {
  std::optional<std::vector<std::uint8_t>> nodes;
  if (options_.nodes) {
    nodes = host::parse_nodes(*options_.nodes, "--node");
  }
  FoundModules found = tools::find_modules(bus_, nodes);
  wait_for_sessions(bus_, found.modules);
  foreign_ = found.foreign;
  silent_ = found.silent;
  for (FlashCandidate& candidate : found.modules) {
    const host::FlashVerdict verdict =
        judge(image_.header, candidate, {options_.force_board, options_.allow_downgrade});
    modules_.push_back({std::move(candidate), verdict, {}, {}, {}});
  }
}

void Flashing::print_verdicts() const {
  std::printf("%s: %s, SHA-256 %s..., for %s\n", options_.image.c_str(), host::version_text(image_.header).c_str(),
              digits_of_hash(image_.header).c_str(), host::board_text(image_.header.board_id).c_str());
  for (const Module& module : modules_) {
    std::printf("  %-22s %-7s %s\n", name_of(module.found).c_str(), word_of(module.verdict.action),
                module.verdict.text.c_str());
  }
  for (const std::uint8_t node : foreign_) {
    std::printf("  %-22s %-7s no joint module of Proleg\n", ("node " + std::to_string(node)).c_str(), "skip");
  }
  for (const std::uint8_t node : silent_) {
    std::printf("  %-22s %-7s heard, but answers nothing\n", ("node " + std::to_string(node)).c_str(), "skip");
  }
  std::fflush(stdout);
}

/// A name that no file has: a file of an earlier run may be all that is left of some settings.
std::string free_name() {
  const std::string base = "settings_before_flash";
  std::string name = base + ".params";
  for (unsigned number = 2; std::filesystem::exists(name); ++number) {
    name = base + "_" + std::to_string(number) + ".params";
  }
  return name;
}

void Flashing::save_settings() {
  std::vector<std::uint8_t> nodes;
  for (const Module& module : modules_) {
    if (module.is_to_be_flashed() && module.found.node != 0 && module.found.program.is(flag::runs_program)) {
      nodes.push_back(module.found.node);
    }
  }
  const std::vector<host::ModuleParameters> settings = read_settings(bus_, nodes);
  for (const host::ModuleParameters& one : settings) {
    const auto module = std::ranges::find(modules_, one.node, [](const Module& each) { return each.found.node; });
    module->settings = one;
  }
  if (!settings.empty()) {
    settings_file_ = options_.settings.value_or(free_name());
    try {
      write_file(settings_file_, host::parameters_text(settings));
    } catch (const FileError& error) {
      throw std::runtime_error(
          std::string(error.what()) +
          "; nothing was flashed; --settings FILE keeps the settings of the modules in another place");
    }
  }
}

bool Flashing::flash(const std::vector<Module*>& modules, bool through_its_line) {
  // An image that is forced onto other boards gets their name.
  std::map<std::uint16_t, std::vector<Module*>> by_board;
  for (Module* const module : modules) {
    by_board[options_.force_board ? module->found.board_id : image_.header.board_id].push_back(module);
  }
  bool are_all_good = true;
  for (const auto& [board, group] : by_board) {
    std::vector<std::uint8_t> bytes = image_.bytes;
    if (board != image_.header.board_id) {
      image::Header header = image_.header;
      header.board_id = board;
      header.lowest_revision = 0;
      header.highest_revision = 0xFF;
      std::ranges::copy(image::encode(header), bytes.begin());
    }
    std::vector<FlashCandidate> candidates;
    for (const Module* const module : group) {
      candidates.push_back(module->found);
    }
    const UpdateRun run =
        run_update(bus_, bytes, candidates, through_its_line, options_.report,
                   settings_file_.empty() ? "" : "; the settings from before are in " + settings_file_);
    if (run.durations.all() > durations_.all()) {
      durations_ = run.durations;
    }
    for (std::size_t i = 0; i < group.size(); ++i) {
      group[i]->result = run.modules[i];
      are_all_good = are_all_good && group[i]->is_good();
    }
  }
  return are_all_good;
}

/// One module first, if that is wished; gateways last, one after the other: through them the host may reach the rest.
void Flashing::flash_all() {
  std::vector<Module*> first;
  std::vector<Module*> ordinary;
  std::vector<Module*> gateways;
  for (Module& module : modules_) {
    if (module.is_to_be_flashed()) {
      (module.found.program.is(flag::is_gateway) ? gateways : ordinary).push_back(&module);
    }
  }
  if (options_.canary && !ordinary.empty()) {
    first.push_back(ordinary.front());
    ordinary.erase(ordinary.begin());
  }
  if (!first.empty() && !flash(first, false)) {
    return;  // the rest keeps its program
  }
  const bool are_good = ordinary.empty() || flash(ordinary, false);
  for (Module* const gateway : gateways) {
    if (options_.canary && !are_good) {
      return;
    }
    if (!flash({gateway}, true)) {
      return;  // the next one may be reached through this one only
    }
  }
}

void Flashing::check_settings() {
  std::vector<std::uint8_t> nodes;
  for (const Module& module : modules_) {
    if (module.settings && module.result && module.is_good()) {
      nodes.push_back(module.found.node);
    }
  }
  bool are_all_good = true;
  for (const host::ModuleParameters& now : read_settings(bus_, nodes)) {
    const auto module = std::ranges::find(modules_, now.node, [](const Module& each) { return each.found.node; });
    module->changed_settings = compare_settings(*module->settings, now);
    are_all_good = are_all_good && module->changed_settings.empty();
  }
  are_all_good = are_all_good && std::ranges::all_of(modules_, [](const Module& module) {
                   return !module.settings || module.is_good();
                 });
  if (are_all_good && !options_.settings && !settings_file_.empty()) {
    std::filesystem::remove(settings_file_);
    settings_file_.clear();
  }
}

void Flashing::print_table() const {
  std::printf("%-22s %-18s %-10s %s\n", "module", "version", "SHA-256", "state");
  for (const Module& module : modules_) {
    const host::ModuleProgram* const program = module.program();
    const std::string version = program != nullptr && program->image ? host::version_text(*program->image)
                                : program != nullptr && program->has_answered && program->missing_words == 0
                                    ? "none"
                                    : "not known";
    const std::string hash = program != nullptr && program->image ? digits_of_hash(*program->image) : "-";
    const std::string state = module.verdict.action == FlashAction::refuse ? "refused: " + module.verdict.text
                              : module.result ? describe(module.result->outcome, module.result->detail)
                              : module.verdict.action == FlashAction::nothing
                                  ? "runs the image"
                                  : "was left alone, because the first module does not run the image";
    std::printf("%-22s %-18s %-10s %s\n", name_of(module.found).c_str(), version.c_str(), hash.c_str(), state.c_str());
  }
  if (durations_.transfer_s > 0) {
    std::printf("transfer %.2f s (%.1f kB/s), installation %.2f s, restart, confirmation %.2f s\n",
                durations_.transfer_s, static_cast<double>(image_.bytes.size()) / durations_.transfer_s / 1e3,
                durations_.installation_s, durations_.restart_s);
  }
}

Json program_json(const host::ModuleProgram* program) {
  if (program == nullptr || !program->image) {
    return {};
  }
  const image::Header& header = *program->image;
  return {{"version", host::version_number_text(header.version)},
          {"commit", host::commit_text(header)},
          {"sha256", hexadecimal_digits(header.hash)},
          {"confirmed", program->is(flag::is_confirmed)},
          {"running", program->is(flag::runs_program)}};
}

/// What was found of a module, and what is done with it. before: what is known of its program.
Json verdict_json(const Module& module, const Json& before) {
  return {{"node", unsigned{module.found.node}},      {"serial", module.found.program.serial},
          {"board", unsigned{module.found.board_id}}, {"before", before},
          {"action", word_of(module.verdict.action)}, {"reason", module.verdict.text}};
}

void Flashing::report_verdicts() const {
  if (options_.report.is_text()) {
    print_verdicts();
  }
  Json modules = Json::empty_array();
  for (const Module& module : modules_) {
    const auto& image = module.found.program.image;
    modules.append(verdict_json(module, image ? Json{{"version", host::version_number_text(image->version)}} : Json()));
  }
  options_.report.print_event("verdicts", {{"version", host::version_number_text(image_.header.version)},
                                           {"sha256", hexadecimal_digits(image_.header.hash)},
                                           {"modules", modules}});
}

Json Flashing::result_json() const {
  Json silent = Json::empty_array();
  for (const std::uint8_t node : silent_) {
    silent.append(unsigned{node});
  }
  Json modules = Json::empty_array();
  for (const Module& module : modules_) {
    Json changed = Json::empty_array();
    for (const std::string& line : module.changed_settings) {
      changed.append(line);
    }
    Json object = verdict_json(module, program_json(&module.found.program));
    object.add("outcome", module.result ? Json(describe(module.result->outcome, module.result->detail)) : Json());
    object.add("good", module.is_good());
    object.add("now", program_json(module.program()));
    object.add("changed_settings", changed);
    modules.append(object);
  }
  return {{"bus", bus_.connection().description()},
          {"image", options_.image},
          {"version", host::version_number_text(image_.header.version)},
          {"sha256", hexadecimal_digits(image_.header.hash)},
          {"dry_run", options_.dry_run},
          {"modules", modules},
          {"silent_nodes", silent},
          {"transfer_s", durations_.transfer_s},
          {"installation_s", durations_.installation_s},
          {"restart_s", durations_.restart_s}};
}

int Flashing::run() {
  judge_all();
  report_verdicts();
  const bool is_any_to_be_flashed = std::ranges::any_of(modules_, &Module::is_to_be_flashed);
  if (is_any_to_be_flashed && !options_.dry_run) {
    save_settings();
    flash_all();
    check_settings();
    if (options_.report.is_text()) {
      print_table();
    }
  }
  options_.report.print_result(result_json());
  for (const Module& module : modules_) {
    for (const std::string& line : module.changed_settings) {
      print_warning("proleg flash", line);
    }
  }
  if (!settings_file_.empty() && !options_.settings) {
    std::cerr << "proleg flash: the settings from before are in " << settings_file_
              << "; 'proleg params load' writes them back\n";
  }
  if (options_.dry_run) {
    return exit_success;
  }
  const auto bad = std::ranges::count_if(modules_, [](const Module& module) { return !module.is_good(); });
  const auto changed =
      std::ranges::count_if(modules_, [](const Module& module) { return !module.changed_settings.empty(); });
  const auto report = [](const std::string& text) { std::cerr << "proleg flash: " << text << '\n'; };
  if (bad != 0) {
    report(std::to_string(bad) + " of " + std::to_string(modules_.size()) + " modules do not run the image");
  }
  if (changed != 0) {
    report(std::to_string(changed) + " of " + std::to_string(modules_.size()) + " modules have other settings now");
  }
  for (const std::uint8_t node : silent_) {
    report("node " + std::to_string(node) + " was heard, but answers nothing: 'proleg recover' looks what it has");
  }
  return bad == 0 && changed == 0 && silent_.empty() ? exit_success : exit_failed;
}

/// Flashes with a probe a chip that has no bootloader.
int run_bare(const FlashOptions& options) {
  const struct {
    const char* name;
    bool is_given;
  } of_a_bus[]{{"--bus", options.bus.has_value()},
               {"--all", options.all},
               {"--canary", options.canary},
               {"--force-board", options.force_board},
               {"--allow-downgrade", options.allow_downgrade},
               {"--settings", options.settings.has_value()},
               {"--json or --json-lines", !options.report.is_text()}};
  for (const auto& option : of_a_bus) {
    if (option.is_given) {
      throw InputError(option.name, 0, "--bare, too", "one of the two: --bare needs no bus");
    }
  }
  BareOptions bare = options.bare;
  bare.image = options.image;
  bare.node = options.nodes;
  bare.dry_run = options.dry_run;
  bare.public_key = options.public_key;
  return run_flash_bare(bare);
}

/// Gives modules their first key over the bus.
int run_key(const FlashOptions& options) {
  if (options.image_file || options.dry_run || options.canary || options.settings || !options.report.is_text()) {
    throw InputError("--public-key", 0, "an image or an option for one, too",
                     "the key alone: then flash an image that is signed; both at once only with --bare");
  }
  const auto nodes = options.nodes ? host::parse_nodes(*options.nodes, "--node") : std::nullopt;
  static_cast<void>(host::read_public_key(*options.public_key));
  BusAccess bus(options);
  catch_interrupts();
  require_no_host(bus);
  HostPresence presence(bus.connection());
  return run_flash_key(bus, *options.public_key, nodes);
}

int run(FlashOptions& options) {
  if (options.public_key && !options.is_bare) {
    return run_key(options);
  }
  if (!options.image_file) {
    throw BadInput("found no IMAGE, expected an image, a .pimg file");
  }
  options.image = *options.image_file;
  if (options.is_bare) {
    return run_bare(options);
  }
  if (options.bare.probe || options.bare.port || options.bare.bootloader) {
    throw InputError("--probe", 0, "no --bare", "--bare with --probe, --port and --bootloader");
  }
  if (options.nodes && options.all) {
    throw InputError("--node", 0, "--all, too", "one of the two");
  }
  if (options.nodes) {
    static_cast<void>(host::parse_nodes(*options.nodes, "--node"));
  }
  const host::ImageFile image = host::read_image(options.image);
  if (options.settings) {
    const std::vector<PlannedOutput> outputs{
        {"--settings", *options.settings, "file of parameters", starts_with(host::parameter_file_start), true}};
    check_outputs(outputs);
  }
  BusAccess bus(options);
  catch_interrupts();
  options.report.begin();
  require_no_host(bus);
  HostPresence presence(bus.connection());
  return Flashing(options, bus, image).run();
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg flash",
      "Brings an image to the modules of a robot, all at once. Says what it would do to each module before anything is "
      "sent; a module whose new program does not start well returns to the one before. With --bare: puts the "
      "bootloader "
      "and the first image on an empty chip, by a probe (docs/flashing.md).");
  FlashOptions options;
  command_line.add_option("IMAGE", options.image_file, "the image, a .pimg file; none with --public-key alone")
      .value_name("");
  command_line
      .add_option("--public-key", options.public_key,
                  "the modules take only images that are signed with the private key of this public key ('proleg image "
                  "key'). With --bare and IMAGE; or over the bus alone, for modules that have no key and were started "
                  "less than ten minutes ago")
      .value_name("FILE");
  command_line.add_option("--node", options.nodes,
                          "only these modules: 3, 1,3 or 2-5. With --bare: the node id of the board record that is "
                          "written; it replaces all settings that the board has.");
  command_line.add_flag("--all", options.all, "all modules on the bus, which is the default");
  command_line.add_flag("--canary", options.canary, "one module first; the others only if it runs the image");
  command_line.add_flag("--dry-run", options.dry_run,
                        "only say what would be done to each module; with --bare: only show the commands");
  command_line.add_flag("--force-board", options.force_board, "also on boards for which the image is not");
  command_line.add_flag("--allow-downgrade", options.allow_downgrade, "also if the image is older");
  command_line.add_option("--settings", options.settings,
                          "FILE: keep the settings of the modules from before in this file. Without it a file is kept "
                          "only if something went wrong.");
  options.report.add_options(command_line);
  add_bus_option(command_line, options);
  command_line.add_flag("--bare", options.is_bare, "the chip is empty: by a probe, and the bootloader first");
  add_bare_options(command_line, options.bare);
  return command_line.run(argc, argv, [&] { return run(options); });
}
