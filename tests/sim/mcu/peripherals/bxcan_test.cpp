// CAN1 at the level of its registers, as the manual describes them (RM0090, section 32).

#include <gtest/gtest.h>

#include "bxcan_rig.hpp"
#include "sim/bus/frame_bits.hpp"

namespace proleg::sim {
namespace {

using BxCanTest = BxCanRig;

constexpr BusTime bit_time = 1'000;
constexpr std::uint32_t rqcp = 1;
constexpr std::uint32_t txok = 2;
constexpr std::uint32_t alst = 4;
constexpr std::uint32_t terr = 8;
constexpr std::uint32_t abrq = 0x80;

BusTime duration(std::uint16_t identifier, std::uint8_t length = 0) {
  return frame_bits({identifier, length, {}}) * bit_time;
}

// Modes

TEST_F(BxCanTest, ResetValuesAreTheManuals) {
  EXPECT_EQ(can.name(), "CAN1");
  EXPECT_EQ(can.base(), 0x4000'6400U);
  EXPECT_EQ(read(can1::mcr), 0x0001'0002U);
  EXPECT_EQ(read(can1::msr), 0x0000'0C02U);
  EXPECT_EQ(read(can1::tsr), 0x1C00'0000U);
  EXPECT_EQ(read(can1::rf0r), 0U);
  EXPECT_EQ(read(can1::rf1r), 0U);
  EXPECT_EQ(read(can1::ier), 0U);
  EXPECT_EQ(read(can1::esr), 0U);
  EXPECT_EQ(read(can1::btr), 0x0123'0000U);
  EXPECT_EQ(read(can1::fmr), 0x2A1C'0E01U);
  EXPECT_EQ(read(can1::fm1r), 0U);
  EXPECT_EQ(read(can1::fs1r), 0U);
  EXPECT_EQ(read(can1::ffa1r), 0U);
  EXPECT_EQ(read(can1::fa1r), 0U);
  EXPECT_EQ(read(can1::ti0r) & 1U, 0U);
}

TEST_F(BxCanTest, InitialisationIsEnteredAndLeftWithAHandshake) {
  write(can1::mcr, can1::inrq);
  run_for(1'000);
  EXPECT_EQ(read(can1::msr) & 3U, can1::inak);
  write(can1::btr, can1::megabit);
  const BusTime asked = bus.now();
  write(can1::mcr, 0);
  run_until(asked + 11 * bit_time - 125);
  EXPECT_EQ(read(can1::msr) & 3U, can1::inak) << "until 11 recessive bits have been seen";
  run_until(asked + 11 * bit_time);
  EXPECT_EQ(read(can1::msr) & 3U, 0U);
}

TEST_F(BxCanTest, SleepMayBeLeftBeforeInitialisationIsRequested) {
  write(can1::mcr, 0);
  run_for(20'000);
  EXPECT_EQ(read(can1::msr) & 3U, 0U);
  partner_sends(0x123);
  run_for(200'000);
  EXPECT_TRUE(partner.sent.empty()) << "without a bit rate it does not acknowledge";
  write(can1::mcr, can1::inrq);
  run_for(1'000);
  EXPECT_EQ(read(can1::msr) & 3U, can1::inak);
}

TEST_F(BxCanTest, WithSleepStillSetItStaysAsleep) {
  write(can1::mcr, can1::inrq | can1::sleep);
  run_for(20'000);
  EXPECT_EQ(read(can1::msr) & 3U, can1::slak);
}

TEST_F(BxCanTest, OutsideOfNormalModeItNeitherReceivesNorAcknowledges) {
  start();
  enter_initialisation();
  partner_sends(0x123);
  run_for(1'000'000);
  EXPECT_TRUE(partner.sent.empty());
  EXPECT_EQ(read(can1::rf0r), 0U);
  write(can1::mcr, can1::sleep);
  run_for(1'000'000);
  EXPECT_EQ(read(can1::msr) & 3U, can1::slak);
  EXPECT_TRUE(partner.sent.empty());
  write(can1::mcr, 0);
  run_for(1'000'000);
  EXPECT_EQ(partner.sent.size(), 1U);
  EXPECT_EQ(read(can1::rf0r), 1U);
}

TEST_F(BxCanTest, InitialisationWaitsForTheFrameOnTheWire) {
  start();
  const BusTime begin = bus.now();
  partner_sends(0x123, 8);
  run_until(begin + 20 * bit_time);
  EXPECT_EQ(read(can1::msr) & 0x300U, 0x200U) << "RXM";
  write(can1::mcr, can1::inrq);
  const BusTime end = bus.next_event();
  run_until(end - 125);
  EXPECT_EQ(read(can1::msr) & can1::inak, 0U);
  run_until(end);
  EXPECT_EQ(read(can1::msr) & can1::inak, can1::inak);
  EXPECT_EQ(read(can1::rf0r), 1U) << "the frame was received";
  EXPECT_EQ(partner.sent.size(), 1U);
}

TEST_F(BxCanTest, OnABusyBusNormalModeBeginsAfterTheFrameAndItsIntermission) {
  enter_initialisation();
  write(can1::btr, can1::megabit);
  TestPartner third(bus);  // acknowledges
  partner_sends(0x123, 8);
  run_for(20 * bit_time);
  write(can1::mcr, 0);
  const BusTime end = bus.next_event();
  run_until(end + 3 * bit_time - 125);
  EXPECT_EQ(read(can1::msr) & can1::inak, can1::inak);
  run_until(end + 3 * bit_time);
  EXPECT_EQ(read(can1::msr) & can1::inak, 0U);
}

TEST_F(BxCanTest, ABitRateThatIsNotTheBusesIsRejectedWithBothRates) {
  enter_initialisation();
  write(can1::btr, (can1::megabit & ~0x3FFU) | 5U);
  expect_rejected(can1::mcr, 0, {"CAN1_BTR", "500000 bit/s", "1000000 bit/s", "42000000 Hz"});
  chip.clocks_.apb1 = local_time_per_us / 16;
  write(can1::btr, (1U << 20U) | (4U << 16U) | 1U);  // 16 MHz / 2 / 8
  write(can1::mcr, 0);
  run_for(20'000);
  EXPECT_EQ(read(can1::msr) & 3U, 0U);
}

TEST_F(BxCanTest, ItsClockMayNotChangeOnTheBus) {
  Clocks other = chip.clocks();
  other.apb1 *= 2;
  can.clocks_change(other);
  start();
  EXPECT_FALSE(can.is_idle());
  EXPECT_THROW(can.clocks_change(other), UnmodelledAccess);
  can.clocks_change(chip.clocks());
}

TEST_F(BxCanTest, AResetOfTheChipLeavesTheBusUntilTheProgramJoinsAgain) {
  start();
  request(0, 0x111);
  write(can1::ier, 1);
  run_for(1'000'000);
  ASSERT_TRUE(chip.lines[BxCan::tx_interrupt]);
  request(1, 0x222);
  can.reset();
  EXPECT_EQ(can.next_request(), never_on_bus);
  EXPECT_FALSE(chip.lines[BxCan::tx_interrupt]);
  EXPECT_EQ(read(can1::mcr), 0x0001'0002U);
  EXPECT_EQ(read(can1::tsr), 0x1C00'0000U);
  EXPECT_EQ(read(can1::btr), 0x0123'0000U);
  partner_sends(0x123);
  run_for(1'000'000);
  EXPECT_TRUE(partner.sent.empty());
  start();
  run_for(1'000'000);
  EXPECT_EQ(partner.sent.size(), 1U);
  EXPECT_EQ(partner.identifiers(), std::vector<std::uint16_t>{0x111});
}

TEST_F(BxCanTest, MasterResetEmptiesTheFifosAndGoesToSleep) {
  start();
  partner_sends(0x123);
  run_for(1'000'000);
  ASSERT_EQ(read(can1::rf0r), 1U);
  write(can1::mcr, 1U << 15U);
  EXPECT_EQ(read(can1::mcr), 0x0001'0002U);
  EXPECT_EQ(read(can1::rf0r), 0U);
  EXPECT_EQ(read(can1::msr) & 3U, can1::slak);
}

TEST_F(BxCanTest, AFrameWakesItOrIsNoted) {
  start();
  write(can1::ier, (1U << 16U) | (1U << 17U));
  write(can1::mcr, can1::sleep);
  run_for(10'000);
  EXPECT_EQ(read(can1::msr) & 0x1FU, can1::slak | can1::slaki);
  EXPECT_TRUE(chip.lines[BxCan::sce_interrupt]);
  write(can1::msr, can1::slaki);
  EXPECT_FALSE(chip.lines[BxCan::sce_interrupt]);

  TestPartner third(bus);
  partner_sends(0x123);
  run_for(10'000);
  EXPECT_EQ(read(can1::msr) & 0x1FU, can1::slak | can1::wkui);
  EXPECT_TRUE(chip.lines[BxCan::sce_interrupt]);
  write(can1::msr, can1::wkui);
  EXPECT_FALSE(chip.lines[BxCan::sce_interrupt]);
  run_for(200'000);

  write(can1::mcr, can1::sleep | can1::awum);
  run_for(10'000);
  partner_sends(0x124);
  partner_sends(0x125);
  run_for(1'000'000);
  EXPECT_EQ(read(can1::mcr) & can1::sleep, 0U);
  EXPECT_EQ(read(can1::msr) & 3U, 0U);
  ASSERT_EQ(read(can1::rf0r), 1U) << "the frame that wakes it is lost";
  EXPECT_EQ(read(can1::ri0r) >> 21U, 0x125U);
}

// Transmission

TEST_F(BxCanTest, AFrameGoesOutAsTheMailboxHasIt) {
  start();
  request(1, 0x5A5, 7, 0x4433'2211, 0xAA77'6655);
  EXPECT_EQ(read(can1::ti0r + 0x10), (0x5A5U << 21U) | 1U);
  EXPECT_FALSE(is_empty(1));
  const BusTime begin = bus.now();
  run_for(1'000'000);
  const CanFrame frame{0x5A5, 7, {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77}};
  ASSERT_EQ(partner.received_frames.size(), 1U);
  EXPECT_EQ(partner.received_frames[0], std::make_pair(begin + frame_bits(frame) * bit_time, frame));
  EXPECT_TRUE(is_empty(1));
  EXPECT_EQ(outcome(1), rqcp | txok);
  EXPECT_EQ(read(can1::ti0r + 0x10), 0x5A5U << 21U);
  write(can1::tsr, rqcp << 8U);
  EXPECT_EQ(outcome(1), 0U);
}

TEST_F(BxCanTest, ARequestOfAChipThatIsAheadReachesTheBusAtItsTrueTime) {
  start();
  chip.time = bus.now() + 40'000;
  request(0, 0x123);
  EXPECT_EQ(can.next_request(), chip.time);
  const BusTime asked = chip.time;
  bus.advance_to(asked - 10'000);
  can.submit(bus.now());
  EXPECT_EQ(bus.next_event(), never_on_bus);
  EXPECT_EQ(can.next_request(), asked);
  run_until(asked + 1'000'000);
  ASSERT_EQ(partner.received_frames.size(), 1U);
  EXPECT_EQ(partner.received_frames[0].first, asked + duration(0x123));
}

TEST_F(BxCanTest, TheLowestIdentifierOfSeveralMailboxesGoesFirstThenTheLowestNumber) {
  start();
  request(2, 0x300);
  request(1, 0x200, 1, 1);
  request(0, 0x200, 1, 0);
  EXPECT_EQ(read(can1::tsr) >> 24U, 0x82U) << "LOW2; CODE: the mailbox of the lowest priority";
  run_for(1'000'000);
  ASSERT_EQ(partner.identifiers(), (std::vector<std::uint16_t>{0x200, 0x200, 0x300}));
  EXPECT_EQ(partner.received_frames[0].second.data[0], 0);
  EXPECT_EQ(read(can1::tsr) >> 24U, 0x1CU);
}

TEST_F(BxCanTest, WithTxfpTheOrderIsThatOfTheRequests) {
  start(can1::txfp);
  request(2, 0x300);
  request(1, 0x200);
  request(0, 0x100);
  EXPECT_EQ(read(can1::tsr) >> 24U, 0x20U) << "LOW0, which was asked last";
  run_for(1'000'000);
  EXPECT_EQ(partner.identifiers(), (std::vector<std::uint16_t>{0x300, 0x200, 0x100}));
}

TEST_F(BxCanTest, TsrNamesAFreeMailboxAndTheLowestPriorityOfTwo) {
  start();
  enter_initialisation();  // so that nothing goes out
  request(0, 0x100);
  EXPECT_EQ(read(can1::tsr) >> 24U, 0x19U) << "TME2, TME1, CODE 1, no LOW: only one is pending";
  request(1, 0x080);
  EXPECT_EQ(read(can1::tsr) >> 24U, 0x32U) << "LOW0, TME2, CODE 2";
}

TEST_F(BxCanTest, ARequestOutsideOfNormalModeGoesOutLater) {
  start();
  enter_initialisation();
  request(0, 0x100);
  run_for(1'000'000);
  EXPECT_TRUE(partner.received_frames.empty());
  write(can1::mcr, 0);
  run_for(1'000'000);
  EXPECT_EQ(partner.received_frames.size(), 1U);
}

TEST_F(BxCanTest, APendingMailboxIsAbortedAtOnceOneOnTheWireOnlyIfItFails) {
  start();
  request(0, 0x100);
  request(1, 0x200);
  run_for(10 * bit_time);
  EXPECT_EQ(read(can1::msr) & 0x300U, 0x100U) << "TXM";
  write(can1::tsr, (abrq << 8U) | abrq);
  EXPECT_EQ(outcome(0), abrq);
  run_for(bit_time);
  EXPECT_TRUE(is_empty(1));
  EXPECT_EQ(outcome(1), rqcp);
  EXPECT_FALSE(is_empty(0));
  EXPECT_EQ(outcome(0), abrq);
  run_for(1'000'000);
  EXPECT_EQ(outcome(0), rqcp | txok);
  EXPECT_EQ(partner.identifiers(), std::vector<std::uint16_t>{0x100});

  bus.set_error_rule([](const CanFrame&, std::uint64_t) { return true; });
  request(2, 0x300);
  run_for(10 * bit_time);
  write(can1::tsr, abrq << 16U);
  run_for(1'000'000);
  EXPECT_TRUE(is_empty(2));
  EXPECT_EQ(outcome(2), rqcp | terr);
  EXPECT_EQ(bus.statistics().errors, 1U) << "it is not tried again";
  write(can1::tsr, abrq);  // an empty one
  EXPECT_EQ(outcome(0), rqcp | txok);
}

TEST_F(BxCanTest, WithNartAFrameIsTriedOnceAndTheOutcomeHasTheReason) {
  start(can1::nart);
  bus.set_error_rule([](const CanFrame& frame, std::uint64_t) { return frame.identifier == 0x100; });
  request(0, 0x100);
  run_for(1'000'000);
  EXPECT_TRUE(is_empty(0));
  EXPECT_EQ(outcome(0), rqcp | terr);
  EXPECT_EQ(bus.statistics().errors, 1U);

  request(1, 0x200);
  partner_sends(0x001);
  run_for(1'000'000);
  EXPECT_TRUE(is_empty(1));
  EXPECT_EQ(outcome(1), rqcp | alst);
  EXPECT_TRUE(partner.received_frames.empty());

  request(1, 0x200);
  run_for(1'000'000);
  EXPECT_EQ(outcome(1), rqcp | txok);
}

TEST_F(BxCanTest, WithRetransmissionAnErrorShowsAndTheFrameFollows) {
  start();
  bus.set_error_rule([](const CanFrame&, std::uint64_t transmission) { return transmission == 1; });
  request(0, 0x100);
  run_for(duration(0x100) + 6 * bit_time);
  EXPECT_EQ(outcome(0), terr);
  EXPECT_FALSE(is_empty(0));
  EXPECT_EQ(read(can1::esr), (8U << 16U) | (4U << 4U)) << "TEC 8, LEC bit recessive";
  run_for(1'000'000);
  EXPECT_EQ(outcome(0), rqcp | txok);
  EXPECT_EQ(partner.received_frames.size(), 1U);
  EXPECT_EQ(read(can1::esr), 7U << 16U);
}

// Reception

TEST_F(BxCanTest, AFrameIsReadFromTheFifo) {
  start();
  partner_sends(0x2A5, 6);
  run_for(1'000'000);
  EXPECT_EQ(read(can1::rf0r), 1U);
  EXPECT_EQ(read(can1::ri0r), 0x2A5U << 21U);
  EXPECT_EQ(read(can1::ri0r + 4), 6U);
  EXPECT_EQ(read(can1::ri0r + 8), 0x0403'0201U);
  EXPECT_EQ(read(can1::ri0r + 12), 0x0605U);
  write(can1::rf0r, 0x20);
  EXPECT_EQ(read(can1::rf0r), 0U);
  write(can1::rf0r, 0x20);
  EXPECT_EQ(read(can1::rf0r), 0U);
}

TEST_F(BxCanTest, TheFifoHoldsThreeAndOverwritesTheLast) {
  start();
  for (const std::uint16_t identifier : std::vector<std::uint16_t>{0x101, 0x102, 0x103, 0x104}) {
    EXPECT_EQ(read(can1::rf0r) & 0x10U, 0U);
    partner_sends(identifier);
    run_for(1'000'000);
  }
  EXPECT_EQ(read(can1::rf0r), 0x1BU) << "FOVR, FULL, three pending";
  write(can1::rf0r, 0x18);
  EXPECT_EQ(read(can1::rf0r), 3U);
  for (const std::uint32_t identifier : {0x101U, 0x102U, 0x104U}) {
    EXPECT_EQ(read(can1::ri0r) >> 21U, identifier);
    write(can1::rf0r, 0x20);
  }
  EXPECT_EQ(read(can1::rf0r), 0U);
}

TEST_F(BxCanTest, ALockedFifoKeepsTheOldest) {
  start(can1::rflm);
  for (const std::uint16_t identifier : std::vector<std::uint16_t>{0x101, 0x102, 0x103, 0x104, 0x105}) {
    partner_sends(identifier);
    run_for(1'000'000);
  }
  EXPECT_EQ(read(can1::rf0r), 0x1BU);
  write(can1::rf0r, 0x20);
  partner_sends(0x106);
  run_for(1'000'000);
  for (const std::uint32_t identifier : {0x102U, 0x103U, 0x106U}) {
    EXPECT_EQ(read(can1::ri0r) >> 21U, identifier);
    write(can1::rf0r, 0x20);
  }
}

TEST_F(BxCanTest, FiltersDirectFramesToEitherFifoOrNone) {
  start();
  write(can1::fmr, 0x2A1C'0000U | (28U << 8U) | 1U);
  write(can1::fs1r, 6);   // banks 1 and 2: 32 bits
  write(can1::fm1r, 6);   // lists
  write(can1::ffa1r, 4);  // bank 2 to FIFO 1
  write(can1::fa1r, 6);
  write(can1::f0r1 + 8, 0x100U << 21U);
  write(can1::f0r1 + 12, 0x101U << 21U);
  write(can1::f0r1 + 16, 0x200U << 21U);
  write(can1::f0r1 + 20, 0x201U << 21U);
  partner_sends(0x100);
  run_for(1'000'000);
  EXPECT_EQ(read(can1::rf0r) + read(can1::rf1r), 0U) << "FINIT deactivates reception";
  EXPECT_EQ(partner.sent.size(), 1U) << "but the frame is acknowledged";
  write(can1::fmr, 0x2A1C'0000U | 28U << 8U);
  for (const std::uint16_t identifier : std::vector<std::uint16_t>{0x101, 0x201, 0x300}) {
    partner_sends(identifier);
    run_for(1'000'000);
  }
  EXPECT_EQ(read(can1::rf0r), 1U);
  EXPECT_EQ(read(can1::ri0r), 0x101U << 21U);
  EXPECT_EQ(read(can1::ri0r + 4), 3U << 8U) << "filters 0 and 1 of FIFO 0 are bank 0's two masks of 16 bits";
  EXPECT_EQ(read(can1::rf1r), 1U);
  EXPECT_EQ(read(can1::ri0r + 0x10), 0x201U << 21U);
  EXPECT_EQ(read(can1::ri0r + 0x14), 1U << 8U);
  expect_rejected(can1::f0r1 + 8, 1, {"CAN1_F1R1", "write-protected"});
  write(can1::f0r1, 1);
  expect_rejected(can1::fs1r, 0, {"CAN1_FS1R", "FINIT"});
  write(can1::fa1r, 4);
  write(can1::f0r1 + 8, 1);
}

// Interrupts

TEST_F(BxCanTest, TransmitInterruptFollowsRqcp) {
  start();
  request(2, 0x100);
  run_for(1'000'000);
  EXPECT_FALSE(chip.lines[BxCan::tx_interrupt]);
  write(can1::ier, 1);
  EXPECT_TRUE(chip.lines[BxCan::tx_interrupt]);
  write(can1::tsr, rqcp << 16U);
  EXPECT_FALSE(chip.lines[BxCan::tx_interrupt]);
  request(2, 0x100);
  run_for(1'000'000);
  EXPECT_TRUE(chip.lines[BxCan::tx_interrupt]);
  request(2, 0x100);
  EXPECT_FALSE(chip.lines[BxCan::tx_interrupt]) << "a request clears RQCP";
}

TEST_F(BxCanTest, FifoInterruptsFollowPendingFullAndOverrun) {
  for (const unsigned fifo : {0U, 1U}) {
    SCOPED_TRACE(fifo);
    const unsigned line = fifo == 0 ? BxCan::rx0_interrupt : BxCan::rx1_interrupt;
    const std::uint32_t status = fifo == 0 ? can1::rf0r : can1::rf1r;
    can.reset();
    start();
    write(can1::fmr, 0x2A1C'0000U | (28U << 8U) | 1U);
    write(can1::ffa1r, fifo);
    write(can1::fmr, 0x2A1C'0000U | 28U << 8U);
    write(can1::ier, 2U << (3 * fifo));
    partner_sends(0x100);
    run_for(1'000'000);
    EXPECT_TRUE(chip.lines.at(line));
    write(status, 0x20);
    EXPECT_FALSE(chip.lines.at(line));

    write(can1::ier, 4U << (3 * fifo));
    for (unsigned i = 0; i < 3; ++i) {
      EXPECT_FALSE(chip.lines.at(line));
      partner_sends(0x100);
      run_for(1'000'000);
    }
    EXPECT_TRUE(chip.lines.at(line));
    write(status, 8);
    EXPECT_FALSE(chip.lines.at(line));

    write(can1::ier, 8U << (3 * fifo));
    partner_sends(0x100);
    run_for(1'000'000);
    EXPECT_TRUE(chip.lines.at(line));
    write(status, 0x10);
    EXPECT_FALSE(chip.lines.at(line));
  }
}

TEST_F(BxCanTest, ErrorInterruptsComeForWhatIsEnabled) {
  struct Case {
    std::uint32_t enable;
    unsigned errors;  ///< in a row until ERRI is set
  };
  for (const Case& it : {Case{1U << 11U, 1}, Case{1U << 8U, 12}, Case{1U << 9U, 16}, Case{1U << 10U, 32}}) {
    SCOPED_TRACE(it.enable);
    can.reset();
    bus.set_error_rule({});
    start();
    bus.start_statistics();
    bus.set_error_rule([](const CanFrame&, std::uint64_t) { return true; });
    write(can1::ier, it.enable | (1U << 15U));
    request(0, 0x100);
    while ((read(can1::msr) & can1::erri) == 0) {
      ASSERT_LE(bus.statistics().errors, 32U);
      EXPECT_FALSE(chip.lines[BxCan::sce_interrupt]);
      run_for(bit_time);
    }
    EXPECT_EQ(bus.statistics().errors, it.errors);
    EXPECT_TRUE(chip.lines[BxCan::sce_interrupt]);
    write(can1::msr, can1::erri);
    EXPECT_FALSE(chip.lines[BxCan::sce_interrupt]);
    run_for(100'000);
  }
}

// Errors

TEST_F(BxCanTest, WithoutAcknowledgementItBecomesPassiveAndContinuesToSend) {
  start();
  partner.controller.switch_off();
  request(0, 0x100);
  run_for(100'000'000);
  EXPECT_EQ(read(can1::esr), (128U << 16U) | (3U << 4U) | 3U) << "TEC 128, LEC acknowledgement, EPVF, EWGF";
  EXPECT_FALSE(is_empty(0));
  partner.controller.switch_on();
  run_for(1'000'000);
  EXPECT_TRUE(is_empty(0));
  EXPECT_EQ(partner.received_frames.size(), 1U);
  EXPECT_EQ(read(can1::esr), (127U << 16U) | 1U);
}

TEST_F(BxCanTest, ReceiveErrorsCountInRec) {
  start();
  bus.set_error_rule([](const CanFrame&, std::uint64_t transmission) { return transmission <= 3; });
  partner_sends(0x100);
  run_for(4 * duration(0x100));
  EXPECT_EQ(read(can1::esr), (3U << 24U) | (2U << 4U)) << "LEC form";
  write(can1::esr, 7U << 4U);
  EXPECT_EQ(read(can1::esr), (3U << 24U) | (7U << 4U));
  run_for(1'000'000);
  EXPECT_EQ(read(can1::esr), 2U << 24U);
}

TEST_F(BxCanTest, BusOffIsLeftByWayOfInitialisation) {
  start();
  bus.set_error_rule([](const CanFrame& frame, std::uint64_t) { return frame.identifier == 0x100; });
  request(0, 0x100);
  request(1, 0x200);
  run_for(100'000'000);
  EXPECT_EQ(read(can1::esr) & 7U, 7U) << "BOFF, EPVF, EWGF";
  EXPECT_EQ(bus.statistics().errors, 32U);
  EXPECT_FALSE(is_empty(0));
  EXPECT_FALSE(is_empty(1));
  partner_sends(0x300);
  run_for(1'000'000);
  EXPECT_TRUE(partner.sent.empty()) << "bus-off does not acknowledge";
  partner.controller.abort_all();
  run_for(1'000'000);

  write(can1::tsr, abrq);
  run_for(1'000);
  EXPECT_TRUE(is_empty(0));
  EXPECT_EQ(outcome(0), rqcp | terr);
  write(can1::mcr, can1::inrq);
  run_for(1'000);
  ASSERT_EQ(read(can1::msr) & can1::inak, can1::inak);
  EXPECT_EQ(read(can1::esr) & 4U, 4U);
  write(can1::mcr, 0);
  run_for(11 * bit_time);
  EXPECT_EQ(read(can1::msr) & can1::inak, 0U);
  run_for(128 * 11 * bit_time - 125);
  EXPECT_EQ(read(can1::esr) & 4U, 4U);
  EXPECT_TRUE(partner.received_frames.empty());
  run_for(125);
  EXPECT_EQ(read(can1::esr) & 0xFFFF'0007U, 0U);
  run_for(1'000'000);
  EXPECT_EQ(partner.identifiers(), std::vector<std::uint16_t>{0x200}) << "what was not aborted goes out";
}

TEST_F(BxCanTest, WithAbomBusOffIsLeftByItself) {
  start(can1::abom);
  std::uint64_t left = 32;
  bus.set_error_rule([&](const CanFrame&, std::uint64_t) { return left > 0 && left-- > 0; });
  request(0, 0x100);
  while ((read(can1::esr) & 4U) == 0) {
    run_for(bit_time);
  }
  const BusTime bus_off = bus.now();
  run_until(bus_off + 128 * 11 * bit_time - 125);
  EXPECT_EQ(read(can1::esr) & 4U, 4U);
  run_until(bus_off + 128 * 11 * bit_time);
  EXPECT_EQ(read(can1::esr) & 7U, 0U);
  run_for(1'000'000);
  EXPECT_EQ(partner.received_frames.size(), 1U);
  EXPECT_EQ(outcome(0), rqcp | txok);
}

// Test modes

TEST_F(BxCanTest, InSilentModeItReceivesButNeitherAcknowledgesNorSends) {
  TestPartner third(bus);
  start(0, can1::megabit | can1::silm);
  partner_sends(0x100);
  request(0, 0x001);
  run_for(1'000'000);
  EXPECT_EQ(read(can1::rf0r), 1U);
  EXPECT_EQ(partner.sent.size(), 1U);
  EXPECT_TRUE(partner.received_frames.empty());
  EXPECT_FALSE(is_empty(0));
  third.controller.switch_off();
  partner_sends(0x100);
  run_for(1'000'000);
  EXPECT_EQ(partner.sent.size(), 1U);
}

TEST_F(BxCanTest, InLoopBackModeItReceivesItsOwnFramesOnly) {
  start(0, can1::megabit | can1::lbkm);
  partner.controller.switch_off();
  request(0, 0x100);
  run_for(1'000'000);
  EXPECT_EQ(outcome(0), rqcp | txok) << "acknowledgement is not needed";
  EXPECT_EQ(read(can1::rf0r), 1U);
  partner.controller.switch_on();
  request(1, 0x200);
  run_for(1'000'000);
  EXPECT_EQ(partner.identifiers(), std::vector<std::uint16_t>{0x200}) << "its frames can be seen on the bus";
  EXPECT_EQ(read(can1::rf0r), 2U);
  TestPartner third(bus);
  partner_sends(0x300);
  run_for(1'000'000);
  EXPECT_EQ(third.received_frames.size(), 1U);
  EXPECT_EQ(read(can1::rf0r), 2U);
}

TEST_F(BxCanTest, TheSelfTestDoesWithoutTheBus) {
  start(0, can1::megabit | can1::lbkm | can1::silm);
  TestPartner third(bus);
  const BusTime begin = bus.now();
  request(1, 0x200, 8, 0x0403'0201, 0x0807'0605);
  request(0, 0x100);
  partner_sends(0x300);
  const BusTime first = frame_bits({0x200, 8, {1, 2, 3, 4, 5, 6, 7, 8}}) * bit_time;
  run_until(begin + first - 125);
  EXPECT_EQ(outcome(1), 0U);
  run_until(begin + first);
  EXPECT_EQ(outcome(1), rqcp | txok);
  run_until(begin + first + 3 * bit_time + duration(0x100));
  EXPECT_EQ(outcome(0), rqcp | txok);
  run_for(1'000'000);
  EXPECT_EQ(read(can1::rf0r), 2U);
  EXPECT_EQ(read(can1::ri0r) >> 21U, 0x200U);
  EXPECT_EQ(read(can1::ri0r + 12), 0x0807'0605U);
  EXPECT_TRUE(partner.received_frames.empty());
  EXPECT_EQ(third.received_frames.size(), 1U);
}

// What is not modelled

TEST_F(BxCanTest, WhatTheProtocolDoesNotUseIsRejectedWithRegisterAndValue) {
  start();
  expect_rejected(can1::ti0r, 0x8000'0005, {"CAN1_TI0R = 0x80000005", "extended identifiers are not modelled"});
  expect_rejected(can1::ti0r + 0x20, 0x8000'0003, {"CAN1_TI2R = 0x80000003", "remote frames are not modelled"});
  expect_rejected(can1::ti0r + 0x14, 0x108, {"CAN1_TDT1R = 0x108", "time triggered"});
  expect_rejected(can1::ti0r + 0x14, 9, {"CAN1_TDT1R = 0x9", "length"});
  expect_rejected(can1::mcr, 0x80, {"CAN1_MCR = 0x80", "time triggered"});
  expect_rejected(can1::mcr, 0x100, {"CAN1_MCR = 0x100", "reserved"});
  expect_rejected(can1::ier, 0x80, {"CAN1_IER = 0x80", "reserved"});
  expect_rejected(can1::btr, can1::megabit, {"CAN1_BTR", "initialisation mode"});
  expect_rejected(can1::ri0r, 0, {"CAN1_RI0R", "write-protected"});
  expect_rejected(can1::fmr, 0x2A1C'0000U | 29U << 8U, {"CAN1_FMR", "CAN2SB"});
  expect_rejected(can1::fmr, 28U << 8U | 1U, {"CAN1_FMR", "reserved bits must keep"});
  expect_rejected(can1::fa1r, 1U << 28U, {"CAN1_FA1R", "28 filter banks"});
  expect_rejected(0x20, 0, {"CAN1 at offset 0x20"});
  expect_rejected(0x320, 0, {"CAN1 at offset 0x320"});
  EXPECT_THROW(static_cast<void>(read(0x20)), UnmodelledAccess);
  EXPECT_THROW(static_cast<void>(read(0x208)), UnmodelledAccess);
  request(0, 0x100);
  expect_rejected(can1::ti0r, 0x2000'0001, {"CAN1_TI0R", "write-protected", "TME0"});
  expect_rejected(can1::ti0r + 8, 0, {"CAN1_TDL0R", "write-protected"});
  enter_initialisation();
  expect_rejected(can1::btr, can1::megabit | 0x400U, {"CAN1_BTR", "reserved"});
}

}  // namespace
}  // namespace proleg::sim
