#include "systems/openmm/xml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "base/errors.hpp"
#include "files/text_file.hpp"

namespace taut {
namespace {

constexpr int kDeepest = 32;  // OpenMM's files have 7 levels, a few more with nested integrators

std::string shown(std::string_view value) {
  constexpr std::size_t kMost = 60;
  return value.size() <= kMost ? fmt::format("\"{}\"", value)
                               : fmt::format("\"{}...\"", value.substr(0, kMost));
}

// Makes a message one line, whatever a name in the file contains.
std::string on_one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 127; }, ' ');
  return text;
}

template <class T>
bool parses(const char* text, T& value) {
  const char* const end = text + std::strlen(text);
  const auto [stop, error] = std::from_chars(text, end, value);
  return error == std::errc() && stop == end;
}

bool contains(const std::vector<std::string_view>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

XmlFile::XmlFile(const std::filesystem::path& path, const std::string& type)
    : XmlFile(path, whole_text(path), type) {}

XmlFile::XmlFile(std::filesystem::path path, std::string text, const std::string& type)
    : path_(std::move(path)), text_(std::move(text)) {
  if (text_.size() > kLongestText) refuse(fmt::format("is over {} GiB, expected less", kLongestText >> 30));
  if (const auto at = text_.find('\0'); at != text_.npos)
    refuse_at(static_cast<std::ptrdiff_t>(at), "not whole XML: a character 0");

  hear();
  // Parsed as a fragment, so that text outside the root element is found.
  const auto parsed = document_.load_buffer(
      text_.data(), text_.size(), pugi::parse_default | pugi::parse_fragment | pugi::parse_trim_pcdata,
      pugi::encoding_utf8);
  if (!parsed) refuse_at(parsed.offset, fmt::format("not whole XML: {}", parsed.description()));
  check_tree();
  const std::string found = document_.first_child().attribute("type").value();
  if (found != type)
    root().refuse(
        fmt::format("expected an OpenMM {}, found {}", type,
                    found.empty() ? fmt::format("<{}>", root().name()) : fmt::format("a {}", shown(found))));
}

// Checks, without recursion, that there is one root element, that all nodes are elements, and that the depth
// is limited.
void XmlFile::check_tree() const {
  const pugi::xml_node top = document_.first_child();
  if (!top) refuse_at(0, "not whole XML: there is no element");
  int depth = 0;
  HearSometimes hear_sometimes;
  for (pugi::xml_node node = top; node;) {
    hear_sometimes();
    if (node.type() != pugi::node_element)
      refuse_at(node.offset_debug(),
                fmt::format("not whole XML: the text {} between elements", shown(node.value())));
    if (depth == 0 && node != top)
      refuse_at(node.offset_debug(), fmt::format("not whole XML: <{}> after the end", node.name()));
    if (node.first_child()) {
      if (++depth > kDeepest)
        refuse_at(node.offset_debug(),
                  fmt::format("<{}> is {} elements deep, OpenMM's files are not", node.name(), depth));
      node = node.first_child();
      continue;
    }
    while (!node.next_sibling() && depth > 0) {
      node = node.parent();
      --depth;
    }
    node = node.next_sibling();
  }
}

Element XmlFile::root() const {
  return {*this, document_.first_child()};
}

void XmlFile::refuse(const std::string& why) const {
  throw InputError(on_one_line(fmt::format("{}: {}", path_.string(), why)));
}

void XmlFile::refuse_at(std::ptrdiff_t offset, const std::string& why) const {
  const auto end = text_.begin() + std::clamp<std::ptrdiff_t>(offset, 0, std::ssize(text_));
  throw InputError(
      on_one_line(fmt::format("{}:{}: {}", path_.string(), 1 + std::count(text_.begin(), end, '\n'), why)));
}

std::string Element::text(const char* attribute) const {
  const pugi::xml_attribute found = node_.attribute(attribute);
  if (!found) refuse(fmt::format("{} lacks {}", name(), attribute));
  return found.value();
}

std::size_t Element::count() const {
  const auto all = node_.children();
  return static_cast<std::size_t>(std::distance(all.begin(), all.end()));
}

void Element::read(const std::vector<Field>& fields, const std::vector<std::string_view>& unused) const {
  std::size_t found = 0;
  for (pugi::xml_attribute a = node_.first_attribute(); a; a = a.next_attribute()) {
    const std::string_view key = a.name();
    if (node_.attribute(a.name()) != a) refuse(fmt::format("{} has {} twice", name(), key));
    const auto field =
        std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.name == key; });
    if (field != fields.end()) {
      put(*field, a.value());
      ++found;
    } else if (!contains(unused, key)) {
      refuse(fmt::format("{} has {}={}, which taut does not know", name(), key, shown(a.value())));
    }
  }
  if (found == fields.size()) return;
  for (const Field& field : fields)
    if (!node_.attribute(std::string(field.name).c_str()))
      refuse(fmt::format("{} lacks {}", name(), field.name));
}

