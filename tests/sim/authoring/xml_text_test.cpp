#include "sim/authoring/xml_text.hpp"

#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <filesystem>
#include <random>

#include "replaced.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::sim {
namespace {

constexpr const char* example = R"(<?xml version="1.0"?>
<!-- a <comment> that is no tag -->
<World name='first'>
  <Body  type = "static">  <!-- stays -->
    <size> 1 2 3 </size>
    <empty/>
  </Body>
	<Body/><Body A="&lt;x&gt; &#228;"></Body>
</World>
)";

std::string after(const TextPatch& patch, std::string text = example) {
  apply(patch, text);
  return text;
}

TEST(XmlText, ElementsHaveParentsAndChildren) {
  const XmlText xml("file.xml", example);
  ASSERT_EQ(xml.size(), 6U);
  EXPECT_FALSE(xml.at(0).parent);
  EXPECT_EQ(xml.children(0), (std::vector<ElementNumber>{1, 4, 5}));
  EXPECT_EQ(xml.children(0, "body"), (std::vector<ElementNumber>{1, 4, 5})) << "in any case";
  EXPECT_EQ(xml.child(1, "EMPTY"), ElementNumber{3});
  EXPECT_EQ(xml.child(1, "World"), std::nullopt);
  EXPECT_EQ(xml.bytes(2), "<size> 1 2 3 </size>");
}

TEST(XmlText, AttributesAreReadAsAParserReadsThem) {
  const XmlText xml("file.xml", example);
  EXPECT_EQ(xml.attribute(0, "NAME"), "first");
  EXPECT_EQ(xml.attribute(5, "a"), "<x> \xc3\xa4");
  EXPECT_EQ(xml.attribute(4, "a"), std::nullopt);
}

TEST(XmlText, AnEditChangesOnlyItsPlace) {
  const XmlText xml("file.xml", example);
  EXPECT_EQ(after(xml.set_attribute(0, "name", "it's <2>")), replaced(example, "first", "it&apos;s &lt;2&gt;"));
  EXPECT_EQ(after(xml.set_attribute(1, "name", "a \"b\"")),
            replaced(example, "\"static\">", "\"static\" name=\"a &quot;b&quot;\">"));
  EXPECT_EQ(after(xml.set_attribute(4, "name", "b")), replaced(example, "<Body/>", "<Body name=\"b\"/>"));
  EXPECT_EQ(after(xml.set_content(2, "4 & 5")), replaced(example, " 1 2 3 ", " 4 &amp; 5 "));
  EXPECT_EQ(after(xml.set_content(3, "7")), replaced(example, "<empty/>", "<empty>7</empty>"));
}

TEST(XmlText, NewElementsHaveTheIndentationOfTheirNeighbours) {
  const XmlText xml("file.xml", example);
  EXPECT_EQ(after(xml.add_behind(3, "<a>\n  <b/>\n</a>")),
            replaced(example, "<empty/>\n", "<empty/>\n    <a>\n      <b/>\n    </a>\n"));
  EXPECT_EQ(after(xml.add_first(1, "<a/>")), replaced(example, "\"static\">", "\"static\">\n    <a/>\n    "))
      << "a comment stands in the line of the tag";
  EXPECT_EQ(after(xml.add_last(1, "<a/>")), replaced(example, "<empty/>\n", "<empty/>\n    <a/>\n"));
  EXPECT_EQ(after(xml.add_behind(4, "<a/>")), replaced(example, "<Body/><", "<Body/><a/><"));
  EXPECT_EQ(after(xml.add_last(4, "<a/>")), replaced(example, "<Body/>", "<Body>\n\t  <a/>\n\t</Body>"));
}

TEST(XmlText, ARemovedElementTakesItsLinesAlong) {
  const XmlText xml("file.xml", example);
  EXPECT_EQ(after(xml.remove(3)), replaced(example, "    <empty/>\n", ""));
  EXPECT_EQ(after(xml.remove(4)), replaced(example, "<Body/>", "")) << "something else stands in the line";
}

TEST(XmlText, LineEndsOfAnotherSystemStay) {
  const std::string text = "<a>\r\n  <b/>\r\n</a>\r\n";
  const XmlText xml("file.xml", text);
  EXPECT_EQ(after(xml.add_behind(1, "<c>\n</c>"), text), "<a>\r\n  <b/>\r\n  <c>\r\n  </c>\r\n</a>\r\n");
  EXPECT_EQ(after(xml.remove(1), text), "<a>\r\n</a>\r\n");
}

