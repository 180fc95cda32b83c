#pragma once

// A strict reader of OpenMM's XML: unexpected and missing attributes and elements are refused by name, with
// file and line. The readers of openmm/import.cpp and the OpenMM twin use it. The same lists of fields serve
// for reading and writing.

#include <filesystem>
#include <initializer_list>
#include <map>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/listen.hpp"

namespace taut {

class Element;

// An XML file with one root element of type "System" or "State". Its depth is limited, so that recursive
// readers are safe. The parser itself hears nothing.
class XmlFile {
 public:
  // Throws InputError, one line that names file and line.
  XmlFile(const std::filesystem::path& path, const std::string& type);
  // The same of a text; the path is for messages.
  XmlFile(std::filesystem::path path, std::string text, const std::string& type);
  XmlFile(const XmlFile&) = delete;
  XmlFile& operator=(const XmlFile&) = delete;

  Element root() const;
  const std::string& text() const { return text_; }
  const std::filesystem::path& path() const { return path_; }

  [[noreturn]] void refuse(const std::string& why) const;  // throws InputError "path: why"
  [[noreturn]] void refuse_at(std::ptrdiff_t offset, const std::string& why) const;  // "path:line: why"

 private:
  void check_tree() const;

  std::filesystem::path path_;
  std::string text_;
  pugi::xml_document document_;
};

// An attribute and the variable for its value. Numbers must be finite, flags 0 or 1.
struct Field {
  struct Integer {
    int* to;
    int low, high;  // limits, inclusive
  };
  std::string_view name;
  std::variant<double*, bool*, std::string*, Integer> to;
};

// Appends an element with these attributes. Values are written with all digits, so that they are read back
// exactly.
pugi::xml_node append(pugi::xml_node to, const char* name, const std::vector<Field>& fields);

class Element {
 public:
  Element(const XmlFile& file, pugi::xml_node node, const std::string* within = nullptr)
      : file_(&file), node_(node), within_(within) {}
  // Returns the element with a prefix `what` for all its error messages; the string must outlive it.
  Element named(const std::string& what) const { return {*file_, node_, &what}; }

  std::string_view name() const { return node_.name(); }
  std::string text(const char* attribute) const;  // value of an attribute that must exist
  std::size_t count() const;                      // number of child elements

  // Reads all attributes: each of the fields must exist, and no others except `unused`.
  void read(const std::vector<Field>& fields, const std::vector<std::string_view>& unused = {}) const;

  // The same for an element that must have no child elements.
  void read_leaf(const std::vector<Field>& fields) const;
  // Returns all attributes, which must be numbers.
  std::map<std::string, double> numbers() const;

  // Checks that its child elements are these parts, each once, and no others except `unused`.
  void check_parts(std::initializer_list<const char*> parts,
                   const std::vector<std::string_view>& unused = {}) const;
  bool has(const char* part) const { return bool(node_.child(part)); }
  bool has_attribute(const char* name) const { return bool(node_.attribute(name)); }
  bool empty() const { return !node_.first_attribute() && !node_.first_child(); }
  Element part(const char* name) const { return {*file_, node_.child(name), within_}; }  // a part that exists

  // Calls use(element) for each child element. All must have this name, and the element itself no attributes.
  template <class Use>
  void each(std::string_view name, Use use) const {
    read({});
    each_of(name, use);
  }
  // The same for an element that may have attributes.
  template <class Use>
  void each_of(std::string_view name, Use use) const {
    HearSometimes hear_sometimes;
    for (const pugi::xml_node node : node_.children()) {
      const Element element(*file_, node, within_);
      if (element.name() != name) element.refuse_as_unknown(this->name());
      hear_sometimes();
      use(element);
    }
  }

  [[noreturn]] void refuse(const std::string& why) const;

 private:
  void put(const Field& field, const char* value) const;
  [[noreturn]] void refuse_as_unknown(std::string_view parent) const;

  const XmlFile* file_;
  pugi::xml_node node_;
  const std::string* within_;
};

}  // namespace taut
