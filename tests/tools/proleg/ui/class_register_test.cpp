#include "tools/proleg/ui/class_register.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "tests/support/files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr WrongCodes::Time first_moment{};
constexpr const char* desk = "192.0.2.1";

class ClassRegisterTest : public ::testing::Test {
 protected:
  Learner join(const std::string& name, const std::string& key = {}) {
    return class_->join({name, key.empty() ? class_->code() : "", key}, desk, first_moment);
  }
  /// The status of the refusal; 200: none.
  unsigned status(const JoinWish& wish, const char* computer = desk, WrongCodes::Time now = first_moment) {
    try {
      static_cast<void>(class_->join(wish, computer, now));
      return 200;
    } catch (const JoinRefusal& refusal) {
      return refusal.status();
    }
  }
  void open_again() {
    class_.reset();
    class_.emplace(folder_.path());
  }

  TemporaryFolder folder_;
  std::optional<ClassRegister> class_{std::in_place, folder_.path()};
};

unsigned parse_status(const std::string& body) {
  try {
    static_cast<void>(JoinWish::parse(body));
    return 200;
  } catch (const JoinRefusal& refusal) {
    EXPECT_EQ(std::string(refusal.what()).find('\n'), std::string::npos);
    EXPECT_LT(std::string(refusal.what()).size(), 300U);
    return refusal.status();
  }
}

std::string wish_text(const std::string& name) { return nlohmann::json{{"name", name}, {"code", "1"}}.dump(); }

