#include "sim/data_file/markup_scanner.hpp"

#include <algorithm>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

constexpr std::size_t buffer_size = 65'536;
// Bounds of the text kept in memory.
constexpr std::size_t max_text = 1'000'000;
constexpr std::size_t max_name = 200;
constexpr std::size_t max_attributes = 32;
constexpr std::size_t max_depth = 16;

bool is_blank(int c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

bool is_of_name(int c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
         c == '.' || c == ':' || c >= 0x80;
}

}  // namespace

MarkupScanner::MarkupScanner(std::string file, std::unique_ptr<std::istream> stream)
    : file_(std::move(file)), stream_(std::move(stream)), buffer_(buffer_size) {
  static_cast<void>(peek());  // this fills the buffer
  position_ = size_ - without_byte_order_mark({buffer_.data(), size_}).size();
}

void MarkupScanner::refuse(int line, const std::string& found, const std::string& expected) const {
  throw InputError(file_, line, found, expected);
}

int MarkupScanner::peek() {
  if (position_ == size_) {
    stream_->read(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    if (stream_->bad()) {
      throw FileError(file_, "cannot be read");
    }
    position_ = 0;
    size_ = static_cast<std::size_t>(stream_->gcount());
    if (size_ == 0) {
      return end;
    }
  }
  return static_cast<unsigned char>(buffer_[position_]);
}

int MarkupScanner::get() {
  const int c = peek();
  if (c != end) {
    ++position_;
    line_ += c == '\n' ? 1 : 0;
  }
  return c;
}

void MarkupScanner::skip_blanks() {
  while (is_blank(peek())) {
    get();
  }
}

std::string MarkupScanner::read_name() {
  std::string name;
  while (is_of_name(peek())) {
    name += static_cast<char>(get());
    if (name.size() > max_name) {
      refuse(line_, "a name of more than " + std::to_string(max_name) + " characters", "a tag of a data file");
    }
  }
  return name;
}

void MarkupScanner::skip_past(std::string_view last) {
  std::string newest;
  for (int c = get(); c != end; c = get()) {
    newest += static_cast<char>(c);
    if (newest.size() > last.size()) {
      newest.erase(0, 1);
    }
    if (newest == last) {
      return;
    }
  }
}

const MarkupScanner::Item& MarkupScanner::at_end_of_file() {
  item_.kind = open_.empty() ? Kind::end_of_file : Kind::cut;
  item_.line = line_;
  item_.text = open_.empty() ? std::string() : open_.back();
  return item_;
}

void MarkupScanner::read_attributes() {
  while (true) {
    skip_blanks();
    if (!is_of_name(peek())) {
      return;
    }
    if (item_.attributes.size() == max_attributes) {
      refuse(line_, "a tag with more than " + std::to_string(max_attributes) + " attributes", "a tag of a data file");
    }
    Attribute attribute{read_name(), {}};
    skip_blanks();
    if (peek() == end) {
      return;
    }
    const int equals = get();
    skip_blanks();
    const int quote = get();
    if (equals != '=' || (quote != '"' && quote != '\'' && quote != end)) {
      refuse(line_, "the attribute " + in_quotes(attribute.name) + " without a value in quotes",
             attribute.name + "=\"...\"");
    }
    for (int c = get(); c != quote && c != end; c = get()) {
      attribute.value += static_cast<char>(c);
      if (attribute.value.size() > max_text) {
        refuse(line_, "an attribute of more than a million characters", "a tag of a data file");
      }
    }
    if (std::ranges::find(item_.attributes, attribute.name, &Attribute::name) != item_.attributes.end()) {
      refuse(line_, "the attribute " + in_quotes(attribute.name) + " twice", "each attribute once");
    }
    item_.attributes.push_back(std::move(attribute));
  }
}

const MarkupScanner::Item& MarkupScanner::read_end_tag() {
  get();  // takes the slash
  item_.kind = Kind::end;
  item_.text = read_name();
  skip_blanks();
  const int last = get();
  if (last == end) {
    return at_end_of_file();
  }
  if (last != '>' || open_.empty() || open_.back() != item_.text) {
    refuse(item_.line, in_quotes("</" + item_.text + (last == '>' ? ">" : "")),
           open_.empty() ? "a start tag" : "</" + open_.back() + ">");
  }
  open_.pop_back();
  return item_;
}

const MarkupScanner::Item& MarkupScanner::read_start_tag() {
  item_.kind = Kind::start;
  item_.text = read_name();
  if (item_.text.empty() && peek() != end) {
    refuse(item_.line, "'<' that begins no tag", "a tag of a data file");
  }
  read_attributes();
  const bool is_empty = peek() == '/';
  if (is_empty) {
    get();
  }
  const int last = get();
  if (last == end) {
    open_.push_back(item_.text);  // the element counts as cut
    return at_end_of_file();
  }
  if (last != '>') {
    refuse(line_, "something else than an attribute in <" + item_.text, "attributes and '>'");
  }
  if (open_.size() == max_depth) {
    refuse(item_.line, "tags in more than " + std::to_string(max_depth) + " others", "tags of a data file");
  }
  open_.push_back(item_.text);
  has_pending_end_ = is_empty;
  return item_;
}

const MarkupScanner::Item& MarkupScanner::next() {
  item_.attributes.clear();
  if (has_pending_end_) {
    has_pending_end_ = false;
    item_.kind = Kind::end;
    open_.pop_back();
    return item_;
  }
  while (true) {
    skip_blanks();
    item_.line = line_;
    item_.text.clear();
    while (peek() != '<' && peek() != end) {
      item_.text += static_cast<char>(get());
      if (item_.text.size() > max_text) {
        refuse(item_.line, "text of more than a million characters", "the numbers of one frame");
      }
    }
    if (!item_.text.empty() && (peek() != end || open_.empty())) {
      item_.kind = Kind::text;
      item_.text = std::string(trimmed(item_.text));
      return item_;
    }
    if (get() == end) {
      return at_end_of_file();
    }
    if (peek() == '?') {
      skip_past("?>");
    } else if (peek() == '!') {
      get();
      const bool is_comment = get() == '-' && peek() == '-';
      if (!is_comment && peek() != end) {
        refuse(item_.line, "'<!' that begins no comment", "a tag of a data file");
      }
      get();
      skip_past("-->");
    } else {
      return peek() == '/' ? read_end_tag() : read_start_tag();
    }
  }
}

void MarkupScanner::skip_element() {
  if (has_pending_end_) {
    has_pending_end_ = false;
    open_.pop_back();
    return;
  }
  const std::string name = open_.back();
  while (true) {
    int c = get();
    while (c != '<' && c != end) {
      c = get();
    }
    if (c == end) {
      return;
    }
    if (peek() != '/') {
      continue;
    }
    get();
    if (read_name() != name) {
      continue;
    }
    skip_blanks();
    if (peek() == '>') {
      get();
      open_.pop_back();
      return;
    }
  }
}

}  // namespace proleg::sim
