// Signed images in a virtual chip that has a key, through the bootloader that is flashed.

#include <iostream>

#include "chip_bootloader.hpp"
#include "firmware/bootloader/trust_store.hpp"
#include "shared/fixed/crc32.hpp"
#include "signed_image.hpp"

namespace proleg::sim {
namespace {

using bootloader::TrustStore;
using image::test::ImageSigner;

constexpr std::uint32_t trust_sector = 0x0801'0000;  // docs/board.md
constexpr std::size_t trust_size = 64 * 1024;

const ImageSigner& maker() {
  static const ImageSigner signer(1);
  return signer;
}
const ImageSigner& other_maker() {
  static const ImageSigner signer(2);
  return signer;
}

/// The program with a header that this function may change, signed.
template <typename Change>
std::vector<std::uint8_t> signed_program(const ImageSigner& signer, Change change) {
  std::vector<std::uint8_t> bytes = newer_program();
  image::Header header = image::decode(bytes).header;
  change(header);
  std::ranges::copy(image::encode(signer.sign(header)), bytes.begin());
  return bytes;
}
std::vector<std::uint8_t> signed_program(const ImageSigner& signer) {
  return signed_program(signer, [](image::Header& /*header*/) {});
}

class ChipWithKey : public ChipBootloader {
 protected:
  ChipWithKey() {
    rig->chip.write(trust_sector, TrustStore::encode({maker().key, {}}));  // as a programmer does it
    write_slot(slot_a, program(), true);
  }
  [[nodiscard]] image::Trust trust() const { return TrustStore::newest(rig->memory(trust_sector, trust_size)); }
};

TEST_F(ChipWithKey, RefusesWhatIsNotSignedWithItAndErasesNothing) {
  enter_bootloader();
  std::vector<std::uint8_t> forged = signed_program(maker());
  forged[image::layout::signature_at] ^= 1;
  write_little_endian(forged, 508, 4, crc32(std::span<const std::uint8_t>(forged).first(508)));
  const std::vector<std::uint8_t> images[]{newer_program(), signed_program(other_maker()), forged};
  std::vector<std::uint64_t> instructions;
  for (const std::vector<std::uint8_t>& image : images) {
    FlashingHost& host = host_with(image);
    const std::uint64_t before = rig->chip.instructions();
    host.transfer();
    EXPECT_EQ(host.finish(), ReceiverState::refused);
    instructions.push_back(rig->chip.instructions() - before);
    EXPECT_TRUE(holds(slot_a, program()));
    rig->run_for(4 * s);  // the session ends
  }
  // The images differ in what is done for them: only the last signature is computed. The CPU takes at least a cycle for
  // an instruction, and 168 million a second; most take one, loads and multiplications two or three.
  const std::uint64_t check = instructions[2] - instructions[0];
  std::cout << "the check of a signature: " << check << " instructions of the virtual chip, "
            << static_cast<double>(check) / 168e3 << " ms with one cycle each, " << static_cast<double>(check) / 84e3
            << " ms with two\n";
  EXPECT_GT(check, 1'000'000U);
  EXPECT_LT(check, 300U * 84'000U) << "300 ms with two cycles for each instruction";
  EXPECT_EQ(rig->read(0x2000, 6), maker().id());
  leave_bootloader();
  EXPECT_TRUE(starts_program());
  EXPECT_EQ(rig->read(0x2000, 6), maker().id()) << "the program says so, too";
}

TEST_F(ChipWithKey, RunsWhatIsSignedWithItAndKeepsWhatItSaysOfLaterImages) {
  enter_bootloader();
  const std::vector<std::uint8_t> image = signed_program(maker(), [](image::Header& header) {
    header.minimum_version = header.version;
    header.next_key = other_maker().key;
  });
  ASSERT_EQ(flash(image), ReceiverState::installed);
  leave_bootloader();
  ASSERT_TRUE(starts_program(s));
  EXPECT_EQ(trust().key, maker().key) << "it is on trial";
  for (unsigned i = 0; i < 10; ++i) {  // it hears others, so it confirms itself
    rig->host.send(broadcast::status_frame(serial));
    rig->run_for(100 * ms);
  }
  EXPECT_EQ(trust().key, maker().key) << "until the next start";
  rig->power_on();
  const BusTime start = rig->bus.now();
  ASSERT_TRUE(starts_program(s));
  std::cout << "the start at which a new key is kept takes " << (rig->bus.now() - start) / ms << " ms\n";
  EXPECT_EQ(trust(), (image::Trust{other_maker().key, image::decode(image).header.version}));
  EXPECT_TRUE(holds(slot_a, image));
  rig->power_on();
  ASSERT_TRUE(starts_program(200 * ms)) << "as fast as any";
}

TEST_F(ChipWithKey, ReturnsToTheProgramBeforeIfTheImageOnTrialIsNotSigned) {
  write_slot(slot_b, program(), true);
  write_slot(slot_a, std::vector<std::uint8_t>(slot_size, 0xFF), false);
  write_slot(slot_a, newer_program(), false);
  rig->power_on();
  ASSERT_TRUE(starts_program(5 * s));
  EXPECT_TRUE(holds(slot_a, program()));
}

TEST_F(ChipBootloader, AChipWithoutAKeyGetsItsFirstOneFromItsProgram) {
  write_slot(slot_a, program(), true);
  start_program();
  EXPECT_EQ(rig->read(0x2000, 6), 0U);
  const auto message = image::encode_key(maker().key);
  EXPECT_EQ(flash(message), ReceiverState::installed);
  leave_bootloader();
  ASSERT_TRUE(starts_program());
  EXPECT_EQ(rig->read(0x2000, 6), maker().id());
}

}  // namespace
}  // namespace proleg::sim
