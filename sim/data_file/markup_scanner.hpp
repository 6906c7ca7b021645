#pragma once

// Reads the simple XML of data files from a stream, tag by tag, in constant memory: a data file may be larger than the
// memory of the computer. Scenario files, which are small, have a reader with more comfort
// (sim/scenario/xml_document.hpp).

#include <cstddef>
#include <cstdint>
#include <istream>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::sim {

/// Returns one item after the other: start tags with their attributes, end tags, and text that is not blank. <a/> gives
/// a start and an end. Comments and <?...?> are skipped; entities stay unchanged. A file that ends inside an element is
/// cut, which is no error here.
class MarkupScanner {
 public:
  enum class Kind : std::uint8_t { start, end, text, end_of_file, cut };
  struct Attribute {
    std::string name;
    std::string value;
  };
  struct Item {
    Kind kind = Kind::end_of_file;
    int line = 0;                       ///< line where the item begins; of a cut: the last line
    std::string text;                   ///< name of the tag, or the text without blanks at its ends
    std::vector<Attribute> attributes;  ///< attributes of a start tag
  };

  /// file: name for messages.
  MarkupScanner(std::string file, std::unique_ptr<std::istream> stream);

  /// Reads the next item, which the next call overwrites. Throws InputError for text that is no such XML, and for end
  /// tags without their start tag; FileError if the stream cannot be read.
  const Item& next();

  /// Moves behind the end tag of the start tag just read, without parsing the text in between. At the end of the file
  /// next() returns the cut.
  void skip_element();

  [[nodiscard]] int line() const { return line_; }
  /// Throws the InputError for a line of the file.
  [[noreturn]] void refuse(int line, const std::string& found, const std::string& expected) const;

 private:
  static constexpr int end = -1;

  [[nodiscard]] int peek();
  int get();
  void skip_blanks();
  /// Reads up to a character that belongs to no name.
  [[nodiscard]] std::string read_name();
  /// Skips a comment or declaration up to and with its last characters.
  void skip_past(std::string_view last);
  void read_attributes();
  const Item& read_end_tag();
  const Item& read_start_tag();
  const Item& at_end_of_file();

  std::string file_;
  std::unique_ptr<std::istream> stream_;
  std::vector<char> buffer_;
  std::size_t position_ = 0;
  std::size_t size_ = 0;
  int line_ = 1;
  std::vector<std::string> open_;  ///< open elements, the outermost first
  bool has_pending_end_ = false;   ///< the end tag of <a/> is the next item
  Item item_;
};

}  // namespace proleg::sim
