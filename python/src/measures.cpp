// What `taut measure` measures, of numpy's arrays.
#include "measures/measures.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"
#include "base/even_times.hpp"
#include "base/series.hpp"
#include "base/zero_step.hpp"
#include "core.hpp"
#include "measures/chain_measures.hpp"
#include "measures/transport.hpp"

namespace taut {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::pair<double, double> pair_of(const Estimate& e) {
  return {e.value, e.error};
}

std::vector<std::pair<double, double>> pairs_of(const std::vector<Estimate>& all) {
  std::vector<std::pair<double, double>> pairs;
  for (const Estimate& e : all) pairs.push_back(pair_of(e));
  return pairs;
}

// A frame of (frames, atoms, 3), its atoms as columns.
Vectors frame_of(const Array& frames, py::ssize_t frame) {
  return Eigen::Map<const Vectors>(frames.data(frame, 0, 0), 3, frames.shape(1));
}

using Times = std::vector<double>;  // ascending [ps]

py::dict viscosity(const Array& pressure, const Times& t, double volume, double temperature) {
  StressSeries stress{.pressure = {}, .t = t, .volume = volume, .temperature = temperature};
  for (py::ssize_t row = 0; row < pressure.shape(0); ++row)
    for (py::ssize_t k = 0; k < 6; ++k)
      stress.pressure[static_cast<std::size_t>(k)].push_back(pressure.at(row, k));
  const GreenKubo found = green_kubo(stress);
  py::dict all;
  all["value"] = pair_of(found.viscosity);
  all["cut"] = found.cut;
  all["t"] = found.t;
  all["correlation"] = pairs_of(found.correlation);
  all["integral"] = pairs_of(found.integral);
  all["flaw"] = found.flaw;
  all["used"] = found.rows.samples;
  return all;
}

// Value, slope, χ², its degrees of freedom and their chance; None where no line is told.
py::object zero_step(const std::vector<double>& h, const std::vector<double>& means,
                     const std::vector<double>& errors) {
  std::vector<AtStep> points;
  for (std::size_t k = 0; k < h.size(); ++k) points.push_back({h[k], {means[k], errors[k]}});
  const auto found = at_zero_step(points);
  if (!found) return py::none();
  return py::make_tuple(pair_of(found->value), pair_of(found->slope), found->chi_square, found->free,
                        found->chance);
}

py::dict displacement(const Array& frames, const Times& t, const std::vector<double>& masses,
                      const std::vector<int>& molecule) {
  MeanSquareDisplacement moved(Eigen::Map<const Eigen::VectorXd>(masses.data(), std::ssize(masses)),
                               molecule);
  for (py::ssize_t frame = 0; frame < frames.shape(0); ++frame)
    moved.see(t[static_cast<std::size_t>(frame)], frame_of(frames, frame));
  const auto found = moved.result();
  py::dict all;
  all["used"] = found.frames.samples;
  all["t"] = found.t;
  all["squared"] = pairs_of(found.squared);
  all["diffusion"] = pair_of(found.diffusion);
  all["exponent"] = found.exponent;
  return all;
}

py::dict chains(const Array& frames, const Times& t, const std::vector<std::vector<int>>& atoms) {
  std::vector<Chain> all_chains;
  std::vector<std::array<int, 2>> ends;
  for (const std::vector<int>& chain : atoms) {
    all_chains.push_back({.atoms = chain, .first = chain.front(), .last = chain.back()});
    ends.push_back({chain.front(), chain.back()});
  }
  ChainMeasures sizes(std::move(all_chains));
  EndToEnd distance(std::move(ends));
  for (py::ssize_t frame = 0; frame < frames.shape(0); ++frame) {
    const Vectors x = frame_of(frames, frame);
    const double at = t[static_cast<std::size_t>(frame)];
    sizes.add_frame(at, x);
    distance.see(at, x);
  }
  const auto relaxation = sizes.relaxation();
  py::dict all;
  all["end_to_end_squared"] = pair_of(distance.squared());
  all["gyration_squared"] = pair_of(sizes.gyration_squared());
  all["t"] = relaxation.t;
  all["correlation"] = pairs_of(relaxation.correlation);
  all["relaxation"] = pair_of(relaxation.time);
  all["flaw"] = relaxation.flaw;
  all["used"] = relaxation.frames.samples;
  return all;
}

}  // namespace

void bind_measures(py::module_& m) {
  m.def("measure_mean", [](const std::vector<double>& y, const Times& t) {
    return pair_of(correlated_mean(EvenMeans(t).of(y)));
  });
  m.def("measure_equilibration", [](const std::vector<double>& y, const Times& t) {
    const EvenMeans even(t);
    return even.first_sample(equilibration_end(even.of(y)));
  });
  m.def("measure_viscosity", viscosity);
  m.def("measure_displacement", displacement);
  m.def("measure_chains", chains);
  m.def("measure_size_correction", finite_size_correction);
  m.def("measure_zero_step", zero_step);
}

}  // namespace taut
