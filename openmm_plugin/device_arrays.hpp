#pragma once

#include <openmm/common/ComputeContext.h>

#include <memory>
#include <string>
#include <vector>

// Numbers on a device, in the precision of its velocities, which is that of all that taut's step computes.
namespace taut {

using DeviceArray = std::unique_ptr<OpenMM::ArrayInterface>;

bool in_double(const OpenMM::ComputeContext& device);  // else in single precision

// Filled with zeros, and never empty: OpenCL has no empty arrays.
DeviceArray make_array(OpenMM::ComputeContext& device, std::size_t size, int element_size,
                       const std::string& called);
DeviceArray make_numbers(OpenMM::ComputeContext& device, const std::vector<double>& numbers,
                         const std::string& called);
DeviceArray make_integers(OpenMM::ComputeContext& device, const std::vector<int>& integers,
                          const std::string& called);
DeviceArray make_vectors(OpenMM::ComputeContext& device, std::size_t size,
                         const std::string& called);  // of mixed4

void add_number(const OpenMM::ComputeContext& device, OpenMM::ComputeKernel& kernel, double value);
void set_number(const OpenMM::ComputeContext& device, OpenMM::ComputeKernel& kernel, int index, double value);

std::vector<double> numbers_in(const OpenMM::ComputeContext& device, OpenMM::ArrayInterface& array);
void put_numbers(const OpenMM::ComputeContext& device, const std::vector<double>& numbers,
                 OpenMM::ArrayInterface& to);

}  // namespace taut
