#include "sim/authoring/world_clipboard.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "replaced.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "tests/support/message_of.hpp"
#include "world_files.hpp"

namespace proleg::sim {
namespace {

const Eigen::Vector3d step(0.5, 0, 0);

void paste(Draft& draft, const std::string& text) {
  const WorldContents world = read_world_contents(draft);
  draft.change("paste", {}, [&](DraftChange& edit) { paste_objects(world, edit, text, step); });
}

class WorldClipboardTest : public testing::Test {
 protected:
  [[nodiscard]] WorldContents world() const { return read_world_contents(draft_); }
  [[nodiscard]] std::size_t find(const std::string& name) const {
    const WorldContents now = world();
    return static_cast<std::size_t>(std::ranges::find(now.objects, name, &WorldObject::name) - now.objects.begin());
  }
  [[nodiscard]] std::string refusal(const std::string& text) {
    const std::string before = draft_.text("environment.xml");
    std::string message = message_of<InputError>([&] { paste(draft_, text); });
    EXPECT_EQ(draft_.text("environment.xml"), before) << "what is refused changes nothing";
    EXPECT_EQ(message.find('\n'), std::string::npos);
    return message;
  }

  MemoryFiles files_ = world_files();
  Draft draft_{files_.scenario(), files_};
};

TEST_F(WorldClipboardTest, ObjectsArePastedBesideThoseThatStandThere) {
  const std::string text = copied_objects(draft_, {find("ball")});
  paste(draft_, text);
  paste(draft_, text);
  const WorldContents now = world();
  std::vector<double> places;
  for (const WorldObject& object : now.objects) {
    if (object.name == "ball") {
      EXPECT_TRUE(object.moves);
      places.push_back(object.pose.position.x());
    }
  }
  EXPECT_EQ(places, (std::vector<double>{1.0, 1.5, 2.0}));
  EXPECT_TRUE(draft_.undo() && draft_.undo());
  EXPECT_EQ(draft_.text("environment.xml"), world_text);
}

TEST_F(WorldClipboardTest, TheStepsOfStairsBelongTogether) {
  const std::string text = copied_objects(draft_, {find("low")});
  EXPECT_EQ(text, copied_objects(draft_, {find("high"), find("low")}));
  const Eigen::Vector3d high = world().objects[find("high")].pose.position;
  paste(draft_, text);
  const WorldContents now = world();
  const auto last = std::ranges::find(now.objects.rbegin(), now.objects.rend(), "high", &WorldObject::name);
  EXPECT_LT((last->pose.position - high - step).norm(), 1e-5) << last->pose.position.transpose();
  EXPECT_EQ(last->group_size, 2U);
  EXPECT_EQ(last->shapes.size(), 2U);
}

TEST_F(WorldClipboardTest, InAnotherWorldTheyStandWhereTheyStood) {
  const std::string text = copied_objects(draft_, {find("ball"), find("low")});
  MemoryFiles other_files = small_scenario();
  Draft other(other_files.scenario(), other_files);
  paste(other, text);
  const WorldContents now = read_world_contents(other);
  const auto ball = std::ranges::find(now.objects, "ball", &WorldObject::name);
  ASSERT_NE(ball, now.objects.end());
  EXPECT_EQ(ball->pose.position, Eigen::Vector3d(1, 1, 0.05));
  EXPECT_NE(std::ranges::find(now.objects, "high", &WorldObject::name), now.objects.end());
}

TEST_F(WorldClipboardTest, AnObjectOfAFileOfItsOwnIsNotCopied) {
  EXPECT_NE(message_of<InputError>([&] { static_cast<void>(copied_objects(draft_, {find("pole")})); }).find("pole.xml"),
            std::string::npos);
  EXPECT_NE(message_of<InputError>([&] { static_cast<void>(copied_objects(draft_, {99})); }).find("found 99"),
            std::string::npos);
  EXPECT_NE(message_of<InputError>([&] { static_cast<void>(copied_objects(draft_, {})); }).find("at least one"),
            std::string::npos);
}

// A clipboard can have any text. Whatever it names, no file is read for it.
TEST_F(WorldClipboardTest, ATextThatIsNoObjectOfAWorldGetsOneLine) {
  files_.texts["secret.xml"] = "<KinBody name=\"secret\"/>";
  files_.texts["../secret.stl"] = "solid";
  const std::string box =
      R"(<KinBody name="box"><Body type="static"><Geom type="box"><extents>1 1 1</extents></Geom></Body></KinBody>)";
  const auto mesh = [](const std::string& tag) {
    return R"(<KinBody name="m"><Body type="static"><Geom type="trimesh">)" + tag + "</Geom></Body></KinBody>";
  };
  struct Row {
    std::string text;
    const char* reason;
  };
  for (const Row& row :
       std::vector<Row>{{"", "no text"},
                        {"hello\nworld", "found 'hello"},
                        {R"(<KinBody file="secret.xml"/>)", "names the file 'secret.xml'"},
                        {R"(<KinBody FILE='/etc/passwd'/>)", "names the file '/etc/passwd'"},
                        {R"(<KinBody name="a"><KinBody file="../x.xml"/></KinBody>)", "names the file '../x.xml'"},
                        {mesh("<data>../secret.stl</data>"), "<data> with '../secret.stl'"},
                        {mesh("<DATA>&#x2f;etc/passwd</DATA>"), "a mesh that this scenario has already"},
                        {mesh("<collision>http://a/b.stl</collision>"), "a mesh that this scenario has already"},
                        {mesh("<render>secret.stl</render>"), "a mesh that this scenario has already"},
                        {"<!DOCTYPE a [<!ENTITY b SYSTEM 'file:///etc/passwd'>]><KinBody/>", "found a text with '<!'"},
                        {"<KinBody/><!--Pose: ,0 0 9,0 0 0,-->", "found a text with '<!'"},
                        {"<![CDATA[<KinBody/>]]>", "found a text with '<!'"},
                        {"<KinBody/><?xml-stylesheet href='a'?>", "found a text with '<?'"},
                        {"<Environment><KinBody/></Environment>", "found <Environment>"},
                        {"<ruler><from>0 0 0</from><to>0 1 0</to></ruler>", "<ruler>"},
                        {"</objects><KinBody/><objects>", "one outermost tag"},
                        {"<KinBody/></objects><objects>", "objects"},
                        {"<KinBody>", "KinBody"},
                        {"<KinBody><Body></KinBody></Body>", "Body"},
                        {replaced(box, "1 1 1", "-1 1 1"), "-1"},
                        {replaced(box, "<Geom", "<Translation>1e9 0 0</Translation><Geom"), "1e9"},
                        {R"(<KinBody><Joint name="a"/></KinBody>)", "<Joint>"},
                        {std::string(max_copied_bytes, ' ') + "<KinBody/>", "more than 48 KiB of text"}}) {
    const std::string message = refusal(row.text);
    EXPECT_NE(message.find(row.reason), std::string::npos) << row.text.substr(0, 80) << ": " << message;
  }
  std::string deep;
  for (int i = 0; i < 2000; ++i) {
    deep += "<KinBody>";
  }
  EXPECT_NE(refusal(deep), "");
  paste(draft_, box);  // what is well formed is taken, wherever it comes from
}

TEST_F(WorldClipboardTest, AMeshIsPastedWhereTheWorldHasItsFile) {
  files_.texts["stone.stl"] =
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid";
  files_.replace(
      "environment.xml", "</Environment>",
      R"(<KinBody name="stone"><!-- grey --><Body type="static"><Geom type="trimesh" open="1"><data>stone.stl</data></Geom></Body></KinBody>
</Environment>)");
  Draft draft(files_.scenario(), files_);
  const WorldContents now = read_world_contents(draft);
  const auto stone = std::ranges::find(now.objects, "stone", &WorldObject::name);
  ASSERT_NE(stone, now.objects.end());
  const std::string text = copied_objects(draft, {static_cast<std::size_t>(stone - now.objects.begin())});
  EXPECT_EQ(text.find("grey"), std::string::npos) << "without comments";
  paste(draft, text);
  EXPECT_EQ(read_world_contents(draft).objects.size(), now.objects.size() + 1);
  const std::size_t at = static_cast<std::size_t>(stone - now.objects.begin());
  change_world(draft, [&](WorldChange& change) { change.remove({at, at + 1}, true); });
  paste(draft, replaced(text, "stone.stl", "stone.stl 0.5"));  // cut and paste; with another factor, too
  EXPECT_EQ(read_world_contents(draft).objects.size(), now.objects.size());
  EXPECT_NE(refusal(text).find("a mesh that this scenario has already"), std::string::npos) << "another world";
}

TEST_F(WorldClipboardTest, SelectionsThatAreTooLongAreNotCopied) {
  const std::size_t ball = find("ball");
  change_world(draft_, [&](WorldChange& change) { change.duplicate({ball}, true, {0, 0.5, 0}, 190); });
  change_world(draft_, [&](WorldChange& change) { change.duplicate({find("low")}, true, {0, 0.5, 0}, 199); });
  std::vector<std::size_t> all;
  const WorldContents now = world();
  for (std::size_t i = 0; i < now.objects.size(); ++i) {
    if (now.objects[i].body) {
      all.push_back(i);
    }
  }
  EXPECT_NE(message_of<InputError>([&] { static_cast<void>(copied_objects(draft_, all)); }).find("48 KiB"),
            std::string::npos);
}

}  // namespace
}  // namespace proleg::sim
