#pragma once

// An XML file for the readers. The case of tags and attributes does not matter, and everything has a line number. A
// reader lists the attributes and tags that an element may have; anything else is an InputError.

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tinyxml2 {
class XMLDocument;
class XMLElement;
}  // namespace tinyxml2

namespace proleg::sim {

class XmlDocument;

/// An element of a document, which must outlive it. Readers spell tags and attributes as OpenRAVE's documentation does;
/// files may use any case.
class XmlElement {
 public:
  XmlElement(const tinyxml2::XMLElement& node, const XmlDocument& document) : node_(&node), document_(&document) {}

  [[nodiscard]] const XmlDocument& document() const { return *document_; }
  [[nodiscard]] int line() const;
  /// The tag as it is written, for messages: "<Geom>".
  [[nodiscard]] std::string label() const;
  [[nodiscard]] bool is(std::string_view tag) const;

  /// Throws the InputError for this place.
  [[noreturn]] void refuse(const std::string& found, const std::string& expected) const;

  /// Throws InputError for other attributes and tags, for an attribute given twice, and for text.
  void allow(std::span<const std::string_view> attributes, std::span<const std::string_view> tags) const;
  void allow(std::initializer_list<std::string_view> attributes, std::initializer_list<std::string_view> tags) const;

  [[nodiscard]] std::vector<XmlElement> children() const;
  /// The only child with that tag. Throws InputError if there are two.
  [[nodiscard]] std::optional<XmlElement> child(std::string_view tag) const;
  [[nodiscard]] XmlElement required_child(std::string_view tag) const;

  [[nodiscard]] std::optional<std::string> attribute(std::string_view name) const;
  [[nodiscard]] std::string required_attribute(std::string_view name) const;
  /// As they are written.
  [[nodiscard]] std::vector<std::string> attribute_names() const;

  /// The text of an element that has no tags and only these attributes, without blanks at its ends.
  [[nodiscard]] std::string text(std::initializer_list<std::string_view> attributes = {}) const;

 private:
  void check_attributes(std::span<const std::string_view> attributes) const;

  const tinyxml2::XMLElement* node_;
  const XmlDocument* document_;
};

/// A parsed file.
class XmlDocument {
 public:
  struct Comment {
    int line;
    std::string text;
  };

  /// includer: the document that names this one; null for the top-level file. It must outlive this document.
  XmlDocument(std::filesystem::path path, std::string text, const XmlDocument* includer);
  ~XmlDocument();
  XmlDocument(const XmlDocument&) = delete;
  XmlDocument& operator=(const XmlDocument&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// The path as messages and the list of sources show it; two paths to the same file have the same name.
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const XmlDocument* includer() const { return includer_; }

  /// The outermost element. Throws InputError if it has another tag.
  [[nodiscard]] XmlElement root(std::string_view tag) const;
  /// The outermost element. Throws InputError if it has none of the tags.
  [[nodiscard]] XmlElement root(std::span<const std::string_view> tags) const;
  /// All comments of the file, in order.
  [[nodiscard]] std::vector<Comment> comments() const;

 private:
  std::filesystem::path path_;
  std::string name_;
  const XmlDocument* includer_;
  std::unique_ptr<tinyxml2::XMLDocument> parsed_;
};

/// How a path is shown and compared.
[[nodiscard]] std::string name_of(const std::filesystem::path& path);

}  // namespace proleg::sim
