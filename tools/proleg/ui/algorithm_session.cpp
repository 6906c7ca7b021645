#include "tools/proleg/ui/algorithm_session.hpp"

#include <algorithm>
#include <exception>
#include <map>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "shared/computer/algorithm_library/algorithm_library.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/installation.hpp"
#include "tools/proleg/ui/algorithm_document.hpp"
#include "tools/proleg/ui/compiler_messages.hpp"
#include "tools/proleg/ui/proof_output.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

constexpr std::chrono::milliseconds look_period{50};

}  // namespace

AlgorithmSession::AlgorithmSession(AlgorithmSessionOptions options, SessionRequests& requests,
                                   host::SessionOutput& output)
    : SessionThread(requests, output),
      options_(std::move(options)),
      folders_(options_.folder),
      image_build_(std::filesystem::canonical(options_.folder)) {
  publish("algorithms", algorithms_json());
  publish_folders();
  begin_thread();
}

AlgorithmSession::~AlgorithmSession() { end_thread(); }

void AlgorithmSession::serve() {
  take_operations();
  if (!job_) {
    requests_.wait();
    return;
  }
  look_at_job();
  if (job_) {
    requests_.wait_until(Clock::now() + look_period);
  }
}

void AlgorithmSession::fail(const std::string& why) {
  if (job_) {
    finish("failed", why);
  }
}

json AlgorithmSession::carry_out(const host::OperationRequest& operation) {
  static const std::map<std::string_view, Handler> handlers{
      {"algorithm.refresh", &AlgorithmSession::refresh}, {"algorithm.read", &AlgorithmSession::read},
      {"algorithm.create", &AlgorithmSession::create},   {"algorithm.save", &AlgorithmSession::save},
      {"algorithm.build", &AlgorithmSession::build},     {"algorithm.check", &AlgorithmSession::check},
      {"algorithm.image", &AlgorithmSession::image},     {"algorithm.cancel", &AlgorithmSession::cancel}};
  const Handler handler = handler_of(handlers, operation.name);
  if (!options_.refusal.empty()) {
    throw std::runtime_error(options_.refusal);
  }
  return (this->*handler)(operation);
}

AlgorithmFolder AlgorithmSession::folder_of(const json& arguments) const {
  const auto folder = argument<std::string>(arguments, "folder", "the name of a folder");
  return folders_.find(folder.value_or(""));
}

json AlgorithmSession::refresh(const host::OperationRequest& /*request*/) {
  publish_folders();
  return json::object();
}

json AlgorithmSession::read(const host::OperationRequest& request) {
  const AlgorithmFolder algorithm = folder_of(request.arguments);
  const SourceText source = AlgorithmFolders::read(algorithm);
  return {{"name", algorithm.name},
          {"file", algorithm.source.filename().string()},
          {"text", source.text},
          {"version", source.version}};
}

json AlgorithmSession::create(const host::OperationRequest& request) {
  const AlgorithmFolder algorithm = folders_.create(read_form(request.arguments), source_tree(""));
  publish_folders();
  output_.notice(host::NoticeLevel::info,
                 "written: the algorithm " + algorithm.name + " in " + one_line(algorithm.path.string()));
  return {{"folder", algorithm.folder}};
}

json AlgorithmSession::save(const host::OperationRequest& request) {
  const json& arguments = request.arguments;
  const AlgorithmFolder algorithm = folder_of(arguments);
  const auto version = argument<std::string>(arguments, "version", "the version of the text that was read");
  const auto text = argument<std::string>(arguments, "text", "the source, or a part of it");
  const auto part = argument<std::uint32_t>(arguments, "part", "the number of the part").value_or(0);
  const auto has_more = argument<bool>(arguments, "more", "true or false").value_or(false);
  if (!text || !version) {
    throw InputError(text ? "version" : "text", 0, "nothing", "a text");
  }
  if (part == 0) {
    upload_ = Upload{request.client, algorithm.folder, 0, {}};
  }
  if (!upload_ || upload_->client != request.client || upload_->folder != algorithm.folder || upload_->parts != part) {
    upload_.reset();
    throw std::runtime_error("another source has come between the parts of this one; save it again");
  }
  if (upload_->text.size() + text->size() > AlgorithmFolders::most_source_bytes) {
    upload_.reset();
    throw InputError(algorithm.name + ".cpp", 0, "a longer text",
                     "at most " + std::to_string(AlgorithmFolders::most_source_bytes / 1024) + " KiB");
  }
  upload_->text += *text;
  ++upload_->parts;
  if (has_more) {
    return {{"version", nullptr}};
  }
  const Upload whole = *std::exchange(upload_, std::nullopt);
  return {{"version", AlgorithmFolders::write(algorithm, whole.text, *version)}};
}

