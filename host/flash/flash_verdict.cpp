#include "host/flash/flash_verdict.hpp"

#include <algorithm>
#include <cstdio>

#include "host/flash/image_file.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

namespace flag = broadcast::module_flag;

std::string protocol_text(std::uint16_t version) {
  return std::to_string(version >> 8U) + "." + std::to_string(version & 0xFFU);
}

std::string board_text(const image::Header& image) {
  return "board " + std::to_string(image.board_id) +
         (image.lowest_revision == 0 && image.highest_revision == 0xFF
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

}  // namespace

std::string version_number_text(const image::Version& version) {
  return std::to_string(version.major) + "." + std::to_string(version.minor) + "." + std::to_string(version.patch);
}

std::string commit_text(const image::Header& image) {
  constexpr std::size_t shown_bytes = 4;
  if (std::ranges::all_of(image.commit, [](std::uint8_t byte) { return byte == 0; })) {
    return "unknown";
  }
  std::string text;
  for (std::size_t i = 0; i < shown_bytes; ++i) {
    std::array<char, 3> digits{};
    std::snprintf(digits.data(), digits.size(), "%02x", unsigned{image.commit.at(i)});
    text += digits.data();
  }
  return text + (image.has_changed_sources ? "+" : "");
}

std::string version_text(const image::Header& image) {
  return version_number_text(image.version) + " (" + commit_text(image) + ")";
}

bool is_same_image(const image::Header& one, const image::Header& other) { return one == other; }

FlashVerdict judge(const image::Header& image, const FlashCandidate& module, const FlashPermissions& permissions) {
  const ModuleProgram& program = module.program;
  if (!program.has_answered) {
    return refuse(
        "answers no request for an update: its program is older than that, or it has no bootloader; flash it "
        "with 'proleg flash --bare'");
  }
  if (!program.is(flag::has_bootloader)) {
    return refuse("has no bootloader: flash it with 'proleg flash --bare'");
  }
  if (module.board_id != image.board_id && !permissions.other_board) {
    return refuse("is board " + std::to_string(module.board_id) + ", the image is for " + board_text(image) +
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