TEST(XmlText, APatchCanBeTakenBack) {
  const XmlText xml("file.xml", example);
  for (const TextPatch& patch :
       {xml.remove(1), xml.add_last(0, "<x/>"), xml.set_content(2, "9"), xml.set_attribute(4, "name", "b")}) {
    EXPECT_EQ(after(inverse(patch), after(patch)), example);
  }
}

TEST(XmlText, CommentsAreFoundByTheirFirstWord) {
  const std::string text = "<a><![CDATA[<!--Pose: no-->]]></a>\n<!-- another -->\n<!--  POSE: ,1 2 3,-->\n";
  const XmlText xml("file.xml", text);
  const auto range = xml.comment_with("pose:");
  ASSERT_TRUE(range);
  EXPECT_EQ(text.substr(range->begin, range->end - range->begin), "<!--  POSE: ,1 2 3,-->");
  EXPECT_FALSE(xml.comment_with("start"));
}

TEST(XmlText, TextWithoutPairsOfTagsIsRefused) {
  const auto refusal = [](const std::string& text) {
    return message_of<InputError>([&] { const XmlText xml("file.xml", text); });
  };
  EXPECT_EQ(refusal("<a>\n<b>\n</a>"), "file.xml:2: found <b> without an end tag before </a> in line 3, expected </b>");
  EXPECT_EQ(refusal("</a>"), "file.xml:1: found </a> without a start tag, expected pairs of tags");
  EXPECT_EQ(refusal("nothing"), "file.xml:1: found no tag, expected XML");
}

/// The text of an element as tinyxml2 writes it, without blanks between tags.
std::string meaning(const std::string& text) {
  tinyxml2::XMLDocument document(true, tinyxml2::COLLAPSE_WHITESPACE);
  EXPECT_EQ(document.Parse(text.c_str()), tinyxml2::XML_SUCCESS) << text;
  tinyxml2::XMLPrinter printer(nullptr, true);
  document.Print(&printer);
  return printer.CStr();
}

// The oracle is another parser's tree: the same edit there gives the same document.
TEST(XmlText, AnyEditOfAShippedFileIsTheEditOfItsTree) {
  constexpr unsigned seed = 20261127;
  std::mt19937 random(seed);
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(source_path("/sim/scenarios"))) {
    if (entry.path().extension() != ".xml") {
      continue;
    }
    ++files;
    const std::string text = file_contents(entry.path());
    const XmlText xml(entry.path().string(), text);
    for (int i = 0; i < 6; ++i) {
      SCOPED_TRACE(entry.path().string() + " edit " + std::to_string(i));
      const ElementNumber element = std::uniform_int_distribution<std::size_t>(0, xml.size() - 1)(random);
      tinyxml2::XMLDocument tree;
      ASSERT_EQ(tree.Parse(text.c_str()), tinyxml2::XML_SUCCESS);
      // The element of the tree with this number, in the order of start tags.
      tinyxml2::XMLElement* node = tree.RootElement();
      for (ElementNumber at = 0; at < element; ++at) {
        if (node->FirstChildElement() != nullptr) {
          node = node->FirstChildElement();
          continue;
        }
        while (node->NextSiblingElement() == nullptr) {
          node = node->Parent()->ToElement();
        }
        node = node->NextSiblingElement();
      }
      ASSERT_EQ(xml.at(element).tag.name, node->Name());
      TextPatch patch;
      switch (i % 3) {
        case 0:
          patch = xml.set_attribute(element, "test", "a<b&\"'");
          node->SetAttribute("test", "a<b&\"'");
          break;
        case 1: {
          patch = xml.add_last(element, "<new>\n  <inner/>\n</new>");
          tinyxml2::XMLElement* const added = tree.NewElement("new");
          added->InsertEndChild(tree.NewElement("inner"));
          node->InsertEndChild(added);
          break;
        }
        default:
          if (element == 0) {
            continue;
          }
          patch = xml.remove(element);
          node->Parent()->DeleteChild(node);
      }
      tinyxml2::XMLPrinter printer(nullptr, true);
      tree.Print(&printer);
      EXPECT_EQ(meaning(after(patch, text)), meaning(printer.CStr()));
    }
  }
  EXPECT_GT(files, 100U);
}

}  // namespace
}  // namespace proleg::sim