TEST(JoinWishTest, NamesAreWhatAPersonSees) {
  EXPECT_EQ(JoinWish::parse(wish_text("  Anna \t Lena ")).name, "Anna Lena");
  EXPECT_EQ(JoinWish::parse(wish_text("<script>alert(1)</script>")).name, "<script>alert(1)</script>");
  EXPECT_EQ(parse_status(wish_text(std::string(40, 'x'))), 200U);
  EXPECT_EQ(parse_status(wish_text("\u00c4\u00d6\u00dc\u00df\U0001F41B")), 200U);
  for (const std::string& name : {std::string(), std::string(" \n"), std::string(41, 'x'), std::string(10'000, 'x'),
                                  std::string("a\u0001b"), std::string("a\u200bb"), std::string("a\u202eb")}) {
    EXPECT_EQ(parse_status(wish_text(name)), 400U) << name.substr(0, 50);
  }
}

TEST(JoinWishTest, OtherBodiesAreRefused) {
  for (const char* body : {"", "{", "[]", "7", "\"Anna\"", "{}", R"({"name": 7})", R"({"name": ["Anna"]})",
                           R"({"name": "Anna", "code": 123456})", R"({"name": "Anna", "key": {}})", "\xff"}) {
    EXPECT_EQ(parse_status(body), 400U) << body;
  }
  EXPECT_EQ(parse_status(std::string(100'000, '[')), 400U);
}

TEST_F(ClassRegisterTest, ALearnerGetsASeatAndAFolder) {
  const Learner anna = join("Anna");
  EXPECT_EQ(anna.seat, 1U);
  EXPECT_TRUE(fs::is_directory(folder_ / anna.folder));
  EXPECT_EQ(join("Bob").seat, 2U);
  EXPECT_EQ(class_->find(ClassRegister::teacher)->name, "Teacher");
}

TEST_F(ClassRegisterTest, ANameBelongsToWhoHasItsKey) {
  const Learner anna = join("Anna");
  EXPECT_EQ(join("anna", anna.key).seat, anna.seat);
  EXPECT_EQ(status({"ANNA", class_->code(), ""}), 409U);
  EXPECT_EQ(status({"Anna", class_->code(), "wrong"}), 409U);
  EXPECT_EQ(status({"Bob", "", anna.key}), 403U);
  EXPECT_EQ(status({"Teacher", class_->code(), ""}), 409U);
  EXPECT_EQ(status({"Teacher", "", class_->find(ClassRegister::teacher)->key}), 403U);
}

TEST_F(ClassRegisterTest, ABrowserThatMadeItsKeyCanAskAgainWhenTheAnswerWasLost) {
  const std::string key = host::AccessToken::make().text();
  const Learner first = class_->join({"Anna", class_->code(), key}, desk, first_moment);
  EXPECT_EQ(first.key, key);
  EXPECT_EQ(class_->join({"Anna", class_->code(), key}, desk, first_moment).seat, first.seat);
  EXPECT_NE(class_->join({"Bob", class_->code(), "123"}, desk, first_moment).key, "123") << "that is no key";
}

TEST_F(ClassRegisterTest, WhereThereIsNoRoomNothingChanges) {
  const auto no_room = [](const Learner*) { throw JoinRefusal(503, "full"); };
  EXPECT_THROW(class_->join({"Anna", class_->code(), ""}, desk, first_moment, no_room), JoinRefusal);
  const Learner anna = join("Anna");
  EXPECT_EQ(anna.seat, 1U);
  EXPECT_EQ(anna.folder, "Anna");
  class_->let_in(anna.seat);
  EXPECT_THROW(class_->join({"Anna", class_->code(), ""}, desk, first_moment, no_room), JoinRefusal);
  EXPECT_EQ(join("Anna").seat, anna.seat) << "still let in";
}

TEST_F(ClassRegisterTest, ACodeCannotBeGuessed) {
  for (std::size_t i = 0; i < WrongCodes::most_of_computer; ++i) {
    EXPECT_EQ(status({"Bob", "000", ""}), 403U);
  }
  EXPECT_EQ(status({"Bob", class_->code(), ""}), 429U);
  EXPECT_EQ(status({"Carl", class_->code(), ""}, "192.0.2.2"), 200U) << "others are not affected";
  EXPECT_EQ(status({"Bob", class_->code(), ""}, desk, first_moment + WrongCodes::period), 200U);
}

TEST_F(ClassRegisterTest, WrongCodesOfManyComputersLockOutNoOther) {
  for (std::size_t i = 0; i < WrongCodes::most_of_all; ++i) {
    const std::string computer = "198.51.100." + std::to_string(i);
    EXPECT_EQ(status({"Eve", "000", ""}, computer.c_str()), 403U);
  }
  EXPECT_EQ(status({"Eve", class_->code(), ""}, "198.51.100.7"), 429U) << "it guesses, too";
  EXPECT_EQ(status({"Anna", class_->code(), ""}), 200U);
  EXPECT_EQ(status({"Bob", "000", ""}, "192.0.2.9"), 403U);
  EXPECT_EQ(status({"Bob", class_->code(), ""}, "192.0.2.9"), 429U);
}

TEST_F(ClassRegisterTest, OneAddressHasSoManyNewNames) {
  class_.reset();
  class_.emplace(folder_.path(), 3);
  EXPECT_EQ(status({"A", class_->code(), ""}), 200U);
  EXPECT_EQ(status({"B", class_->code(), ""}), 200U);
  const Learner third = join("C");
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(status({"D", class_->code(), ""}), 503U);
  }
  try {
    join("D");
    ADD_FAILURE();
  } catch (const JoinRefusal& refusal) {
    EXPECT_EQ(std::string(refusal.what()).find("found 3 names from the address of this computer, expected at most 3"),
              0U)
        << refusal.what();
  }
  EXPECT_EQ(class_->find("D"), nullptr);
  EXPECT_EQ(status({"C", "", third.key}), 200U) << "who is in may come back";
  EXPECT_EQ(status({"D", class_->code(), ""}, "192.0.2.2"), 200U) << "others are not affected";
  class_->remove(third.seat);
  EXPECT_EQ(status({"E", class_->code(), ""}), 200U);
  for (const std::string name : {"F", "G", "H", "I", "J"}) {
    EXPECT_EQ(status({name, class_->code(), ""}, "127.0.0.1"), 200U) << "a proxy here gives all its address";
  }
}

TEST_F(ClassRegisterTest, NobodyNewJoinsALockedClass) {
  const Learner anna = join("Anna");
  class_->lock(true);
  EXPECT_EQ(status({"Bob", class_->code(), ""}), 409U);
  EXPECT_EQ(join("Anna", anna.key).seat, anna.seat);
  open_again();
  EXPECT_EQ(status({"Bob", class_->code(), ""}), 409U) << "also after a restart";
  class_->lock(false);
  EXPECT_EQ(status({"Bob", class_->code(), ""}), 200U);
}

TEST_F(ClassRegisterTest, AnotherBrowserIsLetInOnceAndTheFirstHasLostTheName) {
  const Learner before = join("Anna");
  class_->let_in(before.seat);
  EXPECT_EQ(status({"Anna", "", before.key}), 403U);
  EXPECT_NE(class_->find(before.seat)->token.text(), before.token.text());
  const Learner after = join("Anna");
  EXPECT_EQ(after.seat, before.seat);
  EXPECT_EQ(after.folder, before.folder);
  EXPECT_EQ(status({"Anna", class_->code(), ""}), 409U);
  EXPECT_EQ(join("Anna", after.key).seat, before.seat);
}

TEST_F(ClassRegisterTest, TheFilesOfOneWhoWasRemovedStay) {
  const Learner first = join("Anna");
  std::ofstream(folder_ / first.folder / "run.proleg") << "x";
  class_->remove(first.seat);
  const Learner second = join("Anna");
  EXPECT_EQ(second.seat, first.seat);
  EXPECT_NE(second.folder, first.folder);
  EXPECT_NE(second.token.text(), first.token.text());
  EXPECT_TRUE(fs::exists(folder_ / first.folder / "run.proleg"));
  EXPECT_THROW(class_->remove(ClassRegister::teacher), InputError);
  EXPECT_THROW(class_->let_in(77), InputError);
}

TEST_F(ClassRegisterTest, FoldersStayBelowThatOfTheClass) {
  for (const char* name : {"..", ".", "../x", "/etc", "a/b", ".hidden", "class.json"}) {
    const Learner learner = join(name);
    const fs::path folder = fs::canonical(folder_ / learner.folder);
    EXPECT_EQ(folder.parent_path(), fs::canonical(folder_.path())) << name;
    EXPECT_TRUE(fs::is_directory(folder)) << name;
  }
}

TEST_F(ClassRegisterTest, AClassGoesOnAfterARestart) {
  const Learner anna = join("Anna");
  const std::string code = class_->code();
  open_again();
  EXPECT_EQ(class_->code(), code);
  EXPECT_EQ(join("Anna", anna.key).token.text(), anna.token.text());
}

TEST_F(ClassRegisterTest, OnlyItsOwnerMayReadTheFile) {
  struct stat status {};
  ASSERT_EQ(::stat((folder_ / "class.json").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
}

TEST_F(ClassRegisterTest, TwoProgramsDoNotHaveOneClass) { EXPECT_THROW(ClassRegister(folder_.path()), InputError); }

TEST_F(ClassRegisterTest, AnotherFileIsRefusedAndStays) {
  const std::string good = file_contents(folder_ / "class.json");
  class_.reset();
  nlohmann::json outside = nlohmann::json::parse(good);
  outside["learners"][0]["folder"] = "../elsewhere";
  nlohmann::json newer = nlohmann::json::parse(good);
  newer["version"] = 2;
  for (const std::string& text : {std::string(), std::string("{"), std::string("[]"), std::string("{}"), outside.dump(),
                                  newer.dump(), good.substr(0, good.size() / 2)}) {
    std::ofstream(folder_ / "class.json", std::ios::trunc) << text;
    EXPECT_THROW(ClassRegister(folder_.path()), InputError) << text;
    EXPECT_EQ(file_contents(folder_ / "class.json"), text);
  }
}

}  // namespace
}  // namespace proleg::tools
