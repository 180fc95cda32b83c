#pragma once

// OpenMM's XML, read strictly: an attribute or element that is not asked for is refused by name, one that is
// lacks likewise, and every refusal says file and line. For the readers of openmm/read.cpp and the twin. What
// is read by a list of fields is written by the same.

#include <filesystem>
#include <initializer_list>
#include <map>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace taut {

class Element;

// A whole XML file of one element, whose type is "System" or "State". No deeper than OpenMM's are: readers
// that go down it by recursion are safe.
class XmlFile {
 public:
  // Throws InputError, one line, with file and line.
  XmlFile(std::filesystem::path path, const std::string& type);
  XmlFile(const XmlFile&) = delete;
  XmlFile& operator=(const XmlFile&) = delete;

  Element root() const;
  const std::string& text() const { return text_; }

  [[noreturn]] void refuse(const std::string& why) const;  // throws InputError "path: why"
  [[noreturn]] void refuse_at(std::ptrdiff_t offset, const std::string& why) const;  // "path:line: why"

 private:
  void check_tree() const;

  std::filesystem::path path_;
  std::string text_;
  pugi::xml_document document_;
};

// An attribute and where its value goes. A number is finite, a flag 0 or 1.
struct Field {
  struct Integer {
    int* to;
    int low, high;  // both allowed
  };
  std::string_view name;
  std::variant<double*, bool*, std::string*, Integer> to;
};

// Appends an element with these attributes, their values such that they are read back to the last bit.
pugi::xml_node append(pugi::xml_node to, const char* name, const std::vector<Field>& fields);

class Element {
 public:
  Element(const XmlFile& file, pugi::xml_node node, const std::string* within = nullptr)
      : file_(&file), node_(node), within_(within) {}
  // The same, and all refusals of it and of what is in it begin with `what`, which outlives them.
  Element named(const std::string& what) const { return {*file_, node_, &what}; }

  std::string_view name() const { return node_.name(); }
  std::string text(const char* attribute) const;  // its value; refuses where it is not there
  std::size_t count() const;                      // of its elements

  // Reads all its attributes: the fields, each of which must be there, and none but `unused` besides.
  void read(const std::vector<Field>& fields, const std::vector<std::string_view>& unused = {}) const;

  // The same of one that has no elements.
  void read_leaf(const std::vector<Field>& fields) const;
  // All its attributes, whatever their names: numbers.
  std::map<std::string, double> numbers() const;

  // Checks that its elements are these parts, each once, and none but `unused` besides.
  void check_parts(std::initializer_list<const char*> parts,
                   const std::vector<std::string_view>& unused = {}) const;
  bool has(const char* part) const { return bool(node_.child(part)); }
  bool has_attribute(const char* name) const { return bool(node_.attribute(name)); }
  bool empty() const { return !node_.first_attribute() && !node_.first_child(); }
  Element part(const char* name) const { return {*file_, node_.child(name), within_}; }  // one it has

  // Calls use(element) for each of its elements, all of which have the name, and which has no attributes
  // itself.
  template <class Use>
  void each(std::string_view name, Use use) const {
    read({});
    each_of(name, use);
  }
  // The same of one that may have attributes.
  template <class Use>
  void each_of(std::string_view name, Use use) const {
    for (const pugi::xml_node node : node_.children()) {
      const Element element(*file_, node, within_);
      if (element.name() != name) element.refuse_as_unknown(this->name());
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
