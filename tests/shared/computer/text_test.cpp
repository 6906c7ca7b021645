#include "shared/computer/text/text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>

#include "shared/computer/errors/input_error.hpp"

namespace proleg {
namespace {

TEST(Text, Utf8IsThatOfRfc3629) {
  for (const char* good : {"", "a", "\x7F", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xED\x9F\xBF", "\xEE\x80\x80",
                           "\xEF\xBF\xBF", "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF"}) {
    EXPECT_FALSE(find_invalid_utf8(good).has_value()) << testing::PrintToString(good);
  }
  // Bytes that are no UTF-8: a continuation alone, cut short, longer than needed, surrogates, beyond U+10FFFF, bytes
  // that never occur.
  for (const char* bad :
       {"\x80", "\xC2", "\xC2\x41", "\xC0\x80", "\xC1\xBF", "\xE0\x80\x80", "\xE0\x9F\xBF", "\xE2\x82", "\xED\xA0\x80",
        "\xED\xBF\xBF", "\xF0\x80\x80\x80", "\xF4\x90\x80\x80", "\xF8\x88\x80\x80\x80", "\xFE", "\xFF"}) {
    EXPECT_EQ(find_invalid_utf8(bad), 0U) << testing::PrintToString(bad);
  }
  EXPECT_EQ(find_invalid_utf8("ab\xFF"), 2U);
}

TEST(Text, OneLineHasNoControlCharactersAndNoBadBytes) {
  EXPECT_EQ(one_line("a\nb\tc\x1b[0m\x7F"), "a b c [0m ");
  EXPECT_EQ(one_line("\xC2\x85|\xE2\x80\xA8|\xE2\x80\xA9|\xC3\xA4"), " | | |\xC3\xA4");
  EXPECT_EQ(one_line("\xFF\xC3"), "??");
}

TEST(Text, LongTextIsCutBetweenCharacters) {
  EXPECT_EQ(shortened(std::string(60, 'a')), std::string(60, 'a'));
  EXPECT_EQ(shortened(std::string(61, 'a')), std::string(60, 'a') + "...");
  std::string umlauts;
  for (int i = 0; i < 61; ++i) {
    umlauts += "\xC3\xA4";
  }
  EXPECT_EQ(shortened(umlauts), umlauts.substr(0, 120) + "...");
  EXPECT_EQ(shortened(umlauts, 3), umlauts.substr(0, 6) + "...");
  EXPECT_EQ(shortened("abc", 3), "abc");
}

TEST(Text, OnlyAWholeByteOrderMarkAtTheStartIsLeftOut) {
  EXPECT_EQ(without_byte_order_mark("\xEF\xBB\xBF<a/>"), "<a/>");
  EXPECT_EQ(without_byte_order_mark("\xEF\xBB\xBF\xEF\xBB\xBF"), "\xEF\xBB\xBF");
  for (const char* const other : {"", "<a/>", "\xEF\xBB", " \xEF\xBB\xBF"}) {
    EXPECT_EQ(without_byte_order_mark(other), other);
  }
}

TEST(Text, InQuotesEveryCharacterIsSeen) {
  EXPECT_EQ(in_quotes("\xEF\xBB\xBF# a\xC2\xA0"
                      "b"),
            "'<U+FEFF># a<U+00A0>b'");
  EXPECT_EQ(in_quotes("\xE2\x80\x8B|\xE2\x80\xAE|\xE3\x80\x80"), "'<U+200B>|<U+202E>|<U+3000>'");
  EXPECT_EQ(in_quotes("\xC3\xA4 \xE2\x82\xAC \xF0\x9F\x90\x9B"), "'\xC3\xA4 \xE2\x82\xAC \xF0\x9F\x90\x9B'");
}

TEST(Text, AVisibleLineHasNoCharacterThatNobodySees) {
  EXPECT_TRUE(is_visible_line(""));
  EXPECT_TRUE(is_visible_line("J 1 \xC3\xA4 \xE2\x82\xAC \xF0\x9F\x90\x9B"));
  for (const char* text : {"a\tb", "a\nb", "a\x7F", "a\xC2\x85", "a\xC2\xA0", "a\xE2\x80\xAE", "a\xE2\x80\xA8",
                           "\xE2\x81\xA6", "\xE2\x80\x8B", "\xEF\xBB\xBF", "\xC3", "\xFF"}) {
    EXPECT_FALSE(is_visible_line(text)) << in_quotes(text);
  }
}

TEST(Text, LinesOfEveryEditorAreEqual) {
  const auto lines_of = [](std::string_view text) {
    std::vector<std::string> all;
    TextLines lines(text);
    while (const auto line = lines.next()) {
      all.push_back(std::to_string(lines.number()) + ":" + std::string(*line));
    }
    return all;
  };
  const std::vector<std::string> expected{"1:a b", "2:", "3:c"};
  for (const char* text : {"a b\n\nc", "a b\n\nc\n", "a b\r\n\r\nc\r\n",
                           "\xEF\xBB\xBF"
                           "a b\r\n\nc"}) {
    EXPECT_EQ(lines_of(text), expected);
  }
  EXPECT_TRUE(lines_of("").empty());
  EXPECT_TRUE(lines_of("\xEF\xBB\xBF").empty());
}

TEST(Text, AWholeNumberIsAllOfTheTextAndFits) {
  EXPECT_EQ(parse_whole<std::uint8_t>("255"), 255);
  EXPECT_EQ(parse_whole<std::uint32_t>("fF", 16), 255U);
  EXPECT_EQ(parse_whole<int>("-7"), -7);
  for (const char* bad : {"", " 1", "1 ", "+1", "-1", "1.0", "0x1", "256"}) {
    EXPECT_FALSE(parse_whole<std::uint8_t>(bad).has_value()) << bad;
  }
}

TEST(Text, ARateIsAShareOrAPercentage) {
  EXPECT_EQ(parse_rate("0.5"), 0x80000000U);
  EXPECT_EQ(parse_rate("50%"), 0x80000000U);
  EXPECT_EQ(parse_rate("0"), 0U);
  EXPECT_EQ(parse_rate("100%"), 0xFFFFFFFFU);
  for (const char* bad : {"", "%", "1.1", "101%", "-1%", "nan", "5 %", "50%%"}) {
    EXPECT_FALSE(parse_rate(bad).has_value()) << bad;
  }
}

TEST(Text, AnExactNumberReadsBackAsTheSame) {
  for (const double value : {0.1, 1.0 / 3.0, -2.5e-300, 1e22}) {
    EXPECT_EQ(std::stod(exact_text(value)), value);
  }
  EXPECT_EQ(exact_text(0.1), "0.1");
  EXPECT_EQ(exact_text(NAN), "");
}

TEST(Text, HexadecimalNumbersHaveAtLeastTheDigitsAskedFor) {
  EXPECT_EQ(hexadecimal(0x1F, 1), "0x1F");
  EXPECT_EQ(hexadecimal(0x1F, 4), "0x001F");
  EXPECT_EQ(hexadecimal(0, 1), "0x0");
  EXPECT_EQ(hexadecimal(0xFFFFFFFFU, 8), "0xFFFFFFFF");
}

TEST(Text, NumbersAreWholeWordsAndFinite) {
  EXPECT_EQ(parse_number("-1.5e3"), -1500.0);
  EXPECT_EQ(parse_number(".5"), 0.5);
  EXPECT_EQ(parse_number("+0.25"), 0.25) << "as printf writes with %+f";
  for (const char* bad :
       {"", " 1", "1 ", "+", "++1", "+-1", "-+1", "1,5", "0x1", "inf", "-infinity", "nan", "1e999", "--1", "1e"}) {
    EXPECT_FALSE(parse_number(bad).has_value()) << bad;
  }
}

TEST(Text, WordsAreSplitAtXmlBlanks) {
  EXPECT_EQ(words(" a\t b\r\nc "), (std::vector<std::string_view>{"a", "b", "c"}));
  EXPECT_TRUE(words(" \n ").empty());
}

TEST(InputErrorText, NamesFileAndLineAndOmitsLineZero) {
  EXPECT_STREQ(InputError("a.xml", 3, "x", "y").what(), "a.xml:3: found x, expected y");
  EXPECT_STREQ(InputError("amplitude=x", 0, "x", "y").what(), "amplitude=x: found x, expected y");
}

TEST(Text, TheMostSimilarWordTakesTheFewestChanges) {
  const std::vector<std::string> known{"record", "reset", "seed", "seconds", "send", "from", "at"};
  EXPECT_EQ(most_similar("recrod", known), "record") << "exchanged";
  EXPECT_EQ(most_similar("form", known), "from");
  EXPECT_EQ(most_similar("second", known), "seconds") << "inserted";
  EXPECT_EQ(most_similar("rreset", known), "reset") << "removed";
  EXPECT_EQ(most_similar("seat", known), std::nullopt) << "two changes of four letters";
  EXPECT_EQ(most_similar("fast", known), std::nullopt);
  EXPECT_EQ(most_similar("x", known), std::nullopt);
  EXPECT_EQ(most_similar("", known), std::nullopt);
  EXPECT_EQ(most_similar("reset", {}), std::nullopt);
}

TEST(TableLine, HasTabsBetweenCellsAndALineEnd) {
  TableLine line;
  line.add("tick");
  line.add(std::uint64_t{18446744073709551615U});
  line.add(0.1);
  EXPECT_EQ(line.finish(), "tick\t18446744073709551615\t0.1\n");
}

TEST(CellsOf, AreWhatIsBetweenTabs) {
  using Cells = std::vector<std::string_view>;
  EXPECT_EQ(cells_of("tick\t1 2\t0.1"), (Cells{"tick", "1 2", "0.1"}));
  EXPECT_EQ(cells_of("\ta\t\t"), (Cells{"", "a", "", ""}));
  EXPECT_EQ(cells_of("one"), (Cells{"one"}));
  EXPECT_EQ(cells_of(""), (Cells{""}));
}

TEST(TableLine, IsEmptyAgainAfterItsEnd) {
  TableLine line;
  line.add("first");
  EXPECT_EQ(line.finish(), "first\n");
  line.add("second");
  EXPECT_EQ(line.finish(), "second\n");
}

TEST(TableLine, LeavesACellEmptyForANumberThatIsNotFinite) {
  TableLine line;
  line.add(1U);
  line.add(NAN);
  line.add(INFINITY);
  line.add(2U);
  EXPECT_EQ(line.finish(), "1\t\t\t2\n");
}

}  // namespace
}  // namespace proleg
