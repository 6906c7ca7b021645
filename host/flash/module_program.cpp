#include "host/flash/module_program.hpp"

#include <algorithm>
#include <cstdio>

#include "host/flash/image_file.hpp"
#include "host/flash/key_file.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg::host {
namespace {

namespace flag = broadcast::module_flag;
using broadcast::Code;

std::string protocol_text(std::uint16_t version) {
  return std::to_string(version >> 8U) + "." + std::to_string(version & 0xFFU);
}

std::string boards_text(const image::Header& image) {
  return board_text(image.board_id) + (image.lowest_revision == 0 && image.highest_revision == 0xFF
                                           ? ""
                                           : ", revisions " + std::to_string(image.lowest_revision) + " to " +
                                                 std::to_string(image.highest_revision));
}

FlashVerdict refuse(const std::string& why) { return {FlashAction::refuse, why}; }

/// Text about differences of the images beside the version.
std::string changes(const image::Header& before, const image::Header& after) {
  std::string text;
  if (before.protocol != after.protocol) {
    text += ", protocol " + protocol_text(before.protocol) + " -> " + protocol_text(after.protocol);
  }
  if (before.core_fingerprint != after.core_fingerprint) {
    text += ", core " + hexadecimal(before.core_fingerprint, 8) + " -> " + hexadecimal(after.core_fingerprint, 8);
  }
  if (before.settings_schema != after.settings_schema) {
    text +=
        ", settings schema " + std::to_string(before.settings_schema) + " -> " + std::to_string(after.settings_schema);
  }
  return text;
}

/// Why the module would refuse the image, as far as its header shows; empty: it would not. Only the module checks the
/// signature.
std::string trust_refusal(const image::Header& image, const broadcast::TrustSummary& trust) {
  const image::Version minimum{trust.major, trust.minor, trust.patch};
  if (trust.key_id == 0) {
    return "";
  }
  if (image.key_id == 0) {
    return "takes only images that are signed with key " + key_id_text(trust.key_id) +
           ", the image is not signed: 'proleg image sign' signs it";
  }
  if (image.key_id != trust.key_id) {
    return "the image is signed with another key (id " + key_id_text(image.key_id) + ", expected " +
           key_id_text(trust.key_id) + ")";
  }
  return image.version < minimum ? "takes no version below " + version_number_text(minimum) + ", the image is " +
                                       version_number_text(image.version)
                                 : "";
}

}  // namespace

void ModuleQuery::start(Microseconds now, const std::vector<std::uint32_t>& serials) {
  for (const std::uint32_t serial : serials) {
    modules_.push_back({serial, false, {}, std::nullopt, {}});
  }
  next_ = 0;
  if (!is_done()) {
    begin_module(now);
  }
}

void ModuleQuery::begin_module(Microseconds now) {
  bytes_.fill(0);
  missing_.clear();
  longest_answer_ = 0;
  attempt_ = 0;
  ask(now);
}

void ModuleQuery::next_module(Microseconds now) {
  ++next_;
  deadline_ = never;
  waiting_.clear();
  if (!is_done()) {
    begin_module(now);
  }
}

/// Requests the state first; then the words of the header that are missing, some at a time.
void ModuleQuery::ask(Microseconds now) {
  waiting_.clear();
  if (!module().has_answered) {
    waiting_.push_back(broadcast::status_frame(module().serial));
  }
  asked_ = std::min(missing_.size(), max_parallel);
  for (std::size_t i = 0; i < asked_; ++i) {
    waiting_.push_back(broadcast::header_frame(module().serial, missing_[i]));
  }
  ++attempt_;
  asked_at_ = now;
  constexpr Microseconds least_us = 5'000;
  const Microseconds timeout = longest_answer_ == 0 ? options_.answer_timeout_us : least_us + 4 * longest_answer_;
  deadline_ = now + std::min(timeout << std::min(attempt_ - 1, 8U), options_.longest_timeout_us);
  send_waiting();
}

void ModuleQuery::send_waiting() {
  while (!waiting_.empty() && port_.send(waiting_.front())) {
    waiting_.pop_front();
  }
}

void ModuleQuery::transmitted(Microseconds /*now*/, const CanFrame& /*frame*/) { send_waiting(); }

void ModuleQuery::receive(Microseconds now, const CanFrame& frame) {
  if (is_done()) {
    return;
  }
  if (const auto word = broadcast::decode_header_word(frame, module().serial)) {
    take_word(now, *word);
    return;
  }
  const auto status = broadcast::decode_status(frame, Code::status, module().serial);
  if (!status || module().has_answered) {
    return;
  }
  module().has_answered = true;
  module().status = *status;
  if (!module().is(broadcast::module_flag::has_image)) {
    next_module(now);
    return;
  }
  longest_answer_ = std::max<Microseconds>(now - asked_at_, 1);
  for (unsigned word = 0; word < first_words; ++word) {
    missing_.push_back(static_cast<std::uint8_t>(word));
  }
  missing_.push_back(last_word);
  for (unsigned word = 0; word < broadcast::TrustSummary::words; ++word) {
    missing_.push_back(static_cast<std::uint8_t>(broadcast::TrustSummary::first_word + word));
  }
  attempt_ = 0;
  ask(now);
}

