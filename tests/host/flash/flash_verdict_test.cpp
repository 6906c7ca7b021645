// What would be done to a module, before anything is sent to it.

#include "host/flash/module_program.hpp"

#include <gtest/gtest.h>

namespace proleg::host {
namespace {

namespace flag = broadcast::module_flag;

image::Header header(std::uint16_t minor, std::uint8_t schema = 2) {
  image::Header made;
  made.board_id = 1;
  made.version = {0, minor, 0};
  made.protocol = 0x100;
  made.core_fingerprint = 0x1111;
  made.settings_schema = schema;
  made.commit.fill(static_cast<std::uint8_t>(minor));
  return made;
}

constexpr std::uint8_t well = flag::runs_program | flag::has_image | flag::is_confirmed | flag::has_bootloader;

FlashCandidate module_with(std::optional<image::Header> image, std::uint8_t flags = well) {
  FlashCandidate module;
  module.program = {7, true, {}, std::move(image)};
  module.program.status.condition.flags = flags;
  module.node = 3;
  module.board_id = 1;
  return module;
}

FlashVerdict judge_image(const image::Header& image, const FlashCandidate& module) { return judge(image, module, {}); }

TEST(FlashVerdict, ANewerImageIsInstalledAndTheVerdictSaysWhatChanges) {
  image::Header newer = header(2);
  newer.protocol = 0x101;
  newer.core_fingerprint = 0x2222;
  newer.settings_schema = 3;
  const FlashVerdict verdict = judge_image(newer, module_with(header(1)));
  EXPECT_EQ(verdict.action, FlashAction::install);
  EXPECT_EQ(
      verdict.text,
      "0.1.0 (01010101) -> 0.2.0 (02020202), protocol 1.0 -> 1.1, core 0x00001111 -> 0x00002222, settings schema 2 "
      "-> 3");
}

TEST(FlashVerdict, TheSameImageIsLeftAloneOnlyIfItRunsAndIsConfirmed) {
  EXPECT_EQ(judge_image(header(2), module_with(header(2))).action, FlashAction::nothing);
  for (const std::uint8_t missing : {flag::runs_program, flag::is_confirmed}) {
    EXPECT_EQ(judge_image(header(2), module_with(header(2), well & ~missing)).action, FlashAction::install);
  }
  image::Header rebuilt = header(2);
  rebuilt.hash[0] = 1;
  EXPECT_EQ(judge_image(rebuilt, module_with(header(2))).action, FlashAction::install)
      << "the same version, built anew";
}

TEST(FlashVerdict, AnOlderVersionAndOneForOlderSettingsNeedAWord) {
  for (const image::Header& older : {header(1), header(3, 1)}) {
    const FlashVerdict refused = judge_image(older, module_with(header(2)));
    EXPECT_EQ(refused.action, FlashAction::refuse);
    EXPECT_NE(refused.text.find("--allow-downgrade"), std::string::npos);
    EXPECT_EQ(judge(older, module_with(header(2)), {.older_version = true}).action, FlashAction::install);
  }
}

TEST(FlashVerdict, AnotherBoardNeedsAWord) {
  FlashCandidate other = module_with(header(1));
  other.board_id = 2;
  const FlashVerdict refused = judge_image(header(2), other);
  EXPECT_EQ(refused.action, FlashAction::refuse);
  EXPECT_NE(refused.text.find("is board 2 (olimex-stm32-p405), the image is for board 1 (reference)"),
            std::string::npos);
  EXPECT_EQ(judge(header(2), other, {.other_board = true}).action, FlashAction::install);
}

TEST(FlashVerdict, ASignedImageIsForItsBoardOnlyBecauseTheSignatureCoversTheBoard) {
  FlashCandidate other = module_with(header(1));
  other.board_id = 2;
  other.program.trust = {0x1A2B'3C4D, 0, 0, 0};
  image::Header signed_image = header(2);
  signed_image.key_id = 0x1A2B'3C4D;
  const FlashVerdict verdict = judge(signed_image, other, {.other_board = true});
  EXPECT_EQ(verdict.action, FlashAction::refuse);
  EXPECT_NE(verdict.text.find("the signature holds for board 1 (reference)"), std::string::npos) << verdict.text;
}

TEST(FlashVerdict, NothingIsSentToAModuleThatMoves) {
  EXPECT_EQ(judge(header(2), module_with(header(1), well | flag::is_busy), {true, true}).action, FlashAction::refuse);
}

TEST(FlashVerdict, ABootloaderWithoutAProgramGetsTheImage) {
  const FlashVerdict verdict = judge_image(header(2), module_with(std::nullopt, flag::has_bootloader));
  EXPECT_EQ(verdict.action, FlashAction::install);
  EXPECT_EQ(verdict.text, "no program -> 0.2.0 (02020202)");
}

TEST(FlashVerdict, AModuleOfWhichFramesWereLostNeedsAnotherTryAndNoProbe) {
  FlashCandidate module = module_with(std::nullopt);
  module.program.missing_words = 7;
  const FlashVerdict verdict = judge_image(header(2), module);
  EXPECT_EQ(verdict.action, FlashAction::refuse);
  EXPECT_NE(verdict.text.find("7 words of the header"), std::string::npos);
  EXPECT_EQ(verdict.text.find("--bare"), std::string::npos);
}

TEST(FlashVerdict, AModuleThatCannotBeFlashedOverTheBusIsNamedWithTheWayThatIsLeft) {
  FlashCandidate silent = module_with(std::nullopt);
  silent.program.has_answered = false;
  for (const FlashCandidate& module : {silent, module_with(header(1), well & ~flag::has_bootloader)}) {
    const FlashVerdict verdict = judge(header(2), module, {true, true});
    EXPECT_EQ(verdict.action, FlashAction::refuse);
    EXPECT_NE(verdict.text.find("--bare"), std::string::npos);
  }
}

TEST(FlashVerdict, AModuleWithAKeyTakesOnlyWhatItsHeaderAllows) {
  FlashCandidate module = module_with(header(1));
  module.program.trust = {0x1A2B'3C4D, 0, 2, 0};
  const auto text_for = [&module](unsigned number, std::uint32_t key_id) {
    image::Header image = header(static_cast<std::uint16_t>(number));
    image.key_id = key_id;
    const FlashVerdict verdict = judge_image(image, module);
    EXPECT_EQ(verdict.action, key_id == 0x1A2B'3C4D && number >= 2 ? FlashAction::install : FlashAction::refuse);
    return verdict.text;
  };
  EXPECT_NE(text_for(2, 0).find("only images that are signed with key 1a2b3c4d, the image is not signed"),
            std::string::npos);
  EXPECT_NE(text_for(2, 0x99).find("another key (id 00000099, expected 1a2b3c4d)"), std::string::npos);
  EXPECT_NE(text_for(1, 0x1A2B'3C4D).find("no version below 0.2.0, the image is 0.1.0"), std::string::npos);
  EXPECT_NE(text_for(2, 0x1A2B'3C4D).find("0.1.0 (01010101) -> 0.2.0"), std::string::npos);
}

TEST(FlashVerdict, CommitsAreShortAndSayIfTheSourcesWereOthers) {
  image::Header image = header(0);
  EXPECT_EQ(commit_text(image), "unknown");
  image.commit = {0xAB, 0xCD, 0xEF, 0x01, 0x23};
  EXPECT_EQ(commit_text(image), "abcdef01");
  image.has_changed_sources = true;
  EXPECT_EQ(version_text(image), "0.0.0 (abcdef01+)");
}

}  // namespace
}  // namespace proleg::host