json AlgorithmSession::build(const host::OperationRequest& request) {
  const AlgorithmFolder algorithm = folder_of(request.arguments);
  const std::string folder = algorithm.path.string();
  const std::string build = algorithm.build().string();
  const std::string tree = source_tree("").string();
  // The same as docs/user-algorithms.md has for the command line; `proleg verify` runs the test.
  begin(Work::build, {algorithm},
        {{"cmake", "-S", folder, "-B", build, "-G", "Ninja", "-DPROLEG_SOURCE=" + tree,
          "-DProleg_DIR=" + tree + "/tools/cmake"},
         {"cmake", "--build", build, "--target", algorithm.name}});
  return {{"version", job_->version}};
}

json AlgorithmSession::check(const host::OperationRequest& request) {
  const AlgorithmFolder algorithm = folder_of(request.arguments);
  const std::filesystem::path verifier =
      options_.verifier.empty() ? program_folder() / "proleg-verify" : options_.verifier;
  begin(Work::proof, {algorithm}, {{verifier.string(), "--json", algorithm.path.string()}});
  return json::object();
}

json AlgorithmSession::image(const host::OperationRequest& request) {
  const auto names = argument<std::vector<std::string>>(request.arguments, "folders", "names of folders");
  std::vector<AlgorithmFolder> algorithms;
  for (const std::string& name : names.value_or(std::vector<std::string>{})) {
    const AlgorithmFolder algorithm = folders_.find(name);
    if (std::ranges::find(algorithms, algorithm.name, &AlgorithmFolder::name) != algorithms.end()) {
      throw InputError("folders", 0, "two algorithms " + in_quotes(algorithm.name), "different names");
    }
    algorithms.push_back(algorithm);
  }
  if (algorithms.empty()) {
    throw InputError("folders", 0, "none", "at least one algorithm");
  }
  require_no_job();
  const std::vector<std::vector<std::string>> commands = image_build_.commands(algorithms);
  begin(Work::image, std::move(algorithms), commands);
  return json::object();
}

json AlgorithmSession::cancel(const host::OperationRequest& /*request*/) {
  if (!job_) {
    throw std::runtime_error("nothing is being built or verified");
  }
  job_->programs->cancel();
  return json::object();
}

void AlgorithmSession::require_no_job() const {
  if (!job_) {
    return;
  }
  const std::string& name = job_->algorithms.front().name;
  const std::string what = job_->work == Work::image   ? "the image is being built"
                           : job_->work == Work::build ? name + " is being built"
                                                       : name + " is being verified";
  throw std::runtime_error(what + "; wait, or cancel it");
}

void AlgorithmSession::begin(Work work, std::vector<AlgorithmFolder> algorithms,
                             const std::vector<std::vector<std::string>>& commands) {
  require_no_job();
  const AlgorithmFolder& first = algorithms.front();
  std::string version = AlgorithmFolders::read(first).version;
  auto programs = std::make_unique<CommandSequence>(
      commands, work == Work::image ? source_tree("").string() : first.path.string(),
      work == Work::build ? options_.longest_build : options_.longest_check,
      work == Work::proof ? ChildProgram::Errors::apart : ChildProgram::Errors::in_output);
  job_ = Job{work, std::move(algorithms), std::move(version), std::move(programs)};
  publish_job("running", "");
}

void AlgorithmSession::look_at_job() {
  Job& job = *job_;
  const std::optional<CommandSequence::End> end = job.programs->look();
  if (!end) {
    publish_job("running", "");
  } else if (end->is_cancelled) {
    finish("cancelled", "cancelled");
  } else if (end->is_late) {
    finish("failed", "it took too long, and was ended");
  } else if (job.work == Work::proof) {
    const std::string error = proof_error(proof_object(job.programs->output()), job.programs->errors(), end->status);
    finish(error.empty() ? "passed" : "failed", error);
  } else if (job.work == Work::image) {
    finish_image(end->status);
  } else if (end->status != 0) {
    const std::string line = last_line_of(job.programs->output());
    finish("failed", line.empty() ? "exit status " + std::to_string(end->status) : line);
  } else {
    const std::string error = load(job.algorithms.front());
    finish(error.empty() ? "passed" : "failed", error);
  }
}