void ModuleQuery::take_word(Microseconds now, const broadcast::HeaderWord& word) {
  const auto found = std::ranges::find(missing_, word.number);
  if (found == missing_.end()) {
    return;  // the word was requested twice
  }
  if (word.number >= broadcast::TrustSummary::first_word) {
    module().trust.set_word(word.number, word.value);
  } else {
    write_little_endian(bytes_, 4U * word.number, 4, word.value);
  }
  const bool was_asked = found - missing_.begin() < static_cast<std::ptrdiff_t>(asked_);
  missing_.erase(found);
  asked_ -= was_asked ? 1U : 0U;
  attempt_ = 0;
  if (missing_.empty()) {
    const image::HeaderResult result = image::decode(bytes_);
    if (result.error == image::Error::none) {
      module().image = result.header;
    }
    next_module(now);
  } else if (asked_ == 0) {
    longest_answer_ = std::max(longest_answer_, now - asked_at_);
    ask(now);
  }
}

void ModuleQuery::poll(Microseconds now) {
  if (is_done() || now < deadline_) {
    return;
  }
  if (attempt_ < options_.attempts) {
    ask(now);
  } else {
    module().missing_words = static_cast<unsigned>(missing_.size());
    next_module(now);
  }
}

std::string version_number_text(const image::Version& version) {
  return std::to_string(version.major) + "." + std::to_string(version.minor) + "." + std::to_string(version.patch);
}

std::string commit_text(const image::Header& image) {
  constexpr std::size_t shown_bytes = 4;
  const char* const changes = image.has_changed_sources ? "+" : "";
  if (std::ranges::all_of(image.commit, [](std::uint8_t byte) { return byte == 0; })) {
    return std::string("unknown") + changes;
  }
  std::string text;
  for (std::size_t i = 0; i < shown_bytes; ++i) {
    std::array<char, 3> digits{};
    std::snprintf(digits.data(), digits.size(), "%02x", unsigned{image.commit.at(i)});
    text += digits.data();
  }
  return text + changes;
}

std::string version_text(const image::Header& image) {
  return version_number_text(image.version) + " (" + commit_text(image) + ")";
}

bool is_same_image(const image::Header& one, const image::Header& other) { return one == other; }

FlashVerdict judge(const image::Header& image, const FlashCandidate& module, const FlashPermissions& permissions) {
  const ModuleProgram& program = module.program;
  if (!program.has_answered) {
    return refuse(
        "was found on the bus, but no answer to " + std::to_string(ModuleQueryOptions{}.attempts) +
        " requests for its program was received: try again, and look with 'proleg doctor' whether frames are lost; if "
        "none are, its program is older than updates over the bus, and only 'proleg flash --bare' replaces it");
  }
  if (!program.is(flag::has_bootloader)) {
    return refuse("has no bootloader: flash it with 'proleg flash --bare'");
  }
  if (module.board_id != image.board_id && !permissions.other_board) {
    return refuse("is " + board_text(module.board_id) + ", the image is for " + boards_text(image) +
                  "; --force-board sends it anyway");
  }
  if (image.length > slot_room) {
    return refuse("has room for " + std::to_string(slot_room) + " bytes, the image has " +
                  std::to_string(image.length));
  }
  const bool is_same = program.image && is_same_image(*program.image, image);
  if (is_same && program.is(flag::is_confirmed) && program.is(flag::runs_program)) {
    return {FlashAction::nothing, "runs " + version_text(image) + " already"};
  }
  if (program.is(flag::is_busy)) {
    return refuse("its servo has power, or it is Operational: stop the robot first");
  }
  if (program.missing_words != 0) {
    return refuse("answers, but " + std::to_string(program.missing_words) +
                  " words of the header of its program were not received: frames are lost ('proleg doctor' looks "
                  "for the cause); try again");
  }
  if (const std::string reason = trust_refusal(image, program.trust); !reason.empty()) {
    return refuse(reason);
  }
  if (module.board_id != image.board_id && program.trust.key_id != 0) {
    return refuse("takes only signed images, and the signature holds for " + boards_text(image) +
                  ": sign an image for " + board_text(module.board_id));
  }
  if (!program.image) {
    return {FlashAction::install, "no program -> " + version_text(image)};
  }
  const image::Header& before = *program.image;
  const bool is_older = image.version < before.version || image.settings_schema < before.settings_schema;
  if (is_older && !permissions.older_version) {
    return refuse("runs " + version_text(before) + ", the image is " +
                  (image.version < before.version
                       ? "older, " + version_number_text(image.version)
                       : "for older settings, schema " + std::to_string(image.settings_schema)) +
                  "; --allow-downgrade sends it anyway");
  }
  return {FlashAction::install, version_text(before) + " -> " + version_text(image) + changes(before, image) +
                                    (is_same ? ", not confirmed yet" : "")};
}

}  // namespace proleg::host
