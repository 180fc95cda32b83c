#include "constraints/methods.hpp"

#include <fmt/format.h>

#include "md/errors.hpp"
#include "md/nearest_name.hpp"

namespace taut {
namespace {

// Calls visit.operator()<M>() for every method of the list.
template <class... Ms>
void for_each_method(MethodList<Ms...>, auto&& visit) {
  (visit.template operator()<Ms>(), ...);
}

template <class Options, class... Ms>
consteval const char* name_of(MethodList<Ms...>) {
  const char* name = nullptr;
  ((std::is_same_v<Options, typename Ms::Options> ? void(name = Ms::kName) : void()), ...);
  return name;
}

}  // namespace

std::vector<std::string_view> method_names() {
  std::vector<std::string_view> names;
  for_each_method(Methods{}, [&]<class M>() { names.emplace_back(M::kName); });
  return names;
}

std::string_view method_summary(std::string_view name) {
  std::string_view summary;
  for_each_method(Methods{}, [&]<class M>() {
    if (name == M::kName) summary = M::kSummary;
  });
  return summary;
}

std::string_view method_name(const MethodOptions& options) {
  return std::visit([]<class O>(const O&) -> std::string_view { return name_of<O>(Methods{}); }, options);
}

MethodOptions default_options(std::string_view name) {
  std::optional<MethodOptions> options;
  for_each_method(Methods{}, [&]<class M>() {
    if (name == M::kName) options = typename M::Options{};
  });
  if (!options)
    throw InputError(fmt::format("there is no method \"{}\"{}", name, did_you_mean(name, method_names())));
  return *options;
}

Method make_method(const System& sys, const MethodOptions& options, double h) {
  if (!(h > 0)) throw InputError(fmt::format("a step of {} ps, expected more than 0", h));
  const auto make = [&]<class... Ms>(MethodList<Ms...>) {
    std::optional<Method> method;
    ((std::holds_alternative<typename Ms::Options>(options)
          ? void(method.emplace(std::in_place_type<Ms>, sys, std::get<typename Ms::Options>(options), h))
          : void()),
     ...);
    return std::move(*method);
  };
  return make(Methods{});
}

}  // namespace taut