void Element::put(const Field& field, const char* value) const {
  const auto expect = [&](bool good, const std::string& what) {
    if (!good) refuse(fmt::format("{} has {}={}, expected {}", name(), field.name, shown(value), what));
  };
  if (auto* const* number = std::get_if<double*>(&field.to)) {
    expect(parses(value, **number) && std::isfinite(**number), "a number");
  } else if (auto* const* flag = std::get_if<bool*>(&field.to)) {
    int bit = 0;
    expect(parses(value, bit) && (bit == 0 || bit == 1), "0 or 1");
    **flag = bit == 1;
  } else if (const auto* integer = std::get_if<Field::Integer>(&field.to)) {
    const auto& [to, low, high] = *integer;
    expect(parses(value, *to) && *to >= low && *to <= high,
           fmt::format("an integer from {} to {}", low, high));
  } else {
    *std::get<std::string*>(field.to) = value;
  }
}

pugi::xml_node append(pugi::xml_node to, const char* name, const std::vector<Field>& fields) {
  struct {
    std::string operator()(const double* x) const { return fmt::format("{}", *x); }
    std::string operator()(const bool* flag) const { return *flag ? "1" : "0"; }
    std::string operator()(const std::string* text) const { return *text; }
    std::string operator()(const Field::Integer& n) const { return fmt::format("{}", *n.to); }
  } const text_of;
  pugi::xml_node node = to.append_child(name);
  for (const Field& field : fields)
    node.append_attribute(std::string(field.name).c_str()) = std::visit(text_of, field.to).c_str();
  return node;
}

void Element::read_leaf(const std::vector<Field>& fields) const {
  check_parts({});
  read(fields);
}

std::map<std::string, double> Element::numbers() const {
  check_parts({});
  std::map<std::string, double> all;
  for (const pugi::xml_attribute attribute : node_.attributes()) {
    const auto [at, is_new] = all.emplace(attribute.name(), 0);
    if (!is_new) refuse(fmt::format("{} has {} twice", name(), attribute.name()));
    put({at->first, &at->second}, attribute.value());
  }
  return all;
}

void Element::check_parts(std::initializer_list<const char*> parts,
                          const std::vector<std::string_view>& unused) const {
  for (const pugi::xml_node node : node_.children()) {
    const Element element(*file_, node, within_);
    const bool known = contains(unused, element.name()) ||
                       std::find(parts.begin(), parts.end(), element.name()) != parts.end();
    if (!known) element.refuse_as_unknown(name());
    if (node_.child(node.name()) != node)
      element.refuse(fmt::format("{} has a second {}", name(), element.name()));
  }
  for (const char* part : parts)
    if (!has(part)) refuse(fmt::format("{} lacks {}", name(), part));
}

void Element::refuse_as_unknown(std::string_view parent) const {
  refuse(fmt::format("{} has an element {}, which taut does not know", parent, name()));
}

void Element::refuse(const std::string& why) const {
  file_->refuse_at(node_.offset_debug(), within_ ? fmt::format("{}: {}", *within_, why) : why);
}

}  // namespace taut
