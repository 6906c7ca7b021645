#include "firmware/bootloader/trust_store.hpp"

#include <gtest/gtest.h>

#include "updated_module.hpp"

namespace proleg::bootloader {
namespace {

using namespace test;

image::Trust trust_of(std::uint8_t number) {
  image::PublicKey key{};
  key.fill(number);
  return {key, {number, 2, 3}};
}

/// Flash with room for eight records.
struct Store {
  SlotMemory flash{8 * TrustStore::record_size};
  TrustStore store{flash};
};

TEST(TrustStore, WithoutARecordTakesAnyImage) {
  EXPECT_EQ(Store().store.read(), image::Trust{});
  EXPECT_FALSE(Store().store.is_full());
}

TEST(TrustStore, HoldsWhatWasAddedLastAndErasesNothing) {
  Store all;
  for (std::uint8_t number = 1; number <= 8; ++number) {
    ASSERT_FALSE(all.store.is_full());
    ASSERT_TRUE(all.store.append(trust_of(number)));
    ASSERT_EQ(all.store.read(), trust_of(number));
  }
  EXPECT_TRUE(all.store.is_full());
  const int operations = all.flash.operations;
  EXPECT_FALSE(all.store.append(trust_of(9)));
  EXPECT_EQ(all.flash.operations, operations);
  EXPECT_EQ(all.store.read(), trust_of(8));
}

TEST(TrustStore, SkipsADamagedRecord) {
  for (std::size_t bit = 0; bit < 8 * TrustStore::record_size; ++bit) {
    Store all;
    ASSERT_TRUE(all.store.append(trust_of(1)));
    ASSERT_TRUE(all.store.append(trust_of(2)));
    all.flash.slots[2][TrustStore::record_size + bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    ASSERT_EQ(all.store.read(), trust_of(1)) << "bit " << bit;
    ASSERT_TRUE(all.store.append(trust_of(3)));
    ASSERT_EQ(all.store.read(), trust_of(3)) << "bit " << bit;
  }
}

// A cut can leave weak bits: a record looks used at one time, so that the next one is behind it, and erased later.
TEST(TrustStore, FindsARecordBehindOneThatLooksErased) {
  Store all;
  ASSERT_TRUE(all.store.append(trust_of(1)));
  ASSERT_TRUE(all.store.append(trust_of(2)));
  ASSERT_TRUE(all.store.append(trust_of(3)));
  std::fill_n(all.flash.slots[2].begin() + TrustStore::record_size, TrustStore::record_size, std::uint8_t{0xFF});
  EXPECT_EQ(all.store.read(), trust_of(3));
  ASSERT_TRUE(all.store.append(trust_of(4)));
  EXPECT_EQ(all.store.read(), trust_of(4));
}

TEST(TrustStore, HoldsTheOldOrTheNewTrustAfterACutOfThePower) {
  constexpr int words = TrustStore::record_size / 4;
  for (unsigned noise = 0; noise < 50; ++noise) {
    for (int cut = 0; cut < words; ++cut) {
      SCOPED_TRACE(testing::Message() << "seed " << noise << ", cut at word " << cut);
      Store all;
      all.flash.noise.seed(noise);
      ASSERT_TRUE(all.store.append(trust_of(1)));
      all.flash.cut_at = all.flash.operations + cut;
      EXPECT_THROW(static_cast<void>(all.store.append(trust_of(2))), PowerCut);
      all.flash.cut_at = -1;
      const image::Trust trust = all.store.read();
      ASSERT_TRUE(trust == trust_of(1) || trust == trust_of(2));
      ASSERT_TRUE(all.store.append(trust_of(3)));
      ASSERT_EQ(all.store.read(), trust_of(3));
    }
  }
}

TEST(TrustStore, ReportsFlashThatFails) {
  Store all;
  ASSERT_TRUE(all.store.append(trust_of(1)));
  all.flash.refused_at = all.flash.operations + 5;
  EXPECT_FALSE(all.store.append(trust_of(2)));
  EXPECT_EQ(all.store.read(), trust_of(1));
  EXPECT_TRUE(all.store.append(trust_of(2)));
  EXPECT_EQ(all.store.read(), trust_of(2));
}

}  // namespace
}  // namespace proleg::bootloader
