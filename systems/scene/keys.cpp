#include "systems/scene/keys.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <tuple>

#include "systems/scene/toml_reader.hpp"

namespace taut {

bool Key::described_as(const Key& other) const {
  const auto all = [](const Key& s) {
    return std::tuple(s.name(), std::string_view(s.about.meaning), std::string_view(s.about.unit),
                      s.allowed(), s.type, s.value, s.counts_only, s.required);
  };
  return all(*this) == all(other);
}

std::string Key::allowed() const {
  return taut::allowed(about.range, {about.words.begin(), about.words.end()});
}

Key& KeysRead::of(std::string_view section, std::string_view key) {
  const auto found =
      std::ranges::find_if(all, [&](const Key& one) { return one.section == section && one.key == key; });
  if (found != all.end()) return *found;
  return all.emplace_back(Key{std::string(section), std::string(key)});
}

std::string value_text(double value) {
  return fmt::format("{}", value);
}

std::string value_text(bool value) {
  return value ? "true" : "false";
}

std::string value_text(const std::string& value) {
  return value.empty() ? "" : toml_quoted(value);
}

std::string value_text(const std::filesystem::path& value) {
  return value_text(value.string());
}

std::string value_text(const Vec3& value) {
  return value_text(std::vector<double>(value.data(), value.data() + 3));
}

std::string value_text(const std::vector<double>& value) {
  return value.empty() ? "" : fmt::format("[{}]", fmt::join(value, ", "));
}

std::string value_text(const Rows& value) {
  if (value.size() == 1) return fmt::format("[{}]", value_text(value[0]));
  return value.empty() ? "" : fmt::format("{} rows", value.size());
}

std::string value_text(const Course& value) {
  if (value.points().size() == 1) return value_text(value.points()[0].value);
  std::vector<std::string> rows;
  for (const auto& [t, number] : value.points()) rows.push_back(fmt::format("[{}, {}]", t, number));
  return rows.empty() ? "" : fmt::format("[{}]", fmt::join(rows, ", "));
}

std::string toml_quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f')
      quoted += fmt::format("\\u{:04x}", c);
    else if (c == '"' || c == '\\')
      quoted += {'\\', c};
    else
      quoted += c;
  }
  return quoted + "\"";
}

}  // namespace taut
