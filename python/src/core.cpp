#include "core.hpp"

#include <fmt/format.h>

#include <string_view>

#include "base/errors.hpp"
#include "base/threads.hpp"
#include "constraints/registry.hpp"
#include "systems/openmm/import.hpp"
#include "systems/scene/scene_file.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

py::object python_class(const char* module, const char* name) {
  return py::module_::import(module).attr(name);
}

py::array_t<double> rows_of(const Vectors& columns, py::handle owner) {
  const py::ssize_t n = columns.cols(), each = sizeof(double);
  return {{n, py::ssize_t{3}}, {3 * each, each}, columns.data(), owner};
}

py::array_t<double> array_of(const Eigen::VectorXd& values) {
  return py::array_t<double>(values.size(), values.data());
}

namespace {

// Of a setting it says what the command says, without the command's option.
void raise(const char* kind, const char* words) {
  const std::string_view said(words);
  PyErr_SetString(python_class("taut.errors", kind).ptr(),
                  words + (said.starts_with(kOverride) ? kOverride.size() : 0));
}

// Turns taut's exceptions into those of the package.
void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const InputError& e) {
    raise("InputError", e.what());
  } catch (const SimulationFailure& e) {
    raise_failure(python_class("taut.errors", "SimulationFailure"), e.what());
  } catch (const OutsideError& e) {
    raise("OutsideError", e.what());
  }
}

// Reads a scene from its text. A start that the scene names is read from the disk.
Input of_toml(const std::string& text, const std::vector<std::string>& overrides) {
  const std::filesystem::path name = "scene.toml";
  Input input{read_scene(parse_toml_text(text, name), name, overrides), {}};
  std::vector<std::filesystem::path> files{std::move(input.scene.files)};
  input.scene.files.assign(files.begin() + 1, files.end());
  input.source = source_of(input.scene, overrides);
  input.source.files.insert(input.source.files.begin(), {name.string(), text});
  return input;
}

Input of_scene(const std::string& name_or_path, const std::vector<std::string>& overrides) {
  Input input{read_scene(find_scene(name_or_path), overrides), {}};
  input.source = source_of(input.scene, overrides);
  return input;
}

Input of_openmm(const std::string& system, const std::string& state, const std::string& names,
                const std::vector<std::string>& overrides) {
  SceneSource source{true, {}, overrides, {}};
  source.files.push_back({"openmm.system.xml", system});
  source.files.push_back({"openmm.state.xml", state});
  hear();  // the texts are long
  if (!names.empty()) source.files.push_back({"topology", names});
  Scene scene = source.read();
  return {std::move(scene), std::move(source)};
}

// Wraps a reader so that it takes a number of threads, too, none: the default, and lets Python's other threads run.
template <class... Given>
auto on_threads(Input (*read)(const Given&...)) {
  return [read](const Given&... given, std::optional<int> threads) {
    if (threads) expect_threads("threads", *threads);
    const ThreadScope scope(threads ? *threads : default_threads());
    const py::gil_scoped_release interpreter;
    const ListenScope interrupted{Interrupts()};
    return read(given...);
  };
}

py::object value_of(const Option& option) {
  return std::visit([](auto* field) { return py::cast(*field); }, option.field);
}

// Describes every built-in method: name, summary, and options with default, unit and meaning.
py::list describe_methods() {
  py::list all;
  for (const MethodEntry& method : methods()) {
    if (method.added) continue;
    MethodOptions defaults(method);
    py::list options;
    for (const Option& option : defaults.describe())
      options.append(
          py::dict(py::arg("key") = option.key, py::arg("default") = value_of(option),
                   py::arg("number") = std::holds_alternative<std::optional<double>*>(option.field),
                   py::arg("unit") = option.about.unit, py::arg("meaning") = option.meaning,
                   py::arg("allowed") = option.allowed()));
    all.append(py::dict(py::arg("name") = method.name, py::arg("summary") = method.summary,
                        py::arg("options") = options));
  }
  return all;
}

py::dict scenes() {
  py::dict all;
  for (const auto& [name, hard_on] : list_scenes()) all[py::str(name)] = hard_on;
  return all;
}

}  // namespace
}  // namespace taut

PYBIND11_MODULE(_core, m) {
  using namespace taut;
  m.doc() = "taut's engine. Use the package taut.";
  m.attr("knows_numpy_2") = PYBIND11_VERSION_HEX >= 0x020C0000;  // earlier ones misread numpy 2's strides
  py::register_exception_translator(translate);
  py::class_<Input>(m, "Input")
      .def_static("of_scene", on_threads(of_scene))
      .def_static("of_toml", on_threads(of_toml))
      .def_static("of_openmm", on_threads(of_openmm))
      .def_property(
          "name", [](const Input& input) { return input.scene.name; },
          [](Input& input, const std::string& name) { input.scene.name = name; });
  m.def("describe_methods", describe_methods);
  m.def("check_method", [](const std::vector<std::string>& overrides) { method_of(overrides); });
  m.def("overrides_of_method", overrides_of_method);
  m.def("scenes", scenes, "Returns the scenes that come with taut, by name, with a line on each.");
  m.def("quoted", [](const std::string& text) { return toml_quoted(text); });
  m.def("threads", default_threads,
        "Returns how many threads a simulation or study uses that names no number: that of use_threads(), "
        "else\n"
        "OMP_NUM_THREADS, else one.");
  m.def(
      "use_threads",
      [](int threads) {
        expect_threads("use_threads", threads);
        use_threads(threads);
      },
      py::arg("threads"),
      "Sets how many threads simulations and studies use that are made from now on and name no number.\n"
      "It acts for all Python threads, and changes no other library's threads.");
  bind_simulations(m);
  bind_studies(m);
  bind_measures(m);
  bind_trajectory_files(m);
  bind_force_evaluation(m);
  bind_parts(m);
}