std::string AlgorithmSession::load(const AlgorithmFolder& algorithm) {
  try {
    static_cast<void>(load_algorithm_again(algorithm.library().string()));
  } catch (const std::exception& error) {
    return one_line(error.what());
  }
  publish("algorithms", algorithms_json());
  options_.on_loaded();
  return "";
}

void AlgorithmSession::finish_image(int status) {
  if (status != 0) {
    const std::string& output = job_->programs->output();
    const std::string problem = image_build_.problem(output);
    finish("failed", problem.empty() ? last_line_of(output) : problem);
    return;
  }
  try {
    built_image_ = image_build_.described(job_->algorithms);
    finish("passed", "");
  } catch (const std::exception& error) {
    finish("failed", one_line(error.what()));
  }
}

void AlgorithmSession::finish(const std::string& state, const std::string& error) {
  if (job_->work == Work::image && state != "passed") {
    image_build_.discard();
  }
  publish_job(state, error);
  const std::string& name = job_->algorithms.front().name;
  if (state == "passed") {
    output_.notice(host::NoticeLevel::info, job_->work == Work::build
                                                ? name + ": the build passed; Simulate and Restart use it from now on"
                                            : job_->work == Work::proof ? name + ": the proof passed"
                                                                        : "the image for the modules is built");
  }
  job_.reset();
  publish_folders();
}

void AlgorithmSession::publish_job(const std::string& state, const std::string& error) {
  const Job& job = *job_;
  if (job.work == Work::image) {
    publish_image(state, error);
    return;
  }
  const AlgorithmFolder& algorithm = job.algorithms.front();
  json document{{"folder", algorithm.folder},
                {"name", algorithm.name},
                {"version", job.version},
                {"state", state},
                {"error", text_or_null(error)}};
  if (job.work == Work::build) {
    const BuildProgress progress = build_progress(job.programs->output());
    document["done"] = progress.done;
    document["of"] = progress.of;
    document["messages"] = messages_json(compiler_messages(job.programs->output()), job.algorithms);
    publish("algorithm_build", std::move(document));
  } else {
    const ProofStep step = proof_step(job.programs->errors());
    document["done"] = step.done;
    document["of"] = step.of;
    document["step"] = text_or_null(step.text);
    document["proof"] = state == "running" ? json() : proof_object(job.programs->output());
    publish("algorithm_check", std::move(document));
  }
}

void AlgorithmSession::publish_image(const std::string& state, const std::string& error) {
  const Job& job = *job_;
  json algorithms = json::array();
  for (const AlgorithmFolder& algorithm : job.algorithms) {
    algorithms.push_back({{"folder", algorithm.folder}, {"name", algorithm.name}});
  }
  const BuildProgress progress = build_progress(job.programs->output());
  publish("algorithm_image", {{"algorithms", std::move(algorithms)},
                              {"state", state},
                              {"error", text_or_null(error)},
                              {"done", progress.done},
                              {"of", progress.of},
                              {"messages", messages_json(compiler_messages(job.programs->output()), job.algorithms)},
                              {"image", state == "passed" ? built_image_ : json()}});
}

void AlgorithmSession::publish_folders() {
  json folders = json::array();
  const std::vector<std::string> loaded = loaded_libraries();
  for (const AlgorithmFolder& algorithm : folders_.list()) {
    folders.push_back({{"folder", algorithm.folder},
                       {"name", algorithm.name},
                       {"library", algorithm.library().string()},
                       {"loaded", std::ranges::any_of(loaded, [&algorithm](const std::string& library) {
                          std::error_code error;
                          return std::filesystem::weakly_canonical(library, error) == algorithm.library();
                        })}});
  }
  publish("algorithm_folders", {{"refusal", text_or_null(options_.refusal)},
                                {"folders", options_.refusal.empty() ? std::move(folders) : json::array()},
                                {"form", example_form_json()}});
}

void AlgorithmSession::publish(const std::string& name, json document) {
  json& before = published_[name];
  if (before != document) {
    before = std::move(document);
    output_.publish(name, before);
  }
}

}  // namespace proleg::tools
