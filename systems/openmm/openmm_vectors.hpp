#pragma once

// For those that know OpenMM: exporter and twin.

#include <OpenMM.h>

#include <vector>

#include "md/vectors.hpp"

namespace taut {

inline Vectors from_openmm(const std::vector<OpenMM::Vec3>& columns) {
  Vectors to(3, columns.size());
  for (Eigen::Index a = 0; a < to.cols(); ++a) to.col(a) << columns[a][0], columns[a][1], columns[a][2];
  return to;
}

inline std::vector<OpenMM::Vec3> to_openmm(const Vectors& columns) {
  std::vector<OpenMM::Vec3> to;
  to.reserve(columns.cols());
  for (const auto& c : columns.colwise()) to.emplace_back(c.x(), c.y(), c.z());
  return to;
}

}  // namespace taut
