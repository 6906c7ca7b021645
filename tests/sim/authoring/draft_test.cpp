#include "sim/authoring/draft.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"
#include "tests/support/from_environment.hpp"
#include "tests/support/message_of.hpp"
#include "world_files.hpp"

namespace proleg::sim {
namespace {

class DraftTest : public testing::Test {
 protected:
  void move_ball(double x, std::optional<std::uint64_t> gesture = {}) {
    change_world(
        draft_,
        [&](WorldChange& change) {
          change.place(3, {{x, 1, 0.05}, Eigen::Quaterniond::Identity()}, false);
        },
        gesture);
  }
  [[nodiscard]] std::string text() const { return text_of(draft_, "environment.xml"); }

  MemoryFiles files_ = world_files();
  Draft draft_{files_.scenario(), files_};
};

TEST_F(DraftTest, AFileThatNobodyChangesKeepsItsBytes) {
  EXPECT_TRUE(draft_.changed_files().empty());
  move_ball(2);
  const std::vector<Draft::ChangedFile> changed = draft_.changed_files();
  ASSERT_EQ(changed.size(), 1U);
  EXPECT_EQ(changed[0].name, "environment.xml");
  EXPECT_EQ(changed[0].saved, SharedText(world_text));
  EXPECT_EQ(changed[0].text, text());
  draft_.mark_saved();
  EXPECT_TRUE(draft_.changed_files().empty());
  ASSERT_TRUE(draft_.undo());
  EXPECT_EQ(draft_.changed_files().size(), 1U) << "undo goes back behind what was saved";
}

TEST_F(DraftTest, TheReaderJudgesEachChange) {
  move_ball(2);
  const std::uint64_t revision = draft_.revision();
  const std::string message = message_of<InputError>([&] { move_ball(1e9); });
  EXPECT_NE(message.find("environment.xml:"), std::string::npos) << message;
  EXPECT_EQ(draft_.revision(), revision);
  EXPECT_DOUBLE_EQ(draft_.scenario().environment.moving_objects.at(0).pose.position.x(), 2.0);
  EXPECT_EQ(draft_.undo_label(), "test");
}

TEST_F(DraftTest, AnErrorInTheMiddleOfAChangeLeavesNothingBehind) {
  const std::string before = text();
  EXPECT_THROW(change_world(draft_,
                            [](WorldChange& change) {
                              change.set_friction(3, 0.5);
                              change.set_size(3, 0, {-1.0});
                            }),
               InputError);
  EXPECT_EQ(text(), before);
  EXPECT_FALSE(draft_.undo_label());
}

TEST_F(DraftTest, TheStepsOfADragAreOneEntry) {
  move_ball(2, 7);
  move_ball(3, 7);
  move_ball(4, 7);
  move_ball(5, 8);
  ASSERT_TRUE(draft_.undo());
  EXPECT_DOUBLE_EQ(draft_.scenario().environment.moving_objects[0].pose.position.x(), 4.0);
  ASSERT_TRUE(draft_.undo());
  EXPECT_EQ(text(), world_text);
  EXPECT_FALSE(draft_.undo());
  ASSERT_TRUE(draft_.redo());
  EXPECT_DOUBLE_EQ(draft_.scenario().environment.moving_objects[0].pose.position.x(), 4.0);
}

TEST_F(DraftTest, AGestureEndsWithUndo) {
  move_ball(2, 7);
  ASSERT_TRUE(draft_.undo());
  ASSERT_TRUE(draft_.redo());
  move_ball(3, 7);
  ASSERT_TRUE(draft_.undo());
  EXPECT_DOUBLE_EQ(draft_.scenario().environment.moving_objects[0].pose.position.x(), 2.0);
}

TEST_F(DraftTest, ANewChangeEndsWhatCouldBeDoneAgain) {
  move_ball(2);
  ASSERT_TRUE(draft_.undo());
  EXPECT_TRUE(draft_.redo_label());
  move_ball(3);
  EXPECT_FALSE(draft_.redo_label());
  EXPECT_FALSE(draft_.redo());
}

TEST_F(DraftTest, ANewFileComesAndGoesWithItsChange) {
  draft_.change("add sphere.xml", {}, [](DraftChange& change) {
    change.add_file("sphere.xml",
                    "<KinBody><Body type='static'><Geom type='sphere'><radius>0.1</radius></Geom></Body></KinBody>");
    change.apply("environment.xml",
                 change.xml("environment.xml").add_last(0, "<KinBody file=\"sphere.xml\" name=\"s\"/>"));
  });
  EXPECT_EQ(draft_.scenario().environment.objects.size(), 5U);
  EXPECT_EQ(draft_.changed_files().size(), 2U);
  ASSERT_TRUE(draft_.undo());
  EXPECT_TRUE(draft_.changed_files().empty());
  EXPECT_EQ(draft_.scenario().environment.objects.size(), 4U);
  EXPECT_NE(message_of<InputError>([&] {
              draft_.change("", {}, [](DraftChange& change) { change.add_file("robot.xml", ""); });
            }).find("a file that exists"),
            std::string::npos);
}

// Files of 5 MiB, until the memory that a draft may have is full.
TEST_F(DraftTest, FilesMayNotFillTheMemory) {
  const auto add = [this](int number) {
    const std::string name = "large" + std::to_string(number) + ".xml";
    draft_.change("add a large file", {}, [&](DraftChange& change) {
      change.add_file(name,
                      "<KinBody><!--" + std::string(std::size_t{5} << 20U, 'x') +
                          "--><Body type='static'><Geom type='sphere'><radius>0.1</radius></Geom></Body></KinBody>");
      change.apply(
          "environment.xml",
          change.xml("environment.xml").add_last(0, "<KinBody file=\"" + name + "\" name=\"s" + name + "\"/>"));
    });
  };
  for (int number = 0; number < 4; ++number) {
    add(number);
  }
  const std::size_t objects = draft_.scenario().environment.objects.size();
  EXPECT_NE(message_of<InputError>([&] { add(4); }).find("at most 24 MiB"), std::string::npos);
  EXPECT_EQ(draft_.scenario().environment.objects.size(), objects);
  move_ball(2);
}

TEST_F(DraftTest, AFileThatAChangeNamesBelongsToTheDraftFromThenOn) {
  files_.texts["late.xml"] =
      "<KinBody><Body type='static'><Geom type='sphere'><radius>0.1</radius></Geom></Body></KinBody>";
  draft_.change("name late.xml", {}, [](DraftChange& change) {
    change.apply("environment.xml",
                 change.xml("environment.xml").add_last(0, "<KinBody file=\"late.xml\" name=\"s\"/>"));
  });
  files_.texts.erase("late.xml");
  move_ball(2);
  EXPECT_EQ(draft_.scenario().environment.objects.size(), 5U);
}

TEST_F(DraftTest, WhatOthersWriteIntoUnchangedFilesIsTakenOver) {
  EXPECT_FALSE(draft_.refresh());
  files_.replace("actuation.xml", "value=\"30\"", "value=\"25\"");
  EXPECT_TRUE(draft_.refresh());
  EXPECT_NE(draft_.text("actuation.xml").find("value=\"25\""), std::string::npos);
  EXPECT_TRUE(draft_.changed_files().empty());
  move_ball(2);
  files_.replace("environment.xml", "This comment stays.", "By hand.");
  EXPECT_FALSE(draft_.refresh()) << "the draft has changed it";
  ASSERT_TRUE(draft_.undo());
  EXPECT_FALSE(draft_.refresh()) << "redo would change it";
  files_.replace("actuation.xml", "<actuation>", "<actuation><oops/>");
  EXPECT_FALSE(draft_.refresh()) << "the reader refuses it";
  move_ball(3);
}

TEST_F(DraftTest, FilesThatAreSavedElsewhereKeepTheirHistory) {
  move_ball(2);
  std::map<std::string, std::string> renamed;
  for (const SourceFile& source : draft_.scenario().sources) {
    renamed[source.path] = "copy/" + source.path;
  }
  draft_.rename_files(renamed, "copy/top.xml", files_);
  EXPECT_TRUE(draft_.changed_files().empty());
  EXPECT_EQ(draft_.scenario().environment_file, "copy/environment.xml");
  ASSERT_TRUE(draft_.undo());
  EXPECT_EQ(text_of(draft_, "copy/environment.xml"), world_text);
}

// Seeded random changes of all kinds; at each state the texts are remembered, and undo and redo must come back to them.
// The slow suite has six times as many (PROLEG_ROUNDS).
TEST_F(DraftTest, UndoAndRedoReturnToEveryEarlierState) {
  constexpr unsigned seed = 48;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const auto below = [&](std::size_t bound) {
    return std::uniform_int_distribution<std::size_t>(0, bound - 1)(random);
  };
  const auto number = [&] { return std::uniform_real_distribution<double>(-3.0, 3.0)(random); };
  std::vector<std::string> states{text()};
  std::size_t at = 0;
  std::size_t refused = 0;
  const std::uint32_t operations = 100 * from_environment("PROLEG_ROUNDS", 1);
  for (std::uint32_t i = 0; i < operations; ++i) {
    SCOPED_TRACE("operation " + std::to_string(i));
    constexpr std::size_t most_objects = 30;
    const std::size_t kind = read_world_contents(draft_).objects.size() > most_objects ? 7 : below(16);
    if (kind < 3) {
      EXPECT_EQ(draft_.undo(), at > 0);
      at -= at > 0 ? 1 : 0;
    } else if (kind < 5) {
      EXPECT_EQ(draft_.redo(), at + 1 < states.size());
      at += at + 1 < states.size() ? 1 : 0;
    } else {
      const std::size_t object = below(read_world_contents(draft_).objects.size());
      const Eigen::Vector3d place(number(), number(), number());
      const std::string before = text();
      try {
        change_world(draft_, [&](WorldChange& change) {
          switch (kind) {
            case 5:
              change.set_friction(object, below(2) == 0 ? std::nullopt : std::optional(std::abs(number())));
              break;
            case 6:
              change.set_moves(object, below(2) == 0);
              break;
            case 7:
              change.remove({object}, below(2) == 0);
              break;
            case 8:
              change.duplicate({object}, below(2) == 0, place, static_cast<unsigned>(1 + below(3)));
              break;
            case 9:
              change.add(static_cast<LibraryItem>(below(library().size())), {}, place, 10.0 * number());
              break;
            case 10:
              change.set_start(place, place * 30.0);
              break;
            case 11:
              change.add_ruler(place, place * 2.0);
              break;
            case 12:
              change.rename(object, "name " + std::to_string(i));
              break;
            case 13:
              change.set_colour(object, place);
              break;
            default:
              change.place(object, {place, Eigen::Quaterniond::UnitRandom()}, below(2) == 0);
          }
        });
      } catch (const InputError&) {
        ++refused;
        EXPECT_EQ(text(), before);
        continue;
      }
      if (text() != before) {
        states.resize(at + 1);
        states.push_back(text());
        ++at;
      }
    }
    ASSERT_EQ(text(), states[at]);
  }
  EXPECT_GT(states.size(), operations / 10);
  EXPECT_LT(refused, operations / 2);
  while (draft_.undo()) {
    ASSERT_EQ(text(), states[--at]);
  }
  EXPECT_EQ(text(), world_text);
}

TEST(DraftOfShippedFiles, OpensAndKeepsEveryByte) {
  std::size_t count = 0;
  DiskFiles disk;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(source_path("/sim/scenarios"))) {
    if (!entry.path().string().ends_with(".simulation.xml")) {
      continue;
    }
    SCOPED_TRACE(entry.path().string());
    ++count;
    Draft draft(read_scenario(entry.path(), disk), disk);
    const WorldContents world = read_world_contents(draft);
    EXPECT_FALSE(world.objects.empty());
    // A change and its undo, of the start and of the first object.
    draft.change("test", {}, [&](DraftChange& change) {
      WorldChange world_change(world, change);
      world_change.set_start(world.start + Eigen::Vector3d(0.125, 0, 0), world.start_degrees);
    });
    EXPECT_EQ(draft.changed_files().size(), 1U);
    EXPECT_NEAR(read_world_contents(draft).start.x(), world.start.x() + 0.125, 1e-6);
    ASSERT_TRUE(draft.undo());
    EXPECT_TRUE(draft.changed_files().empty());
    for (const SourceFile& source : draft.scenario().sources) {
      EXPECT_EQ(source.text, file_contents(source.path)) << source.path;
    }
  }
  EXPECT_GT(count, 25U);
}

}  // namespace
}  // namespace proleg::sim
