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
#include "tools/proleg/common/program_run.hpp"
#include "tools/proleg/ui/algorithm_document.hpp"
#include "tools/proleg/ui/compiler_messages.hpp"
#include "tools/proleg/ui/proof_output.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

constexpr std::chrono::milliseconds look_period{50};
std::filesystem::path program_beside_this(const std::string& name) {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / name;
}

/// The last line of what a program has printed.
std::string last_line(std::string_view output) {
  std::string last;
  TextLines lines(output);
  while (const std::optional<std::string_view> line = lines.next()) {
    if (!trimmed(*line).empty()) {
      last = one_line(trimmed(*line));
    }
  }
  return last;
}

/// "being built", "being verified"
std::string what_goes_on(const std::string& name, bool is_build) {
  return name + (is_build ? " is being built" : " is being verified");
}

}  // namespace

AlgorithmSession::AlgorithmSession(AlgorithmSessionOptions options, SessionRequests& requests,
                                   host::SessionOutput& output)
    : SessionThread(requests, output), options_(std::move(options)), folders_(options_.folder) {
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
      {"algorithm.cancel", &AlgorithmSession::cancel}};
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
  // The same as docs/user-algorithms.md has for the command line; `proleg verify` runs the test.
  begin(Work::build, algorithm,
        {{"cmake", "-S", folder, "-B", build, "-G", "Ninja", "-DPROLEG_SOURCE=" + source_tree("").string()},
         {"cmake", "--build", build, "--target", algorithm.name}});
  return {{"version", job_->version}};
}

json AlgorithmSession::check(const host::OperationRequest& request) {
  const AlgorithmFolder algorithm = folder_of(request.arguments);
  const std::filesystem::path verifier =
      options_.verifier.empty() ? program_beside_this("proleg-verify") : options_.verifier;
  begin(Work::proof, algorithm, {{verifier.string(), "--json", algorithm.path.string()}});
  return json::object();
}

json AlgorithmSession::cancel(const host::OperationRequest& /*request*/) {
  if (!job_) {
    throw std::runtime_error("nothing is being built or verified");
  }
  job_->programs->cancel();
  return json::object();
}

void AlgorithmSession::begin(Work work, const AlgorithmFolder& algorithm,
                             const std::vector<std::vector<std::string>>& commands) {
  if (job_) {
    throw std::runtime_error(what_goes_on(job_->algorithm.name, job_->work == Work::build) + "; wait, or cancel it");
  }
  const bool is_build = work == Work::build;
  std::string version = AlgorithmFolders::read(algorithm).version;
  auto programs = std::make_unique<CommandSequence>(
      commands, algorithm.path.string(), is_build ? options_.longest_build : options_.longest_check,
      is_build ? ChildProgram::Errors::in_output : ChildProgram::Errors::apart);
  job_ = Job{work, algorithm, std::move(version), std::move(programs)};
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
  } else if (end->status != 0) {
    const std::string line = last_line(job.programs->output());
    finish("failed", line.empty() ? "exit status " + std::to_string(end->status) : line);
  } else {
    const std::string error = load(job.algorithm);
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

void AlgorithmSession::finish(const std::string& state, const std::string& error) {
  publish_job(state, error);
  const std::string& name = job_->algorithm.name;
  if (state == "passed") {
    output_.notice(host::NoticeLevel::info, job_->work == Work::build
                                                ? name + ": the build passed; Simulate and Restart use it from now on"
                                                : name + ": the proof passed");
  }
  job_.reset();
  publish_folders();
}

void AlgorithmSession::publish_job(const std::string& state, const std::string& error) {
  const Job& job = *job_;
  json document{{"folder", job.algorithm.folder},
                {"name", job.algorithm.name},
                {"version", job.version},
                {"state", state},
                {"error", text_or_null(error)}};
  if (job.work == Work::build) {
    const BuildProgress progress = build_progress(job.programs->output());
    document["done"] = progress.done;
    document["of"] = progress.of;
    document["messages"] = messages_json(compiler_messages(job.programs->output()), job.algorithm);
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
