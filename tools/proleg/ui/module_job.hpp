#pragma once

// A job on a bus that this program has open: one of our programs, a process of its own, that takes part in the bus.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/proleg/common/child_program.hpp"
#include "tools/proleg/common/scratch_folder.hpp"
#include "tools/proleg/ui/bus_sharing.hpp"

namespace proleg::tools {

/// What a job is, before it begins.
struct ModuleJobPlan {
  enum class Output : std::uint8_t {
    text,    ///< for people
    object,  ///< one JSON object, of --json
    events,  ///< one on each line, of --json-lines; the last one is the result
  };

  std::string kind;                        ///< as in the document `module_job`
  std::vector<std::string> words;          ///< a program without "proleg-", and its arguments but --bus
  std::string shown;                       ///< what does the same in a shell
  std::vector<std::string> shown_words{};  ///< for it, without --bus; nothing: `words`
  std::string by;                          ///< the viewer that has begun it
  Output output = Output::object;
  bool opens_bus = false;                ///< it opens the bus itself; else it takes part in ours
  bool gives_way = false;                ///< it is to end when servos are to get power
  std::chrono::seconds longest_loss{0};  ///< the line of a gateway ends for a while when its module is flashed
  /// With files of the job, and its working directory. Null: it works in `folder`.
  std::unique_ptr<ScratchFolder> files{};
  std::string folder;
};

class ModuleJob {
 public:
  /// Begins it, if the bus is free. number: of the document. address: of the bus. sharing: must outlive this. Throws
  /// std::runtime_error if a robot has power, or the program cannot be started.
  ModuleJob(unsigned number, ModuleJobPlan plan, std::string address, BusSharing& sharing);
  /// Ends it.
  ~ModuleJob();
  ModuleJob(const ModuleJob&) = delete;
  ModuleJob& operator=(const ModuleJob&) = delete;

  [[nodiscard]] unsigned number() const { return number_; }
  [[nodiscard]] const std::string& kind() const { return plan_.kind; }
  /// Takes what it has printed, and its end. Does not wait. Returns whether the document is another one.
  bool look();
  [[nodiscard]] bool has_ended() const { return status_.has_value(); }
  /// Its exit status; nothing: it runs, or a signal has ended it.
  [[nodiscard]] std::optional<int> status() const;
  /// What it has printed: the result, or null; as text if it is not JSON.
  [[nodiscard]] const nlohmann::json& result() const { return result_; }
  /// Why it has failed: its last line for people.
  [[nodiscard]] std::string failure() const;

  /// Answers its question. Throws std::runtime_error if there is another question, or none.
  void answer(std::uint64_t question, const std::string& word);
  /// Asks it to end, as Ctrl-C does. by: who, or why.
  void end(const std::string& by);

  /// The document `module_job` (docs/page-interface.md).
  [[nodiscard]] nlohmann::json document() const;

 private:
  static constexpr std::size_t most_output = std::size_t{4} << 20U;
  static constexpr std::size_t most_lines = 50;

  void start();
  bool take_output();
  bool take_errors();
  void take_event(const std::string& line);
  void add_ended(const nlohmann::json& event);
  void finish();
  /// Texts name the bus as viewers know it, not as the program that has inherited it.
  [[nodiscard]] std::string with_address(std::string text) const;

  unsigned number_;
  ModuleJobPlan plan_;
  std::string address_;
  BusSharing& sharing_;
  std::unique_ptr<ChildProgram> program_;
  std::string output_;  ///< that is no whole event yet
  std::string errors_;  ///< that is no whole line yet
  std::deque<std::string> lines_;
  nlohmann::json latest_ = nlohmann::json::object();
  nlohmann::json question_;
  std::uint64_t questions_ = 0;
  nlohmann::json result_;
  std::optional<int> status_;
  std::string ended_by_;
};

}  // namespace proleg::tools
